"""Elements of a mesh cut in two: the same functions on more elements (Bezier subdivision, Farin 2002, section 5.4)."""

from __future__ import annotations

import numpy as np

from iga.bernstein import bernstein
from iga.extraction import SIDES, Chain, ElementBlock, Mesh


def cut(mesh: Mesh, at_ed: np.ndarray) -> Mesh:
    """The same mesh with some elements cut; its chains run over the pieces.

    Parameters
    ----------
    at_ed : (n_e, 2) parameters of the elements, counted through the blocks, at which to cut across s and across t;
        NaN where an element stays whole.
    """
    for direction in (0, 1):
        parts = np.split(at_ed[:, direction], mesh.first_b[1:-1])
        blocks = tuple(_cut(block, direction, at_e) for block, at_e in zip(mesh.blocks, parts, strict=True))
        cut_e = ~np.isnan(at_ed[:, direction])
        chains = {name: _carried(chain, direction, cut_e, mesh.first_b) for name, chain in mesh.chains.items()}
        mesh = Mesh(mesh.P_AI, mesh.w_A, blocks, chains)
        at_ed = np.repeat(at_ed, 1 + cut_e, axis=0)
    return mesh


def halved(mesh: Mesh) -> Mesh:
    """Every element cut into four."""
    return cut(mesh, np.full((mesh.elements, 2), 0.5))


def _cut(block: ElementBlock, direction: int, at_e: np.ndarray) -> ElementBlock:
    """Elements cut across one direction, ``B_b`` on a part by interpolation in p + 1 points, which is exact."""
    source = np.repeat(np.arange(len(at_e)), 2 - np.isnan(at_e))
    piece = np.flatnonzero(~np.isnan(at_e[source]))
    second, at = np.arange(len(piece)) % 2 == 1, at_e[source[piece]]
    low, high = np.where(second, at, 0.0)[:, None], np.where(second, 1.0, at)[:, None]
    (p, q), degree = block.degrees, block.degrees[direction]
    xi = np.linspace(0.0, 1.0, degree + 1)
    part_eacb = (np.linalg.inv(bernstein(degree, xi)) @ bernstein(degree, low * (1.0 - xi) + high * xi))[:, None]
    C_eab = block.C_eab[source]
    C_eaji = C_eab[piece].reshape(len(piece), C_eab.shape[1], q + 1, p + 1)
    C_eaji = C_eaji @ part_eacb.swapaxes(2, 3) if direction == 0 else part_eacb @ C_eaji
    C_eab[piece] = C_eaji.reshape(len(piece), *C_eab.shape[1:])
    return ElementBlock(block.degrees, C_eab, block.conn_ea[source])


def _carried(chain: Chain, direction: int, cut_e: np.ndarray, first_b: np.ndarray) -> Chain:
    """The chain on the pieces of its elements, in the same order."""
    piece_e = np.cumsum(np.concatenate([[0], 1 + cut_e]))
    start_c = first_b[chain.block_c]
    cut_c = cut_e[start_c + chain.element_c]
    fixed_c, value_c = np.array([SIDES[side] for side in chain.side_c]).reshape(-1, 2).T
    whole_c = fixed_c == direction
    c = np.repeat(np.arange(len(cut_c)), 1 + (cut_c & ~whole_c))
    second = np.diff(c, prepend=-1) == 0
    far = np.where(whole_c[c], value_c[c] == 1.0, second != chain.reversed_c[c])
    element_c = piece_e[start_c + chain.element_c] - piece_e[start_c]
    return Chain(chain.block_c[c], element_c[c] + (far & cut_c[c]), chain.side_c[c], chain.outward)
