"""Refinement of any mesh from its extraction alone: every element cut in four, the pieces joined with C0 continuity."""

from __future__ import annotations

import numpy as np

from iga.mesh.bernstein import bernstein, elevation
from iga.mesh.bezier import homogeneous
from iga.mesh.edges import SAME_POINT, Sides, element_sides, walked
from iga.mesh.extraction import SIDES, ElementBlock, Mesh

#: Largest number of rounds of cuts; in each round a cut crosses one element.
ROUNDS = 200


def bezier_refined(mesh: Mesh, times: int = 1) -> Mesh:
    """The same geometry in Bezier elements with shared control points, each element cut into ``4**times`` pieces.

    All elements get the highest degree of the mesh. Elements with hanging nodes are cut first, so that the pieces
    conform; the new space contains the old one. Chains are left out.
    """
    mesh = _joined(conforming(mesh))
    for _ in range(times):
        mesh = _joined(halved(mesh))
    return mesh


def conforming(mesh: Mesh) -> Mesh:
    """The same functions without hanging nodes: elements are cut along the lines that end on their sides."""
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


def halved(mesh: Mesh) -> Mesh:
    """Every element cut into four."""
    return cut(mesh, np.full((mesh.elements, 2), 0.5))


def cut(mesh: Mesh, at_ed: np.ndarray) -> Mesh:
    """The same mesh with some elements cut in two or four.

    Parameters
    ----------
    at_ed : (n_e, 2) parameters in (0, 1) at which the elements, counted through the blocks, are cut across s and
        across t; NaN for an element that is not cut.
    """
    for direction in (0, 1):
        parts = np.split(at_ed[:, direction], mesh.first_b[1:-1])
        blocks = tuple(_cut(block, direction, at_e) for block, at_e in zip(mesh.blocks, parts, strict=True))
        at_ed = np.repeat(at_ed, 1 + ~np.isnan(at_ed[:, direction]), axis=0)
        mesh = Mesh(mesh.P_AI, mesh.w_A, blocks)
    return mesh


def _cut(block: ElementBlock, direction: int, at_e: np.ndarray) -> ElementBlock:
    """Elements cut across one direction; ``B_b`` on a piece by interpolation at p + 1 points, which is exact."""
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


def _joined(mesh: Mesh) -> Mesh:
    """Elements with Bernstein polynomials of the highest degree, control points shared at vertices and on edges."""
    sides, p = element_sides(mesh), max(max(block.degrees) for block in mesh.blocks)
    Q_ebk = np.concatenate([_elevated(mesh, block, p) for block in mesh.blocks])
    conn_eb = _numbers(sides, p)
    Q_Ak = np.empty((conn_eb.max() + 1, 3))
    Q_Ak[conn_eb] = Q_ebk
    gap = np.max(np.abs(Q_Ak[conn_eb] - Q_ebk), axis=(1, 2)) / np.max(np.abs(Q_ebk - Q_ebk[:, :1]), axis=(1, 2))
    assert np.max(gap) < 10.0 * SAME_POINT, "neighbours agree on their common side"
    C_eab = np.broadcast_to(np.eye(Q_ebk.shape[1]), (len(conn_eb), Q_ebk.shape[1], Q_ebk.shape[1]))
    return Mesh(Q_Ak[:, :2] / Q_Ak[:, 2:], Q_Ak[:, 2], (ElementBlock((p, p), C_eab, conn_eb),))


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
