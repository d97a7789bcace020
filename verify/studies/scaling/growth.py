"""Exponents of growth, value = factor N^exponent, least squares on logarithms; and what more ranks gain."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf, isfinite, nan

import numpy as np

from verify.studies.scaling.row import PARTS, Row


@dataclass(frozen=True)
class Fit:
    """A power law through points (N, value).

    exponent, error : of the power, with its standard error; NaN for fewer than three points
    factor : value at N = 1
    """

    exponent: float
    error: float
    factor: float

    def __str__(self) -> str:
        """1.02 +- 0.01"""
        return f"{self.exponent:.2f} +- {self.error:.2f}" if isfinite(self.exponent) else "?"


def fit(n: Sequence[float], value: Sequence[float]) -> Fit:
    """The power law through at least three points, all positive; without them all is NaN."""
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
    """A size on some ranks against the same on one.

    speed_up, serial : of an iteration ("iteration") and of its parts, with the part of the time that is not shared
    """

    dofs: int
    ranks: int
    speed_up: Mapping[str, float]
    serial: Mapping[str, float]

    @property
    def efficiency(self) -> float:
        return self.speed_up["iteration"] / self.ranks


def shared(rows: Sequence[Row]) -> list[Shared]:
    """Every run on more ranks than one against its like on one."""
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
    """Part of the time on one rank that more do not share, from a measured speed-up (Karp and Flatt 1990, Eq. 2).

    It holds all that keeps ranks from being that many times as fast: what each repeats, what they wait for, and the
    memory bandwidth that they share. Above 1 more ranks are slower than one.
    """
    if not speed_up > 0:
        return inf if speed_up == 0 else nan
    return (1.0 / speed_up - 1.0 / ranks) / (1.0 - 1.0 / ranks)
