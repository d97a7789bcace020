"""The tangent of the path that leaves a converged state: which points load, which unload, which touch.

At such a state many points stand on a kink of the law: those on the envelope go on along it or turn into their secant,
and those without a gap open or close. Which, their own rates must say: the tangent is the solution of a
complementarity problem, found by going through sets of points until rates and set agree.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from iga.algebra.factors import Bordered
from iga.interface.interface import holding
from iga.path.gap_newton import GapLaw, settled_step
from iga.path.kinks import Kink
from iga.path.solver import Solver
from iga.system.state import Response, State
from iga.system.system import System


@dataclass(frozen=True)
class Sorting:
    """How points are sorted into those that load, unload and touch.

    There are at most ``attempts``; gaps below ``closed``, in units of g_max, count as closed, and rates below ``still``
    of the largest as rounding. A kink is rough where one slope is less than the part ``rough`` of the other.
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


def away_from_zero(direction: float, opening: float) -> bool:
    """Whether a programme goes on opening, or on pressing: damage may grow there; on the way back it unloads."""
    return direction * opening >= 0.0


def on_envelope(system: System, state: State, g_q: np.ndarray) -> np.ndarray:
    """Points that soften: their damage grows as soon as they open any further."""
    law, k_q = system.interface.law, state.k_q
    return (k_q > law.g_max) & (k_q < law.g_u) & (g_q >= (1.0 - 1e-9) * k_q)


def tangent(
    solver: Solver,
    state: State,
    response: Response,
    direction: float,
    turning: bool = False,
    kink: Kink | None = None,
) -> Tangent | None:
    """Tangent of the path at a converged state; None where the matrix is singular.

    The solver keeps what it was read from: the response with every point on the branch on which it leaves, and the
    factors there.

    Parameters
    ----------
    response : to this very state, used as it is where all its points agree with it.
    direction : +1 where the programme opens the specimen, -1 where it closes it. Damage cannot heal: while it grows
        on the way away from zero the path goes forward where energy is dissipated, whatever the opening does there.
    turning : the programme has turned round at this state, or begins: nothing is known of the points.
    kink : the one that the state stands on; ``slope`` is the mean of both sides where these have one sign.
    """
    system, law, g_q = solver.system, solver.system.interface.law, response.contact.g_q
    onward = away_from_zero(direction, float(system.load_d @ state.u_d))
    soft_q = on_envelope(system, state, g_q) & holding(system.interface, response.contact)
    growing_q = soft_q if onward or not law.irreversible else np.zeros_like(soft_q)
    flat_q = law.contact & (np.abs(g_q) <= SORTING.closed * law.g_max)
    closed_q, found = state.closed_q, None
    for attempt in range(SORTING.attempts):
        if attempt > 0 or turning:
            # a history larger by a rounding is enough to be on the secant, a smaller one to be on the envelope
            k_q = np.where(soft_q & ~growing_q, state.k_q * (1.0 + 1e-12), state.k_q)
            k_q = np.where(growing_q, np.minimum(k_q, g_q) * (1.0 - 1e-12), k_q)
            response = solver.respond(replace(state, k_q=k_q, closed_q=closed_q), decide=False)
        if solver.factorise(response) is None:
            return None
        found = _along(solver, direction, onward, growing_q, kink)
        least = SORTING.still * float(np.abs(found.rate_q).max(initial=0.0))
        agreeing_q = soft_q & (found.rate_q > np.where(growing_q, -least, least)) if law.irreversible else soft_q
        touching_q = np.where(flat_q & turning, found.rate_q < 0.0, closed_q)
        if (agreeing_q == growing_q).all() and (touching_q == closed_q).all():
            return replace(found, agreed=True)
        if attempt == 0 and turning:
            sorted_ = _sorted(solver, state, direction, soft_q, flat_q)
            agreeing_q, touching_q = sorted_ or (agreeing_q, touching_q)
        growing_q, closed_q = agreeing_q, touching_q
    return found


def _sorted(
    solver: Solver, state: State, direction: float, soft_q: np.ndarray, flat_q: np.ndarray
) -> tuple[np.ndarray, np.ndarray] | None:
    """Points that grow and points that touch, under a load that changes in a direction; None where that is not found.

    As a rate has a slope where it opens and another where it closes, rates are gaps of a law with a kink at zero.
    """
    assert solver.linearised is not None
    response, inverse = solver.linearised.response, solver.linearised.inverse
    interface, law = solver.system.interface, solver.system.interface.law
    touch = replace(response.contact, g_q=np.zeros(interface.points))
    held_q = np.where(holding(interface, touch), touch.share_q, 0.0)
    secant_q, falling = held_q * law.secant(state.k_q), law.softening(state.k_q)
    pressed_q = touch.share_q * law.penalty

    def growing(rate_q: np.ndarray) -> np.ndarray:
        return soft_q & (rate_q > 0.0) if law.irreversible else soft_q

    def touching(rate_q: np.ndarray) -> np.ndarray:
        return np.where(flat_q, rate_q < 0.0, response.closed_q)

    def tractions(rate_q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        slope_q = np.where(touching(rate_q), pressed_q, np.where(growing(rate_q), held_q * falling, secant_q))
        return slope_q * rate_q, slope_q

    with solver.phase("solve"):
        load = Bordered(inverse, np.zeros(solver.system.n_dof), 1.0)
        linear_d = direction * np.append(inverse.under_load_d, 1.0)
        rates = GapLaw(interface, touch, tractions, np.zeros(interface.points), response.dp_q)
        step_d = settled_step(rates, linear_d, load)
    if step_d is None:
        return None
    rate_q = touch.rates(step_d[:-1])
    return growing(rate_q), touching(rate_q)


def _along(solver: Solver, direction: float, onward: bool, growing_q: np.ndarray, kink: Kink | None) -> Tangent:
    """Solution of ``K du = f d_load`` for one set of points, turned forward."""
    assert solver.linearised is not None
    system, response, z_d = solver.system, solver.linearised.response, solver.inverse.under_load_d
    before_d = z_d if kink is None else _before(solver, response, kink)
    compliance, before = float(system.load_d @ z_d), float(system.load_d @ before_d)
    arrival, departure = 1.0 / before if before != 0.0 else np.inf, 1.0 / compliance
    slope = 0.5 * (departure + arrival) if before * compliance > 0.0 else departure
    rate_q = response.contact.rates(z_d)
    onto_envelope = onward or not system.interface.law.irreversible

    def forward(rate_q: np.ndarray, compliance: float) -> float:
        growth = float(system.interface.dA_q @ np.where(growing_q, rate_q, 0.0))
        if growth != 0.0 and onto_envelope:
            return float(np.sign(growth)) if onward else -float(np.sign(growth))
        return direction * float(np.sign(compliance))

    sign = forward(rate_q, compliance)
    came = sign if kink is None else forward(response.contact.rates(before_d), before)
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
    """Solution with the tangent just before a kink: one point less stiff by its jump (Sherman and Morrison 1950)."""
    interface = solver.system.interface
    g_d = response.contact.row(kink.q, solver.system.n_dof)
    with solver.phase("solve"):
        y_d, z_d = solver.inverse.solve(g_d[:, None])[:, 0], solver.inverse.under_load_d
    weight = -interface.law.jump(kink.gap) * interface.dA_q[kink.q]
    return z_d - y_d * (weight * float(g_d @ z_d) / (1.0 + weight * float(g_d @ y_d)))
