"""The traction laws for checks and the cohesive beam, independent of those of the solvers on purpose.

For a law of a solver that is missing here, the checks take a plain `Law`: they use the properties that all laws have,
and leave the rest out.
"""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from verify.support.refusal import Refusal
from verify.theory.traction_law import KnownLaw, Law


@dataclass(frozen=True)
class Bilinear(KnownLaw):
    """Mode I bilinear law with damage on opening and a penalty on closing; ``ductility`` is g_u / g_max.

    Source: Alfano and Crisfield (2001), Int. J. Numer. Methods Eng. 50, eqs. 1-5, in mode I.
    """

    @property
    def softening(self) -> float:
        """Slope of the falling branch, negative."""
        return -self.strength / (self.g_open - self.g_peak)

    def damage(self, history: ArrayLike) -> np.ndarray:
        """Damage d at points with the largest opening ``history`` so far: 0 intact, 1 open."""
        k = np.clip(history, self.g_peak, self.g_open)
        return self.g_open * (k - self.g_peak) / (k * (self.g_open - self.g_peak))

    def area(self, gap: ArrayLike) -> np.ndarray:
        """Integral of the envelope from 0 to ``gap``; for gaps < 0 the energy of contact (or of the secant)."""
        gap = np.asarray(gap, dtype=float)
        closed = np.minimum(gap, 0.0)
        rising = np.clip(gap, 0.0, self.g_peak)
        beyond = np.clip(gap, self.g_peak, self.g_open) - self.g_peak
        below_zero = self.penalty if self.contact else self.stiffness
        return (
            0.5 * below_zero * closed**2
            + 0.5 * self.stiffness * rising**2
            + beyond * (self.strength + 0.5 * self.softening * beyond)
        )


@dataclass(frozen=True)
class Polyline(KnownLaw):
    """A law of straight lines from the origin through `corners`, where damage begins at the first."""

    @property
    @abstractmethod
    def corners(self) -> np.ndarray:
        """Openings and tractions (n, 2), the last traction zero."""

    @property
    def g_open(self) -> float:
        """Opening g_u of the last corner."""
        return float(self.corners[-1, 0])

    def damage(self, history: ArrayLike) -> np.ndarray:
        """Damage d at points with the largest opening ``history`` so far: 0 intact, 1 open."""
        k = np.maximum(history, self.g_peak)
        return np.maximum(1.0 - np.interp(k, *self.corners.T) / (self.stiffness * k), 0.0)

    def area(self, gap: ArrayLike) -> np.ndarray:
        """Integral of the envelope from 0 to ``gap``; for gaps < 0 the energy of contact (or of the secant)."""
        gap = np.asarray(gap, dtype=float)
        opening, traction = np.concatenate([[[0.0, 0.0]], self.corners]).T
        up_to = np.concatenate([[0.0], np.cumsum(0.5 * (traction[1:] + traction[:-1]) * np.diff(opening))])
        k = np.clip(gap, 0.0, opening[-1])
        i = np.searchsorted(opening, k, side="right") - 1
        last = 0.5 * (traction[i] + np.interp(k, opening, traction)) * (k - opening[i])
        below_zero = self.penalty if self.contact else self.stiffness
        return 0.5 * below_zero * np.minimum(gap, 0.0) ** 2 + up_to[i] + last


@dataclass(frozen=True)
class Trapezoidal(Polyline):
    """The traction stays at the strength for the part ``plateau`` of the way w from g_max to g_u, then falls.

    w = (2 G_Ic - p_max g_max) / ((1 + plateau) p_max), so that the area is the toughness.

    Raises
    ------
    Refusal : a plateau outside [0, 1)
    """

    plateau: float = 0.5

    def __post_init__(self) -> None:
        if not 0.0 <= self.plateau < 1.0:
            raise Refusal(f"plateau: must be in [0, 1), got {self.plateau:g}")

    @property
    def corners(self) -> np.ndarray:
        """Ends of the plateau, and where nothing is left."""
        way = (2.0 * self.toughness / self.strength - self.g_peak) / (1.0 + self.plateau)
        ends = [self.g_peak, self.g_peak + self.plateau * way] if self.plateau > 0.0 else [self.g_peak]
        return np.array([*((g, self.strength) for g in ends), (self.g_peak + way, 0.0)])


@dataclass(frozen=True)
class Tabular(Polyline):
    """Lines through a ``table`` of openings and tractions, as of fibres that bridge a crack.

    Strength, toughness and ductility are those of the table, whatever is given: its largest traction, its area, and
    2 G_Ic / (p_max g_max) with its first opening, at which damage begins.

    Raises
    ------
    Refusal : less than two pairs, openings that do not rise from above 0, a traction that is not > 0 before the last,
        which is 0, or a secant that does not fall, for damage does not heal
    """

    table: tuple[tuple[float, float], ...] = ()

    def __post_init__(self) -> None:
        _require_softening(np.array(self.table, dtype=float))
        area = float(self.area(np.inf))
        strength = float(np.max(self.corners[:, 1]))
        for name, value in (
            ("strength", strength),
            ("toughness", area),
            ("ductility", 2.0 * area / (strength * self.g_peak)),
        ):
            object.__setattr__(self, name, value)

    @property
    def g_peak(self) -> float:
        """Opening of the first corner, at which damage begins."""
        return float(self.corners[0, 0])

    @property
    def stiffness(self) -> float:
        """Slope K0 of the first line."""
        return float(self.corners[0, 1] / self.corners[0, 0])

    @property
    def corners(self) -> np.ndarray:
        """The table."""
        return np.array(self.table, dtype=float)


def _require_softening(table: np.ndarray) -> None:
    """Raise `Refusal` for a table (n, 2) that is no law."""
    if table.shape[1:] != (2,) or table.shape[0] < 2 or not np.all(np.isfinite(table)):
        raise Refusal(f"table: must be two or more pairs of opening and traction, got {table.tolist()}")
    opening, traction = table.T
    if opening[0] <= 0.0 or np.any(np.diff(opening) <= 0.0):
        raise Refusal(f"table: openings must rise from above 0, got {opening.tolist()}")
    if np.any(traction[:-1] <= 0.0) or traction[-1] != 0.0:
        raise Refusal(f"table: tractions must be > 0 and the last one 0, got {traction.tolist()}")
    secant = traction / opening
    if np.any(np.diff(secant) >= 0.0):
        raise Refusal(f"table: traction / opening must fall from pair to pair, got {secant.tolist()}")


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
        """Damage d at points with the largest opening ``history`` so far: 0 intact, 1 open."""
        x = np.maximum(history, self.g_peak) / self.g_0
        return np.where(x < self.ends, -np.expm1(self.begins - x), 1.0)

    def area(self, gap: ArrayLike) -> np.ndarray:
        """Integral of the envelope from 0 to ``gap``; for gaps < 0 the energy of contact (or of the secant)."""
        gap = np.asarray(gap, dtype=float)
        below_zero = self.penalty if self.contact else self.stiffness
        rising = np.clip(gap, 0.0, self.g_peak)
        first, last = self.begins, np.clip(gap / self.g_0, self.begins, self.ends)
        beyond = self.toughness * ((1.0 + first) * np.exp(-first) - (1.0 + last) * np.exp(-last))
        opened = np.where(gap < self.g_open, 0.5 * self.stiffness * rising**2 + beyond, self.toughness)
        return 0.5 * below_zero * np.minimum(gap, 0.0) ** 2 + opened


#: Name in a scene -> law; the checks take a plain `Law` for any other name.
KNOWN_LAWS: dict[str, type[Law]] = {
    "bilinear": Bilinear,
    "trapezoidal": Trapezoidal,
    "tabular": Tabular,
    "exponential": Exponential,
}
