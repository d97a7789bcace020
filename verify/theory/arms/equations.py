"""One Newton step of the arms: banded equations of the elements, bordered by supports, load and control.

Unknowns inside an element are eliminated there; what is left couples neighbours alone, 12 by 12 a band of 11.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import lapack

from verify.theory.arms.mesh import ARM_DEGREE, UNKNOWNS
from verify.theory.arms.structure import Structure

#: Entries beside the diagonal between the unknowns of two neighbouring nodes.
BAND = 2 * UNKNOWNS - 1


@dataclass(frozen=True)
class Banded:
    """A factored matrix of elements (E, 30, 30), not singular."""

    K_eab: np.ndarray

    @cached_property
    def _inside(self) -> np.ndarray:
        return self.K_eab[:, UNKNOWNS:-UNKNOWNS, UNKNOWNS:-UNKNOWNS]

    @cached_property
    def _ends(self) -> np.ndarray:
        last = UNKNOWNS * ARM_DEGREE
        return np.concatenate((np.arange(UNKNOWNS), last + np.arange(UNKNOWNS)))

    @cached_property
    def _eliminated(self) -> np.ndarray:
        """What the inner unknowns are (E, 18, 12) for those of the ends, with the sign of K."""
        return np.linalg.solve(self._inside, self.K_eab[:, UNKNOWNS:-UNKNOWNS][:, :, self._ends])

    @cached_property
    def _factors(self) -> tuple[np.ndarray, np.ndarray]:
        outer = self.K_eab[:, self._ends]
        left = outer[:, :, self._ends] - outer[:, :, UNKNOWNS:-UNKNOWNS] @ self._eliminated
        n, i = UNKNOWNS * (len(left) + 1), np.arange(2 * UNKNOWNS)
        band = np.zeros((3 * BAND + 1, n))
        rows = 2 * BAND + i[:, None] - i[None, :]
        columns = UNKNOWNS * np.arange(len(left))[:, None, None] + i[None, None, :]
        np.add.at(band, (np.broadcast_to(rows, left.shape), np.broadcast_to(columns, left.shape)), left)
        lu, pivots, info = lapack.dgbtrf(band, BAND, BAND)
        if info:
            raise np.linalg.LinAlgError("the band is singular")
        return lu, pivots

    def solve(self, b: np.ndarray) -> np.ndarray:
        """Solutions (n, m) of right-hand sides (n, m)."""
        E, m = len(self.K_eab), b.shape[1]
        step = UNKNOWNS * ARM_DEGREE
        blocks = b[:-UNKNOWNS].reshape(E, step, m)
        inner = np.linalg.solve(self._inside, blocks[:, UNKNOWNS:])
        ends = np.concatenate((blocks[:, :UNKNOWNS].reshape(-1, m), b[-UNKNOWNS:]))
        less = self.K_eab[:, self._ends][:, :, UNKNOWNS:-UNKNOWNS] @ inner
        nodes = ends.reshape(E + 1, UNKNOWNS, m).copy()
        nodes[:-1] -= less[:, :UNKNOWNS]
        nodes[1:] -= less[:, UNKNOWNS:]
        lu, pivots = self._factors
        found, _ = lapack.dgbtrs(lu, BAND, BAND, nodes.reshape(-1, m), pivots)
        nodes = found.reshape(E + 1, UNKNOWNS, m)
        both = np.concatenate((nodes[:-1], nodes[1:]), axis=1)
        blocks = np.concatenate((nodes[:-1], inner - self._eliminated @ both), axis=1)
        return np.concatenate((blocks.reshape(-1, m), nodes[-1]))


@dataclass(frozen=True)
class Bordered:
    """Equations K x = b + load P + held^T R, with held x = c, the control row x + column P = e, and no pinned motion.

    A spring holds the right end of the lower arm, so that K can be factored; its force is taken off again.
    """

    structure: Structure
    K_eab: np.ndarray

    @cached_property
    def _spring(self) -> np.ndarray:
        """Stiffness (3,) of the spring: that of the arm at its end."""
        return np.diag(self.structure.stiffness_eab[-1])[-3:].copy()

    @cached_property
    def _banded(self) -> Banded:
        K = self.K_eab.copy()
        at = np.arange(-3, 0)
        K[-1, at, at] += self._spring
        return Banded(K)

    @cached_property
    def _columns(self) -> tuple[np.ndarray, np.ndarray]:
        """Right-hand sides (n, k) of what borders K, and their solutions: load, supports, spring, pins."""
        one, n = self.structure, self.structure.mesh.count
        spring = np.zeros((n, 3))
        spring[-3:] = np.diag(self._spring)
        sides = np.column_stack((one.load, one.held.T, spring, spring @ one.pinned))
        return sides, self._banded.solve(sides)

    def solve(self, b: np.ndarray, c: np.ndarray, row: np.ndarray, column: float, e: float) -> tuple[np.ndarray, ...]:
        """x (n,), P, R (m,): with ``b`` (n,) forces, ``c`` (m,) motions of the supports, and the control."""
        one = self.structure
        m = len(one.held)
        _, by = self._columns
        x0 = self._banded.solve(b[:, None])[:, 0]
        k = by.shape[1]
        end = np.zeros((3, len(x0)))
        end[:, -3:] = np.eye(3)
        rows = np.concatenate((row[None], one.held, end, one.pinned.T @ end))
        A = rows @ by
        A[0, 0] += column
        A[m + 1 : m + 4, m + 1 : m + 4] -= np.eye(3)
        right = np.concatenate(([e], c, np.zeros(k - m - 1))) - rows @ x0
        z = _scaled_solve(A, right)
        return x0 + by @ z, z[0], z[1 : m + 1]


def _scaled_solve(A: np.ndarray, b: np.ndarray) -> np.ndarray:
    """A small system whose rows and columns have different units."""
    by_row = 1.0 / np.maximum(np.abs(A).max(axis=1), 1e-300)
    by_column = 1.0 / np.maximum(np.abs(A * by_row[:, None]).max(axis=0), 1e-300)
    return by_column * np.linalg.solve(A * by_row[:, None] * by_column, b * by_row)
