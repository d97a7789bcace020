"""The equilibrium path: tangent predictor, choice of the control, step length, programme.

While damage grows the opening of the cohesive front is prescribed, so that the path is followed through snap-backs;
otherwise the opening of the specimen is.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from iga.newton import DEFAULT, Control, Newton, equilibrium, gap_control, opening_control
from iga.quadrature import gauss
from iga.system import Phase, Response, State, System, factorise, respond, untimed

#: Attempts at the contact of a tangent that leaves a state, and the gap, in units of g_max, that counts as none.
CONTACT, NO_GAP = 30, 1e-6


@dataclass(frozen=True)
class Point:
    """A converged point of the path, its history committed.

    ``slope`` is d load / d opening and ``du_d`` is du / d opening along the path, from the tangent at this very point;
    ``external_work`` is the integral of the load over the opening along the path.
    ``residuals`` are the norms that Newton went through, relative to the scale of the forces; ``heading`` is the sign
    of the change of the opening along the path.
    """

    state: State
    response: Response
    opening: float
    slope: float
    du_d: np.ndarray
    external_work: float
    iterations: int
    residuals: tuple[float, ...]
    heading: float = 1.0


@dataclass(frozen=True)
class End:
    """How a path ended: ``complete`` or ``stopped: <cause and what to do>``, and how many steps were taken back.

    ``separated``: the specimen came apart before the programme was over, which is a complete path, too.
    """

    status: str
    rejected: int
    separated: bool = False


def front(system: System, point: Point) -> int | None:
    """The most open quadrature point whose damage is growing: the front of the crack."""
    law, g_q = system.interface.law, point.response.contact.g_q
    k_q = point.state.k_q
    alive = np.where((k_q > law.g_max) & (k_q < law.g_u) & (g_q >= (1.0 - 1e-9) * k_q), g_q, -np.inf)
    most = int(np.argmax(alive))
    return most if alive[most] > 0.0 else None


def follow(
    system: System, programme: Sequence[float], steps: int, newton: Newton = DEFAULT, phase: Phase = untimed
) -> Iterator[Point | End]:
    """Walk through a programme of openings; yields every converged `Point` and, last, the `End`.

    Parameters
    ----------
    programme : openings to be reached one after the other, from zero.
    steps : number of steps asked for over the whole programme; one that fails is halved, down to 1/1024, and grows
        again afterwards.
    """
    largest = float(np.sum(np.abs(np.diff([0.0, *programme])))) / steps
    step, rejected = largest, 0
    heading = float(np.sign(programme[0]))
    point = _departing(system, system.start(), heading, phase)
    yield point
    for goal in programme:
        if heading * (goal - point.opening) < 0.0:
            heading = -heading
            turned = _departing(system, point.state, heading, phase)
            point = replace(turned, external_work=point.external_work)
        loading = heading > 0.0
        while point.opening != goal:
            control, change, exact = _choose(system, point, goal, step, step / largest, loading)
            reached = _advance(system, point, control, change, newton, phase)
            if reached is not None and loading and reached.opening > goal and not exact:
                exact = True
                reached = _advance(system, point, opening_control(system), goal - point.opening, newton, phase)
            if reached is not None:
                moved = abs(reached.opening - point.opening)
                point = replace(reached, opening=goal) if exact else reached
                yield point
                step = min(step * min(max(largest / (moved or largest), 0.5), 2.0), largest)
                continue
            rejected, step = rejected + 1, 0.5 * step
            if step < largest / 1024:
                yield End(_advice(point.opening), rejected)
                return
    yield End("complete", rejected)


def _choose(
    system: System, point: Point, goal: float, step: float, fraction: float, loading: bool
) -> tuple[Control, float, bool]:
    """Control of the next step, the change asked of it, and whether it ends exactly on the goal.

    The front moves on by at most a quarter of g_u, and by no more than changes the opening by ``step``.
    """
    left, q = goal - point.opening, front(system, point) if loading else None
    if q is None or 0.0 < left < step and fraction == 1.0:
        exact = abs(left) < 1.001 * step
        return opening_control(system), left if exact else np.copysign(step, left), exact
    gap_rate = float(point.response.contact.rates(point.du_d)[q])
    change = min(0.25 * fraction * system.interface.law.g_u, abs(gap_rate) * step)
    return gap_control(system, q), change, False


def _departing(system: System, state: State, direction: float, phase: Phase) -> Point:
    """A converged state with the tangent of the path that leaves it for larger (+1) or smaller (-1) openings.

    Points that set out to unload do so along their secants, for which a history larger by a rounding is enough. Where a
    gap is zero, as all are before anything moves, its rate alone shows whether it will close: contact is set by the
    rates until it stays.
    """
    tiny = NO_GAP * system.interface.law.g_max
    held = replace(state, k_q=state.k_q * (1.0 + 1e-12)) if direction < 0.0 else state
    for _ in range(CONTACT):
        with phase("assembly"):
            response = respond(system, held, decide=False)
        point = _point(system, replace(state, closed_q=held.closed_q), response, (), phase)
        if point is None:
            raise ValueError("the system is singular: the supports or the interface do not hold the bodies")
        touch = response.contact
        rates_q = direction * touch.rates(point.du_d)
        closed_q = np.where(np.abs(touch.g_q) <= tiny, rates_q < 0.0, touch.g_q < 0.0)
        if np.array_equal(closed_q, held.closed_q):
            break
        held = replace(held, closed_q=closed_q)
    return point


def _advance(
    system: System, point: Point, control: Control, change: float, newton: Newton, phase: Phase
) -> Point | None:
    """One step from the tangent predictor, or None; nothing is committed before it has converged."""
    value, a_d = control(point.state, point.response)
    d_opening = change / float(a_d @ point.du_d)
    old = point.state
    trial = replace(old, u_d=old.u_d + d_opening * point.du_d, load=old.load + d_opening * point.slope)
    found = equilibrium(system, trial, control, value + change, change, newton, phase)
    if found is None:
        return None
    trial, response, residuals = found
    state = replace(trial, k_q=response.k_q, scale=max(old.scale, response.scale))
    reached = _point(system, state, response, residuals, phase)
    if reached is None:
        return None
    rates = (1.0 / float(a_d @ point.du_d), 1.0 / float(control(trial, response)[1] @ reached.du_d))
    return replace(reached, external_work=point.external_work + _work(point, reached, change, rates))


def _work(start: Point, end: Point, change: float, rates: tuple[float, float]) -> float:
    """Integral of the load over the opening along one step, both cubic Hermite curves over the controlled quantity.

    ``change`` is the step of that quantity and ``rates`` the derivative of the opening by it at both ends. Unlike a
    rule over the opening it holds where the path turns back. Its error is of fourth order; three Gauss points
    integrate it exactly.
    """
    s, w = gauss(3)
    values = np.stack([(1 + 2 * s) * (1 - s) ** 2, s * s * (3 - 2 * s)])
    slopes = np.stack([s * (1 - s) ** 2, s * s * (s - 1)])
    d_values = np.stack([6 * s * (s - 1), 6 * s * (1 - s)])
    d_slopes = np.stack([(1 - s) * (1 - 3 * s), s * (3 * s - 2)])
    d_opening = change * np.array(rates)
    load = np.array([start.state.load, end.state.load]) @ values + d_opening * [start.slope, end.slope] @ slopes
    d_opening_ds = np.array([start.opening, end.opening]) @ d_values + d_opening @ d_slopes
    return float(np.sum(w * load * d_opening_ds))


def _point(
    system: System, state: State, response: Response, residuals: tuple[float, ...], phase: Phase
) -> Point | None:
    """The converged point with its exact path tangent ``K du = f d_load``, scaled to a unit change of the opening."""
    with phase("factor"):
        lu = factorise(response)
    if lu is None:
        return None
    with phase("solve"):
        z_d = lu.solve(system.load_d[:, None])[:, 0]
    slope = 1.0 / float(system.load_d @ z_d)
    opening = float(system.load_d @ state.u_d)
    return Point(state, response, opening, slope, slope * z_d, 0.0, len(residuals), residuals)


def _advice(opening: float) -> str:
    return (
        f"stopped: Newton did not converge beyond opening {opening:.6g} even with a step 1024 times smaller; "
        "refine the mesh along the crack (discretization.dofs), take more interface points "
        "(discretization.interface_points) or lower interface.strength"
    )
