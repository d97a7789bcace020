"""The tangent of the path that leaves a converged state: which points load and which unload.

At such a state many points stand on a kink of the law: those on the envelope go on along it or turn into their secant.
The rates decide, and they depend on the decision: the tangent is the solution of a complementarity problem, found by
trying sets of points until rates and set agree.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from iga.interface.response import holding
from iga.path.kinks import Kink
from iga.path.solver import Solver
from iga.system.state import Response, State
from iga.system.system import System


@dataclass(frozen=True)
class Sorting:
    """How points are sorted into those that load and those that unload.

    - ``attempts``: largest number of sets of points that are tried, each with a tangent of its own.
    - ``zero``: openings below it, in units of g_max, count as none.
    - ``still``: rates below this part of the largest are rounding.
    - ``rough``: a kink is rough where one slope is less than this part of the other.
    """

    attempts: int = 30
    zero: float = 1e-6
    still: float = 1e-9
    rough: float = 1.0 / 3.0


SORTING = Sorting()


@dataclass(frozen=True)
class Tangent:
    """Direction of the path ``(du_d, d_load)``, of any length, forward.

    ``slope`` is d load / d opening; at a kink ``arrival`` is the slope before it, ``departure`` that behind it, and
    ``slope`` their mean. ``heading`` is the sign of the change of the opening, ``came`` that before the kink,
    ``rate_q`` (n_q,) the rates of `Response.x_q`, and ``growing_q`` the points whose damage grows.
    """

    du_d: np.ndarray
    d_load: float
    slope: float
    heading: float
    rate_q: np.ndarray
    growing_q: np.ndarray
    arrival: float
    departure: float
    came: float

    @property
    def rough(self) -> bool:
        """Whether the slope changes so much at a kink that neither side is a guide to the way ahead."""
        low, high = sorted((self.arrival, self.departure), key=abs)
        return low * high <= 0.0 or abs(low) < SORTING.rough * abs(high)


def away_from_zero(system: System, direction: float, opening: float) -> bool:
    """Whether a programme goes away from zero, opening or pressing: damage may grow. On the way back it unloads.

    Where it comes through zero the opening there is rounding, of either sign.
    """
    return direction * opening >= -SORTING.zero * system.interface.law.g_max


def on_envelope(system: System, state: State, response: Response) -> np.ndarray:
    """Points on the softening envelope: damage grows with any further separation. ``response`` is that of the state."""
    law, k_q = system.interface.law, state.k_q
    return (k_q > law.begun) & (k_q < law.failed) & (response.pull.driven_q >= (1.0 - 1e-9) * k_q)


def tangent(
    solver: Solver,
    state: State,
    response: Response,
    direction: float,
    turning: bool = False,
    kink: Kink | None = None,
) -> Tangent | None:
    """Tangent of the path at a converged state; None where the matrix is singular.

    The solver keeps the linearisation it was found with: the response with every point on the branch on which it
    leaves, and the factors of its tangent.

    Parameters
    ----------
    response : the response to this state, used as it is where all its points agree with it.
    direction : +1 where the programme opens the specimen, -1 where it closes it. Damage cannot heal: while it grows
        on the way away from zero the path goes forward where energy is dissipated, whatever the opening does there.
    turning : the programme has turned round at this state, or begins: it is not known which points load.
    kink : the kink that the state stands on; ``slope`` is the mean of both sides where these have one sign.
    """
    system, law = solver.system, solver.system.interface.law
    onward = away_from_zero(system, direction, float(system.load_d @ state.u_d))
    soft_q = on_envelope(system, state, response) & holding(system.interface, response.contact)
    growing_q = soft_q if onward or not law.irreversible else np.zeros_like(soft_q)
    driven_q, found, tried = response.pull.driven_q, None, set()
    for attempt in range(SORTING.attempts):
        if attempt > 0 or turning:
            # a history larger by a rounding is enough to be on the secant, a smaller one to be on the envelope
            k_q = law.nudged(state.k_q, driven_q, growing_q, soft_q & ~growing_q)
            response = solver.respond(replace(state, k_q=k_q), decide=False)
        if solver.factorise(response) is None:
            return None
        found = _along(solver, direction, onward, growing_q, kink)
        least = SORTING.still * float(np.abs(found.rate_q).max(initial=0.0))
        agreeing_q = soft_q & (found.rate_q > np.where(growing_q, -least, least)) if law.irreversible else soft_q
        if (agreeing_q == growing_q).all():
            break
        tried.add(growing_q.tobytes())
        growing_q = _untried(growing_q, agreeing_q, np.flatnonzero(soft_q), tried)
    return found


def in_time(solver: Solver, state: State, dt: float, direction: float) -> Tangent | None:
    """Tangent of a path with viscosity for a step of the time ``dt``; None where the matrix is singular.

    The solver keeps its factors for the next step. Delayed damage goes on growing whatever the jumps do, so that points
    need not be sorted into loading and unloading; forward is the direction of the programme.
    """
    response = solver.respond(replace(state, dt=dt), decide=False)
    if solver.factorise(response) is None:
        return None
    found = _along(solver, direction, True, np.zeros_like(state.closed_q), None)
    return replace(found, growing_q=response.k_q > state.k_q)


def _untried(now_q: np.ndarray, asked_q: np.ndarray, soft: np.ndarray, tried: set[bytes]) -> np.ndarray:
    """The set of growing points (n_q,) that rates have ``asked`` for or, if that has been ``tried``, the one of ``now``
    with one point changed that has not: the first point asked to change, or else of the ``soft`` points (n_m,).

    Where the load falls, rates alone may not tell where damage grows: of two softening neighbours one may have to
    unload.
    """
    if asked_q.tobytes() not in tried:
        return asked_q
    for q in (*np.flatnonzero(now_q != asked_q), *soft):
        other_q = now_q.copy()
        other_q[q] = ~other_q[q]
        if other_q.tobytes() not in tried:
            return other_q
    return asked_q


def _along(solver: Solver, direction: float, onward: bool, growing_q: np.ndarray, kink: Kink | None) -> Tangent:
    """Solution of ``K du = f d_load`` for one set of points, turned forward."""
    assert solver.linearised is not None
    system, response, z_d = solver.system, solver.linearised.response, solver.inverse.under_load_d
    before_d = z_d if kink is None else _before(solver, response, kink)
    compliance, before = float(system.load_d @ z_d), float(system.load_d @ before_d)
    arrival, departure = 1.0 / before if before != 0.0 else np.inf, 1.0 / compliance
    slope = 0.5 * (departure + arrival) if before * compliance > 0.0 else departure
    rate_q = response.x_rates(z_d)
    onto_envelope = onward or not system.interface.law.irreversible

    def forward(rate_q: np.ndarray, compliance: float) -> float:
        growth = float(system.interface.dA_q @ np.where(growing_q, rate_q, 0.0))
        if growth != 0.0 and onto_envelope:
            return float(np.sign(growth)) if onward else -float(np.sign(growth))
        return direction * float(np.sign(compliance))

    sign = forward(rate_q, compliance)
    came = sign if kink is None else forward(response.x_rates(before_d), before)
    return Tangent(
        du_d=sign * z_d,
        d_load=sign,
        slope=slope,
        heading=sign * float(np.sign(compliance)),
        rate_q=sign * rate_q,
        growing_q=growing_q,
        arrival=arrival,
        departure=departure,
        came=came * float(np.sign(before)),
    )


def _before(solver: Solver, response: Response, kink: Kink) -> np.ndarray:
    """Solution with the tangent just before a kink: one point has other slopes there (Sherman and Morrison 1950)."""
    system, q = solver.system, np.array([kink.q])
    rows, change = response.contact.jump_rows, response.pull.slopes_across(kink.q, kink.gap)
    change = change * system.interface.dA_q[kink.q]
    V_dr = np.concatenate([row.gradients(q, system.n_dof) for row in rows], axis=1)
    with solver.phase("solve"):
        Y_dr, z_d = solver.inverse.solve(V_dr), solver.inverse.under_load_d
    small_rr = np.eye(len(rows)) + change @ (V_dr.T @ Y_dr)
    return z_d - Y_dr @ np.linalg.solve(small_rr, change @ (V_dr.T @ z_d))
