"""Traction laws in mode I with damage and contact, for all points of an interface at once.

A law is a class in `LAWS`, whose names are those of ``interface.law`` in a scene: one of each shape of
`iga.laws.shapes`, and others. What all laws share is `iga.laws.traction_law.TractionLaw`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from iga.laws.shapes import Lines, Softening, shaped
from iga.laws.traction_law import TractionLaw


@dataclass(frozen=True)
class SofteningLaw(TractionLaw, Softening):
    """Linear up to the onset, from there on with a `shape` (Dimitri, De Lorenzis, Zavarise 2013, sec. 2: bilinear).

    A ``table`` says strength (its largest traction), toughness and ductility; given values are ignored.
    """

    def __post_init__(self) -> None:
        if self.row == "tabular":
            area, (first, onset) = self.shape.area, self.table[0]
            toughness = onset * (0.5 * first + (self.table[-1][0] - first) * area)
            strength = max(traction for _, traction in self.table)
            numbers = {"strength": strength, "toughness": toughness, "ductility": 2.0 * toughness / (strength * first)}
            for key, value in numbers.items():
                object.__setattr__(self, key, float(value))
        assert self.shape  # refuses a key out of its range
        super().__post_init__()

    @cached_property
    def onset(self) -> float:
        """Traction at which damage begins."""
        return self.table[0][1] if self.row == "tabular" else self.strength

    @cached_property
    def g_u(self) -> float:
        """Opening from which there is no traction, with which the area is the toughness."""
        twice = 2.0 * self.shape.area
        return (2.0 * self.toughness / self.onset + (twice - 1.0) * self.g_max) / twice

    @cached_property
    def way(self) -> float:
        """Opening from onset to failure."""
        return self.g_u - self.g_max

    @cached_property
    def corners(self) -> tuple[np.ndarray, np.ndarray]:
        """Openings and tractions (n,) of zero and all corners."""
        left = [0.0, *(f * self.onset for _, f in self.shape.corners)]
        return np.array([0.0, *self.kinks]), np.array(left)

    @cached_property
    def stiffness(self) -> float:
        """Initial slope."""
        return self.onset / self.g_max

    @cached_property
    def kinks(self) -> tuple[float, ...]:
        """Openings of the corners."""
        inner = [self.g_max + x * self.way for x, _ in self.shape.corners[1:-1]]
        return (self.g_max, *inner, self.g_u)

    def left(self, k: np.ndarray) -> np.ndarray:
        """Part of the way that is left."""
        return 1.0 - (k - self.g_max) / self.way

    def envelope(self, k: np.ndarray) -> np.ndarray:
        """Traction on first loading to the opening k >= 0."""
        if isinstance(self.shape, Lines):
            return np.interp(k, *self.corners)
        return np.where(k < self.g_max, self.stiffness * k, self.onset * self.shape.at(self.left(k))[0])

    def softening(self, k: np.ndarray) -> np.ndarray:
        """Slope of the envelope."""
        return -self.onset / self.way * np.asarray(self.shape.at(self.left(k))[1])

    def work(self, k: np.ndarray) -> np.ndarray:
        """Integral of the envelope from 0 to k >= 0."""
        rising = 0.5 * self.stiffness * np.minimum(k, self.g_max) ** 2
        return rising + self.onset * self.way * (self.shape.area - self.shape.rest(self.left(k)))


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
LAWS: dict[str, type[TractionLaw]] = {**shaped(SofteningLaw), "exponential": ExponentialLaw}
