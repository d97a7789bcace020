"""Refinement of any extracted mesh, its history unknown: every element cut in four, the pieces joined C0."""

from __future__ import annotations

import numpy as np

from iga.bernstein import bernstein
from iga.bezier import homogeneous
from iga.cells import SAME, SIDE_NAMES, Cells, whole_cells
from iga.conform import conforming
from iga.extraction import HANDS, SIDES, Chain, ElementBlock, Mesh


def bezier_refined(mesh: Mesh, times: int = 1) -> Mesh:
    """The same geometry in Bezier elements with shared control points, each element cut into ``4**times``.

    All elements get the highest degree of the mesh, and hanging nodes are cut through first, so that the pieces
    conform; the new space contains the old one. Chains are carried over.

    Raises
    ------
    ValueError : hanging nodes that cannot be resolved, or neighbours with different traces on their common side.
    """
    mesh = _joined(conforming(mesh))
    for _ in range(times):
        mesh = _joined(whole_cells(mesh).halved())
    return mesh


def _joined(cells: Cells) -> Mesh:
    """Every cell an element of its own, with shared control points on shared vertices and sides."""
    p = max(max(block.degrees) for block in cells.mesh.blocks)
    Q_cbk = _homogeneous(cells, p)
    conn_cb = _numbers(cells, p)
    Q_Ak = np.empty((conn_cb.max() + 1, 3))
    Q_Ak[conn_cb] = Q_cbk
    gap = np.max(np.abs(Q_Ak[conn_cb] - Q_cbk), axis=(1, 2)) / np.max(np.abs(Q_cbk - Q_cbk[:, :1]), axis=(1, 2))
    if np.max(gap) > 10.0 * SAME:
        worst = int(np.argmax(gap))
        where = f"element {cells.element_c[worst]} of block {cells.block_c[worst]}"
        raise ValueError(f"neighbours must agree on their common side, {where} misses by {gap[worst]:.1e} of its size")
    C_eab = np.broadcast_to(np.eye(Q_cbk.shape[1]), (len(conn_cb), Q_cbk.shape[1], Q_cbk.shape[1]))
    chains = {name: _carried(cells, chain) for name, chain in cells.mesh.chains.items()}
    return Mesh(Q_Ak[:, :2] / Q_Ak[:, 2:], Q_Ak[:, 2], (ElementBlock((p, p), C_eab, conn_cb),), chains)


def _homogeneous(cells: Cells, p: int) -> np.ndarray:
    """Homogeneous Bezier points (n_c, (p + 1)^2, 3) of all cells in degree p, by interpolation, which is exact."""
    xi = np.linspace(0.0, 1.0, p + 1)
    to_bezier = np.linalg.inv(bernstein(p, xi))
    Q = np.empty((len(cells.block_c), (p + 1) ** 2, 3))
    for number, block in enumerate(cells.mesh.blocks):
        here = np.flatnonzero(cells.block_c == number)
        box = cells.box_cds[here][..., None]
        x_cdq = box[:, :, 0] * (1.0 - xi) + box[:, :, 1] * xi
        M_s, M_t = (to_bezier @ bernstein(degree, x_cdq[:, d]) for d, degree in enumerate(block.degrees))
        points = homogeneous(cells.mesh.P_AI, cells.mesh.w_A, block)
        old = points[cells.element_c[here]].reshape(len(here), block.degrees[1] + 1, block.degrees[0] + 1, 3)
        Q[here] = np.einsum("cnj,cmi,cjik->cnmk", M_t, M_s, old, optimize=True).reshape(len(here), -1, 3)
    return Q


def _numbers(cells: Cells, p: int) -> np.ndarray:
    """Control points (n_c, (p + 1)^2): one a vertex, p - 1 a side, (p - 1)^2 within."""
    table = np.arange((p + 1) ** 2).reshape(p + 1, p + 1)
    corner, side = cells.corner_ck, cells.side_ck
    vertices, sides, n_c = corner.max() + 1, side.max() + 1, len(corner)
    conn = np.empty((n_c, (p + 1) ** 2), dtype=int)
    conn[:, table[[0, 0, -1, -1], [0, -1, -1, 0]]] = corner
    forth = np.arange(p - 1)
    backwards = corner > np.roll(corner, -1, axis=1)
    along = np.where(backwards[:, :, None], forth[::-1], forth)
    walked = np.stack([table[0, 1:-1], table[1:-1, -1], table[-1, -2:0:-1], table[-2:0:-1, 0]])
    conn[:, walked] = vertices + side[:, :, None] * (p - 1) + along
    inner = table[1:-1, 1:-1].ravel()
    conn[:, inner] = vertices + sides * (p - 1) + np.arange(n_c * inner.size).reshape(n_c, -1)
    return conn


def _carried(cells: Cells, chain: Chain) -> Chain:
    """The chain on the pieces of its sides, in the same order."""
    pieces = []
    for side in SIDE_NAMES:
        direction, value = SIDES[side]
        at = np.flatnonzero(chain.side_c == side)
        width = max(len(block.conn_ea) for block in cells.mesh.blocks)
        key = chain.block_c[at] * width + chain.element_c[at]
        order = np.argsort(key)
        on_side = np.flatnonzero(cells.box_cds[:, direction, int(value)] == value)
        cell_key = cells.block_c[on_side] * width + cells.element_c[on_side]
        first, last = np.searchsorted(key[order], cell_key), np.searchsorted(key[order], cell_key, side="right")
        found = last > first
        sign = 1.0 if HANDS[side] == chain.outward else -1.0
        position = sign * cells.box_cds[on_side[found], 1 - direction, 0]
        pieces.append((at[order[first[found]]], position, on_side[found], np.full(found.sum(), side)))
    place, position, cell, side_c = (np.concatenate(part) for part in zip(*pieces, strict=True))
    order = np.lexsort((position, place))
    return Chain(np.zeros(order.size, dtype=int), cell[order], side_c[order], chain.outward)
