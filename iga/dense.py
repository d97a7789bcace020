"""Dense direct solver, for the few unknowns that are left of a condensed system."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg.lapack import dgecon, dgetrf, dgetrs


@dataclass(frozen=True)
class Dense:
    """A full matrix of ``n`` equations, numbered as the unknowns are; the counterpart of `iga.banded.Band`."""

    n: int

    @property
    def size(self) -> int:
        """Entries of the matrix."""
        return self.n**2

    def positions(self, row: np.ndarray, column: np.ndarray) -> np.ndarray:
        """Index of each entry (row, column) in an array of entries (Fortran order)."""
        return row + self.n * column

    def reaching(self, row: np.ndarray, column: np.ndarray) -> Dense:
        """Itself: it has room for all entries."""
        return self

    def factor(self, values: np.ndarray) -> DenseLU | None:
        """LU of the entries (``size``,), which it overwrites; None where a pivot is exactly zero."""
        lu, pivots, info = dgetrf(values.reshape(self.n, self.n).T, overwrite_a=True)
        return DenseLU(lu, pivots) if info == 0 else None

    def condition(self, values: np.ndarray) -> float:
        """Estimate of the condition number in the 1-norm, infinite where the matrix is singular; overwrites it."""
        norm = float(np.abs(values.reshape(self.n, self.n)).sum(1).max())
        factors = self.factor(values)
        reciprocal = 0.0 if factors is None else float(dgecon(factors.lu, norm)[0])
        return 1.0 / reciprocal if reciprocal > 0.0 else float("inf")


@dataclass(frozen=True)
class DenseLU:
    """LU factors with partial pivoting."""

    lu: np.ndarray
    pivots: np.ndarray

    def solve(self, b_d: np.ndarray) -> np.ndarray:
        """Solution (n, n_rhs) for right-hand sides (n, n_rhs)."""
        x, info = dgetrs(self.lu, self.pivots, b_d)
        if info != 0:
            raise ValueError(f"dgetrs refused its argument {-info}")
        return x
