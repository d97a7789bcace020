"""Elements in Bezier form: homogeneous control points of each element, by its extraction operator."""

from __future__ import annotations

import numpy as np

from iga.mesh.bernstein import bernstein, bernstein_derivative, tensor
from iga.mesh.extraction import SIDES, Chain, ElementBlock, Mesh


def homogeneous(P_AI: np.ndarray, w_A: np.ndarray, block: ElementBlock) -> np.ndarray:
    """Homogeneous Bezier points ``sum_a C_ab w_a (P_a, 1)`` (Borden, Scott, Evans, Hughes 2011, eq. 62).

    Parameters
    ----------
    P_AI : (n_A, d) control points, or control values of any field.
    w_A : (n_A,) weights.

    Returns
    -------
    H_ebI : (n_e, n_b, d + 1), the Bezier weights last.
    """
    H_AI = np.column_stack([P_AI * w_A[:, None], w_A])
    return block.C_eab.swapaxes(1, 2) @ H_AI[block.conn_ea]


def jacobian(H_ebI: np.ndarray, degrees: tuple[int, int], points_q: np.ndarray) -> np.ndarray:
    """Jacobian determinants (n_e, n_q) at points (n_q, 2), of any sign.

    With homogeneous positions h = (W X, W) the determinant is ``det[h, h_s, h_t] / W^3``: the terms with derivatives of
    W are multiples of h and drop out.
    """
    (p, q), (s, t) = degrees, points_q.T
    h_eqI = tensor(bernstein(p, s), bernstein(q, t)) @ H_ebI
    h_s_eqI = tensor(bernstein_derivative(p, s), bernstein(q, t)) @ H_ebI
    h_t_eqI = tensor(bernstein(p, s), bernstein_derivative(q, t)) @ H_ebI
    return np.linalg.det(np.stack([h_s_eqI, h_t_eqI, h_eqI], -1)) / h_eqI[..., 2] ** 3


def cut(mesh: Mesh, at_ed: np.ndarray) -> Mesh:
    """The same mesh with some elements cut in two or four; its chains run over the pieces.

    Parameters
    ----------
    at_ed : (n_e, 2) parameters in (0, 1) at which the elements, counted through the blocks, are cut across s and
        across t; NaN for an element that is not cut.
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


def _carried(chain: Chain, direction: int, cut_e: np.ndarray, first_b: np.ndarray) -> Chain:
    """The chain over the pieces of its elements, in the same order."""
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
