"""Whether G rises along the crack beyond its noise, and how: initiation, plateau, and the growth up to it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from verify.reduction.corrections import fitted_line, noise_of
from verify.reduction.initiation import ONSET

#: Groups of neighbouring rows whose means are compared, at most, and the fewest that tell a rise from noise.
GROUPS, FEWEST_GROUPS = 20, 6
#: Standard deviations of 95 % of a normal distribution.
AGREED = 1.96


@dataclass(frozen=True)
class RCurve:
    """G = plateau - (plateau - initiation) max(0, 1 - growth / length), by least squares.

    ``noise`` is the standard deviation of a mean of neighbouring rows. ``reached``: whether the crack grows on behind
    ``length``; if not the plateau is not known, and ``plateau`` is the last G of the line.
    """

    initiation: float
    plateau: float
    length: float
    noise: float
    reached: bool


def group_means(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Means (k,) of x and y over groups of neighbouring rows."""
    parts = np.array_split(np.arange(x.size), min(GROUPS, x.size))
    return np.array([x[rows].mean() for rows in parts]), np.array([y[rows].mean() for rows in parts])


def rise(growth: np.ndarray, G: np.ndarray) -> tuple[float, float]:
    """Rise of G (n,) along the growth, by the line through its means, and the standard deviation of that."""
    x, means = group_means(growth, G)
    if x.size < FEWEST_GROUPS or not np.ptp(x) > 0.0:
        return float("nan"), float("nan")
    reach, size = float(np.ptp(x)), float(x.std()) * x.size**0.5
    return fitted_line(x, means)[0] * reach, noise_of(means) / size * reach


def rises(found: list[tuple[float, float]]) -> bool:
    """Whether the schemes of a test, each with its `rise`, agree that G rises.

    Each rise is more than `ONSET.sigmas` deviations of its noise, and their mean more than `AGREED` standard deviations
    of them from scheme to scheme: what schemes disagree about is an error of theirs.
    """
    known = [one for one in found if np.isfinite(one[0])]
    if not known or any(R <= ONSET.sigmas * s for R, s in known):
        return False
    values = np.array([R for R, _ in known])
    return values.size == 1 or bool(values.mean() > AGREED * values.std(ddof=1))


def r_curve(growth: np.ndarray, G: np.ndarray) -> RCurve:
    """The best `RCurve` of rows (n,): the length with the least residual of 200, the rest linear."""
    x, means = group_means(growth, G)
    lengths = np.linspace(x[0], x[-1], 201)[1:]
    fits = [np.linalg.lstsq(_basis(x, L), means, rcond=None)[0] for L in lengths]
    left = [float(np.sum((_basis(x, L) @ one - means) ** 2)) for L, one in zip(lengths, fits, strict=True)]
    best = int(np.argmin(left))
    low, high = map(float, fits[best])
    return RCurve(low, high, float(lengths[best]), noise_of(means), bool(lengths[best] < x[-2]))


def _basis(x: np.ndarray, length: float) -> np.ndarray:
    """Parts (n, 2) of initiation and plateau at growths ``x``."""
    before = np.maximum(1.0 - x / length, 0.0)
    return np.stack([before, 1.0 - before], axis=1)
