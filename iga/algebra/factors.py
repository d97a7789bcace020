"""The inverse of a tangent by its factors, with the displacements under the unit load.

After the peak of the load a specimen is stable under a prescribed opening, but not under a prescribed load. So a
tangent K is factorised together with a spring of stiffness ``hold`` across the opening,

    K + hold r r' ,      K^-1 b = x + hold (r'x) K^-1 r      with  (K + hold r r') x = b,

where r is the load f, or its part in one place (Sherman and Morrison 1950). Except at a snap-back this matrix is
positive definite, and Cholesky factorises it.
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
    """Inverse by Cholesky; None where the matrix is not positive definite.

    ``half`` (size,) is the lower half of the matrix including the spring; the factor overwrites it. ``rows_d`` are the
    load and the row (n_dof,) of the spring.
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
    """Inverse by LU; None where the matrix is exactly singular."""
    factors = band.lu(half, skew)
    return None if factors is None else Inverse(factors, factors.solve(load_d[:, None])[:, 0])


def condition(band: Band | Dense, half: np.ndarray, skew: Skew | None, inverse: Inverse) -> float:
    """Condition number in the 1-norm of the matrix with this lower half and skew part, given its ``inverse``.

    The norm of the inverse is estimated from below by a few solutions (Hager 1984), mostly within a factor of two. More
    columns (Higham and Tisseur 2000) would start from random vectors, and results would differ from run to run.
    """
    n_dof = inverse.under_load_d.size

    def solved(b: np.ndarray) -> np.ndarray:
        return inverse.solve(b.reshape(n_dof, -1)).reshape(b.shape)

    def transposed(b: np.ndarray) -> np.ndarray:
        if not isinstance(inverse.factors, BandLU | DenseLU):
            return solved(b)  # Cholesky: the matrix is symmetric
        return inverse.factors.solve(b.reshape(n_dof, -1), transposed=True).reshape(b.shape)

    operator = LinearOperator((n_dof, n_dof), matvec=solved, rmatvec=transposed, dtype=float)
    return float(np.max(band.columns(half, skew))) * float(onenormest(operator, t=1))


@dataclass(frozen=True)
class Bordered:
    """Equilibrium ``K du = b + f d_load`` closed by one equation, ``a . du + a_load d_load = c``.

    ``a_d`` (n_dof,) is the gradient of the control, ``grip`` its change under a unit load.
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
    """The bordered system of a control; None where the control does not change with the load."""
    grip = float(a_d @ inverse.under_load_d) + a_load
    return None if grip == 0.0 else Bordered(inverse, a_d, grip)
