"""Hanging nodes: elements are cut where the corner of a neighbour lies on their side, until none is left."""

from __future__ import annotations

import numpy as np

from iga.cut import cut
from iga.extraction import SIDES, Mesh
from iga.neighbours import element_sides

#: Rounds of cuts before giving up: a cut crosses one element a round.
ROUNDS = 200


def conforming(mesh: Mesh) -> Mesh:
    """The same functions on elements that meet side to side, cut along the lines that end on their sides.

    Raises
    ------
    ValueError : cuts that go on for ever, as they may where they wind around an extraordinary point.
    """
    for _ in range(ROUNDS):
        sides = element_sides(mesh)
        _, k, t = sides.hanging_at
        if not k.size:
            return mesh
        at_ed = np.full((mesh.elements, 2), np.nan)
        along = np.array([1 - SIDES[side][0] for side in sides.side_k[k]])
        at = sides.parameters(k, t)[np.arange(len(k)), along]
        at_ed[k // len(SIDES), along] = at  # of several cuts across one element one is made, the others in later rounds
        mesh = cut(mesh, at_ed)
    raise ValueError(f"hanging nodes are left after {ROUNDS} rounds of cuts, at {mesh.elements} elements")
