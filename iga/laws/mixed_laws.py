"""The traction laws for opening and sliding: damage on first loading, and the scaled jump that measures its progress.

A law is a class in `MIXED_LAWS`, whose names are those of ``interface.law`` in a scene: one of each shape of
`iga.laws.shapes`, and others. `MixedLaw` has what all of them
share: secant, contact, friction, viscosity and energies.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from iga.laws.law import Scaled
from iga.laws.mixed_law import Driving, MixedLaw
from iga.laws.shapes import Softening, shaped

#: Least distance from onset to failure, relative to the onset: pressure may raise the onset to failure.
BRITTLE = 1e-14
#: Exponent of the exponential law from which a point counts as failed; exp(-8) = 3e-4 of its stiffness is left.
EXPONENTS_GONE = 8.0
#: Least value of 1 - d where damage d is converted to a jump.
TINY_PART = 1e-15
#: Smallest squared jump by which is divided; a smaller jump has mode ratio 0.
TINY = float(np.finfo(float).tiny)


@dataclass(frozen=True)
class SofteningMixed(MixedLaw, Softening):
    """Over the energy norm ``lambda`` of the jump the traction rises up to lambda0, and falls to 0 at lambda_f with a
    shape (along a line: Camanho and Davila 2002; Turon et al. 2006).

    ``lambda0`` and the area G_c follow from the mode ratio (see `iga.laws.mode_ratio`).
    """

    def __post_init__(self) -> None:
        assert self.shape  # refuses a key out of its range

    @cached_property
    def twice(self) -> float:
        """Twice the area of the shape, 1 along a line."""
        return 2.0 * self.shape.area

    def scaled(self, *jump_and_history: np.ndarray) -> Scaled:
        """``lambda / lambda0`` up to the onset, then the value at which a law with the mean ``lambda_f / lambda0`` of
        the pure modes has the damage of this jump (`reached`): it rises with damage, however the mode ratio changes."""
        (K, Ks), (g, s, d) = self.stiffness, jump_and_history
        g = np.maximum(g, 0.0)
        driven = self.driving(g, s, None)
        opening, sliding = K * g * g, Ks * s * s
        moved = opening + sliding > TINY**0.5
        square = np.where(moved, opening + sliding, 1.0)
        B, size = np.where(moved, sliding / square, 0.0), np.where(moved, np.sqrt(square), 0.0)
        (m, dm), (G, dG) = self.modes.at(B)
        onset, gone = np.sqrt(m), driven.d >= 1.0
        last = (2.0 * G - m) / (self.twice * onset)  # from lambda0 to lambda_f
        d_onset = 0.5 * dm / onset
        d_last = (2.0 * dG - dm) / (self.twice * onset) - last * d_onset / onset
        by_size = np.where(gone, self.slender / last, 1.0 / onset)
        by_B = np.where(gone, -(d_onset + (size - onset) / last * d_last) * by_size, -size * d_onset / m)
        along, across = by_size / square**0.5, 2.0 * by_B / square / square
        x = np.where(gone, 1.0 + (size - onset) / last * self.slender, size / onset)
        by_g, by_s = K * g * (along - across * sliding), Ks * s * (along + across * opening)
        soft, (reached, slope) = (driven.d > 0.0) & ~gone, self.reached(driven.d)
        x, by_g = np.where(soft, reached, x), np.where(soft, slope * driven.by_g, by_g)
        back = np.where(d > 0.0, self.reached(d)[0], np.minimum(x, 1.0))
        back = np.where(d < 1.0, back, np.maximum(x, self.kinks[-1]))
        return Scaled(x, by_g, np.where(soft, slope * driven.by_s, by_s), back)

    @property
    def kinks(self) -> tuple[float, ...]:
        return 1.0, 1.0 + self.slender

    @cached_property
    def slender(self) -> float:
        """``lambda_f / lambda0 - 1``: geometric mean of pure opening and pure sliding, each at least `BRITTLE`."""
        (m, _), (G, _) = self.modes.at(np.array([0.0, 1.0]))
        return float(np.prod(np.maximum((2.0 * G / m - 1.0) / self.twice, BRITTLE)) ** 0.5)

    def reached(self, d: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """``lambda / lambda0`` (n,) at which damage is d (n,), and its slope, for the mean lambda_f / lambda0."""
        return self.shape.reached(1.0 - d, self.slender)

    def driving(self, g: np.ndarray, s: np.ndarray, stronger: np.ndarray | None) -> Driving:
        (K, Ks), twice = self.stiffness, self.twice
        Kg, Kss = K * g, Ks * s
        opening, sliding = Kg * g, Kss * s
        square = np.maximum(opening + sliding, TINY)
        B, size = sliding / square, np.sqrt(square)
        (m, dm), (G, dG) = self.modes.at(B)
        if stronger is not None:
            stronger = np.minimum(stronger, np.sqrt(2.0 * G / m))
            m, dm = m * stronger**2, dm * stronger**2
        onset = np.sqrt(m)
        way = np.maximum((2.0 * G - m) / (twice * onset), BRITTLE * onset)  # from lambda0 to lambda_f
        d_onset = 0.5 * dm / onset
        d_way = (2.0 * dG - dm) / (twice * onset) - way * d_onset / onset
        height, slope = self.shape.at((onset + way - size) / way)
        ratio = np.minimum(onset / size, 1.0)  # not used below the onset, where it may overflow
        d = np.where(size > onset, 1.0 - ratio * height, 0.0)
        loads = (size > onset) & (height > 0.0)
        steep = ratio * slope / way  # derivative of height by the numerator of what is left
        by_size = np.where(loads, ratio * height / size + steep, 0.0)
        by_onset = height * ratio / onset + steep
        by_way = steep * (size - onset) / way
        by_B = np.where(loads, -by_onset * d_onset - by_way * d_way, 0.0)
        # d lambda / dg = K g / lambda, dB / dg = -2 sliding K g / lambda^4; alike for the slip
        along, across = by_size / size, 2.0 * by_B / square / square  # square**2 may underflow
        by_g, by_s = Kg * (along - across * sliding), Kss * (along + across * opening)
        if stronger is None:
            return Driving(d, by_g, by_s)
        shorter = way + 2.0 * m / (twice * onset)
        rises = loads & (way > BRITTLE * onset)
        return Driving(d, by_g, by_s, np.where(rises, (by_way * shorter - by_onset * onset) / stronger, 0.0))


@dataclass(frozen=True)
class ExponentialMixed(MixedLaw):
    """``p = e p_max x exp(-x - y^2)``, ``t = sqrt(2 e) t_max y exp(-x - y^2)`` (Salehani and Irani 2018).

    The lengths in ``x = g / g0`` and ``y = s / s0`` follow from strength and toughness in pure modes, ``g0 = G_I / (e
    p_max)``, ``s0 = sqrt(2) G_II / (sqrt(e) t_max)``. They determine the stiffnesses, and `modes` must have these
    (`stiffnesses`). Damage is ``1 - exp(-x - y^2)``; it begins at once and never ends: a point counts as failed where
    the exponent is `EXPONENTS_GONE`. The toughness in mixed modes follows from the coupling in the formula.
    """

    @property
    def failed(self) -> float:
        return -float(np.expm1(-EXPONENTS_GONE))

    @property
    def kinks(self) -> tuple[float, ...]:
        """The law has no kinks: in their place stand the exponent at the shear strength (as onset) and `failed`."""
        return 1.0 + 0.5 / EXPONENTS_GONE, 2.0

    def __post_init__(self) -> None:
        if self.pressure_strength or self.rubs != "damage":
            raise ValueError('the exponential law has no pressure_strength, and what rubs of it is the "damage"')

    @staticmethod
    def stiffnesses(toughness: tuple[float, float], strength: tuple[float, float]) -> tuple[float, float]:
        """Initial stiffness in opening and sliding, ``e p_max / g0`` and ``sqrt(2 e) t_max / s0``."""
        (first, second), (p, t) = toughness, strength
        return (np.e * p) ** 2 / first, np.e * t**2 / second

    def scaled(self, *jump_and_history: np.ndarray) -> Scaled:
        """``1 + (x + y^2) / EXPONENTS_GONE``, which is 2 at `failed`."""
        (g0, s0), (g, s, d) = self.lengths, jump_and_history
        g = np.maximum(g, 0.0)
        y, size = s / s0, 1.0 / EXPONENTS_GONE
        back = -np.log1p(-np.minimum(d, 1.0 - TINY_PART)) * size
        return Scaled(
            x=1.0 + size * (g / g0 + y * y),
            by_g=np.where(g > 0.0, size / g0, 0.0),
            by_s=2.0 * size / s0 * y,
            back=np.where(d > 0.0, 1.0 + back, 0.0),
        )

    @cached_property
    def lengths(self) -> tuple[float, float]:
        """g0 and s0."""
        (first, second), (p, t) = self.modes.toughness, self.modes.strength
        return first / (np.e * p), (2.0 / np.e) ** 0.5 * second / t

    def driving(self, g: np.ndarray, s: np.ndarray, stronger: np.ndarray | None) -> Driving:
        g0, s0 = self.lengths
        y = s / s0
        left = np.exp(-g / g0 - y * y)
        return Driving(1.0 - left, left / g0, left * (2.0 / s0) * y)


#: Name in a scene -> law.
MIXED_LAWS: dict[str, type[MixedLaw]] = {**shaped(SofteningMixed), "exponential": ExponentialMixed}
