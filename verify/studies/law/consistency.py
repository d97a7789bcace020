"""Effect of a shear stiffness that is not the consistent one on the energy released when the mode changes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from verify.theory.mixed_law import MixedBond

#: Relative difference from which two stiffnesses count as different.
OTHER = 1e-6


def inconsistent(bond: MixedBond) -> Iterator[str]:
    """A sentence where the shear stiffness is not ``K (G_I / G_II) (t_max / p_max)^2`` (Turon et al. 2010)."""
    (K, Ks), (G_I, G_II), (p, t) = bond.slopes, bond.toughness, bond.strength
    consistent = K * G_I / G_II * (t / p) ** 2
    if bond.law == "exponential" or abs(Ks / consistent - 1.0) < OTHER:
        return
    found, plain = (_opened_then_slid(one) for one in (bond, replace(bond, stiffness=(K, consistent))))
    yield (
        f"the shear stiffness is {Ks / consistent:.3g} of the consistent one, so that the same damage means different "
        f"things in opening and sliding: opened half way and then slid to failure, the bond takes up {found:.6g}, with "
        f"the consistent one {plain:.6g} ({found / plain - 1.0:+.1%})"
    )


def _opened_then_slid(bond: MixedBond) -> float:
    """Energy per area released on opening to the middle of the law and sliding from there to failure."""
    half, end = bond.toughness[0] / bond.strength[0], 4.0 * max(bond.toughness) / min(bond.strength)
    part = np.linspace(0.0, 1.0, 20_001)
    g, s = np.append(half * part, np.full(20_000, half)), np.append(np.zeros(20_001), end * part[1:])
    return float(replace(bond, viscosity=0.0, friction=0.0).path(g, s).released[-1])
