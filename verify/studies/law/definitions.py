"""Laws that no scene has, by which a law is judged, with the numbers of the bond of a scene."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from verify.theory.mixed_law import KNOWN_MIXED_LAWS, MixedBond


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


#: Name of a definition -> class, and the law of a bond that it is like: where damage begins and ends.
DEFINITIONS: dict[str, tuple[type[MixedBond], str]] = {
    **{name: (MixedBond, name) for name in KNOWN_MIXED_LAWS},
    "ortiz-pandolfi": (EffectiveOpening, "exponential"),
}
