"""Meshes with reversed parameters, and mirror images, with positive Jacobians."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from iga.mesh.extraction import Chain, ElementBlock, Mesh

#: Names of the sides of an element after s is reversed.
SEEN_FROM_BEHIND = {"LEFT": "RIGHT", "RIGHT": "LEFT"}


def from_behind(mesh: Mesh) -> Mesh:
    """The same body with the first parametric direction of every element reversed."""
    blocks = tuple(block_from_behind(block, np.ones(len(block.conn_ea), dtype=bool)) for block in mesh.blocks)
    chains = {
        name: Chain(
            chain.block_c[::-1],
            chain.element_c[::-1],
            np.array([SEEN_FROM_BEHIND.get(side, side) for side in chain.side_c[::-1]]),
            chain.outward,
        )
        for name, chain in mesh.chains.items()
    }
    return replace(mesh, blocks=blocks, chains=chains)


def block_from_behind(block: ElementBlock, turned_e: np.ndarray) -> ElementBlock:
    """The block with the first parametric direction of some of its elements (n_e,) reversed."""
    p, q = block.degrees
    back_b = np.arange((p + 1) * (q + 1)).reshape(q + 1, p + 1)[:, ::-1].ravel()
    return replace(block, C_eab=np.where(turned_e[:, None, None], block.C_eab[:, :, back_b], block.C_eab))


def upside_down(mesh: Mesh) -> Mesh:
    """The mirror image of a body in Y = 0; the chains ``bottom`` and ``top`` are exchanged."""
    back = from_behind(mesh)
    other = {"bottom": "top", "top": "bottom"}
    chains = {other.get(name, name): chain for name, chain in back.chains.items()}
    return replace(back, P_AI=back.P_AI * [1.0, -1.0], chains=chains)
