"""Where a crack begins to grow (NL, 5 %/max, VIS), and the rows on which it grows, or the specimen unloads."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from verify.curves.legs import unloads_alone
from verify.reduction.corrections import LinearPart
from verify.reduction.data import Measured
from verify.reduction.scheme import Setting

#: Names of initiation values: ASTM D5528, 11.6; ISO 15024, 9.2.
NL, FIVE, VIS = "NL", "5%/max", "VIS"


@dataclass(frozen=True)
class Onset:
    """When a curve has left its line, and what counts as growth.

    departs : opening beyond the line from which it is not linear, in parts of the opening there; what the eye tells
    sigmas : and in standard deviations of the noise
    softer : compliance of the 5 % line over that of the linear part, minus 1
    settled : growth of the equivalent crack, in parts of the largest, from which G counts as propagation where no crack
        length is read: less takes more of a rising R-curve into its mean
    least_load : of rows that count, in parts of the largest load
    reach : crack length, in parts of that up to which the formulas hold, beyond which rows do not count
    """

    departs: float = 0.01
    sigmas: float = 5.0
    softer: float = 0.05
    settled: float = 0.2
    least_load: float = 0.02
    reach: float = 0.95


ONSET = Onset()
SAME_LENGTH = 1e-6


def initiation(rows: Measured, part: LinearPart, noise: float, a0: float) -> dict[str, int]:
    """Index of each initiation point; VIS only where crack lengths are read, NL and 5 % at the maximum at the latest.

    NL: from there to the maximum the opening stays beyond the line by 1 % of it, or more where the load is noisy.
    5 %/max: where the curve meets the line through the origin of 1.05 times the compliance, or the maximum before it.
    VIS: the last row before a crack length exceeds that of the linear part, or the first one after it.
    """
    top = int(np.argmax(rows.load))
    straight = part.compliance * rows.load[: top + 1]
    beyond = rows.opening[: top + 1] - part.toe - straight
    rough = ONSET.sigmas * part.compliance * noise
    found = {
        NL: _leaves(beyond, np.maximum(ONSET.departs * straight, rough), top),
        FIVE: _leaves(beyond, ONSET.softer * straight, top),
    }
    grown = first_growth(rows, part, a0)
    if grown is not None:
        read = np.flatnonzero(np.isfinite(rows.crack))
        before = read[(read < grown) & (read > part.rows[-1])]
        found[VIS] = int(before[-1] if before.size else grown)
    return found


def first_growth(rows: Measured, part: LinearPart, a0: float) -> int | None:
    """Index of the first reading longer than the precrack, as the scene says and as it was read up to the linear part.

    None without such a reading.
    """
    read = np.flatnonzero(np.isfinite(rows.crack))
    start = max(a0, float(np.max(rows.crack[read[read <= part.rows[-1]]], initial=a0)))
    grown = read[rows.crack[read] > start * (1.0 + SAME_LENGTH)]
    return int(grown[0]) if grown.size else None


def _leaves(beyond: np.ndarray, most: np.ndarray, top: int) -> int:
    """The first index from which ``beyond`` stays above ``most`` up to the end, or the end."""
    within = np.flatnonzero(beyond <= most)
    return min(int(within[-1]) + 1 if within.size else 0, top)


def growing(setting: Setting, equivalent: np.ndarray, onset: dict[str, int], unloads: np.ndarray) -> np.ndarray:
    """Rows (n,) of all, ``setting.grown``, on which G counts as propagation.

    They come after the 5 %/max point and the first growth that was read, under load, before the crack meets a load or
    an end, and not on unloading. ``equivalent`` are crack lengths by the compliance (n,).
    """
    rows, settings, a0 = setting.grown, setting.settings, setting.coupon.precrack
    index, longest = np.arange(rows.load.size), ONSET.reach * setting.beam.limit
    crack = np.where(np.isfinite(rows.crack), rows.crack, equivalent)
    bears = rows.load > ONSET.least_load * rows.load.max()
    kept = bears & (index >= onset[FIVE]) & (crack < longest) & ~unloads
    if rows.front is not None:
        kept &= rows.front < longest
    growth = crack - a0
    if settings.begin is not None:
        kept &= growth >= settings.begin
    elif rows.has_cracks:
        first = first_growth(rows, setting.part, a0)
        kept &= index >= (index.size if first is None else first)
    elif kept.any():
        kept &= growth >= ONSET.settled * growth[kept].max()
    if settings.end is not None:
        kept &= growth <= settings.end
    return kept


@dataclass(frozen=True)
class Loops:
    """Limits for rows of unloading: below the largest opening so far, and without growth of the crack.

    back : fall of the opening, in parts of the largest so far, that is more than its noise
    turned : fall of the opening from which a row in a snap-back unloads where its compliance stands still
    stands : compliance, in parts of the largest so far, up to which it stands still
    """

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
    C = np.where(rows.load > ONSET.least_load * rows.load.max(), rows.compliance, 0.0)
    so_far = np.maximum.accumulate(C)
    below = (rows.opening < (1.0 - LOOPS.turned) * largest) & (C < LOOPS.stands * so_far)
    return found | (below & np.append(False, so_far[1:] <= so_far[:-1]))
