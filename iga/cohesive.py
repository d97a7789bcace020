"""The bilinear cohesive law with damage and contact, for all points of an interface at once."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class BilinearLaw:
    """Mode I bilinear law (Dimitri, De Lorenzis, Zavarise 2013, sec. 2).

    ``strength`` p_max [stress], ``toughness`` G_Ic [force/length], ``ductility`` g_u/g_max > 1, ``penalty``
    [stress/length]. Without ``contact`` the secant stiffness of the opening side continues to negative gaps; without
    ``irreversible`` the damage follows the present gap down as well as up, and nothing is dissipated.
    """

    strength: float
    toughness: float
    ductility: float
    penalty: float
    contact: bool = True
    irreversible: bool = True

    @property
    def g_u(self) -> float:
        """Opening at which the traction vanishes, 2 G_Ic / p_max."""
        return 2.0 * self.toughness / self.strength

    @property
    def g_max(self) -> float:
        """Opening at the strength, g_u / ductility."""
        return self.g_u / self.ductility

    @property
    def stiffness(self) -> float:
        """Initial slope p_max / g_max."""
        return self.strength / self.g_max

    @property
    def dissipation_rate(self) -> float:
        """Energy dissipated per area and increase of the largest opening, (p - p' k) / 2, while softening."""
        return 0.5 * self.strength * self.g_u / (self.g_u - self.g_max)

    def envelope(self, k: np.ndarray) -> np.ndarray:
        """Traction on first loading to the opening k >= 0."""
        softening = self.strength * (self.g_u - k) / (self.g_u - self.g_max)
        return np.where(k <= self.g_max, self.stiffness * k, np.maximum(softening, 0.0))

    def secant(self, k: np.ndarray) -> np.ndarray:
        """Secant stiffness (1 - d) K0 after the largest opening k."""
        k = np.maximum(k, self.g_max)
        return self.envelope(k) / k

    def damage(self, k: np.ndarray) -> np.ndarray:
        """d = 1 - secant / stiffness: 0 up to g_max, 1 from g_u on."""
        return 1.0 - self.secant(k) / self.stiffness

    def traction(
        self, g: np.ndarray, k: np.ndarray, closed: np.ndarray | None = None
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Traction, consistent tangent and new history.

        Parameters
        ----------
        g : (...,) normal gap, positive when open.
        k : (...,) largest gap of all converged states so far, the history.
        closed : (...,) which points are in contact; those with a negative gap if left out.

        Returns
        -------
        p, dp_dg, k_new : (...,) each.
        """
        closed = (g < 0.0 if closed is None else closed) & self.contact
        k_new = np.maximum(k, g) if self.irreversible else np.maximum(g, 0.0)
        secant = self.secant(k_new)
        softening = (g >= k_new) & (g > self.g_max) & (g < self.g_u)
        slope = np.where(softening, -self.strength / (self.g_u - self.g_max), secant)
        return np.where(closed, self.penalty, secant) * g, np.where(closed, self.penalty, slope), k_new

    def energies(self, g: np.ndarray, k: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Energies per area: stored in cohesion, stored in contact, dissipated; k includes the present gap."""
        work = self.work(k)
        if self.irreversible:
            secant = self.secant(k)
            recoverable, dissipated = 0.5 * secant * g**2, work - 0.5 * secant * k**2
        else:
            secant = np.full_like(g, self.stiffness)
            recoverable, dissipated = np.where(g > 0.0, work, 0.5 * secant * g**2), np.zeros_like(g)
        closed = (g < 0.0) & self.contact
        return np.where(closed, 0.0, recoverable), np.where(closed, 0.5 * self.penalty * g**2, 0.0), dissipated

    def work(self, k: np.ndarray) -> np.ndarray:
        """Integral of the envelope from 0 to k >= 0; G_Ic from g_u on."""
        rising = 0.5 * self.stiffness * np.minimum(k, self.g_max) ** 2
        k = np.clip(k, self.g_max, self.g_u)
        return rising + 0.5 * (self.strength + self.envelope(k)) * (k - self.g_max)
