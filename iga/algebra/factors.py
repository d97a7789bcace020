"""The inverse of a tangent, and the forces on which it has been tried: the unit load.

Under a given opening a specimen is stable where under a given load it is not: behind the peak. So a tangent K is
factorised together with a spring across the opening, of stiffness ``hold``,

    K + hold f f' ,      K^-1 b = x + hold (f'x) K^-1 f      with  (K + hold f f') x = b

(Sherman and Morrison 1950), which is positive definite, and Cholesky does it, but for snap-back.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from iga.algebra.banded import Band, BandCholesky, BandLU, Skew
from iga.algebra.dense import Dense, DenseCholesky, DenseLU


@dataclass(frozen=True)
class Inverse:
    """Factors of a tangent, with a spring ``hold`` across the opening; ``under_load_d`` (n_dof,) is K^-1 f."""

    factors: BandLU | BandCholesky | DenseLU | DenseCholesky
    load_d: np.ndarray
    under_load_d: np.ndarray
    hold: float = 0.0

    def solve(self, b_dm: np.ndarray) -> np.ndarray:
        """Displacements (n_dof, n_m) for forces (n_dof, n_m), zero where fixed."""
        x_dm = self.factors.solve(b_dm)
        return x_dm + self.under_load_d[:, None] * (self.hold * (self.load_d @ x_dm)) if self.hold else x_dm


def held_inverse(band: Band | Dense, half: np.ndarray, load_d: np.ndarray, hold: float) -> Inverse | None:
    """By Cholesky, where the matrix with the lower half (size,), the spring in it, is positive definite; else None."""
    factors = band.cholesky(half)
    if factors is None:
        return None
    z_d = factors.solve(load_d[:, None])[:, 0]
    free = 1.0 - hold * float(load_d @ z_d)
    return Inverse(factors, load_d, z_d / free, hold) if free != 0.0 else None


def inverse(band: Band | Dense, half: np.ndarray, skew: Skew | None, load_d: np.ndarray) -> Inverse | None:
    """By LU, of any matrix that is not exactly singular."""
    factors = band.lu(half, skew)
    return None if factors is None else Inverse(factors, load_d, factors.solve(load_d[:, None])[:, 0])


@dataclass(frozen=True)
class Bordered:
    """Equilibrium ``K du = b + f d_load`` closed by one equation, ``a . du + a_load d_load = c``.

    ``a_d`` (n_dof,) is the gradient of the control, ``grip`` what it feels of a unit load.
    """

    inverse: Inverse
    a_d: np.ndarray
    grip: float

    def solve(self, b_dm: np.ndarray, c: float = 0.0) -> np.ndarray:
        """Steps (n_dof + 1, n_m), the load last, for forces b_dm (n_dof, n_m)."""
        v_dm = self.inverse.solve(b_dm)
        d_load_m = (c - self.a_d @ v_dm) / self.grip
        return np.concatenate([v_dm + self.inverse.under_load_d[:, None] * d_load_m, d_load_m[None]])


def bordered(inverse: Inverse, a_d: np.ndarray, a_load: float) -> Bordered | None:
    """None where the control does not feel the load."""
    grip = float(a_d @ inverse.under_load_d) + a_load
    return None if grip == 0.0 else Bordered(inverse, a_d, grip)
