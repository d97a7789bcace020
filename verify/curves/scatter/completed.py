"""A curve of another code as far as it goes: between its rows in the shape of a right one, without its scatter."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from verify.curves.curve import Curve, envelope, load_at
from verify.curves.legs import Leg, path
from verify.curves.scatter.found import Scatter

#: Part of a tolerance to which the mean of neighbouring rows takes the scatter down, and of the rows of a leg that such
#: a mean has at most: beyond it is no local one.
LEFT_BY_A_MEAN, MOST_OF_A_MEAN = 0.25, 0.1


@dataclass(frozen=True)
class Completed:
    """The path (n,), the most that scatter leaves in its loads, ``left`` (n,), its root mean square ``spread`` (n,).

    ``given`` (n,): whether a point is within the rows of the curve, and not before the first one.
    """

    opening: np.ndarray
    load: np.ndarray
    left: np.ndarray
    spread: np.ndarray
    given: np.ndarray


def completed(curve: Curve, right: Curve, programme: Sequence[float], scatter: Scatter, near: float) -> Completed:
    """The curve along the rows of both, leg by leg: a ``right`` one plus their difference at the rows of the curve,
    which goes straight between them.

    So the peak and the bends of few rows are not cut off, and a curve that is right at all of its rows is right. In a
    curve with scatter the difference is the running mean of as many rows as take it down to `LEFT_BY_A_MEAN` of the
    load ``near``. Before the first row the difference goes straight to zero at the origin, as that of a stiffness does.
    """
    one, other, first = path(curve, programme), path(right, programme), float(np.asarray(curve[0])[0])
    pairs = zip(one.legs, other.legs, strict=False)
    legs = [_leg(*pair, scatter, near, 0.0 if i else abs(first)) for i, pair in enumerate(pairs)]
    return Completed(*(np.concatenate(values) for values in zip(*legs, strict=True)))


def _leg(mine: Leg, its: Leg, scatter: Scatter, near: float, first: float) -> tuple[np.ndarray, ...]:
    """The fields of `Completed` on one leg; ``first``: of the rows of the first leg, 0 on others."""
    (x, y), (known, shape) = envelope(*mine.onward), envelope(*its.onward)
    low, high = max(float(known[0]), float(x[0]), first or -np.inf), min(float(known[-1]), float(x[-1]))
    kept = (x >= low) & (x <= high)
    if not (high > low and kept.any()):
        none = np.zeros_like(mine.opening)
        return mine.opening, mine.load, none, none, none == 0.0
    x, y = x[kept], y[kept]
    wanted, half = load_at((known, shape), x), scatter.half(x, y)
    half[1] = np.hypot(half[1], half[0] * _slope(known, shape, x, half[0]))
    spread = float(np.median(np.hypot(scatter.noise, half[1] / np.sqrt(3.0))))
    rows = _rows_of_a_mean(spread / (LEFT_BY_A_MEAN * near), len(x))
    off, (left, rms) = _mean(y - wanted, rows), _left(scatter.noise, half[1], wanted, rows)
    before, inside = known < min(low, first), (known >= low) & (known <= high)
    at = np.append(x, known[inside])
    load = np.append(wanted + off, shape[inside] + np.interp(known[inside], x, off))
    order = np.argsort(at, kind="stable")
    start, none = known[before], np.zeros(np.count_nonzero(before))
    return (
        mine.heading * np.append(start, at[order]),
        np.append(shape[before] + (off[0] / low * start if start.size else none), load[order]),
        np.append(none, np.interp(at[order], x, left)),
        np.append(none, np.interp(at[order], x, rms)),
        np.append(none, np.ones(at.size)).astype(bool),
    )


def _slope(known: np.ndarray, shape: np.ndarray, x: np.ndarray, half: np.ndarray) -> np.ndarray:
    """Change of the load over that of the opening (n,), within half a quantum; 0 where openings are not rounded."""
    low, high = (np.interp(x + side * half, known, shape) for side in (-1.0, 1.0))
    return np.abs(high - low) / np.where(half > 0.0, 2.0 * half, 1.0)


def _rows_of_a_mean(spread: float, n: int) -> int:
    """The odd number of rows, of n, that takes a spread down to 1, or as many as there may be."""
    rows = int(min(np.ceil(spread**2), max(MOST_OF_A_MEAN * n, 1.0)))
    return max(rows - 1 + rows % 2, 1)


def _mean(values: np.ndarray, rows: int) -> np.ndarray:
    """Of each value (n,) and as many neighbours on both sides, fewer near an end."""
    total, i = np.append(0.0, np.cumsum(values)), np.arange(len(values))
    reach = np.minimum(rows // 2, np.minimum(i, i[::-1]))
    return (total[i + reach + 1] - total[i - reach]) / (2 * reach + 1)


def _left(noise: float, half: np.ndarray, load: np.ndarray, rows: int) -> tuple[np.ndarray, np.ndarray]:
    """Three standard deviations (n,) of a mean of rows, with ``half`` (n,) a quantum of the load, and one of them,
    which of rounding is more than a third of its bound.

    Rounding is no chance where the load changes by less than a quantum from row to row: of c quanta in a window the
    last, incomplete one leaves up to half a quantum over 4 c, and all of it where c is small.
    """
    i = np.arange(len(load))
    reach = np.minimum(rows // 2, np.minimum(i, i[::-1]))
    crossed = np.abs(load[i + reach] - load[i - reach]) / np.where(half > 0.0, 2.0 * half, 1.0)
    by_chance = np.sqrt(3.0 / (2 * reach + 1))  # three standard deviations half / sqrt(3) / sqrt(rows)
    rounded = half * np.minimum(1.0, np.maximum(by_chance, 0.25 / np.maximum(crossed, 0.25)))
    by_noise = noise / np.sqrt(2 * reach + 1)
    return np.hypot(3.0 * by_noise, rounded), np.hypot(by_noise, rounded / np.sqrt(3.0))
