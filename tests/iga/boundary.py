"""The boundary of a body: its closed chains of element sides."""

from __future__ import annotations

import numpy as np

from iga.mesh.edges import chains_of, element_sides
from iga.mesh.extraction import Chain, Mesh


def boundary_chains(body: Mesh) -> tuple[Chain, ...]:
    """The closed chains of all element sides without a neighbour, walked with the body on the left.

    Two elements share a side, or a part of one, if the same functions have the same values on it; the faces of a slit
    are boundary.

    Raises
    ------
    ValueError : the boundary touches itself in a vertex, so that its chains are not unique.
    """
    sides = element_sides(body)
    chains = chains_of(sides, np.flatnonzero(~sides.shared_k))
    if not chains:
        raise ValueError("the boundary of the mesh is not made of closed chains: it touches itself, or there is none")
    return chains
