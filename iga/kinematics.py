"""From displacement gradient to first Piola-Kirchhoff stress, its tangent, and stored energy, for every point at once.

Both kinematics speak the same language, so that one assembler serves them: ``P_iI = dW/dH_iI`` and ``A_iIjJ = dP_iI/dH_jJ``.
"""

from __future__ import annotations

import numpy as np

VOIGT = ((0, 2), (2, 1))


def elasticity_tensor(D: np.ndarray) -> np.ndarray:
    """D (3, 3) in Voigt order as a tensor C_IJKL (2, 2, 2, 2) with its minor symmetries."""
    v = np.array(VOIGT)
    return D[v[:, :, None, None], v[None, None]]


def finite_strain(D: np.ndarray, H_qiI: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """St. Venant-Kirchhoff, total Lagrangian: ``E = (F'F - 1)/2``, ``S = D:E``, ``P = F S`` (Bonet and Wood 2008, sec. 6.4).

    Parameters
    ----------
    D : (3, 3) elasticity matrix [stress].
    H_qiI : (..., 2, 2) displacement gradient.

    Returns
    -------
    P_qiI : (..., 2, 2) first Piola-Kirchhoff stress.
    A_qiIjJ : (..., 2, 2, 2, 2) its derivative, ``A_iIjJ = delta_ij S_IJ + F_iK C_KILJ F_jL``.
    W_q : (...,) stored energy per reference volume.
    """
    F = H_qiI + np.eye(2)
    S, W = _svk(D, F, H_qiI)
    P = F @ S
    A = np.einsum("...iK,KILJ,...jL->...iIjJ", F, elasticity_tensor(D), F, optimize=["einsum_path", (0, 1), (0, 1)])
    A[..., 0, :, 0, :] += S
    A[..., 1, :, 1, :] += S
    return P, A, W


def small_strain(D: np.ndarray, H_qiI: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Linear kinematics: the same with E replaced by the symmetric gradient and no geometric stiffness."""
    C = elasticity_tensor(D)
    P = np.einsum("iIjJ,...jJ->...iI", C, H_qiI)
    A = np.broadcast_to(C, H_qiI.shape[:-2] + C.shape)
    return P, A, 0.5 * np.sum(P * H_qiI, axis=(-1, -2))


def cauchy_stress(D: np.ndarray, H_qiI: np.ndarray, kinematics: str) -> np.ndarray:
    """Cauchy stress (..., 2, 2): ``F S F' / det F``, or the linear stress."""
    if kinematics == "linear":
        return small_strain(D, H_qiI)[0]
    F = H_qiI + np.eye(2)
    S, _ = _svk(D, F, H_qiI)
    return F @ S @ F.swapaxes(-1, -2) / np.linalg.det(F)[..., None, None]


def _svk(D: np.ndarray, F: np.ndarray, H: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Second Piola-Kirchhoff stress and energy; E is formed from H, which keeps its digits where F is close to one."""
    E = 0.5 * (H + H.swapaxes(-1, -2) + H.swapaxes(-1, -2) @ H)
    E_v = np.stack([E[..., 0, 0], E[..., 1, 1], 2.0 * E[..., 0, 1]], -1)
    S_v = E_v @ D
    S = S_v[..., np.array(VOIGT)]
    return S, 0.5 * np.sum(S_v * E_v, -1)


KINEMATICS = {"finite": finite_strain, "linear": small_strain}
