"""First Piola-Kirchhoff stress, its tangent and the stored energy by the displacement gradient, at all points at once.

Both kinematics have the same interface, so that one assembler serves them: ``P_iI = dW/dH_iI`` and ``A_iIjJ =
dP_iI/dH_jJ``. Components are the first axes of all arrays, so that each operation runs through memory in order. In the
moduli alone they are the last axes, since these are factors of many small products: ``A_IpJ`` for the `PAIRS` p.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from itertools import product

import numpy as np

#: Pairs (i, j) of displacement components whose moduli are stored; those of (1, 0) are the transpose of (0, 1).
PAIRS = ((0, 0), (0, 1), (1, 1))
#: Voigt number of the components (I, J) of a symmetric tensor, order 11, 22, 12.
VOIGT = ((0, 2), (2, 1))


def elasticity_tensor(D: np.ndarray) -> np.ndarray:
    """D (3, 3) in Voigt order as a tensor C_IJKL (2, 2, 2, 2) with its minor symmetries."""
    v = np.array(VOIGT)
    return D[v[:, :, None, None], v[None, None]]


@dataclass(frozen=True)
class Kinematics:
    """Functions of an elasticity matrix D (3, 3) [stress] and a displacement gradient H_iI (2, 2, ...).

    ``linear``: stresses are proportional to H. ``stress`` returns P (2, 2, ...) and the stored energy per reference
    volume W (...,), ``moduli`` A (..., 2, 3, 2), ``cauchy`` the Cauchy stress (2, 2, ...). ``material`` returns the
    second Piola-Kirchhoff stress over det F (2, 2, ...) of a Cauchy stress and H.
    """

    linear: bool
    stress: Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]
    moduli: Callable[[np.ndarray, np.ndarray], np.ndarray]
    cauchy: Callable[[np.ndarray, np.ndarray], np.ndarray]
    material: Callable[[np.ndarray, np.ndarray], np.ndarray]


def finite_stress(D: np.ndarray, H: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """St. Venant-Kirchhoff solid, total Lagrangian (Bonet and Wood 2008, sec. 6.4).

    ``E = (F'F - 1)/2``, ``S = D:E``, ``P = F S``.
    """
    F, P = _deformation(H), np.empty_like(H)
    S_v, W = _svk(D, H)
    for i, I in product(range(2), repeat=2):
        P[i, I] = F[i, 0] * S_v[VOIGT[0][I]] + F[i, 1] * S_v[VOIGT[1][I]]
    return P, W


def finite_moduli(D: np.ndarray, H: np.ndarray) -> np.ndarray:
    """``A_iIjJ = delta_ij S_IJ + F_iK C_IKJL F_jL``, by one matrix product from S and the products of F."""
    F, parts = _deformation(H), np.empty((15, *H.shape[2:]))
    for n, (i, j) in enumerate(PAIRS):
        np.multiply(F[i, :, None], F[j], out=parts[4 * n : 4 * n + 4].reshape(2, 2, *H.shape[2:]))
    parts[12:] = _svk(D, H)[0]
    A = parts.reshape(15, -1).T @ _moduli_of_parts(D.tobytes())
    return A.reshape(*H.shape[2:], 2, 3, 2)


def small_stress(D: np.ndarray, H: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Linear kinematics: E is the symmetric gradient, ``P = D:E``."""
    E_v = np.empty((3, *H.shape[2:]))
    E_v[0], E_v[1], E_v[2] = H[0, 0], H[1, 1], H[0, 1] + H[1, 0]
    S_v = (D @ E_v.reshape(3, -1)).reshape(E_v.shape)
    return S_v[np.array(VOIGT)], 0.5 * (S_v * E_v).sum(0)


def small_moduli(D: np.ndarray, H: np.ndarray) -> np.ndarray:
    """The elasticity tensor at every point."""
    return np.broadcast_to(of_pairs(elasticity_tensor(D)), (*H.shape[2:], 2, 3, 2))


def of_pairs(A_iIjJ: np.ndarray) -> np.ndarray:
    """``A_IpJ`` (2, 3, 2) of moduli (2, 2, 2, 2)."""
    i, j = np.array(PAIRS).T
    return A_iIjJ[i, :, j].swapaxes(0, 1)


def finite_cauchy(D: np.ndarray, H: np.ndarray) -> np.ndarray:
    """``sigma = F S F' / det F``."""
    F, (S_v, _) = _deformation(H), _svk(D, H)
    det = F[0, 0] * F[1, 1] - F[0, 1] * F[1, 0]
    return np.einsum("iI...,IJ...,jJ...->ij...", F, S_v[np.array(VOIGT)], F) / det


def finite_material(sigma: np.ndarray, H: np.ndarray) -> np.ndarray:
    """``S / det F = F^-1 sigma F^-T``."""
    inverse = np.linalg.inv(np.moveaxis(_deformation(H), (0, 1), (-2, -1)))
    return np.einsum("...Ii,ij...,...Jj->IJ...", inverse, sigma, inverse)


def _deformation(H: np.ndarray) -> np.ndarray:
    F = H.copy()
    F[0, 0] += 1.0
    F[1, 1] += 1.0
    return F


def _svk(D: np.ndarray, H: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Second Piola-Kirchhoff stress (3, ...) and energy; E from H directly, since F'F - 1 cancels near F = 1."""
    E_v = np.empty((3, *H.shape[2:]))
    E_v[0] = H[0, 0] + 0.5 * (H[0, 0] ** 2 + H[1, 0] ** 2)
    E_v[1] = H[1, 1] + 0.5 * (H[0, 1] ** 2 + H[1, 1] ** 2)
    E_v[2] = H[0, 1] + H[1, 0] + H[0, 0] * H[0, 1] + H[1, 0] * H[1, 1]
    S_v = (D @ E_v.reshape(3, -1)).reshape(E_v.shape)
    return S_v, 0.5 * (S_v * E_v).sum(0)


@cache
def _moduli_of_parts(D: bytes) -> np.ndarray:
    """Coefficients (15, 12) of ``A_IpJ`` in the products ``F_iK F_jL`` of the `PAIRS` (3, K, L), and in S_v.

    ``D`` are the bytes of the elasticity matrix (3, 3): every tangent asks for the same few of them.
    """
    C_IKJL, pairs = elasticity_tensor(np.frombuffer(D).reshape(3, 3)), np.eye(3)
    of_products = np.einsum("IKJL,po->pKLIoJ", C_IKJL, pairs).reshape(12, 12)
    same = np.array([i == j for i, j in PAIRS], dtype=float)
    of_stress = np.einsum("vIJ,p->vIpJ", np.eye(3)[:, np.array(VOIGT)], same).reshape(3, 12)
    return np.concatenate([of_products, of_stress])


FINITE = Kinematics(False, finite_stress, finite_moduli, finite_cauchy, finite_material)
# linear kinematics has one stress
LINEAR = Kinematics(True, small_stress, small_moduli, lambda D, H: small_stress(D, H)[0], lambda sigma, _: sigma)
KINEMATICS = {"finite": FINITE, "linear": LINEAR}
