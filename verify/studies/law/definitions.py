"""Laws that no scene has, by which a law is judged, with the numbers of the bond of a scene."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass, fields
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from verify.support.refusal import Refusal
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

    @property
    def of_criterion(self) -> bool:
        return False

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


#: Exponents alpha = beta of the potential below.
PPR_SHAPE = 3.0


@dataclass(frozen=True)
class ParkPaulinoRoesler(OfAPotential):
    """Park, Paulino, Roesler (2009), J. Mech. Phys. Solids 57, 891-908, with alpha = beta = 3. With G_I <= G_II

        phi = G_I + F(g+ / delta_n, m) [G_II - G_I - G_II F(|s| / delta_t, n)],
        F(x, m) = (1 - x)^alpha (1 + alpha x / m)^m

    up to where a traction is zero, and with the modes exchanged otherwise. The opening lambda delta at the strength,
    ``m = alpha (alpha - 1) lambda^2 / (1 - alpha lambda^2)`` and delta follow from strength, toughness and stiffness.
    """

    def __post_init__(self) -> None:
        super().__post_init__()
        assert self.modes.size  # raises a refusal of its own

    @cached_property
    def modes(self) -> np.ndarray:
        """Exponent m, length delta and lambda (3, 2) of both modes."""
        numbers = zip(("", "shear_"), self.strength, self.toughness, self.stiffness, strict=True)
        return np.transpose([_mode(*one) for one in numbers])

    def critical(self, B: ArrayLike) -> np.ndarray:
        B = np.asarray(B, dtype=float)
        size = self.corners(B)[-1][..., None] * np.linspace(0.0, 1.0, 4001)
        g, s = (np.sqrt(part / k)[..., None] * size for part, k in zip((1.0 - B, B), self.stiffness, strict=True))
        opens, slides = self.left(g, s)
        return np.trapezoid(size * ((1.0 - B[..., None]) * opens + B[..., None] * slides), size, axis=-1)

    by_criterion = critical

    def corners(self, B: ArrayLike, pressure: ArrayLike = 0.0) -> tuple[np.ndarray, ...]:
        B, (_, delta, peak) = np.asarray(B, dtype=float), self.modes
        with np.errstate(divide="ignore"):
            ends = [d * np.sqrt(k / part) for d, k, part in zip(delta, self.stiffness, (1.0 - B, B), strict=True)]
        return np.minimum(peak[0] * ends[0], peak[1] * ends[1]), np.minimum(*ends)

    def left(self, g: np.ndarray, s: np.ndarray) -> np.ndarray:
        a, (m, delta, _) = PPR_SHAPE, self.modes
        parts, held = [], []
        for one, m_i, d in zip((g, np.abs(s)), m, delta, strict=True):
            x = np.minimum(one / d, 1.0)
            parts.append((1.0 - x) ** (a - 1.0) * (1.0 + a * x / m_i) ** (m_i - 1.0))
            held.append((1.0 - x) ** a * (1.0 + a * x / m_i) ** m_i)
        over = [max(1.0, other / own) for own, other in (self.toughness, self.toughness[::-1])]
        by_other = [np.maximum(1.0 - r * (1.0 - F), 0.0) for r, F in zip(over, held[::-1], strict=True)]
        return np.array(parts) * by_other


def _mode(which: str, strength: float, toughness: float, stiffness: float) -> tuple[float, float, float]:
    """m, delta and lambda of a mode, by the initial stiffness ``G / delta^2 alpha (1 + alpha / m)``."""
    a = PPR_SHAPE

    def of(peak: float) -> tuple[float, float, float]:
        m = a * (a - 1.0) * peak**2 / (1.0 - a * peak**2)
        rise = a * peak * (1.0 - peak) ** (a - 1.0) * (a / m + 1.0) * (1.0 + a * peak / m) ** (m - 1.0)
        return m, toughness / strength * rise, peak

    def off(peak: float) -> float:
        m, delta, _ = of(peak)
        return toughness / delta**2 * a * (1.0 + a / m) / stiffness - 1.0

    low, high = 1e-4, 0.999 / a**0.5
    if not off(low) > 0.0 > off(high):
        least, most = (stiffness * (1.0 + off(one)) for one in (high, low))
        raise Refusal(f"interface.{which}stiffness: must be > {least:g} and < {most:g} for ppr, got {stiffness:g}")
    return of(float(brentq(off, low, high, xtol=1e-14)))


#: Name of a definition -> class, and the law of a bond that it is like: where damage begins and ends.
DEFINITIONS: dict[str, tuple[type[MixedBond], str]] = {
    **{name: (MixedBond, name) for name in KNOWN_MIXED_LAWS},
    "ortiz-pandolfi": (EffectiveOpening, "exponential"),
    "xu-needleman": (XuNeedleman, "exponential"),
    "ppr": (ParkPaulinoRoesler, "bilinear"),
}


def defined(bond: MixedBond, name: str) -> MixedBond:
    """The definition ``name`` with the numbers of a bond.

    Raises
    ------
    Refusal : the definition has no place for a number of the bond.
    """
    made, law = DEFINITIONS[name]
    found = made(**{one.name: getattr(bond, one.name) for one in fields(MixedBond)} | {"law": law})
    if isinstance(found, OfAPotential) and (bond.friction or bond.viscosity):
        raise Refusal(f"--definition: {name} needs interface.friction and interface.viscosity to be left out")
    if isinstance(found, XuNeedleman) and bond.toughness[1] > bond.toughness[0]:
        rule = f"must be <= interface.toughness for {name}, or faces that have slid push each other apart"
        raise Refusal(f"interface.shear_toughness: {rule}, got {bond.toughness[1]:g}")
    return found
