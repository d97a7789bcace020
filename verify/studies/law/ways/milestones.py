"""Jumps at which a law changes: onset of damage, half way to failure, failure."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from verify.studies.law.opening_bond import OpeningBond
from verify.theory.mixed_law import MixedBond

#: Exponents of exp(-x - y^2) of the exponential law: before the peak, behind it, and where 1e-12 is left.
BEFORE, BEHIND, LEFT_NOTHING = 0.5, 1.5, 27.6


@dataclass(frozen=True)
class Milestones:
    """Jumps in the energy norm lambda at one mode ratio; ``kinks`` are those at which the slope of the law jumps."""

    onset: float
    half: float
    end: float
    kinks: tuple[float, ...]


def milestones(bond: MixedBond, B: float, pressure: float = 0.0) -> Milestones:
    """Milestones of a bond at the mode ratio ``B`` by energy; under ``pressure`` [stress] B is 1."""
    if isinstance(bond, OpeningBond):
        size = bond.slopes[0] ** 0.5
        kinks = tuple(size * kink for kink in bond.kinks)
        return Milestones(kinks[0], 0.5 * (kinks[0] + kinks[-1]), kinks[-1], kinks)
    if bond.law == "exponential":
        onset, half, end = (_exponential(bond, B, size) for size in (BEFORE, BEHIND, LEFT_NOTHING))
        return Milestones(onset, half, end, kinks=())
    ratio = np.array(B)
    gain = 1.0 + (bond.pressure_strength * pressure / bond.strength[1] if bond.contact else 0.0)
    toughness = float(bond.critical(ratio))
    onset = min(float(bond.onset_norm(ratio)) * gain, (2.0 * toughness) ** 0.5)
    flat = bond.plateau if bond.law == "trapezoidal" else 0.0
    way = (2.0 * toughness - onset**2) / ((1.0 + flat) * onset)
    end = onset + way
    return Milestones(onset, onset + 0.5 * way, end, (onset, onset + flat * way, end))


def jump(bond: MixedBond, B: float, size: float) -> tuple[float, float]:
    """Opening and slip of the ``size`` lambda at the mode ratio B, ``sqrt((1 - B) / K) lambda``, ``sqrt(B / Ks)
    lambda``."""
    K, Ks = bond.slopes
    return size * ((1.0 - B) / K) ** 0.5, size * (B / Ks) ** 0.5


def _exponential(bond: MixedBond, B: float, exponent: float) -> float:
    """lambda at which ``x + y^2`` is the exponent, x = g / g0, y = s / s0."""
    g, s = jump(bond, B, 1.0)
    x = g * np.e * bond.strength[0] / bond.toughness[0]
    y = s * bond.strength[1] / bond.toughness[1] * (np.e / 2.0) ** 0.5
    if y == 0.0:
        return exponent / x
    return float((np.sqrt(x * x + 4.0 * y * y * exponent) - x) / (2.0 * y * y))
