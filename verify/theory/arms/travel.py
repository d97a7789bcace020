"""The way of the jumps at the points of a bond on a step: they change evenly, or travel with a crack that runs on.

While a crack runs its profile of jumps travels along the bond and changes little. A point that the crack passes on a
step has had, one after the other, the jumps of the points behind it. Damage takes an energy that depends on this way
where the mode ratio changes through the process zone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

#: Part of the change of the jumps that may be left beyond the travelled profile where a crack has run on.
LEFT = 0.5

#: The jumps (q, J) at a part of a step.
Way = Callable[[float], np.ndarray]


def way(x: np.ndarray, reached: tuple[np.ndarray, np.ndarray], jumps: tuple[np.ndarray, np.ndarray]) -> Way:
    """The way between two states.

    x : places (q,) of the points
    reached : progress (q,) of the points before and after, 0 at onset and 1 at failure
    jumps : (q, J) before and after
    """
    (before, after), order = jumps, np.argsort(x)

    def travelled(distance: float) -> np.ndarray:
        return np.stack([np.interp(x - distance, x[order], column[order]) for column in before.T], axis=1)

    fronts = [_fronts(x[order], r[order]) for r in reached]
    if all(len(found) == 1 for found in fronts):
        run = float(fronts[1][0] - fronts[0][0])
        left = after - travelled(run)
        if np.linalg.norm(left) <= LEFT * np.linalg.norm(after - before):
            return lambda part: travelled(part * run) + part * left
    return lambda part: (1.0 - part) * before + part * after


def _fronts(x: np.ndarray, r: np.ndarray) -> np.ndarray:
    """Where the progress r (q,) at rising places x (q,) passes one half."""
    over = r - 0.5
    at = np.flatnonzero(over[:-1] * over[1:] < 0.0)
    return np.asarray(x[at] - over[at] * (x[at + 1] - x[at]) / (over[at + 1] - over[at]))
