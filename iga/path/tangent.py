"""The tangent of the path that leaves a converged state: which points load, which unload, which touch.

At such a state many points stand on a kink of the law: those on the envelope go on along it or turn into their secant,
and those without a gap open or close. Which, their own rates must say: the tangent is the solution of a
complementarity problem, found by going through sets of points until rates and set agree.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from iga.algebra.factors import Bordered, Inverse
from iga.interface.interface import holding
from iga.path.gap_newton import settled_step
from iga.path.kinks import Kink
from iga.system.state import Response, State
from iga.system.system import Phase, System, factorise, respond

#: Attempts at the set of points, the gap, in units of g_max, that counts as none, and the part of the largest rate
#: that counts as rounding.
ATTEMPTS, NO_GAP, NO_RATE = 30, 1e-6, 1e-9

#: A slope less than this part of the one on the other side of a kink.
ROUGH = 1.0 / 3.0


@dataclass(frozen=True)
class Tangent:
    """Direction of the path ``(du_d, d_load)``, of any length, forward.

    ``slope`` is d load / d opening; at a kink ``arrival`` is the slope before it, ``departure`` that behind it, and
    ``slope`` their mean. ``heading`` is the sign of the change of the opening, ``came`` that before the kink,
    ``rate_q`` (n_q,) the rates of the gaps, and ``growing_q`` the points whose damage grows.
    ``closed_q`` is the contact; whether the rates agree with it and with ``growing_q``, ``agreed`` says.
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
        """Whether the slope changes so much at a kink that neither side says anything of the way ahead."""
        low, high = sorted((self.arrival, self.departure), key=abs)
        return low * high <= 0.0 or abs(low) < ROUGH * abs(high)


@dataclass(frozen=True)
class Linearised:
    """A response with every point on the branch that it leaves on, and the inverse of its tangent."""

    response: Response
    inverse: Inverse


def away_from_zero(direction: float, opening: float) -> bool:
    """Whether a programme goes on opening, or on pressing: damage may grow there; on the way back it unloads."""
    return direction * opening >= 0.0


def on_envelope(system: System, state: State, g_q: np.ndarray) -> np.ndarray:
    """Points that soften: their damage grows as soon as they open any further."""
    law, k_q = system.interface.law, state.k_q
    return (k_q > law.g_max) & (k_q < law.g_u) & (g_q >= (1.0 - 1e-9) * k_q)


def tangent(
    system: System,
    state: State,
    response: Response,
    direction: float,
    phase: Phase,
    turning: bool = False,
    kink: Kink | None = None,
) -> tuple[Tangent, Linearised] | None:
    """Tangent of the path at a converged state, and what it was read from; None where the matrix is singular.

    Parameters
    ----------
    response : to this very state, used as it is where all its points agree with it.
    direction : +1 where the programme opens the specimen, -1 where it closes it. Damage cannot heal: while it grows
        on the way away from zero the path goes forward where energy is dissipated, whatever the opening does there.
    turning : the programme has turned round at this state, or begins: nothing is known of the points.
    kink : the one that the state stands on; ``slope`` is the mean of both sides where these have one sign.
    """
    law, g_q = system.interface.law, response.contact.g_q
    onward = away_from_zero(direction, float(system.load_d @ state.u_d))
    soft_q = on_envelope(system, state, g_q) & holding(system.interface, response.contact)
    growing_q = soft_q if onward or not law.irreversible else np.zeros_like(soft_q)
    flat_q = law.contact & (np.abs(g_q) <= NO_GAP * law.g_max)
    closed_q = state.closed_q
    inverse: Inverse | None
    for attempt in range(ATTEMPTS):
        if attempt > 0 or turning:
            # a history larger by a rounding is enough to be on the secant, a smaller one to be on the envelope
            k_q = np.where(soft_q & ~growing_q, state.k_q * (1.0 + 1e-12), state.k_q)
            k_q = np.where(growing_q, np.minimum(k_q, g_q) * (1.0 - 1e-12), k_q)
            with phase("assembly"):
                response = respond(system, replace(state, k_q=k_q, closed_q=closed_q), decide=False)
        inverse = None  # before the next one is made
        inverse = factorise(system, response, phase)
        if inverse is None:
            return None
        with phase("solve"):
            found = _along(system, response, inverse, direction, onward, growing_q, kink)
        least = NO_RATE * float(np.abs(found.rate_q).max(initial=0.0))
        agreeing_q = soft_q & (found.rate_q > np.where(growing_q, -least, least)) if law.irreversible else soft_q
        touching_q = np.where(flat_q & turning, found.rate_q < 0.0, closed_q)
        if (agreeing_q == growing_q).all() and (touching_q == closed_q).all():
            return replace(found, agreed=True), Linearised(response, inverse)
        if attempt == 0 and turning:
            with phase("solve"):
                agreeing_q, touching_q = _sorted_out(system, state, response, inverse, direction, soft_q, flat_q) or (
                    agreeing_q,
                    touching_q,
                )
        growing_q, closed_q = agreeing_q, touching_q
    return None if inverse is None else (found, Linearised(response, inverse))


def _sorted_out(
    system: System,
    state: State,
    response: Response,
    inverse: Inverse,
    direction: float,
    soft_q: np.ndarray,
    flat_q: np.ndarray,
) -> tuple[np.ndarray, np.ndarray] | None:
    """Points that grow and points that touch, under a load that changes in a direction; None where that is not found.

    As a rate has a slope where it opens and another where it closes, rates are gaps of a law with a kink at zero.
    """
    interface, law = system.interface, system.interface.law
    touch = replace(response.contact, g_q=np.zeros(interface.points))
    held_q = np.where(holding(interface, touch), touch.share_q, 0.0)
    secant_q, falling = held_q * law.secant(state.k_q), law.softening(state.k_q)
    pressed_q = touch.share_q * law.penalty

    def growing(rate_q: np.ndarray) -> np.ndarray:
        return soft_q & (rate_q > 0.0) if law.irreversible else soft_q

    def touching(rate_q: np.ndarray) -> np.ndarray:
        return np.where(flat_q, rate_q < 0.0, response.closed_q)

    def rates(rate_q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        slope_q = np.where(touching(rate_q), pressed_q, np.where(growing(rate_q), held_q * falling, secant_q))
        return slope_q * rate_q, slope_q

    load = Bordered(inverse, np.zeros(system.n_dof), 1.0)
    plain_d, tangents = direction * np.append(inverse.under_load_d, 1.0), (np.zeros(interface.points), response.dp_q)
    step_d = settled_step(interface, touch, rates, tangents, plain_d, load)
    if step_d is None:
        return None
    rate_q = touch.rates(step_d[:-1])
    return growing(rate_q), touching(rate_q)


def _along(
    system: System,
    response: Response,
    inverse: Inverse,
    direction: float,
    onward: bool,
    growing_q: np.ndarray,
    kink: Kink | None,
) -> Tangent:
    """Solution of ``K du = f d_load`` for one set of points, turned forward."""
    z_d = inverse.under_load_d
    before_d = z_d if kink is None else _before(system, response, kink, inverse)
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
        sign * z_d,
        sign,
        slope,
        sign * float(np.sign(compliance)),
        sign * rate_q,
        growing_q,
        response.closed_q,
        arrival,
        departure,
        came * float(np.sign(before)),
    )


def _before(system: System, response: Response, kink: Kink, inverse: Inverse) -> np.ndarray:
    """Solution with the tangent just before a kink: one point less stiff by its jump (Sherman and Morrison 1950)."""
    g_d = response.contact.row(kink.q, system.n_dof)
    y_d, z_d = inverse.solve(g_d[:, None])[:, 0], inverse.under_load_d
    weight = -kink.jump * system.interface.dA_q[kink.q]
    return z_d - y_d * (weight * float(g_d @ z_d) / (1.0 + weight * float(g_d @ y_d)))
