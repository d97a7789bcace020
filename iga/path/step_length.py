"""How long the next step is, and by what it is controlled.

Steps are counted, all of one length, or chosen by accuracy (`StepLength`); with viscosity they are `InTime`. Each has a
``length``, the change of the opening, and methods that give what comes next:

- ``failed``: after a step at an opening that has not converged or lost energy,
- ``cut``: after a step that was to change the opening by ``moved`` and was not accurate,
- ``after``: after a step from ``start`` to ``end``, with the largest load ``peak`` so far.

Steps are shortened until they are as accurate as ``tolerance`` asks for (see `iga.path.polyline`), at most
`Lengths.cuts` times (``cuts``).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from iga.interface.response import holding
from iga.path.control import Control, arc_length_control, dissipation_control, gap_control, opening_control
from iga.path.kinks import DISTANCES, first_kink
from iga.path.point import Point
from iga.path.polyline import StepError
from iga.path.tangent import away_from_zero
from iga.system.state import State
from iga.system.system import System


@dataclass(frozen=True)
class Lengths:
    """Bounds on steps: shorter ones seldom fail and draw more of the curve, longer ones take less time.

    - ``front``, ``front_by_accuracy``: largest steps of the front in parts of g_u, of counted steps and of steps by
      accuracy. ``smallest``: smallest step relative to the one asked for.
    - ``first``, ``largest``: first and largest step by accuracy, in parts of the programme.
    - ``tolerance``: default of the part of the peak by which the load may leave the tangent of a step.
    - ``failures``: number of failed steps by accuracy that are allowed; each converged step makes up for one. After
      more failures the rest is counted, with ``safe`` steps for the whole programme.
    - ``fewest``: fewer counted steps do not draw the curve; a smaller number is taken as a least number of steps.
    - ``still``: a front that moves by a smaller part of g_u in a step does not control the step.
    - ``cuts``: how often a step is shortened because it is not accurate.
    - ``slow``: when steps that are cut or shorter than counted ones outnumber the longer ones by this, the rest is
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
    tolerance: float = 0.005
    failures: int = 3
    safe: int = 150
    fewest: int = 40
    still: float = 1e-9
    cuts: int = 6
    slow: int = 24
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
    def to_kink(self) -> bool:
        """Whether it is to end at a kink."""
        return self.by_kinks and not self.exact


@dataclass(frozen=True)
class StepLength:
    """Steps of the ``usual`` length, at most the ``largest``.

    ``by_accuracy`` steps end where a point breaks, and grow as long as they are accurate. One that fails is halved, and
    so is the largest step of the front until a step converges; with no failures ``left`` steps are counted from then
    on, ``safe`` long. After a single arc of the load that is not accurate ``at_kinks`` steps end at kinks of any kind.
    Where the load rises and falls with single points by more than the tolerance, ``slow`` steps from one point to the
    next cost more than they save: counted steps follow, with no check of accuracy. ``since`` is the opening of that.

    After a counted step that fails steps are ``careful``: they end at the next kink of the law, as from kink to kink
    the path is nearly straight. They are tried with each of the `CONTROLS` (``number``), then at half the length; each
    converged step takes back one of the ``halvings``.
    """

    largest: float
    usual: float
    tolerance: float | None = None
    by_accuracy: bool = False
    safe: float = 0.0
    left: int = LENGTHS.failures
    cuts: int = 0
    at_kinks: int = 0
    slow: int = 0
    since: float | None = None
    careful: bool = False
    halvings: int = 0
    number: int = 0

    @property
    def length(self) -> float:
        return 0.5**self.halvings * self.usual

    @property
    def front(self) -> float:
        """Largest step of the front, in parts of g_u: by accuracy longer where the tolerance is larger."""
        if not self.by_accuracy or self.tolerance is None:
            return 0.5**self.halvings * LENGTHS.front
        halved = 0.5 ** (LENGTHS.failures - self.left)
        return halved * LENGTHS.front_by_accuracy * (self.tolerance / LENGTHS.tolerance) ** 0.5

    def counted(self, tolerance: float | None, since: float) -> StepLength:
        """Counted steps from an opening on."""
        return StepLength(self.safe, self.safe, tolerance, since=since)

    def failed(self, at: float) -> StepLength | None:
        if self.by_accuracy and self.left == 0:
            return self.counted(self.tolerance, at)
        if self.by_accuracy:
            return replace(self, usual=0.5 * self.usual, left=self.left - 1, cuts=0)
        if not self.careful:
            return replace(self, careful=True, cuts=0)
        if self.number + 1 < len(CONTROLS):
            return replace(self, number=self.number + 1, cuts=0)
        halved = replace(self, halvings=self.halvings + 1, number=0, cuts=0)
        return None if 0.5**halved.halvings < LENGTHS.smallest else halved

    def cut(self, error: StepError, moved: float) -> StepLength:
        usual = min(error.part * abs(moved) / 0.5**self.halvings, self.usual)
        at_kinks = LENGTHS.at_kinks if self.by_accuracy and error.single else self.at_kinks
        return replace(self, usual=usual, cuts=self.cuts + 1, at_kinks=at_kinks, slow=self.slow + 1)

    def after(self, start: Point, end: Point, peak: float, error: StepError) -> StepLength:
        if self.careful:
            halvings = max(self.halvings - 1, 0)
            return replace(self, careful=self.halvings > 0, halvings=halvings, number=0, cuts=0)
        if not self.by_accuracy or self.tolerance is None:
            return replace(self, usual=min(2.0 * self.usual, self.largest), cuts=0)
        moved, rough = end.opening - start.opening, start.tangent.rough
        short = abs(moved) < self.safe and error.opened < LENGTHS.front
        slow = self.slow + 1 if short else max(self.slow - 1, 0)
        if slow > LENGTHS.slow:
            return self.counted(None, end.opening)
        slope = start.tangent.departure if rough and not error.broken else start.slope
        off = abs(end.state.load - start.state.load - slope * moved) / (self.tolerance * peak)
        if error.broken:  # the ripple of single points does not shorten steps while the path is near the straight line
            near = error.single and error.distance <= 0.5
            off = min(off, 0.25 if near else LENGTHS.parabola * error.distance)
        # past a kink a step goes less far than asked, and where the load falls the opening may stand still
        gone = max(abs(moved), self.usual) if rough or error.broken else abs(moved)
        grown = gone * max(min(off**-0.5, 2.0), 0.5) if off > 0.0 else 2.0 * gone
        usual = min(max(grown, LENGTHS.smallest * self.largest), self.largest)
        left, at_kinks = min(self.left + 1, LENGTHS.failures), max(self.at_kinks - 1, 0)
        return replace(self, usual=usual, left=left, cuts=0, at_kinks=at_kinks, slow=slow)


@dataclass(frozen=True)
class Pace:
    """Length of steps with viscosity: the error of the implicit Euler method is proportional to the growth of damage.

    - ``growth``: largest growth of damage at a point in a step, for the default tolerance; a smaller one reduces it in
      proportion. ``aim``: part of that growth at which steps aim.
    - ``fewest``: the longest step is the programme over this number.
    - ``smallest``: the shortest step takes this part of the time in which damage can grow by ``growth`` (the viscosity
      times ``growth``), at most this part of the programme. A shorter one would only fail for want of equilibrium.
    """

    growth: float = 0.1
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
    by_accuracy: bool = False
    tolerance: None = None
    front: float = 0.0
    cuts: int = 0
    since: None = None

    def failed(self, at: float) -> InTime | None:
        return replace(self, length=0.5 * self.length) if self.length > self.shortest else None

    def cut(self, error: StepError, moved: float) -> InTime | None:
        return self.failed(0.0)

    def after(self, start: Point, end: Point, peak: float, error: StepError) -> InTime:
        grown = PACE.aim * self.growth / max(grows(start.state, end.state), 0.5 * PACE.aim * self.growth)
        # at most halved: the last step before a goal is short for another reason
        return replace(self, length=min(max(grown * abs(end.opening - start.opening), self.length / 2.0), self.largest))


def step_length(
    programme: np.ndarray,
    steps: int | None,
    tolerance: float = LENGTHS.tolerance,
    linear: bool = False,
    viscosity: float = 0.0,
) -> StepLength | InTime:
    """The step length at which a programme (n,) begins; ``steps`` and ``tolerance`` as in `iga.path.follow.follow`.

    Where kinematics and bulk are ``linear`` the path is straight until damage begins, and the first step may go that
    far. With ``viscosity`` the steps are `InTime`.
    """
    whole = float(np.sum(np.abs(np.diff(programme, prepend=0.0))))
    if viscosity:
        longest, growth = whole / max(steps or 0, PACE.fewest), PACE.growth * min(tolerance / LENGTHS.tolerance, 1.0)
        return InTime(whole, longest, longest, PACE.smallest * whole * min(growth * viscosity, 1.0), growth)
    asked = whole / steps if steps else np.inf
    if steps and steps >= LENGTHS.fewest:
        return StepLength(asked, asked)
    largest = min(LENGTHS.largest * whole, asked)
    first = largest if linear else min(LENGTHS.first * whole, asked)
    return StepLength(largest, first, tolerance, by_accuracy=True, safe=whole / LENGTHS.safe)


def grows(before: State, after: State) -> float:
    """Largest growth of the damage of a point."""
    return float(np.max(after.k_q - before.k_q, initial=0.0))


def next_step(system: System, point: Point, goal: float, lengths: StepLength | InTime, direction: float) -> Step:
    """Control and length of the next step.

    While damage grows the front of the crack is controlled: it opens by a part of g_u, but no further than changes the
    opening of the specimen by one step. Otherwise that opening is controlled, up to where damage begins; so it is on
    the way back to zero, where damage grows only as friction turns round: its front would also open by loading again. A
    reversible bond heals there, and its front controls as long as it is beyond the onset.
    """
    law, path, length = system.interface.law, point.tangent, lengths.length
    left, opening_rate = goal - point.opening, float(system.load_d @ path.du_d)
    exact = abs(left) < 1.001 * length
    move = left if exact else float(np.copysign(length, left))
    if isinstance(lengths, InTime):
        dt = abs(move) / lengths.whole
        return Step(opening_control(system), move / opening_rate, exact, dt=dt, growth=lengths.growth)
    by_kinks, every_kink = lengths.by_accuracy, lengths.at_kinks > 0
    onward, q, past = away_from_zero(system, direction, point.opening), point.front, None
    beyond = bool(point.response.x_q[q] > law.kinks[0])
    grows = bool(path.growing_q.any()) and (onward or (beyond and not law.irreversible))

    def moves(q: int, away: float) -> bool:
        """Whether a point moves enough to control the step: driving separations like s^2 have no rate at rest."""
        return abs(path.rate_q[q]) * away >= LENGTHS.still * law.span

    if onward and (lengths.careful or not grows):
        past = _past_kink(system, point)
    if not grows:
        away = move / opening_rate
        if past is not None and past[1] < away and moves(past[0], abs(away)):
            return Step(gap_control(system, past[0]), past[2], by_kinks=by_kinks)
        return Step(opening_control(system), away, exact, by_kinks, every_kink)
    furthest = lengths.front * law.span / max(abs(path.rate_q[q]), 1e-300)
    onto = 0.0 < direction * left < length and abs(left) < furthest * abs(opening_rate)
    if onto and not lengths.careful and path.heading == direction:
        return Step(opening_control(system), left / opening_rate, True, by_kinks)
    away = min(furthest, length / abs(opening_rate))
    if not moves(q, away):
        return Step(opening_control(system), away, by_kinks=by_kinks)
    if past is not None and past[1] < away:
        q, _, away = past
    controls = {
        "front": lambda: gap_control(system, q),
        "dissipation": lambda: dissipation_control(system),
        "arc length": lambda: arc_length_control(system, point.response, path.du_d),
    }
    return Step(controls[CONTROLS[lengths.number]](), away, by_kinks=by_kinks, every_kink=every_kink)


def past(system: System, point: Point, asked: Step, front: float) -> Step:
    """A step controlled by the front that goes a little further than one that was to end on its goal, by at most
    ``front`` in parts of g_u."""
    q, path = point.front, point.tangent
    away = min(LENGTHS.past_goal * abs(asked.away), front * system.interface.law.span / abs(path.rate_q[q]))
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
