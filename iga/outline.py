"""The outline of any mesh, from its extraction alone."""

from __future__ import annotations

import numpy as np

from iga.cells import SIDE_NAMES
from iga.conform import conforming
from iga.extraction import Chain, Mesh
from iga.loops import loops


def outline(mesh: Mesh) -> tuple[Chain, ...]:
    """Closed chains of all element sides that no other element shares, walked with the body to the left.

    Raises
    ------
    ValueError : hanging nodes that cannot be resolved, or an outline that touches itself.
    """
    cells = conforming(mesh)
    c, k = np.nonzero(cells.lonely_ck)
    chains = []
    for loop in loops(cells.corner_ck[c, k], cells.corner_ck[c, (k + 1) % 4]):
        sides = np.stack([cells.block_c[c[loop]], cells.element_c[c[loop]], k[loop]], -1)
        first = np.any(sides != np.roll(sides, 1, axis=0), axis=1)  # the pieces of one side follow each other
        block, element, side = sides[first].T
        chains.append(Chain(block, element, SIDE_NAMES[side], 1.0))
    return tuple(chains)
