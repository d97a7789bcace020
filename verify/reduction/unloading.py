"""Rows of a test on which the specimen unloads, and loads again up to where it was."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from verify.reduction.data import Measured


@dataclass(frozen=True)
class Loops:
    """How a loop of unloading is told from a snap-back, in which the opening falls while the crack grows.

    least_load : of rows whose compliance counts, in parts of the largest load
    back : fall of the opening, in parts of the largest so far, that is more than its noise
    loaded : of rows that tell both apart, in parts of the load where the opening began to fall. At smaller loads a
        residual opening makes the compliance of a loop grow without bounds
    snaps : growth of log C over the fall of log d from which a fall is a snap-back: an ENF specimen has 0.6 to 1 where
        its opening is least, a loop with a residual opening of 5 % has 0.13
    turned : fall of the opening from which a row in a snap-back unloads where its compliance stands still
    stands : compliance, in parts of the largest so far, up to which it stands still
    """

    least_load: float = 0.02
    back: float = 2e-3
    loaded: float = 0.2
    snaps: float = 0.25
    turned: float = 1e-2
    stands: float = 1.005


LOOPS = Loops()


def unloading(rows: Measured) -> np.ndarray:
    """Rows (n,) at which the opening is below its largest so far, and the crack does not grow."""
    largest = np.maximum.accumulate(rows.opening)
    falls = np.concatenate([[False], rows.opening < largest - LOOPS.back * np.abs(largest), [False]])
    first, end = np.flatnonzero(falls[1:] > falls[:-1]), np.flatnonzero(falls[1:] < falls[:-1])
    found = np.zeros(rows.opening.size, dtype=bool)
    for i, j in zip(first, end, strict=True):
        found[i:j] = _is_loop(rows, i, j)
    return found | _stands_still(rows, largest)


def _is_loop(rows: Measured, first: int, end: int) -> bool:
    """Whether the compliance of the rows ``first`` to ``end`` grows too little for a snap-back."""
    top = int(np.argmax(rows.opening[:first]))
    bear = first + np.flatnonzero(rows.load[first:end] >= LOOPS.loaded * rows.load[top])
    if not bear.size:
        return True
    low = bear[np.argmin(rows.opening[bear])]
    growth = np.log(rows.compliance[low] / rows.compliance[top])
    return bool(growth <= LOOPS.snaps * np.log(rows.opening[top] / rows.opening[low]))


def _stands_still(rows: Measured, largest: np.ndarray) -> np.ndarray:
    C = np.where(rows.load > LOOPS.least_load * rows.load.max(), rows.compliance, 0.0)
    so_far = np.maximum.accumulate(C)
    below = (rows.opening < (1.0 - LOOPS.turned) * largest) & (C < LOOPS.stands * so_far)
    return below & np.append(False, so_far[1:] <= so_far[:-1])
