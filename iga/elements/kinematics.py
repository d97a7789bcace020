"""First Piola-Kirchhoff stress, its tangent and the stored energy by the displacement gradient, at all points at once.

Both kinematics have the same interface, so that one assembler serves them: ``P_iI = dW/dH_iI`` and ``A_iIjJ =
dP_iI/dH_jJ``. Components are the first axes of all arrays, so that each operation runs through memory in order. In the
moduli alone they are the last axes, since these are factors of many small products: ``A_IpJ`` for the `PAIRS` p.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from itertools import combinations_with_replacement, product

import numpy as np


@cache
def pairs(d: int) -> tuple[tuple[int, int], ...]:
    """Pairs (i, j) of d displacement components whose moduli are stored; those of (j, i) are the transpose."""
    return tuple(combinations_with_replacement(range(d), 2))


#: Pairs of the plane.
PAIRS = pairs(2)
#: Voigt number of the components (I, J) of a symmetric tensor by the number of directions, order 11, 22, 12, or 11, 22,
#: 33, 23, 13, 12.
VOIGT = {2: ((0, 2), (2, 1)), 3: ((0, 5, 4), (5, 1, 3), (4, 3, 2))}


def elasticity_tensor(D: np.ndarray) -> np.ndarray:
    """D in Voigt order, (3, 3) or (6, 6), as a tensor C_IJKL with its minor symmetries."""
    v = np.array(VOIGT[2 if len(D) == 3 else 3])
    return D[v[:, :, None, None], v[None, None]]


@dataclass(frozen=True)
class Kinematics:
    """Functions of an elasticity matrix D, (3, 3) or (6, 6), [stress] and a displacement gradient H_iI (d, d, ...).

    ``linear``: stresses are proportional to H. ``stress`` returns P (d, d, ...) and the stored energy per reference
    volume W (...,), ``moduli`` A (..., d, n_p, d) for the `pairs`, ``cauchy`` the Cauchy stress (d, d, ...).
    ``material`` returns the second Piola-Kirchhoff stress over det F (d, d, ...) of a Cauchy stress and H.
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
    F, P, v = _deformation(H), np.empty_like(H), VOIGT[len(H)]
    S_v, W = _svk(D, H)
    for i, I in product(range(len(H)), repeat=2):
        P[i, I] = F[i, 0] * S_v[v[0][I]] + F[i, 1] * S_v[v[1][I]]
        if len(H) == 3:
            P[i, I] += F[i, 2] * S_v[v[2][I]]
    return P, W


def finite_moduli(D: np.ndarray, H: np.ndarray) -> np.ndarray:
    """``A_iIjJ = delta_ij S_IJ + F_iK C_IKJL F_jL``, by one matrix product from S and the products of F."""
    F, d, coefficients = _deformation(H), len(H), _moduli_of_parts(D.tobytes())
    parts = np.empty((len(coefficients), *H.shape[2:]))
    for n, (i, j) in enumerate(pairs(d)):
        np.multiply(F[i, :, None], F[j], out=parts[d * d * n : d * d * (n + 1)].reshape(H.shape))
    parts[len(coefficients) - len(D) :] = _svk(D, H)[0]
    A = parts.reshape(len(coefficients), -1).T @ coefficients
    return A.reshape(*H.shape[2:], d, len(D), d)


def small_stress(D: np.ndarray, H: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Linear kinematics: E is the symmetric gradient, ``P = D:E``."""
    E_v = np.empty((len(D), *H.shape[2:]))
    for I, J in pairs(len(H)):
        E_v[VOIGT[len(H)][I][J]] = H[I, I] if I == J else H[I, J] + H[J, I]
    S_v = (D @ E_v.reshape(len(D), -1)).reshape(E_v.shape)
    return S_v[np.array(VOIGT[len(H)])], 0.5 * (S_v * E_v).sum(0)


def small_moduli(D: np.ndarray, H: np.ndarray) -> np.ndarray:
    """The elasticity tensor at every point."""
    return np.broadcast_to(of_pairs(elasticity_tensor(D)), (*H.shape[2:], len(H), len(D), len(H)))


def of_pairs(A_iIjJ: np.ndarray) -> np.ndarray:
    """``A_IpJ`` (d, n_p, d) of moduli (d, d, d, d)."""
    i, j = np.array(pairs(len(A_iIjJ))).T
    return A_iIjJ[i, :, j].swapaxes(0, 1)


def finite_cauchy(D: np.ndarray, H: np.ndarray) -> np.ndarray:
    """``sigma = F S F' / det F``."""
    F, (S_v, _) = _deformation(H), _svk(D, H)
    det = F[0, 0] * F[1, 1] - F[0, 1] * F[1, 0] if len(F) == 2 else np.linalg.det(np.moveaxis(F, (0, 1), (-2, -1)))
    return np.einsum("iI...,IJ...,jJ...->ij...", F, S_v[np.array(VOIGT[len(F)])], F) / det


def finite_material(sigma: np.ndarray, H: np.ndarray) -> np.ndarray:
    """``S / det F = F^-1 sigma F^-T``."""
    inverse = np.linalg.inv(np.moveaxis(_deformation(H), (0, 1), (-2, -1)))
    return np.einsum("...Ii,ij...,...Jj->IJ...", inverse, sigma, inverse)


def _deformation(H: np.ndarray) -> np.ndarray:
    F = H.copy()
    for i in range(len(F)):
        F[i, i] += 1.0
    return F


def _svk(D: np.ndarray, H: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Second Piola-Kirchhoff stress (n_v, ...) and energy; E from H directly, since F'F - 1 cancels near F = 1."""
    E_v, v = np.empty((len(D), *H.shape[2:])), VOIGT[len(H)]
    for I, J in pairs(len(H)):
        products = H[0, I] * H[0, J] + H[1, I] * H[1, J] if I == J else H[I, J] + H[J, I] + H[0, I] * H[0, J]
        for k in range(2 if I == J else 1, len(H)):
            products += H[k, I] * H[k, J]
        E_v[v[I][J]] = H[I, I] + 0.5 * products if I == J else products
    S_v = (D @ E_v.reshape(len(D), -1)).reshape(E_v.shape)
    return S_v, 0.5 * (S_v * E_v).sum(0)


@cache
def _moduli_of_parts(D: bytes) -> np.ndarray:
    """Coefficients of ``A_IpJ`` in the products ``F_iK F_jL`` of the `pairs` (n_p, K, L), and in S_v: (15, 12) in the
    plane, (60, 54) in a solid.

    ``D`` are the bytes of the elasticity matrix: every tangent asks for the same few of them.
    """
    d = 2 if len(D) == np.dtype(float).itemsize * 9 else 3
    n_v = len(pairs(d))
    C_IKJL, each = elasticity_tensor(np.frombuffer(D).reshape(n_v, n_v)), np.eye(n_v)
    of_products = np.einsum("IKJL,po->pKLIoJ", C_IKJL, each).reshape(n_v * d * d, d * n_v * d)
    same = np.array([i == j for i, j in pairs(d)], dtype=float)
    of_stress = np.einsum("vIJ,p->vIpJ", each[:, np.array(VOIGT[d])], same).reshape(n_v, d * n_v * d)
    return np.concatenate([of_products, of_stress])


FINITE = Kinematics(False, finite_stress, finite_moduli, finite_cauchy, finite_material)
# linear kinematics has one stress
LINEAR = Kinematics(True, small_stress, small_moduli, lambda D, H: small_stress(D, H)[0], lambda sigma, _: sigma)
KINEMATICS = {"finite": FINITE, "linear": LINEAR}
