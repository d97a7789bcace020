"""Laws that no scene has, by which a law is judged, with the numbers of the bond of a scene."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from verify.theory.mixed_law import KNOWN_MIXED_LAWS, MixedBond
from verify.theory.mixed_path import Path, accumulated


@dataclass(frozen=True)
class EffectiveOpening(MixedBond):
    """One effective opening ``delta^2 = g+^2 + beta^2 s^2`` with ``beta = t_max / p_max`` (Ortiz and Pandolfi 1999).

    ``p = e p_max g / delta_c exp(-delta / delta_c)``, ``t`` alike with ``beta^2 s``, ``delta_c = G_I / (e p_max)``;
    unloading to the origin. The toughness is G_I in every mode, and that of sliding is not used.
    """

    @property
    def slopes(self) -> tuple[float, float]:
        K = (np.e * self.strength[0]) ** 2 / self.toughness[0]
        return K, K * (self.strength[1] / self.strength[0]) ** 2

    def critical(self, B: ArrayLike) -> np.ndarray:
        return np.full_like(B, self.toughness[0], dtype=float)

    by_criterion = critical

    def driving(self, g: ArrayLike, s: ArrayLike) -> np.ndarray:
        return -np.expm1(-self.energy_norm(g, s) / self.toughness[0] ** 0.5)


@dataclass(frozen=True)
class OfAPotential(MixedBond):
    """Tractions of a potential. Each unloads along what is ``left`` of its own stiffness, the least so far; there is
    neither friction nor viscosity."""

    @abstractmethod
    def left(self, g: np.ndarray, s: np.ndarray) -> np.ndarray:
        """Parts (2, ...) of the stiffness of opening and of sliding that loading to a jump (...) leaves."""

    def path(self, g: ArrayLike, s: ArrayLike, time: ArrayLike | None = None) -> Path:
        g, s, (K, Ks) = np.asarray(g, dtype=float), np.asarray(s, dtype=float), self.slopes
        opens, slides = np.minimum.accumulate(self.left(np.maximum(g, 0.0), s), axis=1)
        closed, none = (g < 0.0) & self.contact, np.zeros_like(g)
        whole = 0.5 * K * np.where(closed, 0.0, g) ** 2, 0.5 * Ks * s**2
        return Path(
            p=np.where(closed, self.penalty, opens * K) * g,
            t=slides * Ks * s,
            d=1.0 - slides,
            slip=none,
            stored=opens * whole[0] + slides * whole[1],
            contact=np.where(closed, 0.5 * self.penalty * g**2, 0.0),
            friction_stored=none,
            released=accumulated(whole[0], 1.0 - opens) + accumulated(whole[1], 1.0 - slides),
            rubbed=none,
        )


@dataclass(frozen=True)
class XuNeedleman(OfAPotential):
    """Xu and Needleman (1993, 1994) with r = 0, ``x = g+ / delta_n``, ``y = s / delta_t``, ``q = G_II / G_I``:

        phi = G_I - G_I (1 + x) exp(-x) [1 - q + q exp(-y^2)],
        delta_n = G_I / (e p_max), delta_t = (2/e)^(1/2) G_II / t_max

    Known defects (van den Bosch, Schreurs, Geers 2006, Eng. Fract. Mech. 73): where q is not 1, faces that have slid
    apart still resist opening with the part 1 - q, and push for q > 1, which is refused; any opening leads to G_I.
    """

    def critical(self, B: ArrayLike) -> np.ndarray:
        return np.where(np.asarray(B, dtype=float) < 1.0, *self.toughness)

    by_criterion = critical

    def left(self, g: np.ndarray, s: np.ndarray) -> np.ndarray:
        x, q = g * np.e * self.strength[0] / self.toughness[0], self.toughness[1] / self.toughness[0]
        slid = np.exp(-((s * self.strength[1] / self.toughness[1]) ** 2) * np.e / 2.0)
        return np.exp(-x) * np.array([1.0 - q + q * slid, (1.0 + x) * slid])


#: Name of a definition -> class, and the law of a bond that it is like: where damage begins and ends.
DEFINITIONS: dict[str, tuple[type[MixedBond], str]] = {
    **{name: (MixedBond, name) for name in KNOWN_MIXED_LAWS},
    "ortiz-pandolfi": (EffectiveOpening, "exponential"),
    "xu-needleman": (XuNeedleman, "exponential"),
}
