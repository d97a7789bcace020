"""Accuracy of a step whose length the path chooses: distance from the straight line, largest load, energy balance.

Of the true path between two converged points two things are known: the slopes at its ends, and the work of the load
along it, which equals the change of the energies. The area between path and straight line follows from the work
exactly, however many points of the interface break on the way.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from iga.path.kinks import SEVERAL, broken_between
from iga.path.point import Point
from iga.system.system import System


@dataclass(frozen=True)
class Accuracy:
    """Required accuracy of steps whose length the path chooses, and how much shorter a step is tried that fails it.

    - ``peak``: the largest load of the path lies above that of its points by at most ``peak`` tolerances.
    - ``ledger``: error of the energy balance of a path that is allowed, relative to the largest work so far: half of
      what counts as closed.
    - ``tip``: height of a triangle over its mean height; no convex bulge of the same area has a higher tip.
    - ``ripple``: part of the height of the ripple by which it may leave the mean, as both ends may lie anywhere on it.
    - ``within``: part of the allowed distance that a step may use, as the height of the ripple is an estimate: some
      arcs are wider than others.
    - ``shortest``, ``longest``: bounds on the next attempt, relative to the failed step; ``safely``: safety factor on
      its estimated length.
    """

    peak: float = 0.2
    ledger: float = 2.5e-3
    tip: float = 2.0
    ripple: float = 1.0
    within: float = 0.8
    shortest: float = 0.25
    longest: float = 0.5
    safely: float = 0.9


ACCURACY = Accuracy()


def cubics(s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Cubic Hermite functions (2, n_s) of the values and of the slopes at both ends."""
    t = 1.0 - s
    return np.stack([(1.0 + 2.0 * s) * t * t, (1.0 + 2.0 * t) * s * s]), np.stack([s * t * t, -s * s * t])


_S = np.linspace(0.0, 1.0, 17)
_VALUES, _SLOPES = cubics(_S)


@dataclass(frozen=True)
class Largest:
    """The largest sizes of load and work so far on one side of zero, and the opening of that load.

    Faces that are pressed together may bear a hundred times what a bond does that opens, so that each side has its own.
    """

    load: float = 0.0
    opening: float = 0.0
    work: float = 0.0

    def with_point(self, point: Point) -> Largest:
        load, opening = max((self.load, self.opening), (abs(point.state.load), abs(point.opening)))
        return Largest(load, opening, max(self.work, abs(point.external_work)))


@dataclass(frozen=True)
class StepError:
    """The accurate ``part`` of a step (1: all of it), and its ``distance`` from the straight line over the tolerance.

    ``broken``: points of the interface have broken on the step; ``single``: at most one has, and at most one has begun
    to soften; ``opened``: largest growth of `Response.x_q` at a point, relative to the span of the law.
    """

    part: float = 1.0
    distance: float = 0.0
    single: bool = False
    broken: bool = False
    opened: float = np.inf


def step_error(system: System, start: Point, end: Point, before: Largest, tolerance: float) -> StepError:
    """How much of a step is accurate: all of it where all of the following hold (estimates; limits in `Accuracy`).

    - No point of the path is further from the straight line between both ends than ``within tolerance``, with loads
      relative to the largest one and openings relative to the opening at that load.
    - No load on the step exceeds the largest load of the points so far by more than ``peak tolerance`` of it.
    - The energy balance of the path is closed to ``ledger`` of the largest work, or that of the step to ``ledger`` of
      the work of the step.
    """
    largest, law = before.with_point(end), system.interface.law
    size = np.array([largest.opening, largest.load])
    if not np.all(size > 0.0):
        return StepError()
    size[1] *= np.sign(end.state.load) or 1.0
    ends = np.array([[point.opening, point.state.load] for point in (start, end)]) / size
    chord, scale = ends[1] - ends[0], float(size[0] / size[1])
    length = float(np.hypot(*chord))
    if length == 0.0:
        return StepError()
    broken = broken_between(system, start.state, end.state)
    several = broken >= SEVERAL
    spent, work = end.energies.total - start.energies.total, end.external_work - start.external_work
    # over several arcs of the load the slopes do not describe what is between
    x, y = np.outer(chord, _S) if several else _cubic(start, end, scale, chord)
    unseen = spent / float(np.prod(size)) - ends[0, 1] * chord[0] - float(np.trapezoid(y, x))
    height, top = _ripple(start, end, scale, chord, broken) if several else (0.0, 0.0)
    away = float(np.abs(x * chord[1] - y * chord[0]).max()) + max(
        ACCURACY.tip * abs(unseen), abs(unseen) + ACCURACY.ripple * height * length
    )
    above = max(unseen * np.sign(chord[0]), 0.0) / length
    over = ends[0, 1] - 1.0 + float(y.max()) + max(ACCURACY.tip * above, above + ACCURACY.ripple * top)
    over = max(over, _maximum(start, end, scale, chord) - max(0.0, chord[1]))
    open_ = abs(end.external_work - end.energies.total) > ACCURACY.ledger * largest.work
    leak = abs(work - spent) / (ACCURACY.ledger * abs(work)) if open_ and work != 0.0 else 0.0
    excess = max(away / length / (ACCURACY.within * tolerance), over / (ACCURACY.peak * tolerance), leak)
    part = 1.0 if excess <= 1.0 else float(np.clip(ACCURACY.safely * excess**-0.5, ACCURACY.shortest, ACCURACY.longest))
    begun = np.count_nonzero((end.state.k_q > law.begun) & (start.state.k_q <= law.begun))
    x_q, before_q = (np.minimum(point.response.x_q, law.kinks[-1]) for point in (end, start))
    opened = float(np.max(x_q - before_q)) / law.span
    return StepError(part, away / length / tolerance, bool(max(begun, broken) < SEVERAL), broken > 0, opened)


def _maximum(start: Point, end: Point, scale: float, chord: np.ndarray) -> float:
    """By how much a load that rises and then falls on a step exceeds its start, on the cubic with the slopes of both
    ends; slopes times ``scale`` are relative ones.

    Programs that read a curve draw it by these slopes, whatever broke on the way.
    """
    first, last = np.array([start.slope, end.slope]) * scale * chord[0]
    if chord[0] <= 0.0 or not first > 0.0 > last:
        return 0.0
    return float(np.max(chord[1] * _VALUES[1] + np.array([first, last]) @ _SLOPES))


def _ripple(start: Point, end: Point, scale: float, chord: np.ndarray, broken: int) -> tuple[float, float]:
    """Height of the ripple of the load above the straight line of a step over several arcs of equal length, one for
    each ``broken`` point, and how far a flank raises the load.

    The ripple lies on both sides of the line, so that the area does not show it. With straight flanks that rise from
    the line by a and fall back to it by b per length along it the height is ``w / (1 / a + 1 / b)`` for arcs of the
    length w; a flank that goes back along the line has a negative length.
    """
    paths = start.tangent, end.tangent
    slope = np.array([[path.arrival, path.departure] for path in paths]).ravel() * scale
    way = np.array([[path.came, path.heading] for path in paths]).ravel()
    flank = np.stack([way, way * slope], axis=1)
    length, least = float(np.hypot(*chord)), np.finfo(float).tiny
    along, off = flank @ chord / length, flank @ [-chord[1], chord[0]] / length
    per = along / np.where(off == 0.0, least, np.abs(off))
    up, down = off > 0.0, off <= 0.0
    if up.all() or down.all():
        height = 0.5 * length / broken / float(np.abs(per).max())
    else:
        both = float(per[up].min() + per[down].min())
        height = length / broken / both if both > 0.0 else np.inf
    return height, max(height * float((flank[:, 1] / np.maximum(np.abs(off), least)).max()), 0.0)


def _cubic(start: Point, end: Point, scale: float, chord: np.ndarray) -> np.ndarray:
    """Opening and load (2, n_s) from the start of a step on: a geometric Hermite cubic with the slopes at both ends."""
    angle = np.arctan(np.array([start.tangent.departure, end.tangent.arrival]) * scale)
    way = np.array([start.heading, end.tangent.came]) * float(np.hypot(*chord))
    return np.outer(chord, _VALUES[1]) + way * np.stack([np.cos(angle), np.sin(angle)]) @ _SLOPES
