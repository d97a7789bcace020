"""The inverse of a tangent, and the forces on which it has been tried: the unit load.

Under a given opening a specimen is stable where under a given load it is not: behind the peak. So a tangent K is
factorised together with a spring across the opening, of stiffness ``hold``,

    K + hold r r' ,      K^-1 b = x + hold (r'x) K^-1 r      with  (K + hold r r') x = b,

where r is the load f itself, or its part in one place (Sherman and Morrison 1950), which is positive definite, and
Cholesky does it, but for snap-back.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.sparse.linalg import LinearOperator, onenormest

from iga.algebra.banded import Band, BandCholesky, BandLU, Skew
from iga.algebra.dense import Dense, DenseCholesky, DenseLU


class Hold(NamedTuple):
    """A spring on the displacement ``row_d @ u``, row_d (n_dof,), and K^-1 row_d."""

    stiffness: float
    row_d: np.ndarray
    under_d: np.ndarray


@dataclass(frozen=True)
class Inverse:
    """Factors of a tangent, with a spring ``hold``; ``under_load_d`` (n_dof,) is K^-1 f."""

    factors: BandLU | BandCholesky | DenseLU | DenseCholesky
    under_load_d: np.ndarray
    hold: Hold | None = None

    def solve(self, b_dm: np.ndarray) -> np.ndarray:
        """Displacements (n_dof, n_m) for forces (n_dof, n_m), zero where fixed."""
        x_dm, hold = self.factors.solve(b_dm), self.hold
        return x_dm if hold is None else x_dm + hold.under_d[:, None] * (hold.stiffness * (hold.row_d @ x_dm))


def held_inverse(
    band: Band | Dense, half: np.ndarray, rows_d: tuple[np.ndarray, np.ndarray], hold: float
) -> Inverse | None:
    """By Cholesky, where the matrix with the lower half (size,), the spring in it, is positive definite; else None.

    ``rows_d`` are the load and the row (n_dof,) of the spring. The factor takes the place of ``half``.
    """
    factors, (load_d, hold_d) = band.cholesky(half), rows_d
    if factors is None:
        return None
    z_d = factors.solve(hold_d[:, None])[:, 0]
    free = 1.0 - hold * float(hold_d @ z_d)
    if free == 0.0:
        return None
    found = Inverse(factors, z_d / free, Hold(hold, hold_d, z_d / free))
    if hold_d is load_d or np.array_equal(hold_d, load_d):
        return found
    return replace(found, under_load_d=found.solve(load_d[:, None])[:, 0])


def inverse(band: Band | Dense, half: np.ndarray, skew: Skew | None, load_d: np.ndarray) -> Inverse | None:
    """By LU, of any matrix that is not exactly singular."""
    factors = band.lu(half, skew)
    return None if factors is None else Inverse(factors, factors.solve(load_d[:, None])[:, 0])


def condition(band: Band | Dense, half: np.ndarray, skew: Skew | None, inverse: Inverse) -> float:
    """Condition number in the 1-norm of the matrix with this lower half and skew part, of which ``inverse`` is that.

    The norm of the inverse is estimated from below by a few solutions (Hager 1984), mostly within a factor of two. With
    more columns (Higham and Tisseur 2000) some of them would be random, and no run like another.
    """
    n_dof = inverse.under_load_d.size

    def solved(b: np.ndarray) -> np.ndarray:
        return inverse.solve(b.reshape(n_dof, -1)).reshape(b.shape)

    def transposed(b: np.ndarray) -> np.ndarray:
        if not isinstance(inverse.factors, BandLU | DenseLU):
            return solved(b)  # Cholesky: of a symmetric matrix
        return inverse.factors.solve(b.reshape(n_dof, -1), transposed=True).reshape(b.shape)

    operator = LinearOperator((n_dof, n_dof), matvec=solved, rmatvec=transposed, dtype=float)
    return float(np.max(band.columns(half, skew))) * float(onenormest(operator, t=1))


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
