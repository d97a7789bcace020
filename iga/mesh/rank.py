"""Rank of a matrix of functions: how many of them are linearly independent."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array, csr_array
from scipy.sparse.linalg import eigsh

from iga.mesh.extraction import Mesh


@dataclass(frozen=True)
class RankSettings:
    """Numerical rank.

    dependent : part of the largest singular value below which a singular value counts as zero.
    dense : number of functions up to which all singular values are computed; beyond, a sparse eigenvalue solver finds
        the smallest one alone.
    """

    dependent: float = 1e-9
    dense: int = 2000


RANK = RankSettings()


def rank(M_Ab: csr_array) -> int:
    """Rank of a matrix (n_A, n_b) with one function per row.

    Rows are scaled to length one. Up to ``RANK.dense`` functions the rank is found from the singular values; beyond,
    from the smallest eigenvalue of the Gram matrix: a result below n_A is then an upper bound of the rank.
    """
    length_A = np.sqrt((M_Ab * M_Ab).sum(axis=1))
    used = length_A > 0
    M_Ab = csr_array(M_Ab[used]).multiply(1.0 / length_A[used][:, None]).tocsr()
    gram_AB = M_Ab @ M_Ab.T
    if M_Ab.shape[0] > RANK.dense:
        largest = float(abs(gram_AB).sum(axis=1).max())
        smallest = eigsh(gram_AB, k=1, sigma=-1e-12 * largest, return_eigenvectors=False)[0]
        return M_Ab.shape[0] - int(smallest < RANK.dependent * largest)
    values = np.linalg.eigvalsh(gram_AB.toarray())
    if values[0] > 1e-11 * values[-1]:  # eigenvalues are squares of singular values: smaller ones are lost in rounding
        return M_Ab.shape[0]
    singular = np.linalg.svd(M_Ab.toarray(), compute_uv=False)
    return int(np.count_nonzero(singular > RANK.dependent * singular[0]))


def coefficients(mesh: Mesh) -> csr_array:
    """Bernstein coefficients (n_A, sum n_e n_b) of all functions on all elements."""
    rows, columns, values, first = [], [], [], 0
    for block in mesh.blocks:
        n_e, n_a, n_b = block.C_eab.shape
        column_eb = first + np.arange(n_e * n_b).reshape(n_e, n_b)
        rows.append(np.repeat(block.conn_ea.ravel(), n_b))
        columns.append(np.broadcast_to(column_eb[:, None], (n_e, n_a, n_b)).ravel())
        values.append(block.C_eab.ravel())
        first += n_e * n_b
    place = np.concatenate(rows), np.concatenate(columns)
    matrix = coo_array((np.concatenate(values), place), shape=(len(mesh.P_AI), first)).tocsr()
    matrix.eliminate_zeros()
    return matrix
