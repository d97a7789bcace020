"""Dense direct solvers, for the few unknowns of a condensed system."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg.lapack import dgetrf, dgetrs, dpotrf, dpotrs

from iga.algebra.banded import Skew


@dataclass(frozen=True)
class Dense:
    """A full symmetric matrix of ``n`` equations, numbered as the unknowns are; the counterpart of
    `iga.algebra.banded.Band`.

    Matrices are given by their lower half, in Fortran order; the upper one is not read.
    """

    n: int

    @property
    def k(self) -> int:
        """Half bandwidth."""
        return self.n - 1

    @property
    def size(self) -> int:
        """Entries of the matrix."""
        return self.n**2

    def positions(self, row: np.ndarray, column: np.ndarray) -> np.ndarray:
        """Index of each entry (row, column), or of its mirror image, in the lower half."""
        return np.maximum(row, column) + self.n * np.minimum(row, column)

    def reaching(self, groups: np.ndarray) -> Dense:
        """Itself: it has room for all entries."""
        return self

    def cholesky(self, half: np.ndarray) -> DenseCholesky | None:
        """Factor of the matrix with this lower half (``size``,); None where it is not positive definite.

        The factor takes the place of ``half``.
        """
        factor, info = dpotrf(half.reshape(self.n, self.n).T, lower=True, clean=False, overwrite_a=True)
        return DenseCholesky(factor) if info == 0 else None

    def lu(self, half: np.ndarray, skew: Skew | None = None) -> DenseLU | None:
        """LU of the matrix with this lower half and a skew part; None where a pivot is exactly zero."""
        lu, pivots, info = dgetrf(self._whole(half, skew), overwrite_a=True)
        return DenseLU(lu, pivots) if info == 0 else None

    def columns(self, half: np.ndarray, skew: Skew | None = None) -> np.ndarray:
        """Sum (n,) of the absolute entries of each column of the matrix that `lu` takes."""
        return np.abs(self._whole(half, skew)).sum(0)

    def _whole(self, half: np.ndarray, skew: Skew | None) -> np.ndarray:
        lower = np.tril(half.reshape(self.n, self.n).T)
        whole = np.asfortranarray(lower + np.tril(lower, -1).T)
        if skew is not None:
            np.add.at(whole, (skew.row, skew.column), skew.value)
        return whole


@dataclass(frozen=True)
class DenseCholesky:
    """Cholesky factor of a positive definite matrix."""

    factor: np.ndarray

    def solve(self, b_d: np.ndarray) -> np.ndarray:
        """Solution (n, n_rhs) for right-hand sides (n, n_rhs)."""
        x, info = dpotrs(self.factor, b_d, lower=True)
        if info != 0:
            raise ValueError(f"dpotrs refused its argument {-info}")
        return x


@dataclass(frozen=True)
class DenseLU:
    """LU factors with partial pivoting."""

    lu: np.ndarray
    pivots: np.ndarray

    def solve(self, b_d: np.ndarray, transposed: bool = False) -> np.ndarray:
        """Solution (n, n_rhs) for right-hand sides (n, n_rhs)."""
        x, info = dgetrs(self.lu, self.pivots, b_d, trans=transposed)
        if info != 0:
            raise ValueError(f"dgetrs refused its argument {-info}")
        return x
