"""Rounding and noise of a curve, found from the curve itself, which are no deviation of its solution; and the curve
between its rows in the shape of a right one, without them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from verify.curves.curve import Curve, envelope, load_at
from verify.curves.legs import Leg, path

#: Part of the largest number below which a quantum is that of numbers printed in full.
FULL_PRECISION = 1e-5

#: Different numbers that share a quantum. By chance this many have twice the quantum they were rounded to once in 256.
SHARED_BY = 8

#: Groups of numbers of similar size, each with its quantum: of significant digits each decade has its own.
QUANTUM_GROUPS = 40

#: Part of the range of openings within which rows are at one opening.
AT_ONE_OPENING = 1e-9

#: Residuals from which a noise is found, and those, over half a quantum of loads, of most rows that are rounded.
RESIDUALS, ROUGH = 3, 0.1

#: Noise before the peak over that behind it, or the inverse, from which both are one noise.
ALIKE = 0.3

#: Standard deviations that a point of a curve with noise may be off: one point of 10^6 is by chance.
SIGMAS = 5.0

#: Part of changes of the step between openings above which openings may be rounded; chosen steps change seldom.
CHANGING_STEPS = 0.2

#: Part of a tolerance to which the mean of neighbouring rows takes the scatter down, and of the rows of a leg that such
#: a mean has at most: beyond it is no local one.
LEFT_BY_A_MEAN, MOST_OF_A_MEAN = 0.25, 0.1


@dataclass(frozen=True)
class Scatter:
    """``noise`` is the standard deviation of the loads beyond rounding; ``sizes`` (2, n) are openings and loads without
    their signs, in rising order, and ``halves`` (2, n) half of the quantum of each, 0 in full precision."""

    noise: float
    sizes: np.ndarray
    halves: np.ndarray

    @property
    def seen(self) -> bool:
        """Whether the noise is more than rounding may look like: no more than half a quantum."""
        return self.noise > float(self.halves[1].max())

    def half(self, d: np.ndarray, P: np.ndarray) -> np.ndarray:
        """Half of the quantum (2, n) of openings and loads (n,)."""
        pairs = zip((d, P), self.sizes, self.halves, strict=True)
        return np.stack([np.interp(np.abs(values), size, half) for values, size, half in pairs])


NO_SCATTER = Scatter(0.0, np.zeros((2, 1)), np.zeros((2, 1)))


def scatter_of(curve: Curve, right: Curve | None = None) -> Scatter:
    """Rounding and noise of the rows (n,) of a curve.

    A quantum is the greatest common divisor of the numbers, by their size. It is none where the rows are as smooth as
    the steps of a calculation, which on a straight line have a common divisor as well. Openings are rounded where their
    steps keep changing and the loads scatter as that makes them.

    Noise is the median of the residuals of rows from the cubic through two neighbours on either side, before the peak
    and behind it, the smaller one: the ripple of a mesh is behind the peak alone, a single wrong row is in no median.
    Where a curve of few rows bends between them the residuals of its difference from a ``right`` one are smaller.
    """
    d, P = (np.asarray(values, dtype=float) for values in curve)
    steps = np.diff(d)[np.diff(d) != 0.0]
    change = np.abs(np.diff(steps)) > 1e-6 * np.max(np.abs(steps), initial=0.0)
    opening = 0.5 * quanta(d) * bool(change.size and np.mean(change) > CHANGING_STEPS)
    load = 0.5 * quanta(P)
    load = load * _rough(d, P, load)
    order = np.unique(d, return_index=True)[1]
    shape = (d[order], P[order]) if right is None else right
    ends = envelope(*shape)[0][[0, -1]]
    ways = [P] if right is None else [P, P - load_at(right, np.clip(d, *ends))]
    reach = np.ptp(d) / 200.0  # the change of the load with the opening is that over a hundredth of the openings
    low, high = (np.clip(d + side, *ends) for side in (-reach, reach))
    by_opening = opening * np.abs(load_at(shape, high) - load_at(shape, low)) / np.maximum(high - low, reach)
    peak = int(np.argmax(np.abs(P)))
    before, behind = ([_residuals(d[on], y[on]) for y in ways] for on in (slice(0, peak + 1), slice(peak, None)))
    parts = [(min(found, key=_size), on) for found, on in ((before, slice(2, peak - 1)), (behind, slice(peak + 2, -2)))]
    parts = [(found, on) for found, on in parts if found.size >= RESIDUALS]
    if all(_size(found) ** 2 < np.median(by_opening[on] ** 2) / 12.0 for found, on in parts):
        opening, by_opening = np.zeros_like(d), np.zeros_like(d)
    printed = (load**2 + by_opening**2) / 3.0  # variance by rounding
    noises = [float(np.sqrt(max(_size(found) ** 2 - float(np.median(printed[on])), 0.0))) for found, on in parts]
    least = min(noises, default=0.0)
    if least > ALIKE * max(noises, default=0.0):
        least = float(np.average(noises, weights=[len(found) for found, _ in parts]))
    sizes = np.abs([d, P])
    order = np.argsort(sizes, axis=1, kind="stable")
    return Scatter(least, np.take_along_axis(sizes, order, 1), np.take_along_axis(np.array([opening, load]), order, 1))


def quanta(values: np.ndarray) -> np.ndarray:
    """The greatest common divisor (n,) of the numbers of similar and of larger size, 0 below `FULL_PRECISION`.

    Of significant digits each decade has a quantum of its own, which a few numbers show if many rows have them.
    """
    size = np.abs(values)
    distinct, rows = np.unique(size[size > 0.0], return_counts=True)
    if distinct.size < SHARED_BY:
        return np.zeros_like(size)
    groups: list[np.ndarray] = []
    for decade in np.split(np.arange(distinct.size), np.flatnonzero(np.diff(np.floor(np.log10(distinct)))) + 1):
        parts = min(decade.size // SHARED_BY, QUANTUM_GROUPS)
        if parts or not groups or (decade.size > 1 and rows[decade].sum() >= SHARED_BY):
            groups += np.array_split(decade, max(parts, 1))
        else:
            groups[-1] = np.append(groups[-1], decade)
    found = np.full_like(size, np.inf)
    for group in groups:
        there = (size >= distinct[group[0]]) & (size <= distinct[group[-1]])
        found[there] = _divisor(distinct[group], FULL_PRECISION * float(distinct[-1]))
    order = np.argsort(-size, kind="stable")  # what is larger has no smaller quantum
    found[order] = np.minimum.accumulate(found[order])
    return np.where(np.isfinite(found), found, 0.0)


def _divisor(values: np.ndarray, least: float) -> float:
    """Of positive numbers, by Euclid's algorithm on all of them at once; 0 below ``least``."""
    divisor, near = float(values[0]), 1e-3 * least
    while divisor >= least:
        left = np.abs(values - divisor * np.round(values / divisor))
        left = left[left > near]
        if not left.size:
            return divisor
        divisor = float(np.min(left))
    return 0.0


def _moved(d: np.ndarray) -> np.ndarray:
    """Rows (n,) at another opening than the one before."""
    return np.append(True, np.abs(np.diff(d)) > AT_ONE_OPENING * np.ptp(d))


def _rough(d: np.ndarray, P: np.ndarray, half: np.ndarray) -> bool:
    """Whether rows at which the load changes are as rough as their rounding to quanta makes them."""
    d, P, half = (values[_moved(d)] for values in (d, P, half))
    changed = (np.diff(P) != 0.0)[1:-2]
    return bool(changed.any() and np.median(np.abs(_residuals(d, P))[changed] >= ROUGH * half[2:-2][changed]) > 0.0)


def _size(residuals: np.ndarray) -> float:
    """Standard deviation by the median, which single rows do not change."""
    return 1.4826 * float(np.median(np.abs(residuals))) if residuals.size else np.inf


def _residuals(d: np.ndarray, P: np.ndarray) -> np.ndarray:
    """Of inner rows (n - 4,) from the cubic through two on either side, in standard deviations of one row.

    Rows at one opening count once; the path is a function of the way that the opening has gone.
    """
    moved = _moved(d)
    t, P = np.append(0.0, np.cumsum(np.abs(np.diff(d[moved])))), P[moved]
    if t.size < 5:
        return np.zeros(0)
    at = np.arange(2, t.size - 2)
    around = at[:, None] + np.array([-2, -1, 1, 2])
    x, here = t[around], t[at]
    factors = [[(here - x[:, k]) / (x[:, j] - x[:, k]) for k in range(4) if k != j] for j in range(4)]
    weights = np.prod(factors, axis=1).T  # of Lagrange's cubic
    return (P[at] - np.sum(weights * P[around], axis=1)) / np.sqrt(1.0 + np.sum(weights**2, axis=1))


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
    one, other, first = path(curve, programme), path(right, programme), abs(float(np.asarray(curve[0])[0]))
    pairs = zip(one.legs, other.legs, strict=False)
    legs = [_completed_leg(*pair, scatter, near, 0.0 if i else first) for i, pair in enumerate(pairs)]
    return Completed(*(np.concatenate(values) for values in zip(*legs, strict=True)))


def _completed_leg(mine: Leg, its: Leg, scatter: Scatter, near: float, first: float) -> tuple[np.ndarray, ...]:
    """The fields of `Completed` on one leg; ``first``: of the rows of the first leg, 0 on others."""
    (x, y), (known, shape) = envelope(*mine.onward), envelope(*its.onward)
    low, high = max(float(known[0]), float(x[0]), first or -np.inf), min(float(known[-1]), float(x[-1]))
    kept = (x >= low) & (x <= high)
    if not (high > low and kept.any()):
        none = np.zeros_like(mine.opening)
        return mine.opening, mine.load, none, none, none == 0.0
    x, y = x[kept], y[kept]
    wanted, (half_d, half) = load_at((known, shape), x), scatter.half(x, y)
    within = [np.interp(x + side * half_d, known, shape) for side in (-1.0, 1.0)]  # half a quantum of the opening
    half = np.hypot(half, 0.5 * np.abs(within[1] - within[0]))
    spread = float(np.median(np.hypot(scatter.noise, half / np.sqrt(3.0)))) / (LEFT_BY_A_MEAN * near)
    rows = int(min(np.ceil(spread**2), max(MOST_OF_A_MEAN * len(x), 1.0)))  # of a mean that takes the spread down to 1
    i = np.arange(len(x))
    reach = np.minimum(max(rows - 1 + rows % 2, 1) // 2, np.minimum(i, i[::-1]))  # on both sides, fewer near an end
    total = np.append(0.0, np.cumsum(y - wanted))
    off = (total[i + reach + 1] - total[i - reach]) / (2 * reach + 1)
    before, inside = known < min(low, first), (known >= low) & (known <= high)
    at = np.append(x, known[inside])
    load = np.append(wanted + off, shape[inside] + np.interp(known[inside], x, off))
    order = np.argsort(at, kind="stable")
    start, none = known[before], np.zeros(np.count_nonzero(before))
    return (
        mine.heading * np.append(start, at[order]),
        np.append(shape[before] + (off[0] / low * start if start.size else none), load[order]),
        *(np.append(none, np.interp(at[order], x, one)) for one in _left(scatter.noise, half, wanted, reach)),
        np.append(none, np.ones(at.size)).astype(bool),
    )


def _left(noise: float, half: np.ndarray, load: np.ndarray, reach: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Three standard deviations (n,) of a mean of rows, with ``half`` (n,) a quantum of the load, and one of them,
    which of rounding is more than a third of its bound.

    Rounding is no chance where the load changes by less than a quantum from row to row: of c quanta in a window the
    last, incomplete one leaves up to half a quantum over 4 c, and all of it where c is small.
    """
    i = np.arange(len(load))
    crossed = np.abs(load[i + reach] - load[i - reach]) / np.where(half > 0.0, 2.0 * half, 1.0)
    by_chance = np.sqrt(3.0 / (2 * reach + 1))  # three standard deviations half / sqrt(3) / sqrt(rows)
    rounded = half * np.minimum(1.0, np.maximum(by_chance, 0.25 / np.maximum(crossed, 0.25)))
    by_noise = noise / np.sqrt(2 * reach + 1)
    return np.hypot(3.0 * by_noise, rounded), np.hypot(by_noise, rounded / np.sqrt(3.0))
