"""Vectors of compiled linear forms, and the number of unknowns that a rank owns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from dolfinx import fem, la


@dataclass(frozen=True)
class BlockVector:
    """Compiled linear forms, one per block, with the vectors that they are assembled into."""

    forms: Sequence[fem.Form]
    vectors: Sequence[la.Vector] = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "vectors", [fem.assemble_vector(form) for form in self.forms])

    def assemble(self) -> np.ndarray:
        """Owned entries (n,) of all blocks, one after the other."""
        owned_parts = []
        for form, b in zip(self.forms, self.vectors, strict=True):
            b.array[:] = 0.0
            fem.assemble_vector(b.array, form)
            b.scatter_reverse(la.InsertMode.add)
            owned_parts.append(b.array[: b.index_map.size_local * b.block_size])
        return np.concatenate(owned_parts)


def owned(u: fem.Function) -> int:
    """Number of unknowns of a function that this rank owns."""
    dofmap = u.function_space.dofmap
    return dofmap.index_map.size_local * dofmap.index_map_bs
