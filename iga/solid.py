"""What the bodies are made of: blocks of elements with one material each."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from iga.basis import BlockBasis


@dataclass(frozen=True)
class Solid:
    """One block of elements with one material: basis at the quadrature points and elasticity matrix D (3, 3)."""

    basis: BlockBasis
    D: np.ndarray


def joined(solids: list[Solid]) -> tuple[Solid, ...]:
    """Blocks of one shape and one material taken together: fewer and longer array operations."""
    groups: dict[tuple, list[Solid]] = {}
    for solid in solids:
        groups.setdefault((solid.basis.N_eqa.shape[1:], solid.D.tobytes()), []).append(solid)
    return tuple(
        Solid(
            BlockBasis(*(np.concatenate([getattr(s.basis, f.name) for s in group]) for f in fields(BlockBasis))),
            group[0].D,
        )
        for group in groups.values()
    )
