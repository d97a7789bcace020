"""Length of the next step: counted steps, all of one length, or steps as long as the curve allows.

Every kind has ``reach``, the largest change of the opening in the next step, and ``front``, the largest change of the
front's measure in its units; ``lands``, whether steps end at edges between elements and where damage begins to grow;
``early``, the residual at which iterations stop before the last correction, 0: at the tolerance; and ``patience``,
whether a second attempt follows where iterations fail. ``failed`` gives the next step after one that has not converged;
``judged`` says whether one that has converged is accurate, and gives the next.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar, NamedTuple

import numpy as np

from fem_reference.path.state import State


@dataclass(frozen=True)
class CountedSteps:
    """Steps of one length; larger ones pass kinks of more points at once.

    front : largest change of the front's gap in one step, in units of g_u, or of its scaled jump.
    halvings : how often a step is halved before the run stops.
    instead : number of steps where the path cannot choose them, since time is proportional to the opening.
    """

    front: float = 0.125
    halvings: int = 12
    instead: int = 150


COUNTED_STEPS = CountedSteps()


@dataclass(frozen=True)
class ChosenSteps:
    """Steps by accuracy; looser bounds make fewer steps and a poorer curve.

    first, largest : length of the first step and of the longest, in parts of the programme.
    front : largest change of the front's measure in one step, in its units, for ``bend`` = ``usual``; it grows with the
        square root of ``bend``.
    chord : distance from the straight line between its ends, in parts of ``bend``, above which a step is too long.
    tangent : the distance from the straight line, in parts of ``bend``, for which the next step is made: a parabola is
        four times as far from its tangent.
    strayed : largest mean distance of the cubic from the path on a step, in parts of ``bend``. most : bound of
        their sum over the programme, in parts of the work up to its largest opening.
    top : largest rise of the cubic above the ends of a step, in parts of ``bend``, relative to the peak.
    spare : the next step is made for this part of ``strayed`` and ``top``.
    grow : bound of the length of a step over that of the one before. shortest, longest : bounds of the length of a
        repeated step over that of the attempt.
    past : length of the step after one that ends at a kink, in parts of the programme.
    cut_off : where a step ended early at an edge or a kink, the next one is made from its intended length, at most this
        times its actual length.
    forget : growth from step to step of the largest step of the front after one that has failed.
    early : residual over the force scale at which iterations stop before the last correction. The tangent of that
        correction is also that of the path, with an error of this size.
    digits : decimals of the ratio of two lengths. Without rounding, differences in the last digits of energies and
        openings would grow from step to step, and steps would depend on the number of ranks.
    length_digits : significant digits of the length of a step, for the same reason.
    finest : steps as short as this number of counted steps are not judged, at ``bend`` = ``usual``: their errors are
        the teeth of the mesh. For a smaller ``bend`` the number grows with the inverse square root of it.
    """

    first: float = 1.0 / 30.0
    largest: float = 0.25
    front: float = 3.0
    usual: float = 0.005
    chord: float = 0.8
    tangent: float = 0.25
    strayed: float = 0.25
    most: float = 4e-3
    top: float = 0.2
    spare: float = 0.5
    grow: float = 2.0
    shortest: float = 0.25
    longest: float = 0.75
    past: float = 1.0 / 300.0
    cut_off: float = 2.0
    forget: float = 1.2
    early: float = 1e-4
    digits: int = 2
    length_digits: int = 4
    finest: int = 600


CHOSEN_STEPS = ChosenSteps()


@dataclass(frozen=True)
class Counted:
    """Steps of an ``increment`` of the opening, or of a ``part`` of it after failures; the part grows again up to 1."""

    lands: ClassVar[bool] = False
    early: ClassVar[float] = 0.0
    patience: ClassVar[bool] = True

    increment: float
    part: float = 1.0

    @property
    def reach(self) -> float:
        return self.part * self.increment

    @property
    def front(self) -> float:
        return self.part * COUNTED_STEPS.front

    def failed(self) -> Counted | None:
        """What follows a step that has not converged; None where it cannot be any shorter."""
        shorter = replace(self, part=0.5 * self.part)
        return None if shorter.part < 0.5**COUNTED_STEPS.halvings else shorter

    def judged(self, before: State, reached: State) -> tuple[bool, Counted]:
        """Whether a step is accurate (always), and what follows it."""
        return True, replace(self, part=min(1.0, 2 * self.part))


@dataclass(frozen=True)
class Chosen:
    """Steps as long as the curve allows: cubics by the slopes at their ends are judged by chord, energy and maximum.

    Parameters
    ----------
    whole, bend : length of the programme in the opening, and the allowed distance from the tangent over the peak.
    turns : that length over the largest opening, above 1 where the programme turns back.
    reach : largest change of the opening in the next step.
    slow : factor on the largest step of the front: 1, or less after steps that have failed or were not accurate; at
        most ``most``, which recovers more slowly from failures.
    """

    lands: ClassVar[bool] = True
    early: ClassVar[float] = CHOSEN_STEPS.early

    whole: float
    bend: float
    reach: float
    turns: float = 1.0
    slow: float = 1.0
    most: float = 1.0

    @property
    def patience(self) -> bool:
        """Only for short steps; long ones are halved."""
        return self.front <= COUNTED_STEPS.front

    @property
    def front(self) -> float:
        return self.slow * CHOSEN_STEPS.front * (self.bend / CHOSEN_STEPS.usual) ** 0.5

    def failed(self) -> Chosen | None:
        """What follows a step that has not converged; None where it cannot be any shorter."""
        shorter = replace(self, reach=0.5 * self.reach, slow=0.5 * self.slow, most=0.5 * self.slow)
        return None if shorter.slow < 0.5**COUNTED_STEPS.halvings else shorter

    def past_kink(self) -> Chosen:
        """What follows a step that has ended at a kink: a short step, as a cubic cannot continue across a kink."""
        return replace(self, reach=min(self.reach, CHOSEN_STEPS.past * self.whole))

    def judged(self, before: State, reached: State) -> tuple[bool, Chosen]:
        """Whether a step is accurate, and what follows it."""
        size = reached.peak.opening, reached.peak.load
        if not all(size):
            return True, self
        drawn = _drawn(before, reached, size)
        ratio = self._ratio(drawn)
        gone = abs(reached.opening - before.opening)
        if max(self._excess(drawn)) > 1.0 and not self._fine(drawn.length * size[0]):
            part = float(np.clip(ratio, CHOSEN_STEPS.shortest, CHOSEN_STEPS.longest))
            return False, replace(
                self, reach=part * min(self.reach, max(gone, 0.1 * self.reach)), slow=part * self.slow
            )
        grown = float(np.clip(ratio, 1.0 / CHOSEN_STEPS.grow, CHOSEN_STEPS.grow))
        # a step that has ended at an edge or a kink is shorter than it might have been; where the load falls and the
        # opening stands still, the way along the curve counts
        along = max(CHOSEN_STEPS.cut_off * gone, drawn.length * size[0] / 2.0**0.5)
        reach = grown * max(gone, min(self.reach, along))
        most = min(1.0, CHOSEN_STEPS.forget * self.most)
        slow = min(most, max(1.0, grown) * self.slow)
        reach = float(f"{min(reach, CHOSEN_STEPS.largest * self.whole):.{CHOSEN_STEPS.length_digits}g}")
        return True, replace(self, reach=reach, slow=slow, most=most)

    def _excess(self, drawn: Drawn) -> tuple[float, float, float]:
        """Distances from chord and path, and rise above the ends, each over its allowed value."""
        straying = min(CHOSEN_STEPS.strayed * self.bend, CHOSEN_STEPS.most / self.turns)
        return (
            drawn.from_chord / (CHOSEN_STEPS.chord * self.bend),
            drawn.strayed / straying,
            drawn.over / (CHOSEN_STEPS.top * self.bend),
        )

    def _ratio(self, drawn: Drawn) -> float:
        """Length of a step with the intended accuracy over that of this step."""
        chord, strayed, over = self._excess(drawn)
        spare = CHOSEN_STEPS.spare
        bounds = (CHOSEN_STEPS.tangent / CHOSEN_STEPS.chord, chord, 2), (spare, strayed, 3), (spare, over, 2)
        ratio = min((aim / max(excess, 1e-9)) ** (1.0 / order) for aim, excess, order in bounds)
        return round(ratio, CHOSEN_STEPS.digits)

    def _fine(self, length: float) -> bool:
        """Whether a step of this length in the plane of opening and load is so short that it is not judged."""
        finer = min(1.0, self.bend / CHOSEN_STEPS.usual) ** 0.5
        return self.front <= finer * COUNTED_STEPS.front or length <= finer * self.whole / CHOSEN_STEPS.finest


Stride = Counted | Chosen


def chosen(whole: float, bend: float, turns: float = 1.0) -> Chosen:
    """The first step by accuracy of a programme of the length ``whole`` in the opening; ``turns`` see `Chosen`."""
    return Chosen(whole, bend, CHOSEN_STEPS.first * whole, turns)


class Drawn(NamedTuple):
    """A step as it is drawn, in the plane of opening and load over their sizes.

    ``length`` is that of its chord. The change of the energies on a step is the area below the true path, however many
    points break on it. ``from_chord`` is the largest distance from the chord of a parabola with that area; ``strayed``
    the mean distance of the cubic from the path over the mean load; ``over`` the rise of the cubic above both ends.
    """

    length: float
    from_chord: float
    strayed: float
    over: float


_S = np.linspace(0.0, 1.0, 17)

#: Errors are relative to the mean load of a step, at least to this part of the peak.
_LIGHT = 0.25


def _drawn(before: State, reached: State, size: tuple[float, float]) -> Drawn:
    """A step as it is drawn; ``size`` are opening and load at the largest load."""
    ends = np.array([[at.opening, at.load] for at in (before, reached)]) / size
    along = ends[1] - ends[0]
    length = float(np.hypot(*along))
    if length == 0.0:
        return Drawn(0.0, 0.0, 0.0, 0.0)
    spent, worked = (
        (b - a) / (size[0] * size[1]) for a, b in ((before.energy, reached.energy), (before.work, reached.work))
    )
    below_chord = 0.5 * (ends[0, 1] + ends[1, 1]) * along[0]
    sign = np.sign(ends[1, 1] or ends[0, 1])
    over = float(np.max(sign * (ends[0, 1] + _cubic(before, reached, size, along)))) - float(np.max(sign * ends[:, 1]))
    strayed = abs(worked - spent) / length / max(0.5 * abs(ends[0, 1] + ends[1, 1]), _LIGHT)
    return Drawn(length, 1.5 * abs(spent - below_chord) / length, strayed, over)


def _cubic(before: State, reached: State, size: tuple[float, float], along: np.ndarray) -> np.ndarray:
    """Load (n_s,) from the start of a step on, of the cubic with the directions at both ends, as long as the chord."""
    angle_e = np.arctan(np.array([before.slope, reached.slope]) * size[0] / size[1])
    first, last = float(np.hypot(*along)) * np.array([before.heading, reached.heading]) * np.sin(angle_e)
    return along[1] * _S**2 * (3.0 - 2.0 * _S) + first * _S * (1.0 - _S) ** 2 - last * _S**2 * (1.0 - _S)
