"""Refinement of any mesh from its extraction alone: every element cut in four, the pieces joined with C0 continuity."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from iga.mesh.bernstein import elevation
from iga.mesh.bezier import cut, halved, homogeneous
from iga.mesh.edges import SAME_POINT, Sides, element_sides, walked
from iga.mesh.extraction import SIDES, ElementBlock, Mesh


def bezier_refined(mesh: Mesh, times: int = 1) -> Mesh:
    """The same geometry in Bezier elements with shared control points, each element cut into ``4**times`` pieces.

    All elements get the highest degree of the mesh. Elements with hanging nodes are cut first, so that the pieces
    conform; the new space contains the old one, and chains run over the pieces.

    Raises
    ------
    ValueError : hanging nodes that cuts do not remove, or neighbours with different traces on their common side.
    """
    mesh = _joined(conforming(mesh))
    for _ in range(times):
        mesh = _joined(halved(mesh))
    return mesh


def _joined(mesh: Mesh) -> Mesh:
    """Elements with Bernstein polynomials of the highest degree, control points shared at vertices and on edges."""
    sides, p = element_sides(mesh), max(max(block.degrees) for block in mesh.blocks)
    Q_ebk = np.concatenate([_elevated(mesh, block, p) for block in mesh.blocks])
    conn_eb = _numbers(sides, p)
    Q_Ak = np.empty((conn_eb.max() + 1, 3))
    Q_Ak[conn_eb] = Q_ebk
    gap = np.max(np.abs(Q_Ak[conn_eb] - Q_ebk), axis=(1, 2)) / np.max(np.abs(Q_ebk - Q_ebk[:, :1]), axis=(1, 2))
    if np.max(gap) > 10.0 * SAME_POINT:
        worst = len(SIDES) * int(np.argmax(gap))
        where = f"element {sides.element_k[worst]} of block {sides.block_k[worst]}"
        raise ValueError(f"neighbours must agree on their common side, {where} misses by {gap.max():.1e} of its size")
    C_eab = np.broadcast_to(np.eye(Q_ebk.shape[1]), (len(conn_eb), Q_ebk.shape[1], Q_ebk.shape[1]))
    chains = {}
    for name, chain in mesh.chains.items():
        element_c = mesh.first_b[chain.block_c] + chain.element_c
        chains[name] = replace(chain, block_c=np.zeros_like(chain.block_c), element_c=element_c)
    return Mesh(Q_Ak[:, :2] / Q_Ak[:, 2:], Q_Ak[:, 2], (ElementBlock((p, p), C_eab, conn_eb),), chains)


def _elevated(mesh: Mesh, block: ElementBlock, p: int) -> np.ndarray:
    """Homogeneous Bezier points (n_e, (p + 1)^2, 3) of a block in degree p."""
    E_s, E_t = (elevation(degree, p) for degree in block.degrees)
    return np.kron(E_t, E_s).T @ homogeneous(mesh.P_AI, mesh.w_A, block)


def _numbers(sides: Sides, p: int) -> np.ndarray:
    """Numbers of control points (n_e, (p + 1)^2): one per vertex, p - 1 per edge, (p - 1)^2 inside an element."""
    start_ek, end_ek = np.moveaxis(sides.vertex_kv.reshape(-1, len(SIDES), 2), 2, 0)
    edge_ek = sides.edge_k.reshape(start_ek.shape)
    vertices, edges, n_e = start_ek.max() + 1, edge_ek.max() + 1, len(start_ek)
    walk_kb = np.array([walked((p, p), side) for side in SIDES])
    conn_eb = np.empty((n_e, (p + 1) ** 2), dtype=int)
    conn_eb[:, walk_kb[:, 0]] = start_ek
    forth = np.arange(p - 1)
    along = np.where((start_ek > end_ek)[:, :, None], forth[::-1], forth)
    conn_eb[:, walk_kb[:, 1:-1]] = vertices + edge_ek[:, :, None] * (p - 1) + along
    inner = np.setdiff1d(np.arange((p + 1) ** 2), walk_kb)
    conn_eb[:, inner] = vertices + edges * (p - 1) + np.arange(n_e * inner.size).reshape(n_e, -1)
    return conn_eb


#: Largest number of rounds of cuts; in each round a cut crosses one element.
ROUNDS = 200


def conforming(mesh: Mesh) -> Mesh:
    """The same functions on elements without hanging nodes: elements are cut along the lines that end on their sides.

    Raises
    ------
    ValueError : hanging nodes remain after `ROUNDS` rounds, as when cuts wind around an extraordinary point.
    """
    for _ in range(ROUNDS):
        sides = element_sides(mesh)
        _, k, t = sides.hanging_at
        if not k.size:
            return mesh
        at_ed = np.full((mesh.elements, 2), np.nan)
        along = np.array([1 - SIDES[side][0] for side in sides.side_k[k]])
        at = sides.parameters(k, t)[np.arange(len(k)), along]
        at_ed[k // len(SIDES), along] = at  # one cut per element and direction in a round, further ones in later rounds
        mesh = cut(mesh, at_ed)
    raise ValueError(f"hanging nodes are left after {ROUNDS} rounds of cuts, at {mesh.elements} elements")
