"""Traction laws in mode I with damage and contact, for all points of an interface at once.

A law is a class in `LAWS`, whose names are those of ``interface.law`` in a scene: the shape of its envelope. What all
laws share is `iga.laws.traction_law.TractionLaw`.
"""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from iga.laws.traction_law import TractionLaw


@dataclass(frozen=True)
class PolylineLaw(TractionLaw):
    """An envelope of straight lines: from zero to the first of its `points`, and on to the last one."""

    @property
    @abstractmethod
    def points(self) -> np.ndarray:
        """Openings and tractions (n, 2) of the corners, rising openings, the last traction zero."""

    @cached_property
    def corners(self) -> tuple[np.ndarray, np.ndarray]:
        """Openings and tractions (n + 1,) of zero and all corners."""
        g_n, p_n = np.vstack([[0.0, 0.0], self.points]).T.copy()
        return g_n, p_n

    @cached_property
    def slopes(self) -> np.ndarray:
        """Slopes (n,) of the lines."""
        g_n, p_n = self.corners
        return np.diff(p_n) / np.diff(g_n)

    @property
    def g_u(self) -> float:
        """Opening of the last corner."""
        return float(self.corners[0][-1])

    @cached_property
    def kinks(self) -> tuple[float, ...]:
        """Openings of the corners."""
        return tuple(float(g) for g in self.corners[0][1:])

    def envelope(self, k: np.ndarray) -> np.ndarray:
        """Traction on first loading to the opening k >= 0."""
        return np.interp(k, *self.corners)

    def softening(self, k: np.ndarray) -> np.ndarray:
        """Slope of the line that begins at or before k."""
        slope_n = self.slopes
        return slope_n[np.clip(np.searchsorted(self.corners[0], k, side="right") - 1, 1, slope_n.size - 1)]

    def work(self, k: np.ndarray) -> np.ndarray:
        """Integral of the envelope from 0 to k >= 0: trapezia up to the last corner before k, and one from there."""
        g_n, p_n = self.corners
        at_n = np.concatenate([[0.0], np.cumsum(0.5 * (p_n[1:] + p_n[:-1]) * np.diff(g_n))])
        n = np.clip(np.searchsorted(g_n, k, side="right") - 1, 0, None)
        return at_n[n] + 0.5 * (p_n[n] + self.envelope(k)) * np.maximum(np.minimum(k, g_n[-1]) - g_n[n], 0.0)


@dataclass(frozen=True)
class BilinearLaw(PolylineLaw):
    """Softening along a line (Dimitri, De Lorenzis, Zavarise 2013, sec. 2); ``ductility`` is g_u / g_max."""

    @property
    def points(self) -> np.ndarray:
        """The strength, and g_u = 2 G_Ic / p_max, where the traction vanishes."""
        return np.array([[self.g_max, self.strength], [2.0 * self.toughness / self.strength, 0.0]])


@dataclass(frozen=True)
class TrapezoidalLaw(PolylineLaw):
    """The traction stays for the part ``plateau`` of the way from g_max to g_u, then falls along a line.

    Raises
    ------
    ValueError : ``plateau`` below 0, or 1 or more.
    """

    plateau: float = 0.5

    def __post_init__(self) -> None:
        super().__post_init__()
        if not 0.0 <= self.plateau < 1.0:
            raise ValueError(f"plateau must be >= 0 and < 1, got {self.plateau}")

    @cached_property
    def points(self) -> np.ndarray:
        """Both ends of the plateau and the point of failure, so that the area is the toughness."""
        way = (2.0 * self.toughness / self.strength - self.g_max) / (1.0 + self.plateau)
        ends = self.g_max, self.g_max + self.plateau * way, self.g_max + way
        corners = np.column_stack([ends, [self.strength, self.strength, 0.0]])
        return corners if self.plateau else corners[1:]


@dataclass(frozen=True)
class TabularLaw(PolylineLaw):
    """Lines through a ``table`` of openings and tractions, for instance of fibre bridging.

    Strength (the largest traction), toughness and ductility are computed from the table; given values are ignored.

    Raises
    ------
    ValueError : less than two corners, openings that do not rise from above zero, a negative traction, a first one
        that is zero, a last one that is not zero, or secants that do not fall: damage would stop or heal.
    """

    table: tuple[tuple[float, float], ...] = ()

    def __post_init__(self) -> None:
        corners = np.asarray(self.table, dtype=float)
        if corners.ndim != 2 or corners.shape[0] < 2 or corners.shape[1] != 2 or not np.all(np.isfinite(corners)):
            raise ValueError(f"table must be two or more pairs of opening and traction, got {self.table}")
        g_n, p_n = corners.T
        if not (g_n[0] > 0.0 and np.all(np.diff(g_n) > 0.0)):
            raise ValueError(f"openings of the table must rise from above zero, got {g_n.tolist()}")
        if not (p_n[0] > 0.0 and np.all(p_n >= 0.0) and p_n[-1] == 0.0):
            raise ValueError(
                f"tractions of the table must be >= 0, the first one > 0, the last one 0, got {p_n.tolist()}"
            )
        if not np.all(np.diff(p_n / g_n) < 0.0):
            raise ValueError(f"traction over opening must fall from corner to corner, got {(p_n / g_n).tolist()}")
        object.__setattr__(self, "strength", float(p_n.max()))
        object.__setattr__(self, "toughness", float(self.work(np.asarray(g_n[-1]))))
        object.__setattr__(self, "ductility", 2.0 * self.toughness / (self.strength * g_n[0]))
        super().__post_init__()

    @cached_property
    def points(self) -> np.ndarray:
        """The table."""
        return np.asarray(self.table, dtype=float)

    @cached_property
    def stiffness(self) -> float:
        """Slope of the first line."""
        return float(self.points[0, 1] / self.points[0, 0])


@dataclass(frozen=True)
class ExponentialLaw(TractionLaw):
    """``p = e p_max (g / g0) exp(-g / g0)`` with ``g0 = G_Ic / (e p_max)`` (Salehani and Irani 2018, in mode I).

    The damage of this formula begins at once and never ends, but a path needs an onset and a failure. So here the law
    is linear up to ``begins`` times g0, with a secant softer by that part, and the traction is zero from ``ends`` times
    g0 on, where 5e-16 of the strength is left. ``ductility`` is not used.
    """

    begins: float = 1e-3
    ends: float = 40.0

    @cached_property
    def g0(self) -> float:
        """Opening at the strength."""
        return self.toughness / (np.e * self.strength)

    @cached_property
    def g_max(self) -> float:
        """Opening at which damage begins."""
        return self.begins * self.g0

    @cached_property
    def g_u(self) -> float:
        """Opening from which the traction is zero."""
        return self.ends * self.g0

    @cached_property
    def stiffness(self) -> float:
        """Initial slope."""
        return float(self._falling(np.asarray(self.g_max)) / self.g_max)

    def envelope(self, k: np.ndarray) -> np.ndarray:
        """Traction on first loading to the opening k >= 0."""
        return np.where(k < self.g_max, self.stiffness * k, np.where(k < self.g_u, self._falling(k), 0.0))

    def softening(self, k: np.ndarray) -> np.ndarray:
        """Slope of the envelope."""
        x = np.maximum(k, 0.0) / self.g0
        return np.e * self.strength / self.g0 * (1.0 - x) * np.exp(-x)

    def work(self, k: np.ndarray) -> np.ndarray:
        """Integral of the envelope from 0 to k >= 0; from g_u on the toughness, with the small rest that is cut off."""
        x = k / self.g0
        linear = 0.5 * self.stiffness * np.minimum(k, self.g_max) ** 2
        beyond = self._area(np.maximum(x, self.begins)) - self._area(np.asarray(self.begins))
        return np.where(k < self.g_u, linear + beyond, self.toughness)

    def _falling(self, k: np.ndarray) -> np.ndarray:
        x = k / self.g0
        return np.e * self.strength * x * np.exp(-x)

    def _area(self, x: np.ndarray) -> np.ndarray:
        return self.toughness * (1.0 - (1.0 + x) * np.exp(-x))


#: Name in a scene -> law.
LAWS: dict[str, type[TractionLaw]] = {
    "bilinear": BilinearLaw,
    "trapezoidal": TrapezoidalLaw,
    "tabular": TabularLaw,
    "exponential": ExponentialLaw,
}
