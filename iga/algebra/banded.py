"""Banded direct solvers: slender specimens, numbered along their length, have narrow bands.

A symmetric matrix is given by its lower half: entries in LAPACK's lower band storage, Fortran order.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.lib.stride_tricks import as_strided
from scipy.linalg import solve_triangular
from scipy.linalg.lapack import dgbtrf, dgbtrs, dpbtrf, dpbtrs
from scipy.sparse import coo_array, csr_array, vstack
from scipy.sparse.csgraph import reverse_cuthill_mckee


@dataclass(frozen=True)
class Skew:
    """Entries (row, column, value) to be added to a symmetric matrix, as degrees of freedom."""

    row: np.ndarray
    column: np.ndarray
    value: np.ndarray


@dataclass(frozen=True)
class Band:
    """Numbering of the free unknowns and their half bandwidth.

    ``place_d`` (n_dof,) is the equation of each degree of freedom, -1 where it is fixed; ``n`` equations, half
    bandwidth ``k``.
    """

    place_d: np.ndarray
    n: int
    k: int

    @property
    def size(self) -> int:
        """Number of entries of the lower half, and one more for all entries of fixed unknowns."""
        return (self.k + 1) * self.n + 1

    def positions(self, row: np.ndarray, column: np.ndarray) -> np.ndarray:
        """Index of each entry (row, column), as degrees of freedom, or of its mirror image, in the lower half."""
        i, j = self.place_d[row], self.place_d[column]
        return np.where((i < 0) | (j < 0), self.size - 1, np.abs(i - j) + (self.k + 1) * np.minimum(i, j))

    def reach(self, groups: np.ndarray) -> int:
        """Half bandwidth that ``groups`` need, rows (n, m) of degrees of freedom that are coupled with each other."""
        return _span(self.place_d[groups])

    @cached_property
    def dof_n(self) -> np.ndarray:
        """The degree of freedom (n,) of each equation."""
        free = np.flatnonzero(self.place_d >= 0)
        return free[np.argsort(self.place_d[free])]

    @cached_property
    def fixed_f(self) -> np.ndarray:
        """The degrees of freedom without an equation."""
        return np.flatnonzero(self.place_d < 0)

    def gather(self, v_d: np.ndarray) -> np.ndarray:
        """Equations (n, ...) from degrees of freedom (n_dof, ...)."""
        return v_d.take(self.dof_n, axis=0)

    def spread(self, v: np.ndarray) -> np.ndarray:
        """Degrees of freedom from equations, zero where fixed."""
        v_d = np.ascontiguousarray(v).take(self.place_d, axis=0)
        v_d[self.fixed_f] = 0.0
        return v_d

    def reaching(self, groups: np.ndarray) -> Band:
        """This band, widened if these groups need it."""
        return replace(self, k=max(self.k, self.reach(groups)))

    def cholesky(self, half: np.ndarray) -> BandCholesky | None:
        """Factor of the matrix with this lower half (``size``,); None where it is not positive definite.

        The factor takes the place of ``half``.
        """
        factor, info = dpbtrf(half[:-1].reshape(self.n, self.k + 1).T, lower=True, overwrite_ab=True)
        return BandCholesky(self, factor) if info == 0 else None

    def lu(self, half: np.ndarray, skew: Skew | None = None) -> BandLU | None:
        """LU of the matrix with this lower half and the skew entries added; None where a pivot is exactly zero."""
        lu, pivots, info = dgbtrf(self._whole(half, skew), self.k, self.k, overwrite_ab=True)
        return BandLU(self, lu, pivots) if info == 0 else None

    def _whole(self, half: np.ndarray, skew: Skew | None) -> np.ndarray:
        """Both halves in the layout (3 k + 1, n) of the LU factors."""
        n, k = self.n, self.k
        lower, flat = half[:-1].reshape(n, k + 1), np.zeros(n * (3 * k + 1) + 3 * k**2)
        # entries right of the diagonal are 3 k apart; those of the last rows beyond the matrix are zeros
        right = as_strided(flat[2 * k :], (n, k + 1), ((3 * k + 1) * flat.itemsize, 3 * k * flat.itemsize))
        right[:] = lower
        whole = flat[: n * (3 * k + 1)].reshape(n, 3 * k + 1).T
        whole[2 * k :] = lower.T
        if skew is not None:
            i, j = self.place_d[skew.row], self.place_d[skew.column]
            there = (i >= 0) & (j >= 0)
            np.add.at(whole, ((2 * k + i - j)[there], j[there]), skew.value[there])
        return whole

    def columns(self, half: np.ndarray, skew: Skew | None = None) -> np.ndarray:
        """Sum (n,) of the absolute entries of each column of the matrix that `lu` takes, or a little more."""
        lower = half[:-1].reshape(self.n, self.k + 1).T
        sums = np.abs(lower[0])
        for d in range(1, min(self.k + 1, self.n)):
            size = np.abs(lower[d, : self.n - d])
            sums[: self.n - d] += size
            sums[d:] += size
        if skew is not None:
            i, j = self.place_d[skew.row], self.place_d[skew.column]
            there = (i >= 0) & (j >= 0)
            np.add.at(sums, j[there], np.abs(skew.value[there]))
        return sums


@dataclass(frozen=True)
class BandCholesky:
    """Cholesky factor of a positive definite matrix."""

    band: Band
    factor: np.ndarray

    def solve(self, b_d: np.ndarray) -> np.ndarray:
        """Solution (n_dof, n_rhs) for right-hand sides (n_dof, n_rhs), zero where fixed."""
        x, info = dpbtrs(self.factor, np.asfortranarray(self.band.gather(b_d)), lower=True, overwrite_b=True)
        if info != 0:
            raise ValueError(f"dpbtrs refused its argument {-info}")
        return self.band.spread(x)

    def products(self, C_nm: csr_array) -> np.ndarray:
        """``C' K^-1 C`` (n_m, n_m) of columns in equations, as ``(L^-1 C)' (L^-1 C)``, by square blocks of the band.

        Columns enter at their first row; of ``L^-1 C`` only one block of rows exists at a time.
        """
        k, n = max(self.band.k, 1), self.band.n
        entries, flat = C_nm.tocoo(), self.factor.ravel(order="K")
        first_m = np.full(C_nm.shape[1], n)
        np.minimum.at(first_m, entries.col, entries.row)
        order = np.argsort(first_m, kind="stable")
        sorted_nm, first_m = csr_array(C_nm[:, order]), first_m[order]
        size, found = flat.itemsize, np.zeros((len(order), len(order)))
        last = np.zeros((0, 0))
        for start in range(0, n, k):
            rows, live = min(k, n - start), int(np.searchsorted(first_m, min(start + k, n)))
            y = sorted_nm[start : start + rows, :live].toarray()
            if start:
                # L[start + r, start - k + c] is k (c + 1) + r places behind the diagonal of the block before
                below = as_strided(flat[(start - k) * (self.band.k + 1) + k :], (rows, k), (size, self.band.k * size))
                y[:, : last.shape[1]] -= np.triu(below) @ last
            block = as_strided(flat[start * (self.band.k + 1) :], (rows, rows), (size, self.band.k * size))
            last = solve_triangular(block, y, lower=True, check_finite=False)
            found[:live, :live] += last.T @ last
        back = np.argsort(order)
        return found[np.ix_(back, back)]


@dataclass(frozen=True)
class BandLU:
    """LU factors with partial pivoting."""

    band: Band
    lu: np.ndarray
    pivots: np.ndarray

    def solve(self, b_d: np.ndarray, transposed: bool = False) -> np.ndarray:
        """Solution (n_dof, n_rhs) for right-hand sides (n_dof, n_rhs), zero where fixed."""
        b = np.asfortranarray(self.band.gather(b_d))
        x, info = dgbtrs(self.lu, self.band.k, self.band.k, b, self.pivots, trans=transposed, overwrite_b=True)
        if info != 0:
            raise ValueError(f"dgbtrs refused its argument {-info}")
        return self.band.spread(x)


def number(groups: Sequence[np.ndarray], x_d: np.ndarray, free_d: np.ndarray) -> Band:
    """Numbering with the narrower band of two: along the coordinate ``x_d``, or reverse Cuthill-McKee.

    Parameters
    ----------
    groups : arrays (n, m) whose rows are degrees of freedom that are all coupled with each other.
    x_d : (n_dof,) coordinate along the specimen.
    free_d : (n_dof,) True where the degree of freedom is an unknown.
    """
    free = np.flatnonzero(free_d)
    n = free.size
    compact = np.full(free_d.size, -1)
    compact[free] = np.arange(n)
    orders = (np.argsort(x_d[free], kind="stable"), reverse_cuthill_mckee(_graph(groups, compact, n), True))
    bands = []
    for order in orders:
        place = np.full(free_d.size, -1)
        place[free[order]] = np.arange(n)
        bands.append(Band(place, n, max(_span(place[d_nm]) for d_nm in groups)))
    return min(bands, key=lambda band: band.k)


def _span(place_nm: np.ndarray) -> int:
    """Largest distance of two equations of a group; all entries of its matrix lie within it."""
    last = place_nm.max(1, initial=-1)
    first = np.where(place_nm < 0, np.iinfo(place_nm.dtype).max, place_nm).min(1, initial=np.iinfo(place_nm.dtype).max)
    return int(np.max((last - first)[last >= 0], initial=0))


def _graph(groups: Sequence[np.ndarray], compact: np.ndarray, n: int) -> csr_array:
    """Pattern of the matrix: the groups that each unknown is in, by the unknowns of each group."""
    parts = []
    for d_nm in groups:
        column = compact[d_nm]
        row = np.broadcast_to(np.arange(len(d_nm))[:, None], d_nm.shape)
        there = column >= 0
        member = coo_array((np.ones(there.sum(), np.int32), (row[there], column[there])), shape=(len(d_nm), n))
        parts.append(member.tocsr())
    member = vstack(parts, format="csr")
    graph = csr_array(member.T @ member)
    graph.sort_indices()
    return graph
