"""Elasticity matrices with engineering shear, Voigt order (11, 22, 12), of a solid (11, 22, 33, 23, 13, 12)."""

from __future__ import annotations

from functools import cache

import numpy as np


@cache
def orthotropic(E1: float, E2: float, G12: float, nu12: float, plane: str, nu23: float | None = None) -> np.ndarray:
    """Elasticity matrix D (3, 3), axis 1 along X.

    Plane stress inverts the in-plane compliance. Plane strain takes the in-plane block of the inverted 3-D compliance,
    whose third direction is like the second (E3 = E2, nu13 = nu12, nu23 = nu12 where it is left out). With E1 = E2
    and G12 = E / (2 (1 + nu)) both are the isotropic matrices (Jones 1999, eqs. 2.15 and 2.60).

    Raises
    ------
    ValueError : ``plane`` is neither "stress" nor "strain", or the matrix is not positive definite.
    """
    S = np.zeros((4, 4))  # 11, 22, 33, 12
    S[0, 0], S[1, 1], S[2, 2], S[3, 3] = 1 / E1, 1 / E2, 1 / E2, 1 / G12
    S[0, 1] = S[1, 0] = S[0, 2] = S[2, 0] = -nu12 / E1
    S[1, 2] = S[2, 1] = -(nu12 if nu23 is None else nu23) / E2
    inside = [0, 1, 3]
    if plane == "stress":
        D = np.linalg.inv(S[np.ix_(inside, inside)])
    elif plane == "strain":
        D = np.linalg.inv(S)[np.ix_(inside, inside)]
    else:
        raise ValueError(f'plane must be "stress" or "strain", got {plane!r}')
    if not np.all(np.linalg.eigvalsh(D) > 0):
        raise ValueError(f"the elastic constants E1={E1}, E2={E2}, G12={G12}, nu12={nu12} store negative energy")
    D = 0.5 * (D + D.T)
    D.flags.writeable = False  # cached: all callers share this array
    return D


def isotropic(young: float, poisson: float, plane: str) -> np.ndarray:
    """Elasticity matrix D (3, 3) of an isotropic solid; raises as `orthotropic` does."""
    return orthotropic(young, young, young / (2.0 * (1.0 + poisson)), poisson, plane)


@cache
def solid(E: tuple[float, ...], nu: tuple[float, ...], G: tuple[float, ...]) -> np.ndarray:
    """Elasticity matrix D (6, 6) by (E1, E2, E3), (nu12, nu13, nu23) and (G23, G13, G12) (Jones 1999, eq. 2.15).

    Raises
    ------
    ValueError : it is not positive definite.
    """
    S = np.diag([1.0 / value for value in (*E, *G)])
    for (i, j), contraction in zip(((0, 1), (0, 2), (1, 2)), nu, strict=True):
        S[i, j] = S[j, i] = -contraction / E[i]
    D = np.linalg.inv(S)
    if not np.all(np.linalg.eigvalsh(0.5 * (D + D.T)) > 0):
        raise ValueError(f"the elastic constants E={E}, nu={nu}, G={G} store negative energy")
    D = 0.5 * (D + D.T)
    D.flags.writeable = False
    return D
