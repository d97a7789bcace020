"""How long the next step is, and by what it is controlled.

Steps are `Counted`, all of one length, or chosen `ByAccuracy`; `Careful` steps follow a counted one that failed; with
viscosity they are `InTime`. Each kind has a ``length``, the change of the opening, and ``front``, the largest step of
the front in parts of g_u. Its methods give the kind of the next step:

- ``failed``: after a step at an opening that has not converged or lost energy,
- ``cut``: after a step that was to change the opening by ``moved`` and was not accurate,
- ``after``: after a step from ``start`` to ``end``, with the largest load ``peak`` so far.

Steps whose length the path chooses are shortened until they are as accurate as ``bend`` asks for (see
`iga.path.polyline`), at most `Lengths.cuts` times (``cuts``).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from iga.interface.response import holding
from iga.path.control import Control, arc_length_control, dissipation_control, gap_control, opening_control
from iga.path.kinks import DISTANCES, first_kink
from iga.path.point import Point
from iga.path.polyline import Kept
from iga.path.tangent import away_from_zero
from iga.system.state import State
from iga.system.system import System


@dataclass(frozen=True)
class Lengths:
    """Bounds on steps: shorter ones seldom fail and draw more of the curve, longer ones take less time.

    - ``front``, ``front_by_accuracy``: largest steps of the front in parts of g_u, of counted steps and of steps by
      accuracy. ``smallest``: smallest step relative to the one asked for.
    - ``first``, ``largest``: first and largest step by accuracy, in parts of the programme.
    - ``bend``: default of the part of the peak by which the load may leave the tangent of a step.
    - ``failures``: number of failed steps by accuracy that are allowed; each converged step makes up for one. After
      more failures the rest is counted, with ``safe`` steps for the whole programme.
    - ``fewest``: fewer counted steps do not draw the curve; a smaller number is taken as a least number of steps.
    - ``still``: a front that moves by a smaller part of g_u in a step does not control the step.
    - ``cuts``: how often a step is shortened because it is not accurate.
    - ``crawl``: when steps that are cut or shorter than counted ones outnumber the longer ones by this, the rest is
      counted.
    - ``at_kinks``: number of steps that end at kinks of any kind after a single arc of the load was not accurate.
    - ``past_goal``: length of a step past a goal over that of one which was to end on it.
    - ``parabola``: distance of a parabola from its tangent over its distance from the chord, as it is measured.
    """

    front: float = 0.125
    front_by_accuracy: float = 1.0
    smallest: float = 1.0 / 4096
    first: float = 1.0 / 30.0
    largest: float = 0.25
    bend: float = 0.005
    failures: int = 3
    safe: int = 150
    fewest: int = 40
    still: float = 1e-9
    cuts: int = 6
    crawl: int = 24
    at_kinks: int = 8
    parabola: float = 3.0
    past_goal: float = 1.1


LENGTHS = Lengths()

#: Controls of careful steps while damage grows, in the order in which they are tried before the step is halved.
CONTROLS = ("front", "dissipation", "arc length")


@dataclass(frozen=True)
class Step:
    """What is asked of a step: the control, the length of the tangent it goes, and where it ends.

    ``exact``: it ends on the goal. ``by_kinks``: unless exact it ends where a point breaks or begins to soften;
    ``every_kink``: at the first kink of any kind. ``near`` is a state near its end, where it is known. With viscosity
    it takes the time ``dt``, and damage may grow by ``growth``.
    """

    control: Control
    away: float
    exact: bool = False
    by_kinks: bool = False
    every_kink: bool = False
    dt: float = 0.0
    growth: float = np.inf
    near: State | None = None

    @property
    def lands(self) -> bool:
        """Whether it is to end at a kink."""
        return self.by_kinks and not self.exact


@dataclass(frozen=True)
class Counted:
    """Steps of one length; those that have been shortened grow again up to ``largest``.

    ``since`` is the opening at which a path that chose its steps began to count them.
    """

    largest: float
    length: float
    bend: float | None = None
    cuts: int = 0
    since: float | None = None

    @property
    def front(self) -> float:
        return LENGTHS.front

    def failed(self, at: float) -> Careful:
        return Careful(replace(self, cuts=0))

    def cut(self, kept: Kept, moved: float) -> Counted:
        return replace(self, length=min(kept.part * abs(moved), self.length), cuts=self.cuts + 1)

    def after(self, start: Point, end: Point, peak: float, kept: Kept) -> Counted:
        return replace(self, length=min(2.0 * self.length, self.largest), cuts=0)


@dataclass(frozen=True)
class ByAccuracy:
    """Steps that end where a point breaks, as long as the load leaves their tangent by no more than ``bend``.

    A step that fails is halved, and so is the largest step of the front until a step converges. With no failures
    ``left`` the steps are ``counted`` from then on. After a single arc of the load that is not accurate ``at_kinks``
    steps end at kinks of any kind. Where the load rises and falls with single points by more than ``bend``, steps
    ``crawl`` from one point to the next and cost more than they save: counted steps follow, with no check of accuracy.
    """

    largest: float
    length: float
    counted: Counted
    bend: float
    left: int = LENGTHS.failures
    cuts: int = 0
    at_kinks: int = 0
    crawl: int = 0
    since: None = None

    @property
    def front(self) -> float:
        """Largest step of the front, in parts of g_u: longer where the load may bend more."""
        halved = 0.5 ** (LENGTHS.failures - self.left)
        return halved * LENGTHS.front_by_accuracy * (self.bend / LENGTHS.bend) ** 0.5

    def failed(self, at: float) -> ByAccuracy | Counted:
        if self.left == 0:
            return replace(self.counted, since=at)
        return replace(self, length=0.5 * self.length, left=self.left - 1, cuts=0)

    def cut(self, kept: Kept, moved: float) -> ByAccuracy:
        length, at_kinks = min(kept.part * abs(moved), self.length), LENGTHS.at_kinks if kept.few else self.at_kinks
        return replace(self, length=length, cuts=self.cuts + 1, at_kinks=at_kinks, crawl=self.crawl + 1)

    def after(self, start: Point, end: Point, peak: float, kept: Kept) -> ByAccuracy | Counted:
        short = abs(end.opening - start.opening) < self.counted.length and kept.opened < self.counted.front
        crawl = self.crawl + 1 if short else max(self.crawl - 1, 0)
        if crawl > LENGTHS.crawl:
            return replace(self.counted, bend=None, since=end.opening)
        moved, rough = end.opening - start.opening, start.tangent.rough
        slope = start.tangent.departure if rough and not kept.broken else start.slope
        bend = abs(end.state.load - start.state.load - slope * moved) / (self.bend * peak)
        if kept.broken:  # teeth of the load do not shorten steps as long as the path is near the straight line
            bend = min(bend, 0.25 if kept.few and kept.away <= 0.5 else LENGTHS.parabola * kept.away)
        # past a kink a step goes less far than asked, and where the load falls the opening may stand still
        gone = max(abs(moved), self.length) if rough or kept.broken else abs(moved)
        grown = gone * max(min(bend**-0.5, 2.0), 0.5) if bend > 0.0 else 2.0 * gone
        length = min(max(grown, LENGTHS.smallest * self.largest), self.largest)
        left, at_kinks = min(self.left + 1, LENGTHS.failures), max(self.at_kinks - 1, 0)
        return replace(self, length=length, left=left, cuts=0, at_kinks=at_kinks, crawl=crawl)


@dataclass(frozen=True)
class Careful:
    """Steps that end at the next kink of the law: from kink to kink the path is nearly straight.

    A step that fails is tried with another of the `CONTROLS` (``number``), then at half the length; each converged step
    takes back one of the ``halvings``. Then the path returns to its ``usual`` steps.
    """

    usual: Counted | ByAccuracy
    halvings: int = 0
    number: int = 0

    @property
    def length(self) -> float:
        return 0.5**self.halvings * self.usual.length

    @property
    def front(self) -> float:
        return 0.5**self.halvings * self.usual.front

    @property
    def bend(self) -> float | None:
        return self.usual.bend

    @property
    def cuts(self) -> int:
        return self.usual.cuts

    @property
    def since(self) -> float | None:
        return None if isinstance(self.usual, ByAccuracy) else self.usual.since

    def failed(self, at: float) -> Careful | None:
        """What follows a step that has not converged; None where it cannot be any shorter."""
        usual, number = replace(self.usual, cuts=0), self.number + 1
        if number < len(CONTROLS):
            return Careful(usual, self.halvings, number)
        shorter = Careful(usual, self.halvings + 1)
        return None if 0.5**shorter.halvings < LENGTHS.smallest else shorter

    def cut(self, kept: Kept, moved: float) -> Careful:
        return replace(self, usual=self.usual.cut(kept, moved / 0.5**self.halvings))

    def after(self, start: Point, end: Point, peak: float, kept: Kept) -> StepLength:
        usual = replace(self.usual, cuts=0)
        return Careful(usual, self.halvings - 1) if self.halvings else usual


@dataclass(frozen=True)
class Pace:
    """Length of steps with viscosity: the error of the implicit Euler method is proportional to the growth of damage.

    - ``growth``: largest growth of damage at a point in a step, for the default ``bend``; a smaller ``bend`` reduces it
      in proportion. ``aim``: part of that growth at which steps aim.
    - ``fewest``: the longest step is the programme over this number.
    - ``smallest``: the shortest step takes this part of the time in which damage can grow by ``growth`` (the viscosity
      times ``growth``), at most this part of the programme. A shorter one would only fail for want of equilibrium.
    """

    growth: float = 0.1
    bend: float = 0.005
    aim: float = 0.8
    fewest: int = 40
    smallest: float = 1e-3


PACE = Pace()


@dataclass(frozen=True)
class InTime:
    """Steps with viscosity, controlled by the opening, to which time is proportional. A step has a ``length`` up to
    ``largest``, and damage grows by at most ``growth`` on it. The programme is ``whole`` long; a step that fails at
    ``shortest`` ends the path."""

    whole: float
    largest: float
    length: float
    shortest: float
    growth: float
    bend: None = None
    cuts: int = 0
    since: None = None

    def failed(self, at: float) -> InTime | None:
        return replace(self, length=0.5 * self.length) if self.length > self.shortest else None

    def cut(self, kept: Kept, moved: float) -> InTime | None:
        return self.failed(0.0)

    def after(self, start: Point, end: Point, peak: float, kept: Kept) -> InTime:
        grown = PACE.aim * self.growth / max(grows(start.state, end.state), 0.5 * PACE.aim * self.growth)
        # at most halved: the last step before a goal is short for another reason
        return replace(self, length=min(max(grown * abs(end.opening - start.opening), self.length / 2.0), self.largest))


StepLength = Counted | ByAccuracy | Careful | InTime


def step_length(
    programme: np.ndarray,
    steps: int | None,
    bend: float = LENGTHS.bend,
    linear: bool = False,
    viscosity: float = 0.0,
) -> Counted | ByAccuracy | InTime:
    """The step length at which a programme begins; ``steps`` and ``bend`` as in `iga.path.follow.follow`.

    Where kinematics and bulk are ``linear`` the path is straight until damage begins, and the first step may go that
    far. With ``viscosity`` the steps are `InTime`.
    """
    if viscosity:
        return _in_time(programme, steps, bend, viscosity)
    whole = float(np.sum(np.abs(np.diff(programme, prepend=0.0))))
    asked = whole / steps if steps else np.inf
    if steps and steps >= LENGTHS.fewest:
        return Counted(asked, asked)
    largest, safe = min(LENGTHS.largest * whole, asked), whole / LENGTHS.safe
    first = largest if linear else min(LENGTHS.first * whole, asked)
    return ByAccuracy(largest, first, Counted(safe, safe, bend), bend)


def _in_time(programme: np.ndarray, steps: int | None, bend: float, viscosity: float) -> InTime:
    """The step length at which a programme (n,) begins; ``steps`` and ``bend`` as in `iga.path.follow.follow`."""
    whole = float(np.sum(np.abs(np.diff(programme, prepend=0.0))))
    largest = whole / max(steps or 0, PACE.fewest)
    growth = PACE.growth * min(bend / PACE.bend, 1.0)
    return InTime(whole, largest, largest, PACE.smallest * whole * min(growth * viscosity, 1.0), growth)


def grows(before: State, after: State) -> float:
    """Largest growth of the damage of a point."""
    return float(np.max(after.k_q - before.k_q, initial=0.0))


def next_step(system: System, point: Point, goal: float, lengths: StepLength, direction: float) -> Step:
    """Control and length of the next step.

    While damage grows the front of the crack is controlled: it opens by a part of g_u, but no further than changes the
    opening of the specimen by one step. Otherwise that opening is controlled, up to where damage begins; so it is on
    the way back to zero, where damage grows only as friction turns round: its front would also open by loading again. A
    reversible bond heals there, and its front controls as long as it is beyond the onset.
    """
    law, path, careful = system.interface.law, point.tangent, isinstance(lengths, Careful)
    left, opening_rate = goal - point.opening, float(system.load_d @ path.du_d)
    if isinstance(lengths, InTime):
        exact = abs(left) < 1.001 * lengths.length
        move = left if exact else float(np.copysign(lengths.length, left))
        dt = abs(move) / lengths.whole
        return Step(opening_control(system), move / opening_rate, exact, dt=dt, growth=lengths.growth)
    by_kinks = isinstance(lengths, ByAccuracy)
    every_kink = isinstance(lengths, ByAccuracy) and lengths.at_kinks > 0
    onward, q, past = away_from_zero(system, direction, point.opening), point.front, None
    beyond = bool(point.response.x_q[q] > law.kinks[0])
    grows = bool(path.growing_q.any()) and (onward or (beyond and not law.irreversible))

    def leads(q: int, away: float) -> bool:
        """Whether a point moves enough to control the step: driving separations like s^2 have no rate at rest."""
        return abs(path.rate_q[q]) * away >= LENGTHS.still * law.span

    if onward and (careful or not grows):
        past = _past_kink(system, point)
    if not grows:
        exact = abs(left) < 1.001 * lengths.length
        away = (left if exact else np.copysign(lengths.length, left)) / opening_rate
        if past is not None and past[1] < away and leads(past[0], abs(away)):
            return Step(gap_control(system, past[0]), past[2], by_kinks=by_kinks)
        return Step(opening_control(system), away, exact, by_kinks, every_kink)
    furthest = lengths.front * law.span / max(abs(path.rate_q[q]), 1e-300)
    onto = 0.0 < direction * left < lengths.length and abs(left) < furthest * abs(opening_rate)
    if onto and not careful and path.heading == direction:
        return Step(opening_control(system), left / opening_rate, True, by_kinks)
    away = min(furthest, lengths.length / abs(opening_rate))
    if not leads(q, away):
        return Step(opening_control(system), away, by_kinks=by_kinks)
    if past is not None and past[1] < away:
        q, _, away = past
    name = CONTROLS[lengths.number] if isinstance(lengths, Careful) else CONTROLS[0]
    controls = {
        "front": lambda: gap_control(system, q),
        "dissipation": lambda: dissipation_control(system),
        "arc length": lambda: arc_length_control(system, point.response, path.du_d),
    }
    return Step(controls[name](), away, by_kinks=by_kinks, every_kink=every_kink)


def past(system: System, point: Point, asked: Step, lengths: ByAccuracy) -> Step:
    """A step controlled by the front that goes a little further than one that was to end on its goal."""
    q, path = point.front, point.tangent
    away = min(LENGTHS.past_goal * abs(asked.away), lengths.front * system.interface.law.span / abs(path.rate_q[q]))
    return Step(gap_control(system, q), away, by_kinks=asked.by_kinks, every_kink=asked.every_kink)


def _past_kink(system: System, point: Point) -> tuple[int, float, float] | None:
    """The point that reaches a kink first along the tangent, and the lengths along it onto the kink and past it."""
    response, rate_q, kinks = point.response, point.tangent.rate_q, np.array(system.interface.law.kinks)
    k_q = np.where(holding(system.interface, response.contact), response.back_q, kinks[-1])  # else no kink
    found = first_kink(kinks, response.x_q, k_q, rate_q)
    if found is None:
        return None
    kink, away = found
    shortest = float(np.min(np.diff(kinks, prepend=0.0)))
    return kink.q, away, float(away + DISTANCES.past * shortest / rate_q[kink.q])
