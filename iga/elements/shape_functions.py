"""Rational basis functions, their gradients and volumes at points of the elements, all elements at once."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property, reduce

import numpy as np

from iga.mesh.bernstein import bernstein, bernstein_derivative, tensor
from iga.mesh.extraction import SIDES, Chain, ElementBlock, Mesh

#: Deviation of all Bezier weights from 1 below which an element is polynomial, and not divided by the weight.
POLYNOMIAL = 1e-13


@dataclass(frozen=True)
class BlockBasis:
    """Basis of one block of elements at the same parametric points of each.

    ``N_eqa`` (n_e, n_q, n_a), ``dN_eqIa`` (n_e, n_q, d, n_a) reference gradients, ``dV_eq`` (n_e, n_q) volume of each
    point, ``X_eqI`` (n_e, n_q, d) reference positions, ``conn_ea`` (n_e, n_a) control points; d directions.
    """

    conn_ea: np.ndarray
    N_eqa: np.ndarray
    dN_eqIa: np.ndarray
    dV_eq: np.ndarray
    X_eqI: np.ndarray

    @cached_property
    def d(self) -> int:
        """Number of directions."""
        return self.dN_eqIa.shape[2]

    @cached_property
    def dN_e_qI_a(self) -> np.ndarray:
        """Gradients (n_e, d n_q, n_a) as a factor of one matrix product an element."""
        n_e, n_q, d, n_a = self.dN_eqIa.shape
        return self.dN_eqIa.reshape(n_e, d * n_q, n_a)

    def of(self, e: slice) -> BlockBasis:
        """That of some of the elements, which shares the arrays."""
        return BlockBasis(self.conn_ea[e], self.N_eqa[e], self.dN_eqIa[e], self.dV_eq[e], self.X_eqI[e])


def block_basis(
    mesh: Mesh, block: ElementBlock, points_q: np.ndarray, weights_q: np.ndarray, width: float = 1.0
) -> BlockBasis:
    """Basis of a whole block at the points (n_q, d) of a rule on the unit square or cube; ``dV`` are areas or volumes
    times ``width``.

    Raises
    ------
    ValueError : an element whose Jacobian determinant is not positive somewhere.
    """
    basis, _ = _mapped(mesh, block, points_q)
    return replace(basis, dV_eq=basis.dV_eq * (weights_q * width))


@dataclass(frozen=True)
class SideBasis(BlockBasis):
    """Basis on sides of one name, with lengths or areas as ``dV_eq`` and unit outward normals ``n_eqI``."""

    n_eqI: np.ndarray


def chain_basis(mesh: Mesh, chain: Chain, points_q: np.ndarray, weights_q: np.ndarray) -> tuple[SideBasis, ...]:
    """Basis on the sides of a chain at the points (n_q,) of a rule on [0, 1], of a solid (n_q, 2).

    One entry for every block and name of a side in the chain; points run along the side's own parameter.
    """
    bases = []
    for here, number, side in chain.parts():
        (direction, value), block, e = SIDES[side], mesh.blocks[number], chain.element_c[here]
        within_q = np.insert(points_q.reshape(len(points_q), -1), direction, value, axis=1)
        part = ElementBlock(block.degrees, block.C_eab[e], block.conn_ea[e])
        basis, K_eqsI = _mapped(mesh, part, within_q)
        n_eqI = (1.0 if value else -1.0) * K_eqsI[..., direction, :]
        area_eq = np.linalg.norm(n_eqI, axis=-1)
        n_eqI = n_eqI / area_eq[..., None]
        bases.append(SideBasis(basis.conn_ea, basis.N_eqa, basis.dN_eqIa, area_eq * weights_q, basis.X_eqI, n_eqI))
    return tuple(bases)


def _mapped(mesh: Mesh, block: ElementBlock, points_q: np.ndarray) -> tuple[BlockBasis, np.ndarray]:
    """Basis at the points, with Jacobian determinants as ``dV``, and the cofactors (n_e, n_q, d, d) of the Jacobians
    ``J_Is = dX_I/ds_s``, so that ``ds_s/dX_I = K_sI / det``."""
    N_eqa, dN_seqa = _rational(mesh, block, points_q)
    P_eaI = mesh.P_AI[block.conn_ea]
    K_sI, det = _cofactors([np.moveaxis(dN @ P_eaI, -1, 0) for dN in dN_seqa])
    if not np.all(det > 0):
        raise ValueError(
            f"element {int(np.argmin(det.min(1)))} is turned inside out: its smallest Jacobian is {det.min():.3g}"
        )
    (n_e, n_q, n_a), d = N_eqa.shape, len(dN_seqa)
    dN_eqIa = np.empty((n_e, n_q, d, n_a))
    for j in range(d):
        np.multiply((K_sI[0][j] / det)[..., None], dN_seqa[0], out=dN_eqIa[:, :, j])
        for K_I, dN in zip(K_sI[1:], dN_seqa[1:], strict=True):
            dN_eqIa[:, :, j] += (K_I[j] / det)[..., None] * dN
    K_eqsI = np.stack([np.stack(K_I, -1) for K_I in K_sI], -2)
    return BlockBasis(block.conn_ea, N_eqa, dN_eqIa, det, N_eqa @ P_eaI), K_eqsI


def _cofactors(J_sI: list[np.ndarray]) -> tuple[list[list[np.ndarray]], np.ndarray]:
    """Cofactors and determinant of Jacobians, given by their columns dX/ds_s (d, ...)."""
    if len(J_sI) == 2:
        (J00, J10), (J01, J11) = J_sI
        K_sI = [[J11, -J01], [-J10, J00]]
    else:
        K_sI = [_crossed(J_sI[(s + 1) % 3], J_sI[(s + 2) % 3]) for s in range(3)]
    return K_sI, reduce(np.add, [a * b for a, b in zip(J_sI[0], K_sI[0], strict=True)])


def _crossed(a: np.ndarray, b: np.ndarray) -> list[np.ndarray]:
    return [a[i - 2] * b[i - 1] - a[i - 1] * b[i - 2] for i in range(3)]


def _rational(mesh: Mesh, block: ElementBlock, points_q: np.ndarray) -> tuple[np.ndarray, list[np.ndarray]]:
    """R_a = w_a N_a / W (n_e, n_q, n_a) and its parametric derivatives (quotient rule) of that shape."""
    each = list(zip(block.degrees, points_q.T, strict=True))
    B_s, dB_s = ([f(p, s) for p, s in each] for f in (bernstein, bernstein_derivative))
    varied = [B_s] + [[*B_s[:s], dB_s[s], *B_s[s + 1 :]] for s in range(len(each))]
    B_kqb = np.concatenate([reduce(tensor, factors) for factors in varied])
    w_ea = mesh.w_A[block.conn_ea]
    wN_ekqa = (B_kqb @ block.C_eab.swapaxes(1, 2)).reshape(len(w_ea), len(varied), len(points_q), -1)
    wN, *wdN_s = np.moveaxis(wN_ekqa * w_ea[:, None, None], 1, 0)
    if np.abs(w_ea[:, None] @ block.C_eab - 1.0).max() <= POLYNOMIAL:
        return wN, wdN_s
    W, *W_s = (v.sum(-1, keepdims=True) for v in (wN, *wdN_s))
    N = wN / W
    return N, [(wdN - N * dW) / W for wdN, dW in zip(wdN_s, W_s, strict=True)]
