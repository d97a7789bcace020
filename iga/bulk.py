"""Element forces and stiffness of the solid, all elements at once."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from iga.basis import BlockBasis

Stress = Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray, np.ndarray]]


def gradient(basis: BlockBasis, u_Ai: np.ndarray) -> np.ndarray:
    """Displacement gradient H_eqiI (n_e, n_q, 2, 2)."""
    n_e, n_q, n_a, _ = basis.dN_eqaI.shape
    dN_eqIa = basis.dN_eqaI.swapaxes(2, 3).reshape(n_e, n_q * 2, n_a)
    return (dN_eqIa @ u_Ai[basis.conn_ea]).reshape(n_e, n_q, 2, 2).swapaxes(2, 3)


def element_forces(basis: BlockBasis, P_eqiI: np.ndarray, width: float) -> np.ndarray:
    """Internal forces ``f_eai = int P_iI dN_a/dX_I dV`` (n_e, n_a, 2)."""
    n_e, n_q, n_a, _ = basis.dN_eqaI.shape
    P = (P_eqiI * (width * basis.dV_eq)[..., None, None]).swapaxes(2, 3).reshape(n_e, n_q * 2, 2)
    return _dN_ea_qI(basis) @ P


def element_stiffness(basis: BlockBasis, A_eqiIjJ: np.ndarray, width: float) -> np.ndarray:
    """Stiffness ``K_eaibj = int dN_a/dX_I A_iIjJ dN_b/dX_J dV`` as (n_e, 2 n_a, 2 n_a), symmetric.

    One batched matrix product for each of the three pairs (i, j) with i <= j.
    """
    n_e, n_q, n_a, _ = basis.dN_eqaI.shape
    dN_a, dN_eqJb = _dN_ea_qI(basis), np.ascontiguousarray(basis.dN_eqaI.swapaxes(2, 3))
    A = A_eqiIjJ * (width * basis.dV_eq)[..., None, None, None, None]
    K = np.empty((n_e, n_a, 2, n_a, 2))
    for i, j in ((0, 0), (0, 1), (1, 1)):
        AdN = A[:, :, i, :, j, 0, None] * dN_eqJb[:, :, None, 0] + A[:, :, i, :, j, 1, None] * dN_eqJb[:, :, None, 1]
        K[:, :, i, :, j] = dN_a @ AdN.reshape(n_e, n_q * 2, n_a)
    K[:, :, 1, :, 0] = K[:, :, 0, :, 1].swapaxes(1, 2)
    return K.reshape(n_e, 2 * n_a, 2 * n_a)


def energy(basis: BlockBasis, W_eq: np.ndarray, width: float) -> float:
    return float(np.sum(W_eq * basis.dV_eq) * width)


def _dN_ea_qI(basis: BlockBasis) -> np.ndarray:
    n_e, n_q, n_a, _ = basis.dN_eqaI.shape
    return basis.dN_eqaI.transpose(0, 2, 1, 3).reshape(n_e, n_a, n_q * 2)
