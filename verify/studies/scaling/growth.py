"""Power laws, value = factor N^exponent, by least squares on logarithms; and speed-ups by more ranks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf, isfinite, nan

import numpy as np

from verify.studies.scaling.row import PARTS, Row


@dataclass(frozen=True)
class Fit:
    """A power law fitted to points (N, value).

    exponent, error : exponent and its standard error; NaN for fewer than three points
    factor : value at N = 1
    """

    exponent: float
    error: float
    factor: float

    def __str__(self) -> str:
        """1.02 +- 0.01"""
        return f"{self.exponent:.2f} +- {self.error:.2f}" if isfinite(self.exponent) else "?"


def fit(n: Sequence[float], value: Sequence[float]) -> Fit:
    """The power law fitted to the positive points; all NaN for fewer than three of them."""
    x, y = np.asarray(n, float), np.asarray(value, float)
    there = (x > 0) & (y > 0) & np.isfinite(x) & np.isfinite(y)
    x, y = np.log(x[there]), np.log(y[there])
    spread = float(np.sum((x - x.mean()) ** 2)) if x.size else 0.0
    if x.size < 3 or spread == 0.0:
        return Fit(nan, nan, nan)
    exponent = float(np.sum((x - x.mean()) * y) / spread)
    level = float(y.mean() - exponent * x.mean())
    scatter = float((np.sum((y - level - exponent * x) ** 2) / (x.size - 2)) ** 0.5)
    return Fit(exponent, scatter / spread**0.5, float(np.exp(level)))


@dataclass(frozen=True)
class Shared:
    """One size on several ranks, compared with the same size on one rank.

    speed_up, serial : speed-up and serial part of the time, of an iteration ("iteration") and of its parts
    """

    dofs: int
    ranks: int
    speed_up: Mapping[str, float]
    serial: Mapping[str, float]

    @property
    def efficiency(self) -> float:
        return self.speed_up["iteration"] / self.ranks


def shared(rows: Sequence[Row]) -> list[Shared]:
    """Every run on several ranks, compared with the run of the same size on one rank."""
    alone = {one.elements: one for one in rows if one.measured and one.ranks == 1 and one.method == "dolfinx"}
    found = []
    for one in rows:
        if one.measured and one.ranks > 1 and one.elements in alone:
            base = alone[one.elements]
            pairs = {name: (getattr(base, name), getattr(one, name)) for name in ("iteration", *PARTS)}
            faster = {name: before / after if after > 0 else inf for name, (before, after) in pairs.items()}
            serial = {name: serial_part(value, one.ranks) for name, value in faster.items()}
            found.append(Shared(one.dofs, one.ranks, faster, serial))
    return sorted(found, key=lambda one: (one.dofs, one.ranks))


def serial_part(speed_up: float, ranks: int) -> float:
    """Serial part of the time on one rank, from a measured speed-up (Karp and Flatt 1990, Eq. 2).

    It contains everything that limits the speed-up: repeated work, waiting, and shared memory bandwidth. Above 1 more
    ranks are slower than one.
    """
    if not speed_up > 0:
        return inf if speed_up == 0 else nan
    return (1.0 / speed_up - 1.0 / ranks) / (1.0 - 1.0 / ranks)
