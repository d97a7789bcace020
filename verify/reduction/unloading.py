"""Rows of a test on which the specimen unloads, and loads again up to where it was."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from verify.curves.legs import unloads_alone
from verify.reduction.data import Measured


@dataclass(frozen=True)
class Loops:
    """Limits for rows of unloading: below the largest opening so far, and without growth of the crack.

    least_load : of rows whose compliance counts, in parts of the largest load
    back : fall of the opening, in parts of the largest so far, that is more than its noise
    turned : fall of the opening from which a row in a snap-back unloads where its compliance stands still
    stands : compliance, in parts of the largest so far, up to which it stands still
    """

    least_load: float = 0.02
    back: float = 2e-3
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
        top = int(np.argmax(rows.opening[:i]))
        fall = np.append(top, np.arange(i, j))
        found[i:j] = unloads_alone(rows.opening[fall], rows.load[fall])
    return found | _stands_still(rows, largest)


def _stands_still(rows: Measured, largest: np.ndarray) -> np.ndarray:
    C = np.where(rows.load > LOOPS.least_load * rows.load.max(), rows.compliance, 0.0)
    so_far = np.maximum.accumulate(C)
    below = (rows.opening < (1.0 - LOOPS.turned) * largest) & (C < LOOPS.stands * so_far)
    return below & np.append(False, so_far[1:] <= so_far[:-1])
