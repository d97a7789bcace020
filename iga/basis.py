"""Rational basis functions, their gradients and volumes at points of the elements, all elements at once."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from iga.bernstein import bernstein, bernstein_derivative, tensor
from iga.extraction import SIDES, Chain, ElementBlock, Mesh


@dataclass(frozen=True)
class BlockBasis:
    """Basis of one block of elements at the same parametric points of each.

    ``N_eqa`` (n_e, n_q, n_a), ``dN_eqaI`` (n_e, n_q, n_a, 2) reference gradients, ``dV_eq`` (n_e, n_q) volume (or, on
    a side, length) that each point stands for, ``X_eqI`` (n_e, n_q, 2) reference positions, ``conn_ea`` (n_e, n_a)
    control points.
    """

    conn_ea: np.ndarray
    N_eqa: np.ndarray
    dN_eqaI: np.ndarray
    dV_eq: np.ndarray
    X_eqI: np.ndarray

    @cached_property
    def dN_e_qI_a(self) -> np.ndarray:
        """Gradients as the left factor (n_e, 2 n_q, n_a) of one matrix product an element, with its displacements."""
        n_e, n_q, n_a, _ = self.dN_eqaI.shape
        return np.ascontiguousarray(self.dN_eqaI.swapaxes(2, 3)).reshape(n_e, n_q * 2, n_a)

    @cached_property
    def dNdV_ea_qI(self) -> np.ndarray:
        """Gradients times volume as the left factor (n_e, n_a, 2 n_q) of one product an element, with stresses."""
        n_e, n_q, n_a, _ = self.dN_eqaI.shape
        dNdV_eqaI = self.dN_eqaI * self.dV_eq[..., None, None]
        return np.ascontiguousarray(dNdV_eqaI.transpose(0, 2, 1, 3)).reshape(n_e, n_a, n_q * 2)

    @cached_property
    def dN_eqJb(self) -> np.ndarray:
        """Gradients as the right factor (n_e, n_q, 2, n_a) of one small product a point."""
        return np.ascontiguousarray(self.dN_eqaI.swapaxes(2, 3))


def block_basis(
    mesh: Mesh, block: ElementBlock, points_q: np.ndarray, weights_q: np.ndarray, width: float = 1.0
) -> BlockBasis:
    """Basis of a whole block at the points (n_q, 2) of a rule on the unit square; ``dV`` are areas times ``width``.

    Raises
    ------
    ValueError : an element whose Jacobian determinant is not positive somewhere.
    """
    N, dN_param = _rational(mesh, block.C_eab, block.conn_ea, block.degrees, points_q)
    P_eaI = mesh.P_AI[block.conn_ea]
    J_eqIs = np.einsum("eaI,eqas->eqIs", P_eaI, dN_param)
    det = J_eqIs[..., 0, 0] * J_eqIs[..., 1, 1] - J_eqIs[..., 0, 1] * J_eqIs[..., 1, 0]
    if not np.all(det > 0):
        raise ValueError(
            f"element {int(np.argmin(det.min(1)))} is turned inside out: its smallest Jacobian is {det.min():.3g}"
        )
    dN = np.einsum("eqas,eqsI->eqaI", dN_param, np.linalg.inv(J_eqIs))
    return BlockBasis(block.conn_ea, N, dN, det * (weights_q * width), np.einsum("eqa,eaI->eqI", N, P_eaI))


def chain_basis(mesh: Mesh, chain: Chain, points_q: np.ndarray, weights_q: np.ndarray) -> tuple[BlockBasis, ...]:
    """Basis on the sides of a chain at the points (n_q,) of a rule on [0, 1], each with its length for ``dV``.

    One entry for every block and side that the chain has, points along the side's own parameter.
    """
    bases = []
    for here, number, side in chain.parts():
        (direction, value), block, e = SIDES[side], mesh.blocks[number], chain.element_c[here]
        square_q = np.insert(points_q[:, None], direction, value, axis=1)
        part = ElementBlock(block.degrees, block.C_eab[e], block.conn_ea[e])
        basis = block_basis(mesh, part, square_q, np.ones(len(points_q)))
        _, dN_param = _rational(mesh, part.C_eab, part.conn_ea, part.degrees, square_q)
        tangent = np.einsum("eaI,eqa->eqI", mesh.P_AI[part.conn_ea], dN_param[..., 1 - direction])
        length = np.linalg.norm(tangent, axis=-1) * weights_q
        bases.append(BlockBasis(basis.conn_ea, basis.N_eqa, basis.dN_eqaI, length, basis.X_eqI))
    return tuple(bases)


def _rational(
    mesh: Mesh, C_eab: np.ndarray, conn_ea: np.ndarray, degrees: tuple[int, int], points_q: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """R_a = w_a N_a / W and its parametric gradient (quotient rule): (n_e, n_q, n_a) and (n_e, n_q, n_a, 2)."""
    (p, q), s, t = degrees, points_q[:, 0], points_q[:, 1]
    B = tensor(bernstein(p, s), bernstein(q, t))
    dB_s = tensor(bernstein_derivative(p, s), bernstein(q, t))
    dB_t = tensor(bernstein(p, s), bernstein_derivative(q, t))
    w_ea = mesh.w_A[conn_ea]
    wN, wdN_s, wdN_t = ((C_eab @ b.T).transpose(0, 2, 1) * w_ea[:, None, :] for b in (B, dB_s, dB_t))
    W, W_s, W_t = (v.sum(-1, keepdims=True) for v in (wN, wdN_s, wdN_t))
    N = wN / W
    return N, np.stack([(wdN_s - N * W_s) / W, (wdN_t - N * W_t) / W], -1)
