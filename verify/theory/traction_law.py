"""What the traction laws of the checks have in common: stiffness and contact, and where damage is known the rest."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike


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
    """

    strength: float
    toughness: float
    ductility: float
    penalty: float
    contact: bool = True

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
        below_zero = self.penalty if self.contact else self.stiffness
        elastic = 0.5 * np.where(gap < 0.0, below_zero, self.stiffness) * gap**2
        return np.where(gap <= self.g_peak, elastic, np.nan)


@dataclass(frozen=True)
class KnownLaw(Law, ABC):
    """A law whose damage and area are known at every opening: unloading along the secant to the origin."""

    @abstractmethod
    def damage(self, history: ArrayLike) -> np.ndarray:
        """Damage d at points with the largest opening ``history`` so far: 0 intact, 1 open."""

    def secant(self, history: ArrayLike) -> np.ndarray:
        """Stiffness (1 - d) K0 of unloading and reloading."""
        return (1.0 - self.damage(history)) * self.stiffness

    def traction(self, gap: ArrayLike, history: ArrayLike | None = None) -> np.ndarray:
        """Traction at ``gap``; without ``history`` on the envelope, where ``gap`` is the largest so far."""
        gap = np.asarray(gap, dtype=float)
        largest = np.maximum(gap, 0.0 if history is None else history)
        on_opening_side = self.secant(largest) * gap
        return np.where(gap < 0.0, self.penalty * gap, on_opening_side) if self.contact else on_opening_side

    def dissipated(self, history: ArrayLike) -> np.ndarray:
        """Dissipated energy per area: the area up to ``history`` minus the energy that unloading recovers."""
        k = np.maximum(history, 0.0)
        return self.area(k) - 0.5 * self.secant(k) * k * k
