"""The traction laws: damage on first loading, and the scaled jump that measures its progress.

A law is a class in `LAWS`, whose names are those of ``interface.law`` in a scene: one of each shape of
`iga.laws.shapes`, and others. `iga.laws.law.Law` has what all of them share: secant, contact, friction, viscosity and
energies.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from iga.laws.law import Driving, Law, Scaled
from iga.laws.shapes import Softening, shaped

#: Least distance from onset to failure, relative to the onset: pressure may raise the onset to failure.
BRITTLE = 1e-14
#: Exponent of the exponential law from which a point of a bond that slides counts as failed; exp(-8) = 3e-4 of its
#: stiffness is left.
EXPONENTS_GONE = 8.0
#: Exponents up to which the exponential law in opening is linear, and from which it is zero.
CHORD, OVER = 1e-3, 40.0
#: Least value of 1 - d where damage d is converted to a jump.
TINY_PART = 1e-15
#: Smallest squared jump by which is divided; a smaller jump has mode ratio 0.
TINY = float(np.finfo(float).tiny)


@dataclass(frozen=True)
class ShapedLaw(Law, Softening):
    """Over the energy norm ``lambda`` of the jump the traction rises up to lambda0, and falls to 0 at lambda_f with a
    shape (along a line: Camanho and Davila 2002; Turon et al. 2006; in opening alone Dimitri, De Lorenzis, Zavarise
    2013, sec. 2).

    ``lambda0`` and the area G_c follow from the mode ratio (see `iga.laws.mode_ratio`). A ``table`` says the numbers of
    a bond that opens alone; given ones are ignored.
    """

    def __post_init__(self) -> None:
        shape = self.shape  # refuses a key out of its range
        if self.row == "tabular" and not self.slides:
            (g, p), (last, _) = self.table[0], self.table[-1]
            modes = replace(
                self.modes, toughness=(g * 0.5 * p + p * (last - g) * shape.area,), strength=(p,), stiffness=(p / g,)
            )
            object.__setattr__(self, "modes", modes)

    @property
    def pure_modes(self) -> tuple[tuple[float, float], ...]:
        """The traction of a table may rise beyond the onset."""
        top = max(f for _, f in self.shape.corners)
        return tuple((top * strength, toughness) for strength, toughness in super().pure_modes)

    @cached_property
    def twice(self) -> float:
        """Twice the area of the shape, 1 along a line."""
        return 2.0 * self.shape.area

    @cached_property
    def slender(self) -> float:
        """``lambda_f / lambda0 - 1``: geometric mean of the pure modes, each at least `BRITTLE`."""
        (m, _), (G, _) = self.modes.at(np.linspace(0.0, 1.0, len(self.modes.strength)))
        return float(np.prod(np.maximum((2.0 * G / m - 1.0) / self.twice, BRITTLE)) ** (1.0 / m.size))

    @cached_property
    def kinks(self) -> tuple[float, ...]:
        """In opening alone the openings of all corners; else ``lambda / lambda0`` of `slender` at the ends."""
        if self.slides:
            return 1.0, 1.0 + self.slender
        onset = self.modes.strength[0] / self.modes.stiffness[0]
        return tuple(onset * (1.0 + x * self.slender) for x, _ in self.shape.corners)

    def fading(self, k: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        x, soft = np.maximum(k / self.kinks[0], 1.0), (k > self.kinks[0]) & (k < self.kinks[-1])
        height, slope = self.shape.at(1.0 - (x - 1.0) / self.slender)
        left = height / x
        return left, np.where(soft, -(left + slope / self.slender) / (x * self.kinks[0]), 0.0)

    def work(self, k: np.ndarray) -> np.ndarray:
        (p,), (first, *_, last) = self.modes.strength, self.kinks
        way = last - first
        rising = 0.5 * p / first * np.minimum(k, first) ** 2
        return rising + p * way * (self.shape.area - self.shape.rest(1.0 - (k - first) / way))

    def progress(self, g: np.ndarray, s: np.ndarray, d: np.ndarray) -> Scaled:
        """``lambda / lambda0`` up to the onset, then the value at which a law with the mean ``lambda_f / lambda0`` of
        the pure modes has the damage of this jump (`reached`): it rises with damage, however the mode ratio changes."""
        (K, Ks), g = self.stiffness, np.maximum(g, 0.0)
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
class ExponentialLaw(Law):
    """``p = e p_max x exp(-x - y^2)``, ``t = sqrt(2 e) t_max y exp(-x - y^2)`` (Salehani and Irani 2018).

    The lengths in ``x = g / g0`` and ``y = s / s0`` follow from strength and toughness in pure modes, ``g0 = G_I / (e
    p_max)``, ``s0 = sqrt(2) G_II / (sqrt(e) t_max)``; they determine the stiffnesses, whatever those of `modes`. Damage
    is ``1 - exp(-x - y^2)``; it begins at once and never ends. The toughness in mixed modes follows from the coupling
    in the formula.

    A path needs an onset and a failure. Where the bond slides a point counts as failed where the exponent is
    `EXPONENTS_GONE`. In opening alone the law is linear up to the exponent `CHORD`, with a secant softer by that part,
    and the traction is zero from `OVER` on, where 5e-16 of the strength is left.
    """

    def __post_init__(self) -> None:
        if self.pressure_strength or self.rubs != "damage":
            raise ValueError('the exponential law has no pressure_strength, and what rubs of it is the "damage"')

    @cached_property
    def stiffness(self) -> tuple[float, ...]:
        """``e p_max / g0`` and ``sqrt(2 e) t_max / s0``; in opening alone that of the chord."""
        modes = self.modes
        own = tuple(c * p**2 / G for c, p, G in zip((np.e**2, np.e), modes.strength, modes.toughness, strict=False))
        return own if self.slides else (own[0] * float(np.exp(-CHORD)),)

    @cached_property
    def lengths(self) -> tuple[float, ...]:
        """g0 and, where the bond slides, s0."""
        sizes = zip((1.0 / np.e, (2.0 / np.e) ** 0.5), self.modes.toughness, self.modes.strength, strict=False)
        return tuple(c * G / p for c, G, p in sizes)

    @property
    def failed(self) -> float:
        return -float(np.expm1(-EXPONENTS_GONE)) if self.slides else super().failed

    @cached_property
    def kinks(self) -> tuple[float, ...]:
        """The law of a bond that slides has no kinks: in their place stand the exponent at the shear strength (as
        onset) and `failed`."""
        return (1.0 + 0.5 / EXPONENTS_GONE, 2.0) if self.slides else (CHORD * self.lengths[0], OVER * self.lengths[0])

    def fading(self, k: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        x = k / self.lengths[0]
        left = np.where(x < OVER, np.exp(-np.maximum(x - CHORD, 0.0)), 0.0)
        return left, np.where(x > CHORD, -left / self.lengths[0], 0.0)

    def work(self, k: np.ndarray) -> np.ndarray:
        """From failure on the toughness, with the small rest that is cut off."""
        x, rising = np.maximum(k / self.lengths[0], CHORD), np.minimum(k, self.kinks[0])
        beyond = (1.0 + CHORD) * np.exp(-CHORD) - (1.0 + x) * np.exp(-x)
        toughness = self.modes.toughness[0]
        return np.where(k < self.kinks[-1], 0.5 * self.stiffness[0] * rising**2 + toughness * beyond, toughness)

    def progress(self, g: np.ndarray, s: np.ndarray, d: np.ndarray) -> Scaled:
        """``1 + (x + y^2) / EXPONENTS_GONE``, which is 2 at `failed`."""
        (g0, s0), g = self.lengths, np.maximum(g, 0.0)
        y, size = s / s0, 1.0 / EXPONENTS_GONE
        back = -np.log1p(-np.minimum(d, 1.0 - TINY_PART)) * size
        return Scaled(
            x=1.0 + size * (g / g0 + y * y),
            by_g=np.where(g > 0.0, size / g0, 0.0),
            by_s=2.0 * size / s0 * y,
            back=np.where(d > 0.0, 1.0 + back, 0.0),
        )

    def driving(self, g: np.ndarray, s: np.ndarray, stronger: np.ndarray | None) -> Driving:
        g0, s0 = self.lengths
        y = s / s0
        left = np.exp(-g / g0 - y * y)
        return Driving(1.0 - left, left / g0, left * (2.0 / s0) * y)


#: Name in a scene -> law.
LAWS: dict[str, type[Law]] = {**shaped(ShapedLaw), "exponential": ExponentialLaw}
#: The same of bonds that open alone, from strength, toughness, ductility and penalty (see `Law.opening`).
OPENING_LAWS: dict[str, Callable[..., Law]] = {name: law.opening for name, law in LAWS.items()}
