"""Element forces and stiffness of the solid, all elements at once."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields
from functools import cache

import numpy as np

from iga.elements.kinematics import pairs
from iga.elements.shape_functions import BlockBasis

#: Elements whose stiffness is computed together; intermediate arrays of so many stay in the cache.
BATCH = 64


def gradient(basis: BlockBasis, u_Ai: np.ndarray) -> np.ndarray:
    """Displacement gradient H_iIeq (d, d, n_e, n_q); components come first so that each is contiguous in memory."""
    H_eqIi = basis.dN_e_qI_a @ relative(basis.conn_ea, u_Ai)
    n_e, n_q, d, _ = basis.dN_eqIa.shape
    return np.ascontiguousarray(H_eqIi.reshape(n_e, n_q, d, d).transpose(3, 2, 0, 1))


def relative(conn_ea: np.ndarray, u_Ai: np.ndarray) -> np.ndarray:
    """Displacements (n_e, n_a, d) of an element's control points relative to those of its first one.

    The translation has no gradient, but its rounding would be multiplied by the stiffness of the element.
    """
    u_eai = u_Ai.take(conn_ea, axis=0)  # several times faster than u_Ai[conn_ea]
    return u_eai - u_eai[:, :1]


def element_forces(basis: BlockBasis, P_iIeq: np.ndarray) -> np.ndarray:
    """Internal forces ``f_eai = int P_iI dN_a/dX_I dV`` (n_e, n_a, d)."""
    n_e, n_q, d, _ = basis.dN_eqIa.shape
    PdV_eqIi = (P_iIeq * basis.dV_eq).transpose(2, 3, 1, 0)
    return basis.dN_e_qI_a.swapaxes(1, 2) @ PdV_eqIi.reshape(n_e, n_q * d, d)


def element_stiffness(basis: BlockBasis, A_eqIpJ: np.ndarray) -> np.ndarray:
    """Stiffness ``K_e(p)ab = int dN_a/dX_I A_IpJ dN_b/dX_J dV`` (n_e, n_a, n_p, n_a) for the `pairs` p.

    One matrix product per element; the block (1, 0) is the transpose of (0, 1).
    """
    n_e, n_q, d, n_a = basis.dN_eqIa.shape
    n_p = A_eqIpJ.shape[3]
    AdV_eqIpJ = A_eqIpJ * basis.dV_eq[:, :, None, None, None]
    AdN = AdV_eqIpJ.reshape(n_e, n_q, d * n_p, d) @ basis.dN_eqIa
    K = basis.dN_e_qI_a.swapaxes(1, 2) @ AdN.reshape(n_e, n_q * d, n_p * n_a)
    return K.reshape(n_e, n_a, n_p, n_a)


def stiffness_of_batches(
    solid: Solid, moduli: Callable[[np.ndarray, np.ndarray], np.ndarray], H_iIeq: np.ndarray | None = None
) -> Iterator[tuple[slice, np.ndarray]]:
    """The elements of each of the `batches` of a solid and their stiffness (n_e, n_a, n_p, n_a).

    ``moduli`` are those of a `Kinematics`; without displacement gradients H (d, d, n_e, n_q) the solid is undeformed.
    """
    for e in batches(len(solid.basis.dV_eq)):
        basis = solid.basis.of(e)
        H = np.zeros((basis.d, basis.d, *basis.dV_eq.shape)) if H_iIeq is None else H_iIeq[:, :, e]
        yield e, element_stiffness(basis, moduli(solid.D, H))


def batches(n_e: int) -> list[slice]:
    """Slices of elements of size `BATCH`: results of one are used before those of the next are computed."""
    return [slice(first, first + BATCH) for first in range(0, n_e, BATCH)]


def stiffness_entries(conn_ea: np.ndarray, d: int = 2) -> tuple[np.ndarray, np.ndarray]:
    """Rows and columns (n_e, n_a, n, n_a) of all entries: the `pairs`, then the transposed blocks of different ones."""
    i, j = np.array([*pairs(d), *((i, j) for i, j in pairs(d) if i != j)]).T
    row = d * conn_ea[:, :, None, None] + i[:, None]
    column = d * conn_ea[:, None, None, :] + j[:, None]
    row, column = np.broadcast_arrays(row, column)
    transposed = np.arange(len(i))[:, None] >= len(pairs(d))
    return np.where(transposed, column, row), np.where(transposed, row, column)


@cache
def half_places(n_a: int, d: int) -> np.ndarray:
    """Indices in the (n_a, n_p, n_a) entries of an element of one triangle of its symmetric matrix."""
    a, p, b = np.indices((n_a, len(pairs(d)), n_a))
    return np.flatnonzero(np.array([i != j for i, j in pairs(d)])[p] | (a >= b))


def half_entries(conn_ea: np.ndarray, d: int) -> tuple[np.ndarray, np.ndarray]:
    """Rows and columns (n_e, n_h) of the entries of `half_places`, on either side of the diagonal."""
    (n_e, n_a), n_p = conn_ea.shape, len(pairs(d))
    rows, columns = (v[:, :, :n_p].reshape(n_e, -1)[:, half_places(n_a, d)] for v in stiffness_entries(conn_ea, d))
    return rows, columns


def full_matrices(K_eapb: np.ndarray) -> np.ndarray:
    """Element matrices (n_e, d n_a, d n_a) over degrees of freedom d a + i."""
    n_e, n_a, n_p, _ = K_eapb.shape
    d = 2 if n_p == 3 else 3
    K = np.empty((n_e, n_a, d, n_a, d))
    for p, (i, j) in enumerate(pairs(d)):
        K[:, :, i, :, j] = K_eapb[:, :, p]
        if i != j:
            K[:, :, j, :, i] = K_eapb[:, :, p].swapaxes(1, 2)
    return K.reshape(n_e, d * n_a, d * n_a)


def energy(basis: BlockBasis, W_eq: np.ndarray) -> float:
    """Integral of an energy density (n_e, n_q) over the bulk."""
    return float(np.sum(W_eq * basis.dV_eq))


@dataclass(frozen=True)
class Solid:
    """One block of elements with one material: basis at the quadrature points and elasticity matrix D."""

    basis: BlockBasis
    D: np.ndarray


def joined(solids: list[Solid]) -> tuple[Solid, ...]:
    """Blocks of one shape and one material taken together: fewer and longer array operations."""
    groups: dict[tuple, list[Solid]] = {}
    for solid in solids:
        groups.setdefault((solid.basis.N_eqa.shape[1:], solid.D.tobytes()), []).append(solid)
    return tuple(
        Solid(
            BlockBasis(*(np.concatenate([getattr(s.basis, f.name) for s in group]) for f in fields(BlockBasis))),
            group[0].D,
        )
        for group in groups.values()
    )
