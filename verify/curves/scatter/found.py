"""Rounding and noise of a curve, found from the curve itself: what is left of them is no deviation of the solution."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from verify.curves.curve import Curve, envelope, load_at

#: Part of the largest number below which a quantum is that of numbers printed in full.
FULL_PRECISION = 1e-5

#: Different numbers that share a quantum. By chance this many have twice the quantum they were rounded to once in 256.
SHARED_BY = 8

#: Groups of numbers of similar size whose quanta are found apart: of significant digits each decade has its own.
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
    and behind it, the smaller one: teeth of a mesh are behind the peak alone, a single wrong row is in no median. Where
    a curve of few rows bends between them the residuals of its difference from a ``right`` one are smaller.
    """
    d, P = (np.asarray(values, dtype=float) for values in curve)
    opening = 0.5 * quanta(d) * _keep_changing(d)
    ends = (-np.inf, np.inf) if right is None else tuple(envelope(*right)[0][[0, -1]])
    ways = [P] if right is None else [P, P - load_at(right, np.clip(d, *ends))]
    load = 0.5 * quanta(P)
    load = load * _rough(d, P, load)
    unseen = _slope(d, P, right, ends) * opening
    peak = int(np.argmax(np.abs(P)))
    before, behind = ([_residuals(d[on], y[on]) for y in ways] for on in (slice(0, peak + 1), slice(peak, None)))
    parts = [(min(found, key=_size), on) for found, on in ((before, slice(2, peak - 1)), (behind, slice(peak + 2, -2)))]
    parts = [(found, on) for found, on in parts if found.size >= RESIDUALS]
    if all(_size(found) ** 2 < np.median(unseen[on] ** 2) / 12.0 for found, on in parts):
        opening, unseen = np.zeros_like(d), np.zeros_like(d)
    noises = [_beyond(found, (load[on] ** 2 + unseen[on] ** 2) / 3.0) for found, on in parts]
    least, most = min(noises, default=0.0), max(noises, default=0.0)
    if least > ALIKE * most:
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
    found = np.full_like(size, np.inf)
    if distinct.size < SHARED_BY:
        return np.zeros_like(size)
    decades = np.split(np.arange(distinct.size), np.flatnonzero(np.diff(np.floor(np.log10(distinct)))) + 1)
    groups: list[np.ndarray] = []
    for decade in decades:
        parts = min(decade.size // SHARED_BY, QUANTUM_GROUPS)
        shown = parts or (decade.size > 1 and rows[decade].sum() >= SHARED_BY)
        groups = (
            [*groups, *np.array_split(decade, max(parts, 1))]
            if shown or not groups
            else [*groups[:-1], np.append(groups[-1], decade)]
        )
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


def _rough(d: np.ndarray, P: np.ndarray, half: np.ndarray) -> bool:
    """Whether rows at which the load changes are as rough as their rounding to quanta makes them."""
    moved = _moved(d)
    d, P, half = d[moved], P[moved], half[moved]
    changed = (np.diff(P) != 0.0)[1:-2]
    return bool(changed.any() and np.median(np.abs(_residuals(d, P))[changed] >= ROUGH * half[2:-2][changed]) > 0.0)


def _moved(d: np.ndarray) -> np.ndarray:
    """Rows (n,) at another opening than the one before."""
    return np.append(True, np.abs(np.diff(d)) > AT_ONE_OPENING * np.ptp(d))


def _keep_changing(d: np.ndarray) -> bool:
    steps = np.diff(d)
    steps = steps[steps != 0.0]
    change = np.abs(np.diff(steps)) > 1e-6 * np.max(np.abs(steps), initial=0.0)
    return bool(change.size and np.mean(change) > CHANGING_STEPS)


def _slope(d: np.ndarray, P: np.ndarray, right: Curve | None, ends: tuple[float, float]) -> np.ndarray:
    """Size (n,) of the change of the load with the opening, over a hundredth of the openings."""
    reach = np.ptp(d) / 200.0
    if right is None:
        order = np.unique(d, return_index=True)[1]
        right, ends = (d[order], P[order]), (float(d.min()), float(d.max()))
    low, high = (np.clip(d + side, *ends) for side in (-reach, reach))
    return np.abs(load_at(right, high) - load_at(right, low)) / np.maximum(high - low, reach)


def _size(residuals: np.ndarray) -> float:
    """Standard deviation by the median, which single rows do not change."""
    return 1.4826 * float(np.median(np.abs(residuals))) if residuals.size else np.inf


def _beyond(residuals: np.ndarray, printed: np.ndarray) -> float:
    """Standard deviation beyond that of rounding, whose variance is ``printed`` (n,)."""
    return float(np.sqrt(max(_size(residuals) ** 2 - float(np.median(printed)), 0.0)))


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
    x, here = t[around], t[at][:, None]
    weights = np.stack(
        [np.prod([(here[:, 0] - x[:, k]) / (x[:, j] - x[:, k]) for k in range(4) if k != j], axis=0) for j in range(4)],
        axis=1,
    )
    off = P[at] - np.sum(weights * P[around], axis=1)
    return off / np.sqrt(1.0 + np.sum(weights**2, axis=1))
