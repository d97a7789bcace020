"""Exponents of growth: value = factor N^exponent, least squares on logarithms."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, nan

import numpy as np

#: Standard errors on either side of what a fit says elsewhere.
WIDTH = 2.0


@dataclass(frozen=True)
class Fit:
    """A power law through points (N, value), and how well it is known.

    exponent, error : of the power, with its standard error; NaN for fewer than three points
    factor : value at N = 1
    scatter : standard deviation of the logarithms about the line
    centre, spread : mean of log N, and the sum of squares about it
    """

    exponent: float
    error: float
    factor: float
    scatter: float
    centre: float
    spread: float
    points: int

    def at(self, n: float) -> tuple[float, float]:
        """Lowest and highest value at ``n``, `WIDTH` standard errors of the line to either side of it.

        The error of a straight line grows with the distance from its points (Draper and Smith 1998, section 3.1).
        """
        middle = np.log(self.factor) + self.exponent * np.log(n)
        off = WIDTH * self.scatter * (1.0 / self.points + (np.log(n) - self.centre) ** 2 / self.spread) ** 0.5
        return float(np.exp(middle - off)), float(np.exp(middle + off))


def fit(n: Sequence[float], value: Sequence[float]) -> Fit:
    """The power law through at least three points, all positive; without them all is NaN."""
    x, y = np.asarray(n, float), np.asarray(value, float)
    there = (x > 0) & (y > 0) & np.isfinite(x) & np.isfinite(y)
    x, y = np.log(x[there]), np.log(y[there])
    spread = float(np.sum((x - x.mean()) ** 2)) if x.size else 0.0
    if x.size < 3 or spread == 0.0:
        return Fit(nan, nan, nan, nan, nan, nan, int(x.size))
    exponent = float(np.sum((x - x.mean()) * y) / spread)
    level = float(y.mean() - exponent * x.mean())
    scatter = float((np.sum((y - level - exponent * x) ** 2) / (x.size - 2)) ** 0.5)
    return Fit(exponent, scatter / spread**0.5, float(np.exp(level)), scatter, float(x.mean()), spread, int(x.size))


def serial_part(speed_up: float, ranks: int) -> float:
    """Part of the time on one rank that more do not share, from a measured speed-up (Karp and Flatt 1990, Eq. 2).

    It holds all that keeps ranks from being that many times as fast: what each repeats, what they wait for, and the
    memory bandwidth that they share. Above 1 more ranks are slower than one.
    """
    if not speed_up > 0:
        return inf if speed_up == 0 else nan
    return (1.0 / speed_up - 1.0 / ranks) / (1.0 - 1.0 / ranks)


def amdahl(serial: float, ranks: float) -> float:
    """Speed-up where that part of the time is not shared (Amdahl 1967)."""
    return 1.0 / (serial + (1.0 - serial) / ranks)
