"""The equilibrium path: predictor along the tangent, choice of the control, step length, programme, end.

While damage grows the opening of the cohesive front is prescribed, so that the path is followed through snap-backs;
otherwise the opening of the specimen is. Where a step fails, the next one ends at the next kink of the law: from kink
to kink a path with a piecewise linear law has no surprises.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from iga.control import Control, gap_control, opening_control
from iga.events import next_event
from iga.landing import landed
from iga.newton import DEFAULT, PATIENT, Newton, equilibrium
from iga.quadrature import gauss
from iga.system import Phase, Response, State, System, energies, respond, untimed
from iga.tangent import Tangent, tangent

#: Largest step of the front in parts of g_u, where steps are counted and where they are chosen by accuracy; smallest
#: step in parts of the largest.
FRONT, FRONT_BY_ACCURACY, SMALLEST = 0.25, 0.5, 1.0 / 4096
#: How far a step may leave the balance of energy open, in parts of the largest work so far: one that leaps over a part
#: of the path does by more.
LEAK = 1e-3
#: Steps chosen by accuracy: the first one in parts of the programme, and by how much of the peak the load may leave
#: the tangent of a step.
FIRST, BEND = 1.0 / 30.0, 0.01
#: A specimen has separated when its load, and all that the rest of the programme could bring back, is below this part
#: of the peak.
SEPARATED = 1e-3
#: A state as good as the one where the path departs is this part of the opening, or of g_max, ahead.
TRIFLE = 1e-6


@dataclass(frozen=True)
class Point:
    """A converged point of the path, its history committed, and the tangent on which the path leaves it.

    ``slope`` is d load / d opening there and ``heading`` the sign of the change of the opening along the path;
    ``external_work`` is the integral of the load over the opening along the path, ``energy`` what is stored and
    dissipated.
    ``residuals`` are the norms that Newton went through, relative to the scale of the forces.
    """

    state: State
    response: Response
    opening: float
    tangent: Tangent
    external_work: float
    energy: float
    residuals: tuple[float, ...]

    @property
    def slope(self) -> float:
        return self.tangent.slope

    @property
    def heading(self) -> float:
        return self.tangent.heading

    @property
    def iterations(self) -> int:
        return len(self.residuals)


@dataclass(frozen=True)
class End:
    """How a path ended: ``complete`` or ``stopped: <cause and what to do>``, and how many steps were taken back.

    ``separated``: the specimen came apart before the programme was over, which is a complete path, too.
    """

    status: str
    rejected: int
    separated: bool = False


@dataclass(frozen=True)
class Step:
    """What is asked of a step: the control, its change, and whether the step ends on the goal."""

    control: Control
    change: float
    exact: bool = False


@dataclass(frozen=True)
class Pace:
    """Step length: ``step`` of the opening and ``front``, in parts of g_u, of the cohesive front, both times ``cut``.

    ``careful`` steps end at the kinks of the law. ``by_accuracy``: the steps are not counted but as long as the curve
    allows, and end where a point breaks.
    """

    largest: float
    step: float
    by_accuracy: bool = False
    careful: bool = False
    cut: float = 1.0

    @property
    def front(self) -> float:
        return self.cut * (FRONT_BY_ACCURACY if self.by_accuracy else FRONT)

    @property
    def length(self) -> float:
        return self.cut * self.step

    def slower(self) -> Pace:
        return replace(self, careful=True, cut=0.5 * self.cut if self.careful else self.cut)

    def after(self, start: Point, end: Point, peak: float) -> Pace:
        """The next step where one from ``start`` to ``end`` has converged."""
        moved = abs(end.opening - start.opening)
        if self.careful:
            return replace(self, careful=self.cut < 1.0, cut=min(2.0 * self.cut, 1.0))
        if not self.by_accuracy:
            return self
        bend = abs(end.state.load - start.state.load - start.slope * (end.opening - start.opening)) / (BEND * peak)
        grown = moved * float(np.clip(bend**-0.5 if bend > 0.0 else 2.0, 0.5, 2.0))
        return replace(self, step=float(np.clip(grown, SMALLEST * self.largest, self.largest)))


def follow(
    system: System, programme: Sequence[float], steps: int | None, newton: Newton = DEFAULT, phase: Phase = untimed
) -> Iterator[Point | End]:
    """Walk through a programme of openings; yields every converged `Point` and, last, the `End`.

    Parameters
    ----------
    programme : openings to be reached one after the other, from zero.
    steps : number of steps asked for over the whole programme; None lets the path choose them, few and by accuracy.
        A step that fails is made to end at the next kink of the law, then halved, down to 1/4096, and grows again
        afterwards.
    """
    whole, reach = float(np.sum(np.abs(np.diff([0.0, *programme])))), float(np.max(np.abs(programme)))
    pace = Pace(whole / steps, whole / steps) if steps else Pace(0.25 * whole, FIRST * whole, by_accuracy=True)
    rejected, peak, most = 0, 0.0, 0.0
    direction = float(np.sign(programme[0]))
    point = _departing(system, system.start(), direction, 0.0, phase)
    if point is None:
        raise ValueError("the system is singular: the supports or the interface do not hold the bodies")
    yield point
    for goal in by_way_of_zero(programme):
        if direction * (goal - point.opening) < 0.0 or point.opening == 0.0:
            direction = float(np.sign(goal - point.opening))
            point = _departing(system, point.state, direction, point.external_work, phase) or point
        while point.opening != goal:
            asked = _ask(system, point, goal, pace, direction)
            reached = _advance(system, point, asked, direction, pace, newton, phase)
            if reached is not None and direction * (reached.opening - goal) > 0.0 and not asked.exact:
                asked = Step(opening_control(system), goal - point.opening, exact=True)
                reached = _advance(system, point, asked, direction, pace, newton, phase)
            if reached is None or _leaks(point, reached, most):
                rejected, pace = rejected + 1, pace.slower()
                if pace.cut < SMALLEST:
                    yield End(_advice(point.opening), rejected)
                    return
                continue
            peak, most = max(peak, abs(reached.state.load)), max(most, abs(reached.external_work))
            pace = pace.after(point, reached, peak)
            point = replace(reached, opening=goal) if asked.exact else reached
            yield point
            if direction > 0.0 and point.opening > 0.0 and _separated(system, point, reach, peak):
                yield End("complete", rejected, separated=True)
                return
    yield End("complete", rejected)


def by_way_of_zero(programme: Sequence[float]) -> tuple[float, ...]:
    """The programme with a stop wherever it passes through zero: there all points of an unloaded interface touch."""
    way, here = [], 0.0
    for goal in programme:
        way += [0.0, goal] if here * goal < 0.0 else [goal]
        here = goal
    return tuple(way)


def _ask(system: System, point: Point, goal: float, pace: Pace, direction: float) -> Step:
    """Control of the next step and the change asked of it.

    The front moves on by at most a quarter of g_u, and by no more than changes the opening by a step.
    """
    law, path = system.interface.law, point.tangent
    left, opening_rate = goal - point.opening, float(system.load_d @ path.du_d)
    k_q, g_q = point.state.k_q, point.response.contact.g_q
    event = next_event(law, g_q, k_q, path.rate_q) if direction > 0.0 else None
    if not np.any(path.growing_q):
        change = np.copysign(min(pace.length, abs(left)), left)
        if event is not None and event.away * abs(opening_rate) < abs(change):
            return Step(gap_control(system, event.q), event.change)
        exact = abs(left) < 1.001 * pace.length
        return Step(opening_control(system), left if exact else change, exact)
    if 0.0 < direction * left < pace.step and not pace.careful and path.heading == direction:
        return Step(opening_control(system), left, exact=True)
    q = int(np.argmax(np.where(path.growing_q, g_q, -np.inf)))
    way = min(pace.front * law.g_u, pace.length * abs(path.rate_q[q] / opening_rate))
    if pace.careful and event is not None and event.away * abs(path.rate_q[q]) < way:
        return Step(gap_control(system, event.q), event.change)
    return Step(gap_control(system, q), np.copysign(way, path.rate_q[q]))


def _separated(system: System, point: Point, reach: float, peak: float) -> bool:
    """Most of the bond is broken, and nothing is left that carries: no load, and none that the path is to bring."""
    interface = system.interface
    broken = float(interface.dA_q @ (point.state.k_q >= interface.law.g_u)) / float(interface.dA_q.sum())
    small = SEPARATED * peak
    falling = point.tangent.d_load < 0.0 or abs(point.slope) * reach <= small
    return broken > 0.5 and abs(point.state.load) <= small and falling


def _departing(system: System, state: State, direction: float, work: float, phase: Phase) -> Point | None:
    """A converged state at which the programme sets out or turns round.

    Where many points touch at once their rates alone may not sort them out. Then a state a trifle ahead does, which
    a patient search finds.
    """
    opening = float(system.load_d @ state.u_d)
    for ahead in (False, True):
        with phase("assembly"):
            response = respond(system, state, decide=False)
        found = tangent(system, state, response, direction, phase, turning=not ahead)
        if found is None:
            return None
        energy = sum(energies(system, state, response))
        start = Point(replace(state, closed_q=found.closed_q), response, opening, found, work, energy, ())
        if found.agreed or ahead:
            break
        trifle = direction * TRIFLE * max(abs(opening), system.interface.law.g_max)
        rate = float(system.load_d @ found.du_d)
        moved = replace(
            start.state,
            u_d=state.u_d + trifle / rate * found.du_d,
            load=state.load + trifle / rate * found.d_load,
        )
        tried = equilibrium(system, moved, opening_control(system), opening + trifle, trifle, PATIENT, phase)
        if tried is not None:
            state = replace(state, closed_q=tried.state.closed_q)
    return start


def _leaks(start: Point, end: Point, most: float) -> bool:
    """Whether the work of a step is not what its energies say: it did not go along the path."""
    work = end.external_work - start.external_work
    return abs(work - (end.energy - start.energy)) > LEAK * max(most, abs(end.external_work))


def _advance(
    system: System, point: Point, asked: Step, direction: float, pace: Pace, newton: Newton, phase: Phase
) -> Point | None:
    """One step from the tangent predictor, or None; nothing is committed before it has converged."""
    old, path, control = point.state, point.tangent, asked.control
    value, a_d, a_load = control(old, point.response)
    rate = float(a_d @ path.du_d) + a_load * path.d_load
    away = asked.change / rate
    trial = replace(old, u_d=old.u_d + away * path.du_d, load=old.load + away * path.d_load)
    found = equilibrium(system, trial, control, value + asked.change, asked.change, newton, phase)
    if found is None:
        return None
    kink = None
    if pace.by_accuracy and not pace.careful and not asked.exact:
        found, kink = landed(system, old, found, newton, phase)
    state = replace(found.state, k_q=found.response.k_q, scale=max(old.scale, found.response.scale))
    leaving = tangent(system, state, found.response, direction, phase, kink=kink)
    if leaving is None:
        return None
    opening = float(system.load_d @ state.u_d)
    energy = sum(energies(system, state, found.response))
    reached = Point(state, found.response, opening, leaving, 0.0, energy, found.residuals)
    value_there, b_d, b_load = control(state, found.response)
    end_rate = float(b_d @ leaving.du_d) + b_load * leaving.d_load
    change = value_there - value
    straight = (
        pace.by_accuracy and not pace.careful and point.heading == leaving.heading == np.sign(opening - point.opening)
    )
    work = (
        _straight_work(point, reached) if straight else _work(system, point, reached, change / rate, change / end_rate)
    )
    return replace(reached, external_work=point.external_work + work)


def _straight_work(start: Point, end: Point) -> float:
    """Integral of the load over the opening along a step that does not turn round, from its slopes."""
    move = end.opening - start.opening
    return 0.5 * move * (start.state.load + end.state.load) + move**2 / 12.0 * (start.slope - end.slope)


def _work(system: System, start: Point, end: Point, away: float, back: float) -> float:
    """Integral of the load over the opening along one step, both cubic Hermite curves over the controlled quantity.

    ``away`` and ``back`` are the lengths of the tangents at both ends that change that quantity by the step. Unlike a
    rule over the opening it holds where the path turns back. Its error is of fourth order; three Gauss points
    integrate it exactly.
    """
    s, w = gauss(3)
    values = np.stack([(1 + 2 * s) * (1 - s) ** 2, s * s * (3 - 2 * s)])
    slopes = np.stack([s * (1 - s) ** 2, s * s * (s - 1)])
    d_values = np.stack([6 * s * (s - 1), 6 * s * (1 - s)])
    d_slopes = np.stack([(1 - s) * (1 - 3 * s), s * (3 * s - 2)])
    loads = np.array([away * start.tangent.d_load, back * end.tangent.d_load])
    openings = np.array([away * (system.load_d @ start.tangent.du_d), back * (system.load_d @ end.tangent.du_d)])
    load = np.array([start.state.load, end.state.load]) @ values + loads @ slopes
    d_opening = np.array([start.opening, end.opening]) @ d_values + openings @ d_slopes
    return float(np.sum(w * load * d_opening))


def _advice(opening: float) -> str:
    return (
        f"stopped: Newton did not converge beyond opening {opening:.6g} even with a step 4096 times smaller; "
        "refine the mesh along the crack (discretization.dofs), take more interface points "
        "(discretization.interface_points) or lower interface.strength"
    )
