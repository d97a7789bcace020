"""What a step that the path chooses keeps: the straight line to its end, the largest load, and the ledger of energy.

The true path between two converged points is not known, but two things of it are: the slopes at its ends, and the work
of the load along it, which is what its energies change by. The area between path and straight line follows from that
exactly, however many points of the interface break on the way.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from iga.path.kinks import SEVERAL, broken_between
from iga.path.point import Point
from iga.system.system import System

#: The largest load of the path lies above that of its points by at most this part of ``bend`` times it.
PEAK = 0.2
#: Part of the largest work so far by which the ledger of a path may be open: half of what is held to be closed.
LEDGER = 2.5e-3
#: Height of a triangle over its mean height: of all that bulges to one side nothing has a higher tip.
TIP = 2.0
#: Part of the height of teeth by which they may leave their mean: both ends stand anywhere on theirs.
PHASE = 1.0
#: Part of the promised distance that a step may use: the height of teeth is an estimate, of some wider than others.
WITHIN = 0.8
#: Step that is tried after one that has failed to keep its promise, in parts of it: least, largest, and of what is due.
SHORTEST, LONGEST, SAFELY = 0.25, 0.75, 0.9

_S = np.linspace(0.0, 1.0, 17)


@dataclass(frozen=True)
class Largest:
    """The largest sizes of load and work on a path so far, and the opening of that load."""

    load: float = 0.0
    opening: float = 0.0
    work: float = 0.0

    def with_point(self, point: Point) -> Largest:
        load, opening = max((self.load, self.opening), (abs(point.state.load), abs(point.opening)))
        return Largest(load, opening, max(self.work, abs(point.external_work)))


@dataclass(frozen=True)
class Kept:
    """Part of a step that keeps what is promised, 1 for one that does, and ``away``: distance over the one promised.

    ``broken``: points of the interface have broken on the step; ``few``: no more than one of them has, and no more than
    one has begun to soften.
    """

    part: float = 1.0
    away: float = 0.0
    few: bool = False
    broken: bool = False


KEPT = Kept()


def judged(system: System, start: Point, end: Point, before: Largest, bend: float) -> Kept:
    """What a step keeps of the following.

    - No point of the path is further from the straight line between both ends than ``bend``, with loads in parts of the
      largest one and openings in parts of the opening at that load.
    - No load between them is larger than those of the points so far by more than ``PEAK bend`` of it.
    - The ledger stays closed to ``LEDGER`` of the largest work, or the step leaves no more than that part of its own.
    """
    largest = before.with_point(end)
    size = np.array([largest.opening, largest.load])
    if not np.all(size > 0.0):
        return KEPT
    size = size * [1.0, np.sign(end.state.load) or 1.0]
    ends = np.array([[point.opening, point.state.load] for point in (start, end)]) / size
    chord = ends[1] - ends[0]
    length = float(np.hypot(*chord))
    if length == 0.0:
        return KEPT
    spent, work = (
        b - a for a, b in ((start.energies.total, end.energies.total), (start.external_work, end.external_work))
    )
    x, y = _drawn(system, start, end, size, chord)
    unseen = spent / float(np.prod(size)) - ends[0, 1] * chord[0] - float(np.trapezoid(y, x))
    tooth = _tooth(system, start, end, size, chord)
    away = float(np.abs(x * chord[1] - y * chord[0]).max()) + max(
        TIP * abs(unseen), abs(unseen) + PHASE * tooth * abs(chord[0])
    )
    above = max(unseen * np.sign(chord[0]), 0.0) / length
    over = ends[0, 1] + float(y.max()) - 1.0 + max(TIP * above, above + PHASE * tooth)
    open_ = abs(end.external_work - end.energies.total) > LEDGER * largest.work
    leak = abs(work - spent) / (LEDGER * abs(work)) if open_ and work != 0.0 else 0.0
    excess = max(away / length / (WITHIN * bend), over / (PEAK * bend), leak)
    part = 1.0 if excess <= 1.0 else float(np.clip(SAFELY * excess**-0.5, SHORTEST, LONGEST))
    g_max = system.interface.law.g_max
    begun = np.count_nonzero((end.state.k_q > g_max) & (start.state.k_q <= g_max))
    broken = broken_between(system, start.state, end.state)
    return Kept(part, away / length / bend, bool(max(begun, broken) < SEVERAL), broken > 0)


def _tooth(system: System, start: Point, end: Point, size: np.ndarray, chord: np.ndarray) -> float:
    """Height of the teeth of the load on a step over several arcs of equal length, 0 on any other.

    Teeth lie on both sides of the straight line, so that the area does not show them. With straight flanks of slopes a
    and b, slope c along the step and width w the height is ``w (a - c) (c - b) / (a - b)``, also where the opening
    falls on one flank.
    """
    broken = broken_between(system, start.state, end.state)
    if broken < SEVERAL or chord[0] == 0.0:
        return 0.0
    paths = start.tangent, end.tangent
    flanks = np.array([[path.arrival, path.departure] for path in paths]).ravel() * size[0] / size[1]
    flanks = flanks - chord[1] / chord[0]
    back = chord[0] * np.array([[path.came, path.heading] for path in paths]).ravel() < 0.0
    width, ahead = abs(chord[0]) / broken, flanks[~back]
    if ahead.size == 0:
        return np.inf
    high, low = ahead.max(), -ahead.min()
    if back.any():  # a flank on which the opening falls makes the other one longer
        high = max(high, low)
        shorter = 1.0 / high - float(np.max(1.0 / np.abs(flanks[back])))
        return width / shorter if shorter > 0.0 else np.inf
    if high * low <= 0.0:
        return 0.5 * width * min(abs(high), abs(low))
    return width / (1.0 / high + 1.0 / low)


def _drawn(system: System, start: Point, end: Point, size: np.ndarray, chord: np.ndarray) -> np.ndarray:
    """Opening and load (2, n_s) from the start of a step on: a geometric Hermite cubic with the slopes at both ends.

    Over several arcs of the load the slopes say nothing of what is between, and the line is straight.
    """
    if broken_between(system, start.state, end.state) >= SEVERAL:
        return np.outer(chord, _S)
    angle = np.arctan(np.array([start.tangent.departure, end.tangent.arrival]) * size[0] / size[1])
    unit = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    way = np.array([start.heading, end.tangent.came])
    first, last = float(np.hypot(*chord)) * way[:, None] * unit
    s = _S
    return (
        np.outer(chord, s * s * (3.0 - 2.0 * s))
        + np.outer(first, s * (1.0 - s) ** 2)
        - np.outer(last, s * s * (1.0 - s))
    )
