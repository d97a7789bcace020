"""The tangent of the path that leaves a converged state: which points load, which unload, which touch.

At such a state many points stand on a kink of the law: those on the envelope go on along it or turn into their secant,
and those without a gap open or close. The rates decide, and they depend on the decision: the tangent is the solution of
a complementarity problem, found by trying sets of points until rates and set agree.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from iga.interface.interface import Interface
from iga.interface.response import holding
from iga.laws.mixed_law import History
from iga.laws.traction_law import TractionLaw
from iga.path.kinks import Kink
from iga.path.solver import Solver
from iga.system.state import Response, State
from iga.system.system import System


@dataclass(frozen=True)
class Sorting:
    """How points are sorted into those that load, unload and touch.

    - ``attempts``: largest number of sets of points that are tried, each with a tangent of its own.
    - ``closed``: gaps below it, in units of g_max, count as closed.
    - ``still``: rates below this part of the largest are rounding.
    - ``rough``: a kink is rough where one slope is less than this part of the other.
    """

    attempts: int = 30
    closed: float = 1e-6
    still: float = 1e-9
    rough: float = 1.0 / 3.0


SORTING = Sorting()


@dataclass(frozen=True)
class Tangent:
    """Direction of the path ``(du_d, d_load)``, of any length, forward.

    ``slope`` is d load / d opening; at a kink ``arrival`` is the slope before it, ``departure`` that behind it, and
    ``slope`` their mean. ``heading`` is the sign of the change of the opening, ``came`` that before the kink,
    ``rate_q`` (n_q,) the rates of the gaps, and ``growing_q`` the points whose damage grows.
    ``closed_q`` is the contact; ``agreed`` where the rates agree with it and with ``growing_q``.
    """

    du_d: np.ndarray
    d_load: float
    slope: float
    heading: float
    rate_q: np.ndarray
    growing_q: np.ndarray
    closed_q: np.ndarray
    arrival: float
    departure: float
    came: float
    agreed: bool = False

    @property
    def rough(self) -> bool:
        """Whether the slope changes so much at a kink that neither side is a guide to the way ahead."""
        low, high = sorted((self.arrival, self.departure), key=abs)
        return low * high <= 0.0 or abs(low) < SORTING.rough * abs(high)


def away_from_zero(system: System, direction: float, opening: float) -> bool:
    """Whether a programme goes away from zero, opening or pressing: damage may grow. On the way back it unloads.

    Where it comes through zero the opening there is rounding, of either sign.
    """
    return direction * opening >= -SORTING.closed * system.interface.law.g_max


def on_envelope(system: System, state: State, response: Response) -> np.ndarray:
    """Points on the softening envelope: damage grows with any further separation. ``response`` is that of the state."""
    law, k_q = system.interface.law, state.k_q
    active_q = (k_q > law.begun) & (k_q < law.failed)
    shear = response.pull.shear
    if shear is not None:
        return active_q & (shear.driven_q >= (1.0 - 1e-9) * k_q)
    return active_q & (response.contact.g_q >= (1.0 - 1e-9) * k_q)


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
    turning : the programme has turned round at this state, or begins: it is not known which points load or touch.
    kink : the kink that the state stands on; ``slope`` is the mean of both sides where these have one sign.
    """
    system, law, g_q = solver.system, solver.system.interface.law, response.contact.g_q
    driving_q = g_q if response.pull.shear is None else response.pull.shear.driven_q
    onward = away_from_zero(system, direction, float(system.load_d @ state.u_d))
    soft_q = on_envelope(system, state, response) & holding(system.interface, response.contact)
    growing_q = soft_q if onward or not law.irreversible else np.zeros_like(soft_q)
    flat_q = law.contact & (np.abs(g_q) <= SORTING.closed * law.g_max)
    closed_q, found = state.closed_q, None
    tried: set[bytes] = set()
    for attempt in range(SORTING.attempts):
        if attempt > 0 or turning:
            # a history larger by a rounding is enough to be on the secant, a smaller one to be on the envelope
            k_q = law.nudged(state.k_q, driving_q, growing_q, soft_q & ~growing_q)
            response = solver.respond(replace(state, k_q=k_q, closed_q=closed_q), decide=False)
        if solver.factorise(response) is None:
            return None
        found = _along(solver, direction, onward, growing_q, kink)
        least = SORTING.still * float(np.abs(found.rate_q).max(initial=0.0))
        agreeing_q = soft_q & (found.rate_q > np.where(growing_q, -least, least)) if law.irreversible else soft_q
        touching_q = np.where(flat_q & turning, response.contact.rates(found.du_d) < 0.0, closed_q)
        if (agreeing_q == growing_q).all() and (touching_q == closed_q).all():
            return replace(found, agreed=True)
        tried.add(np.concatenate([growing_q, closed_q]).tobytes())
        if np.concatenate([agreeing_q, touching_q]).tobytes() in tried:
            asked, now = (agreeing_q, touching_q), (growing_q, closed_q)
            agreeing_q, touching_q = _one_changed(now, asked, np.flatnonzero(soft_q), tried)
        growing_q, closed_q = agreeing_q, touching_q
    return found


def _one_changed(
    now: tuple[np.ndarray, np.ndarray], asked: tuple[np.ndarray, np.ndarray], soft: np.ndarray, tried: set[bytes]
) -> tuple[np.ndarray, np.ndarray]:
    """The sets of growing and of closed points (n_q,) ``now`` with one point changed, so that they were not ``tried``
    yet: the first such point that is ``asked`` to change, or else of the ``soft`` points (n_m,). Else ``asked``.

    Where the load falls, rates alone may not tell where damage grows: of two softening neighbours one may have to
    unload.
    """
    both, points = np.concatenate(now), now[0].size
    for place in (*np.flatnonzero(both != np.concatenate(asked)), *soft):
        other = both.copy()
        other[place] = ~other[place]
        if other.tobytes() not in tried:
            return other[:points], other[points:]
    return asked


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
        closed_q=response.closed_q,
        arrival=arrival,
        departure=departure,
        came=came * float(np.sign(before)),
    )


def _before(solver: Solver, response: Response, kink: Kink) -> np.ndarray:
    """Solution with the tangent just before a kink: one point has other slopes there (Sherman and Morrison 1950)."""
    system, q = solver.system, np.array([kink.q])
    touch, change = response.contact, slopes_before(system.interface, response, kink) * system.interface.dA_q[kink.q]
    rows = [touch.gap_rows] if touch.slip is None else [touch.gap_rows, touch.slip.rows]
    V_dr = np.concatenate([row.gradients(q, system.n_dof) for row in rows], axis=1)
    with solver.phase("solve"):
        Y_dr, z_d = solver.inverse.solve(V_dr), solver.inverse.under_load_d
    small_rr = np.eye(len(rows)) + change @ (V_dr.T @ Y_dr)
    return z_d - Y_dr @ np.linalg.solve(small_rr, change @ (V_dr.T @ z_d))


def slopes_before(interface: Interface, response: Response, kink: Kink) -> np.ndarray:
    """Slopes of the tractions at a point just before a kink less those after it: (1, 1), or (2, 2) if it slides."""
    law, q = interface.law, [kink.q]
    if isinstance(law, TractionLaw):
        return np.array([[-law.jump(kink.gap)]])
    assert response.contact.slip is not None and response.pull.shear is not None
    g, s, d = response.contact.g_q[q], response.contact.slip.s_q[q], response.k_q[q]
    slips, less = response.pull.shear.slip_q, np.zeros(1) if kink.gap <= law.kinks[0] else law.driven(g, s) * 0.5
    found = []
    for part, damage in ((1.0 - 1e-6, np.minimum(less, d)), (1.0 + 1e-6, np.minimum(less, d))):
        past = History(damage, None if slips is None else slips[q])
        now = law.traction(part * g, part * s, past)
        found.append(np.array([[now.dp_dg, now.dp_ds], [now.dt_dg, now.dt_ds]])[..., 0])
    return found[0] - found[1]
