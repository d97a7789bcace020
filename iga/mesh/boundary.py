"""The boundary of a body: its closed chains of element sides."""

from __future__ import annotations

import numpy as np

from iga.mesh.edges import chains_of, element_sides
from iga.mesh.extraction import Chain, Mesh


def boundary_chains(body: Mesh) -> tuple[Chain, ...]:
    """The closed chains of all element sides with no element on the other hand, walked with the body on the left.

    A side is shared where the same functions have the same values on both hands, whole or in parts; the faces of a
    slit are boundary.

    Raises
    ------
    ValueError : the boundary touches itself in a vertex, so that its chains cannot be told apart.
    """
    sides = element_sides(body)
    chains = chains_of(sides, np.flatnonzero(~sides.shared_k))
    if not chains:
        raise ValueError("the boundary of the mesh is not made of closed chains: it touches itself, or there is none")
    return chains
