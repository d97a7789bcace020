"""How long the next step is, and by what it is controlled."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from iga.interface.interface import holding
from iga.path.control import Control, arc_length_control, dissipation_control, gap_control, opening_control
from iga.path.kinks import next_event
from iga.path.point import Point
from iga.path.polyline import KEPT, Kept
from iga.path.tangent import away_from_zero
from iga.system.system import System

#: Largest step of the front in parts of g_u, where steps are counted and where they are chosen by accuracy; smallest
#: step in parts of the one asked for.
FRONT, FRONT_BY_ACCURACY, SMALLEST = 0.125, 1.0, 1.0 / 4096
#: Steps chosen by accuracy: the first and the largest one in parts of the programme, and by how much of the peak the
#: load may leave the tangent of a step, if nothing else is asked for.
FIRST, LARGEST, BEND = 1.0 / 30.0, 0.25, 0.005
#: How often steps chosen by accuracy may fail; every one that converges makes up for one that has failed.
SPARED = 3
#: Fewer steps than these would not draw the curve: what is asked for is then a least number of steps. How long they are
#: once one that was chosen by accuracy has failed, in such parts of the programme.
FEWEST, SAFE = 40, 150
#: How often a step is shortened because it does not keep its promise.
CUTS = 6
#: How many steps end at kinks of any kind once a single arc has turned out to have a corner.
CORNERED = 8
#: Of a parabola what it leaves its tangent by over what it leaves the straight line by, as it is measured.
OF_TANGENT = 3.0
#: What a step that has failed is tried with, in this order, before it is halved.
CAREFUL = ("front", "dissipation", "arc length")


@dataclass(frozen=True)
class Step:
    """What is asked of a step: the control, the length of the tangent it goes, and whether it ends on the goal.

    ``every_kink``: where it ends at a kink, that is the first one of any kind.
    """

    control: Control
    away: float
    exact: bool = False
    every_kink: bool = False


@dataclass(frozen=True)
class Pace:
    """Step length: ``step`` of the opening, at most ``largest``, and a part of g_u at the cohesive front.

    ``by_accuracy``: the steps are not counted but as long as the curve allows, and end where a point breaks. One that
    fails is halved, and the front goes half as far until as many have converged; where that is ``spared`` no more they
    are ``counted``, each of this length.
    ``bend`` is by how much of the peak the load may leave the tangent of such a step; the front may go as much further
    as steps are longer for it.
    ``promised``: steps keep what `iga.path.polyline` states. One that does not is shortened, up to ``CUTS`` times
    (``cuts``); after a single arc of the load that does not, ``cornered`` steps end at kinks of any kind.
    ``attempt`` counts how often the next one has failed: careful steps end at the kinks of the law; they change the
    control, and then their length.
    """

    largest: float
    step: float
    by_accuracy: bool = False
    attempt: int = 0
    counted: float = 0.0
    bend: float = BEND
    spared: int = SPARED
    promised: bool = False
    cuts: int = 0
    cornered: int = 0

    @property
    def careful(self) -> bool:
        return self.attempt > 0

    @property
    def by_kinks(self) -> bool:
        """Whether steps end where a point breaks, that do not end on a goal."""
        return self.by_accuracy and not self.careful

    @property
    def level(self) -> int:
        """How often the step has been halved."""
        return max(self.attempt - 1, 0) // len(CAREFUL)

    @property
    def control(self) -> str:
        return CAREFUL[max(self.attempt - 1, 0) % len(CAREFUL)]

    @property
    def exhausted(self) -> bool:
        return 0.5**self.level < SMALLEST

    @property
    def length(self) -> float:
        return 0.5**self.level * self.step

    @property
    def front(self) -> float:
        if not self.by_accuracy:
            return 0.5**self.level * FRONT
        return 0.5 ** (SPARED - self.spared) * FRONT_BY_ACCURACY * (self.bend / BEND) ** 0.5

    def slower(self) -> Pace:
        if not self.by_accuracy:
            return replace(self, attempt=self.attempt + 1, cuts=0)
        if self.spared == 0:
            return Pace(self.counted, self.counted, bend=self.bend, promised=self.promised)
        return replace(self, step=0.5 * self.step, spared=self.spared - 1, cuts=0)

    def cut(self, kept: Kept, moved: float) -> Pace:
        """Where a step that went for a change ``moved`` of the opening has not kept its promise."""
        step = min(kept.part * abs(moved) / 0.5**self.level, self.step)
        return replace(self, step=step, cuts=self.cuts + 1, cornered=CORNERED if kept.few else self.cornered)

    @property
    def every_kink(self) -> bool:
        """Whether steps end at the next kink of any kind."""
        return self.by_kinks and self.cornered > 0

    def after(self, start: Point, end: Point, peak: float, kept: Kept = KEPT) -> Pace:
        """The next step where one from ``start`` to ``end`` has converged."""
        if self.careful:
            return replace(self, attempt=1 + len(CAREFUL) * (self.level - 1) if self.level else 0, cuts=0)
        if not self.by_accuracy:
            return replace(self, step=min(2.0 * self.step, self.largest), cuts=0) if self.promised else self
        moved, rough = end.opening - start.opening, start.tangent.rough
        slope = start.tangent.departure if rough and not kept.broken else start.slope
        bend = abs(end.state.load - start.state.load - slope * moved) / (self.bend * peak)
        if kept.broken:  # teeth are no reason for shorter steps as long as the straight line is near
            bend = min(bend, 0.25 if kept.few and kept.away <= 0.5 else OF_TANGENT * kept.away)
        gone = max(abs(moved), self.step) if rough else abs(moved)  # behind a kink a step goes less far than asked
        grown = gone * max(min(bend**-0.5, 2.0), 0.5) if bend > 0.0 else 2.0 * gone
        step = min(max(grown, SMALLEST * self.largest), self.largest)
        return replace(self, step=step, spared=min(self.spared + 1, SPARED), cuts=0, cornered=max(self.cornered - 1, 0))


def paced(programme: np.ndarray, steps: int | None, bend: float = BEND, linear: bool = False) -> Pace:
    """The pace at which a programme begins; ``bend`` as in `follow`.

    Where kinematics and bulk are ``linear`` nothing bends before damage begins, and the first step goes that far.
    """
    whole = float(np.sum(np.abs(np.diff(programme, prepend=0.0))))
    asked = whole / steps if steps else np.inf
    if steps and steps >= FEWEST:
        return Pace(asked, asked)
    largest = min(LARGEST * whole, asked)
    first = largest if linear else min(FIRST * whole, asked)
    return Pace(largest, first, by_accuracy=True, counted=whole / SAFE, bend=bend, promised=True)


def next_step(system: System, point: Point, goal: float, pace: Pace, direction: float) -> Step:
    """Control and length of the next step.

    While damage grows the front is led: it moves on by a part of g_u, and by no more than changes the opening by a
    step. Otherwise the opening is, up to where damage begins.
    """
    law, path = system.interface.law, point.tangent
    left, opening_rate = goal - point.opening, float(system.load_d @ path.du_d)
    grows, event = bool(path.growing_q.any()), None
    if away_from_zero(direction, point.opening) and (pace.careful or not grows):
        touch = point.response.contact
        k_q = np.where(holding(system.interface, touch), point.state.k_q, law.g_u)  # no kink for the others
        event = next_event(law, touch.g_q, k_q, path.rate_q)
    if not grows:
        exact = abs(left) < 1.001 * pace.length
        away = (left if exact else np.copysign(pace.length, left)) / opening_rate
        if event is not None and event.away < away:
            return Step(gap_control(system, event.q), event.beyond)
        return Step(opening_control(system), away, exact, pace.every_kink)
    if 0.0 < direction * left < pace.step and not pace.careful and path.heading == direction:
        return Step(opening_control(system), left / opening_rate, exact=True)
    q = point.front
    away = min(pace.front * law.g_u / abs(path.rate_q[q]), pace.length / abs(opening_rate))
    if event is not None and event.away < away:
        q, away = event.q, event.beyond
    controls = {
        "front": lambda: gap_control(system, q),
        "dissipation": lambda: dissipation_control(system),
        "arc length": lambda: arc_length_control(system, point.response, path.du_d),
    }
    return Step(controls[pace.control](), away, every_kink=pace.every_kink)
