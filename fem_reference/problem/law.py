"""The bilinear traction law in mode I, for all points of the interface at once."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Law:
    """Traction against opening with damage on opening and a penalty on closing.

    p = (1 - d) K0 g with K0 = p_max / g_max, d = g_u (k - g_max) / (k (g_u - g_max)) between g_max and g_u, and k the
    largest gap so far; g < 0: p = penalty g (Alfano and Crisfield 2001, Int. J. Numer. Methods Eng. 50, 1701-1736).

    Parameters
    ----------
    strength, toughness, ductility, penalty : p_max [stress], G_Ic [energy per area], g_u / g_max, stiffness against
        closing [stress per length].
    contact : if False, (1 - d) K0 continues into closing.
    irreversible : if False, k is the present gap: nonlinear elastic.
    """

    strength: float
    toughness: float
    ductility: float
    penalty: float
    contact: bool = True
    irreversible: bool = True

    @property
    def g_open(self) -> float:
        """Opening g_u from which the traction is zero."""
        return 2.0 * self.toughness / self.strength

    @property
    def g_peak(self) -> float:
        """Opening g_max at the strength."""
        return self.g_open / self.ductility

    @property
    def K0(self) -> float:
        """Initial stiffness [stress per length]."""
        return self.strength / self.g_peak

    def history(self, g_q: np.ndarray, k_q: np.ndarray) -> np.ndarray:
        """Largest gap (n_q,) so far, the present gap included."""
        return np.maximum(g_q, k_q if self.irreversible else 0.0)

    def damage(self, k_q: np.ndarray) -> np.ndarray:
        """d (n_q,), 0 intact to 1 open."""
        k_q = np.clip(k_q, self.g_peak, self.g_open)
        return self.g_open * (k_q - self.g_peak) / (k_q * (self.g_open - self.g_peak))

    def traction(self, g_q: np.ndarray, k_q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Traction p and slope dp/dg, (n_q,) each, from the present gap and the history committed before it."""
        k_new_q = self.history(g_q, k_q)
        secant_q = (1.0 - self.damage(k_new_q)) * self.K0
        softens_q = (g_q >= k_new_q) & (g_q > self.g_peak) & (g_q < self.g_open)
        slope_q = np.where(softens_q, -self.strength / (self.g_open - self.g_peak), secant_q)
        closed_q = self._closed(g_q)
        return np.where(closed_q, self.penalty, secant_q) * g_q, np.where(closed_q, self.penalty, slope_q)

    def energies(self, g_q: np.ndarray, k_q: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Energies per area, (n_q,) each: recoverable from cohesion, stored in contact, dissipated.

        The history ``k_q`` includes the present gap ``g_q``.
        """
        secant_q = (1.0 - self.damage(k_q)) * self.K0
        recoverable_q = 0.5 * secant_q * g_q**2
        lost_q = self.area(k_q) - 0.5 * secant_q * k_q**2
        if not self.irreversible:
            recoverable_q, lost_q = recoverable_q + lost_q, np.zeros_like(g_q)
        closed_q = self._closed(g_q)
        return np.where(closed_q, 0.0, recoverable_q), np.where(closed_q, 0.5 * self.penalty * g_q**2, 0.0), lost_q

    def area(self, k_q: np.ndarray) -> np.ndarray:
        """Integral (n_q,) of the envelope from 0 to k >= 0; G_Ic from g_u on."""
        rising_q = np.minimum(k_q, self.g_peak)
        beyond_q = np.clip(k_q, self.g_peak, self.g_open) - self.g_peak
        slope = self.strength / (self.g_open - self.g_peak)
        return 0.5 * self.K0 * rising_q**2 + beyond_q * (self.strength - 0.5 * slope * beyond_q)

    def _closed(self, g_q: np.ndarray) -> np.ndarray:
        return (g_q < 0.0) & self.contact


#: Name in a scene -> law, a class with the fields, properties and methods of `Law`.
MODELLED_LAWS: dict[str, type[Law]] = {"bilinear": Law}
