"""One Newton step of the arms: banded equations of the splines, bordered by load, supports and control."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.lib.stride_tricks import as_strided
from scipy.linalg import blas, lapack
from scipy.sparse import csr_array

from verify.theory.arms.splines import ARM_DEGREE
from verify.theory.arms.structure import Part, Structure


@dataclass(frozen=True)
class Pattern:
    """Where the entries of element matrices stand in the banded matrix of a structure, and what borders it."""

    structure: Structure

    @cached_property
    def _sums(self) -> csr_array:
        """Sums over the elements: rows are pairs of a function and its distance from another, columns (E a a)."""
        functions, a = self.structure.functions, ARM_DEGREE + 1
        columns = np.broadcast_to(functions[:, None, :], (len(functions), a, a))
        rows = columns * (2 * a - 1) + functions[:, :, None] - columns + a - 1
        shape = self.structure.mesh.count * (2 * a - 1), rows.size
        return csr_array((np.ones(rows.size), (rows.ravel(), np.arange(rows.size))), shape)

    def banded(self, parts: Iterable[Part], onto: np.ndarray | None = None) -> np.ndarray:
        """Matrix (3 k + 1, n) as LAPACK has it, of all parts on top of ``onto``."""
        one, wide = self.structure, 2 * ARM_DEGREE + 1
        n, m, k = one.mesh.count, one.unknowns, one.band
        found = np.zeros((n * m, 3 * k + 1)) if onto is None else onto.T.copy()
        step = found.itemsize
        # entry (i, j) of functions I, J: row 2 k + (I - J) m + i - j of column J m + j
        strides = m * (3 * k + 1) * step, m * step, step, 3 * k * step
        blocks = as_strided(found.ravel()[2 * k - ARM_DEGREE * m :], (n, wide, m, m), strides)
        for at, K in parts:
            summed = self._sums @ K.reshape(self._sums.shape[1], -1)
            blocks[:, :, at[:, None], at] += summed.reshape(n, wide, len(at), -1)
        return found.T

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
        return self.banded(self.structure.linear, self.springs)

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
        lu, pivots, info = lapack.dgbtrf(self.band, k, k)
        if info:
            raise np.linalg.LinAlgError("the band is singular")
        return lu, pivots

    def _solve(self, b: np.ndarray) -> np.ndarray:
        lu, pivots = self._factors
        k = self.pattern.structure.band
        found, _ = lapack.dgbtrs(lu, k, k, b, pivots)
        return found

    def _times(self, x: np.ndarray) -> np.ndarray:
        """K x."""
        k, n = self.pattern.structure.band, len(x)
        return np.asarray(blas.dgbmv(n, n, k, k, 1.0, self.band[k:], x))

    def solve(self, b: np.ndarray, c: np.ndarray, row: np.ndarray, e: float) -> tuple[Step, Step]:
        """The solution with forces ``b`` (n,), motions ``c`` (m,) of the supports and the control; and its change with
        the value ``e`` of the control.

        Springs hold an end, so that K can be factored; their forces are taken off again.
        """
        one = self.pattern.structure
        m, sides, springs = len(one.held), self.pattern.sides, len(one.springs)
        rows = np.concatenate((row[None], one.held, one.springs, one.pins))
        solved = self._solve(np.column_stack((b, sides)))
        x, by = solved[:, 0], solved[:, 1:]
        A, taken = rows @ by, np.zeros(len(rows))
        taken[m + 1 : m + 1 + springs] = 1.0
        A -= np.diag(taken)
        right = np.zeros((len(rows), 2))
        right[0, 1] = 1.0
        right[: m + 1, 0] = np.concatenate(([e], c))
        z = _scaled_solve(A, right - np.outer(rows @ x, (1.0, 0.0)))
        x, along = x + by @ z[:, 0], by @ z[:, 1]
        # the matrix loses many digits: what is left over is solved for again
        more = self._solve(b + sides @ z[:, 0] - self._times(x))
        left = right[:, 0] - rows @ (x + more) + taken * z[:, 0]
        dz = _scaled_solve(A, left[:, None])[:, 0]
        x, z0 = x + more + by @ dz, z[:, 0] + dz
        return Step(x, z0[0], z0[1 : m + 1]), Step(along, z[0, 1], z[1 : m + 1, 1])


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
