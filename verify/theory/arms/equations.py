"""One Newton step of the arms: banded equations of the splines, bordered by load, supports and control."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import lapack

from verify.theory.arms.splines import ARM_DEGREE
from verify.theory.arms.structure import Structure


@dataclass(frozen=True)
class Pattern:
    """Where the entries of element matrices stand in the banded matrix of a structure, and what borders it."""

    structure: Structure

    @cached_property
    def _places(self) -> np.ndarray:
        """Positions (E a a m m) in the band, column after column."""
        one, m, a = self.structure, self.structure.unknowns, ARM_DEGREE + 1
        k = one.band
        rows = one.dofs[:, :, None, :, None]
        columns = one.dofs[:, None, :, None, :]
        shape = (len(one.dofs), a, a, m, m)
        return np.broadcast_to(columns * (3 * k + 1) + 2 * k + rows - columns, shape).ravel()

    def banded(self, K: np.ndarray) -> np.ndarray:
        """Matrix (3 k + 1, n) as LAPACK has it, from those of the elements (E, a a, m m)."""
        n, k = self.structure.count, self.structure.band
        found = np.bincount(self._places, K.ravel(), (3 * k + 1) * n)
        return found.reshape(n, 3 * k + 1).T

    @cached_property
    def stiff(self) -> np.ndarray:
        """Stiffness of the springs: that of the bodies at the end that they hold."""
        diagonal = self.banded(self.structure.linear)[2 * self.structure.band]
        return np.array([float(diagonal @ np.abs(row)) for row in self.structure.springs])

    @cached_property
    def unused(self) -> np.ndarray:
        """Unknowns that no element has, which a number on the diagonal keeps at zero."""
        return self.banded(self.structure.linear)[2 * self.structure.band] == 0.0

    @cached_property
    def springs(self) -> np.ndarray:
        """Springs as a banded matrix."""
        n, k = self.structure.count, self.structure.band
        found = np.zeros((3 * k + 1, n))
        for row, stiffness in zip(self.structure.springs, self.stiff, strict=True):
            at = np.flatnonzero(row)
            i, j = np.meshgrid(at, at, indexing="ij")
            found[2 * k + i - j, j] += stiffness * np.outer(row[at], row[at])
        found[2 * k, self.unused] = 1.0
        return found

    @cached_property
    def linear(self) -> np.ndarray:
        """The banded matrix of the unstrained bodies with springs."""
        return self.banded(self.structure.linear) + self.springs

    @cached_property
    def sides(self) -> np.ndarray:
        """Columns (n, k) that border the matrix: load, supports, springs that are taken off again, pins."""
        one = self.structure
        spring = one.springs.T * self.stiff
        onto = np.linalg.lstsq(one.springs.T, one.pins.T, rcond=None)[0]
        return np.column_stack((one.load, one.held.T, spring, spring @ onto))


@dataclass(frozen=True)
class Bordered:
    """Equations K x = b + load P + held^T R, with held x = c, the control row x = e, and no pinned motion."""

    pattern: Pattern
    band: np.ndarray

    @cached_property
    def _factors(self) -> tuple[np.ndarray, np.ndarray]:
        k = self.pattern.structure.band
        lu, pivots, info = lapack.dgbtrf(self.band, k, k, overwrite_ab=True)
        if info:
            raise np.linalg.LinAlgError("the band is singular")
        return lu, pivots

    def _solve(self, b: np.ndarray) -> np.ndarray:
        lu, pivots = self._factors
        k = self.pattern.structure.band
        found, _ = lapack.dgbtrs(lu, k, k, b, pivots)
        return found

    def solve(self, b: np.ndarray, c: np.ndarray, row: np.ndarray, e: float) -> tuple[Step, Step]:
        """The solution with forces ``b`` (n,), motions ``c`` (m,) of the supports and the control; and its change with
        the value ``e`` of the control.

        Springs hold an end, so that K can be factored; their forces are taken off again.
        """
        one = self.pattern.structure
        m, sides = len(one.held), self.pattern.sides
        solved = self._solve(np.column_stack((b, sides)))
        x0, by = solved[:, 0], solved[:, 1:]
        k = by.shape[1]
        rows = np.concatenate((row[None], one.held, one.springs, one.pins))
        A, springs = rows @ by, len(one.springs)
        A[m + 1 : m + 1 + springs, m + 1 : m + 1 + springs] -= np.eye(springs)
        right = np.zeros((k, 2))
        right[:, 0] = np.concatenate(([e], c, np.zeros(k - m - 1))) - rows @ x0
        right[0, 1] = 1.0
        z = _scaled_solve(A, right)
        return Step(x0 + by @ z[:, 0], z[0, 0], z[1 : m + 1, 0]), Step(by @ z[:, 1], z[0, 1], z[1 : m + 1, 1])


@dataclass(frozen=True)
class Step:
    """Change of the unknowns (n,), of the load and of the reactions (m,)."""

    x: np.ndarray
    load: float
    reactions: np.ndarray


def _scaled_solve(A: np.ndarray, b: np.ndarray) -> np.ndarray:
    """A small system whose rows and columns have different units."""
    by_row = 1.0 / np.maximum(np.abs(A).max(axis=1), 1e-300)
    by_column = 1.0 / np.maximum(np.abs(A * by_row[:, None]).max(axis=0), 1e-300)
    return by_column[:, None] * np.linalg.solve(A * by_row[:, None] * by_column, b * by_row[:, None])
