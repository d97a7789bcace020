"""Rational basis functions, their gradients and volumes at points of the elements, all elements at once."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from iga.mesh.bernstein import bernstein, bernstein_derivative, tensor
from iga.mesh.extraction import HANDS, SIDES, Chain, ElementBlock, Mesh

#: Deviation of all Bezier weights from 1 below which an element is polynomial, and not divided by the weight.
POLYNOMIAL = 1e-13


@dataclass(frozen=True)
class BlockBasis:
    """Basis of one block of elements at the same parametric points of each.

    ``N_eqa`` (n_e, n_q, n_a), ``dN_eqIa`` (n_e, n_q, 2, n_a) reference gradients, ``dV_eq`` (n_e, n_q) volume of each
    point, ``X_eqI`` (n_e, n_q, 2) reference positions, ``conn_ea`` (n_e, n_a) control points.
    """

    conn_ea: np.ndarray
    N_eqa: np.ndarray
    dN_eqIa: np.ndarray
    dV_eq: np.ndarray
    X_eqI: np.ndarray

    @property
    def dN_e_qI_a(self) -> np.ndarray:
        """Gradients (n_e, 2 n_q, n_a) as a factor of one matrix product an element."""
        n_e, n_q, _, n_a = self.dN_eqIa.shape
        return self.dN_eqIa.reshape(n_e, 2 * n_q, n_a)

    def of(self, e: slice) -> BlockBasis:
        """That of some of the elements, which shares the arrays."""
        return BlockBasis(self.conn_ea[e], self.N_eqa[e], self.dN_eqIa[e], self.dV_eq[e], self.X_eqI[e])


def block_basis(
    mesh: Mesh, block: ElementBlock, points_q: np.ndarray, weights_q: np.ndarray, width: float = 1.0
) -> BlockBasis:
    """Basis of a whole block at the points (n_q, 2) of a rule on the unit square; ``dV`` are areas times ``width``.

    Raises
    ------
    ValueError : an element whose Jacobian determinant is not positive somewhere.
    """
    basis, _ = _mapped(mesh, block, points_q)
    return replace(basis, dV_eq=basis.dV_eq * (weights_q * width))


@dataclass(frozen=True)
class SideBasis(BlockBasis):
    """Basis on sides of one name, with lengths as ``dV_eq`` and unit outward normals ``n_eqI`` (n_e, n_q, 2)."""

    n_eqI: np.ndarray


def chain_basis(mesh: Mesh, chain: Chain, points_q: np.ndarray, weights_q: np.ndarray) -> tuple[SideBasis, ...]:
    """Basis on the sides of a chain at the points (n_q,) of a rule on [0, 1].

    One entry for every block and name of a side in the chain; points run along the side's own parameter.
    """
    bases = []
    for here, number, side in chain.parts():
        (direction, value), block, e = SIDES[side], mesh.blocks[number], chain.element_c[here]
        square_q = np.insert(points_q[:, None], direction, value, axis=1)
        part = ElementBlock(block.degrees, block.C_eab[e], block.conn_ea[e])
        basis, J_eqIs = _mapped(mesh, part, square_q)
        t_eqI = J_eqIs[..., 1 - direction]
        length_eq = np.linalg.norm(t_eqI, axis=-1)
        n_eqI = HANDS[side] * np.stack([t_eqI[..., 1], -t_eqI[..., 0]], -1) / length_eq[..., None]
        bases.append(SideBasis(basis.conn_ea, basis.N_eqa, basis.dN_eqIa, length_eq * weights_q, basis.X_eqI, n_eqI))
    return tuple(bases)


def _mapped(mesh: Mesh, block: ElementBlock, points_q: np.ndarray) -> tuple[BlockBasis, np.ndarray]:
    """Basis at the points, with Jacobian determinants as ``dV``, and the Jacobians dX_I/ds_s (n_e, n_q, 2, 2)."""
    N_eqa, dN_seqa = _rational(mesh, block, points_q)
    P_eaI = mesh.P_AI[block.conn_ea]
    (J00, J10), (J01, J11) = (np.moveaxis(dN @ P_eaI, -1, 0) for dN in dN_seqa)
    det = J00 * J11 - J01 * J10
    if not np.all(det > 0):
        raise ValueError(
            f"element {int(np.argmin(det.min(1)))} is turned inside out: its smallest Jacobian is {det.min():.3g}"
        )
    (n_e, n_q, n_a), (dN_s, dN_t) = N_eqa.shape, dN_seqa
    dN_eqIa = np.empty((n_e, n_q, 2, n_a))
    dN_eqIa[:, :, 0] = (J11 / det)[..., None] * dN_s - (J10 / det)[..., None] * dN_t
    dN_eqIa[:, :, 1] = (J00 / det)[..., None] * dN_t - (J01 / det)[..., None] * dN_s
    J_eqIs = np.stack([J00, J01, J10, J11], -1).reshape(*det.shape, 2, 2)
    return BlockBasis(block.conn_ea, N_eqa, dN_eqIa, det, N_eqa @ P_eaI), J_eqIs


def _rational(
    mesh: Mesh, block: ElementBlock, points_q: np.ndarray
) -> tuple[np.ndarray, tuple[np.ndarray, np.ndarray]]:
    """R_a = w_a N_a / W (n_e, n_q, n_a) and its two parametric derivatives (quotient rule) of that shape."""
    (p, q), s, t = block.degrees, points_q[:, 0], points_q[:, 1]
    B_s, B_t = bernstein(p, s), bernstein(q, t)
    dB_s, dB_t = bernstein_derivative(p, s), bernstein_derivative(q, t)
    B_kqb = np.concatenate([tensor(B_s, B_t), tensor(dB_s, B_t), tensor(B_s, dB_t)])
    w_ea = mesh.w_A[block.conn_ea]
    wN_ekqa = (B_kqb @ block.C_eab.swapaxes(1, 2)).reshape(len(w_ea), 3, len(points_q), -1)
    wN, wdN_s, wdN_t = np.moveaxis(wN_ekqa * w_ea[:, None, None], 1, 0)
    if np.abs(w_ea[:, None] @ block.C_eab - 1.0).max() <= POLYNOMIAL:
        return wN, (wdN_s, wdN_t)
    W, W_s, W_t = (v.sum(-1, keepdims=True) for v in (wN, wdN_s, wdN_t))
    N = wN / W
    return N, ((wdN_s - N * W_s) / W, (wdN_t - N * W_t) / W)
