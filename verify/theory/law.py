"""Traction laws of a bond that opens, for checks and beam; independent of those of the solvers on purpose.

For a law of a solver that is missing here, the checks take a plain `Law`: they use the properties that all laws have,
and leave the rest out. A `KnownLaw` answers for jumps (g, s) as well, as a `verify.theory.mixed_law.MixedBond` whose
slip is 0.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from verify.theory.shapes import KNOWN_SHAPES, Keys, Shape


@dataclass(frozen=True)
class Law:
    """The common properties of all mode I laws: linear up to the strength, a toughness, a penalty on closing.

    Parameters
    ----------
    strength : largest traction, p_max (stress)
    toughness : area under the envelope, G_Ic (energy per area)
    ductility : 2 G_Ic / (p_max g_max), > 1
    penalty : stiffness against closing (stress per length)
    contact : if False, the secant of the opening side continues into closing
    irreversible : if False, damage is that of the present opening
    """

    strength: float
    toughness: float
    ductility: float
    penalty: float
    contact: bool = True
    irreversible: bool = True

    @property
    def g_open(self) -> float:
        """Scale of openings, 2 G_Ic / p_max; for a known law the opening g_u from which the traction is zero."""
        return 2.0 * self.toughness / self.strength

    @property
    def g_peak(self) -> float:
        """Opening g_max at which damage begins."""
        return 2.0 * self.toughness / self.strength / self.ductility

    @property
    def stiffness(self) -> float:
        """Initial slope K0."""
        return self.strength / self.g_peak

    def area(self, gap: ArrayLike) -> np.ndarray:
        """Integral of the envelope from 0 to ``gap``, NaN beyond g_max; for gaps < 0 the energy of contact."""
        gap = np.asarray(gap, dtype=float)
        return np.where(gap <= self.g_peak, self._elastic(gap), np.nan)

    def _elastic(self, gap: np.ndarray) -> np.ndarray:
        """Energy of the intact bond, and of contact."""
        below_zero = self.penalty if self.contact else self.stiffness
        return 0.5 * np.where(gap < 0.0, below_zero, self.stiffness) * gap**2


@dataclass(frozen=True)
class KnownLaw(Law, ABC):
    """A law whose damage and area are known at every opening: unloading along the secant to the origin."""

    slides = False
    friction = 0.0
    steepness = 1.0

    @abstractmethod
    def damage(self, history: ArrayLike) -> np.ndarray:
        """Damage d at points with the largest opening ``history`` so far: 0 intact, 1 open."""

    @abstractmethod
    def _opened(self, gap: np.ndarray) -> np.ndarray:
        """Integral of the envelope up to gaps >= 0."""

    def area(self, gap: ArrayLike) -> np.ndarray:
        """Integral of the envelope from 0 to ``gap``; for gaps < 0 the energy of contact (or of the secant)."""
        gap = np.asarray(gap, dtype=float)
        return np.where(gap < 0.0, self._elastic(gap), self._opened(np.maximum(gap, 0.0)))

    def secant(self, history: ArrayLike) -> np.ndarray:
        """Stiffness (1 - d) K0 of unloading and reloading."""
        return (1.0 - self.damage(history)) * self.stiffness

    def traction(self, gap: ArrayLike, history: ArrayLike | None = None) -> np.ndarray:
        """Traction at ``gap``; without ``history`` on the envelope, where ``gap`` is the largest so far."""
        gap = np.asarray(gap, dtype=float)
        largest = np.maximum(gap, 0.0 if history is None else history)
        return np.where((gap < 0.0) & self.contact, self.penalty, self.secant(largest)) * gap

    def dissipated(self, history: ArrayLike) -> np.ndarray:
        """Dissipated energy per area: the area up to ``history`` minus the energy that unloading recovers."""
        k = np.maximum(history, 0.0)
        return self.area(k) - 0.5 * self.secant(k) * k * k

    @property
    def slopes(self) -> tuple[float, float]:
        """Initial stiffness on opening and on sliding."""
        return self.stiffness, 0.0

    @property
    def scale(self) -> np.ndarray:
        """A jump of the size at which damage begins."""
        return np.array([self.strength / self.stiffness])

    def driving(self, g: ArrayLike, s: ArrayLike) -> np.ndarray:
        """Damage that jumps ask for on their own."""
        return self.damage(np.maximum(g, 0.0))

    def progress(self, g: ArrayLike, s: ArrayLike) -> np.ndarray:
        """How far a jump is on its own: 1 where damage begins, 2 where the bond fails, beyond at the same rate."""
        g = np.maximum(g, 0.0)
        beyond = 1.0 + (g - self.g_peak) / (self.g_open - self.g_peak)
        return np.where(g <= self.g_peak, g / self.g_peak, beyond)

    def critical(self, B: float) -> float:
        """Toughness, in whatever mode."""
        return self.toughness


@dataclass(frozen=True)
class Softened(KnownLaw, Keys):
    """Linear up to the onset, from there on one of the shapes; along a line ``ductility`` is g_u / g_max.

    Strength, toughness and ductility of a table are its own, whatever is given: its largest traction, its area, and
    2 G_Ic / (p_max g_max) with its first opening, at which damage begins.

    Source: Alfano and Crisfield (2001), Int. J. Numer. Methods Eng. 50, eqs. 1-5, bilinear in mode I.

    Raises
    ------
    Refusal : a key of the shape that is out of its range
    """

    row: ClassVar[str] = "bilinear"

    def __post_init__(self) -> None:
        area = self.shape.area
        if self.row == "tabular":
            (first, traction), strength = self.table[0], max(p for _, p in self.table)
            toughness = float(traction * (0.5 * first + (self.table[-1][0] - first) * area))
            numbers = {"strength": strength, "toughness": toughness, "ductility": 2.0 * toughness / (strength * first)}
            for name, value in numbers.items():
                object.__setattr__(self, name, value)

    @cached_property
    def shape(self) -> Shape:
        return KNOWN_SHAPES[self.row](self)

    @property
    def steepness(self) -> float:  # type: ignore[override]
        return self.shape.steepness

    @property
    def onset(self) -> float:
        """Traction at which damage begins."""
        return self.table[0][1] if self.row == "tabular" else self.strength

    @property
    def stiffness(self) -> float:
        """Initial slope K0."""
        return self.onset / self.g_peak

    @property
    def way(self) -> float:
        """Opening from onset to failure."""
        return (self.toughness / self.onset - 0.5 * self.g_peak) / self.shape.area

    @property
    def g_open(self) -> float:
        """Opening g_u of the last corner."""
        return self.g_peak + self.way

    def damage(self, history: ArrayLike) -> np.ndarray:
        k = np.maximum(history, self.g_peak)
        left = self.shape.left(1.0 - (k - self.g_peak) / self.way)
        return np.maximum(1.0 - left * self.g_peak / k, 0.0)

    def _opened(self, gap: np.ndarray) -> np.ndarray:
        beyond = self.onset * self.way * self.shape.spent((gap - self.g_peak) / self.way)
        return self._elastic(np.minimum(gap, self.g_peak)) + beyond


@dataclass(frozen=True)
class Exponential(KnownLaw):
    """p = e p_max (g / g0) exp(-g / g0) with g0 = G_Ic / (e p_max) (Salehani and Irani 2018, in mode I).

    Its damage begins at once and never ends. To have an elastic branch and an end, it begins at ``begins`` g0, up to
    which p follows the chord, and p is zero from ``ends`` g0 on. What the area lacks then, 2e-10 of G_Ic, is lost
    there. ``ductility`` is not used.
    """

    begins: float = 1e-3
    ends: float = 40.0

    @property
    def g_0(self) -> float:
        """Opening g0 at the strength."""
        return self.toughness / (np.e * self.strength)

    @property
    def g_peak(self) -> float:
        """Opening at which damage begins, not that at the strength."""
        return self.begins * self.g_0

    @property
    def g_open(self) -> float:
        """Opening from which the traction is zero."""
        return self.ends * self.g_0

    @property
    def stiffness(self) -> float:
        """Slope K0 of the chord."""
        return np.e * self.strength / self.g_0 * np.exp(-self.begins)

    def damage(self, history: ArrayLike) -> np.ndarray:
        x = np.maximum(history, self.g_peak) / self.g_0
        return np.where(x < self.ends, -np.expm1(self.begins - x), 1.0)

    def _opened(self, gap: np.ndarray) -> np.ndarray:
        first, last = self.begins, np.clip(gap / self.g_0, self.begins, self.ends)
        beyond = self.toughness * ((1.0 + first) * np.exp(-first) - (1.0 + last) * np.exp(-last))
        opened = self._elastic(np.minimum(gap, self.g_peak)) + beyond
        return np.where(gap < self.g_open, opened, self.toughness)


#: Name in a scene -> law; the checks take a plain `Law` for any other name.
KNOWN_LAWS: dict[str, type[Law]] = {
    **{row: type("Softened", (Softened,), {"row": row, "__module__": __name__}) for row in KNOWN_SHAPES},
    "exponential": Exponential,
}
