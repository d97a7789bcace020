"""From one T-mesh of a domain to another: control values carried over, exactly where the new space holds the old one.

The control value of a function is a linear functional of the field on any one Bezier element of its support: sixteen
values there give the polynomial, and the inverse of the extraction operator gives the control value. Where the field is
no polynomial on that element (coarsening) the same functional is a quasi-interpolant that keeps cubics.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array

from iga.bernstein import bernstein, tensor
from iga.extraction import Mesh
from iga.tmesh import DEGREE, TMesh
from iga.tspline import Extraction, extracted, tspline_mesh

#: Sample points of a cubic in each direction, the zeros of the Chebyshev polynomial of degree 4.
SAMPLES = 0.5 - 0.5 * np.cos((2 * np.arange(DEGREE + 1) + 1) * np.pi / (2 * DEGREE + 2))


def transfer(old: TMesh, new: TMesh) -> csr_array:
    """Matrix (n_new, n_old) that takes control values, homogeneous where rational, from one T-mesh to another.

    ``N_old = M N_new`` gives ``P_new = M^T P_old`` where the spaces are nested; this matrix is M^T.

    Raises
    ------
    ValueError : the T-meshes have different domains.
    """
    for ours, theirs in ((old.knots_i, new.knots_i), (old.knots_j, new.knots_j)):
        if ours[0] != theirs[0] or ours[-1] != theirs[-1]:
            raise ValueError(f"T-meshes must share their domain, got {ours[[0, -1]]} and {theirs[[0, -1]]}")
    elements = extracted(new)
    e_A, weight_Aq = _functionals(elements, len(new.anchors))
    x_Aqi = _sample_points(new, elements.box_ek[e_A])
    n_A, n_q = weight_Aq.shape
    rows = np.repeat(np.arange(n_A), n_q), np.arange(n_A * n_q)
    functional = csr_array((weight_Aq.ravel(), rows), shape=(n_A, n_A * n_q))
    return functional @ collocation(old, x_Aqi.reshape(-1, 2))


def transferred(old: TMesh, mesh: Mesh, new: TMesh) -> Mesh:
    """A T-spline on another T-mesh: the same body where that refines the first one."""
    matrix = transfer(old, new)
    w_A = matrix @ mesh.w_A
    return tspline_mesh(new, (matrix @ (mesh.w_A[:, None] * mesh.P_AI)) / w_A[:, None], w_A)


def nesting_error(old: TMesh, new: TMesh) -> float:
    """Largest difference between an old function and its copy in the new space: rounding where they are nested."""
    x_qi = _sample_points(new, extracted(new).box_ek).reshape(-1, 2)
    return float(abs(collocation(old, x_qi) - collocation(new, x_qi) @ transfer(old, new)).max())


def collocation(mesh: TMesh, x_qi: np.ndarray) -> csr_array:
    """Values (n_q, n_A) of all functions at points (n_q, 2) of the domain, in knot values."""
    elements = extracted(mesh)
    e_q, xi_qs = locate(mesh, elements.box_ek, x_qi)
    B_qb = tensor(bernstein(DEGREE, xi_qs[:, 0]), bernstein(DEGREE, xi_qs[:, 1]))
    value, row, column = [], [], []
    for number, block in enumerate(elements.blocks):
        q = np.flatnonzero(elements.block_e[e_q] == number)
        e = elements.place_e[e_q[q]]
        N_qa = (block.C_eab[e] @ B_qb[q, :, None])[..., 0]
        value.append(N_qa.ravel())
        row.append(np.repeat(q, N_qa.shape[1]))
        column.append(block.conn_ea[e].ravel())
    entries = np.concatenate(value), (np.concatenate(row), np.concatenate(column))
    return csr_array(entries, shape=(len(x_qi), len(mesh.anchors)))


def locate(mesh: TMesh, box_ek: np.ndarray, x_qi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Bezier element (n_q,) of each point and its place (n_q, 2) in the element's unit square."""
    cell_qk = [
        np.clip(np.searchsorted(knots, x, side="right") - 1, DEGREE, len(knots) - DEGREE - 2)
        for knots, x in zip((mesh.knots_i, mesh.knots_j), x_qi.T, strict=True)
    ]
    # every index cell knows the lower left corner of its element: the last one at or before it both ways
    i0, i1, j0, j1 = box_ek.T
    owner = np.zeros((len(mesh.knots_i), len(mesh.knots_j)), dtype=int)
    change = np.zeros((owner.shape[0] + 1, owner.shape[1] + 1), dtype=int)
    for (i, j), sign in (((i0, j0), 1), ((i1, j0), -1), ((i0, j1), -1), ((i1, j1), 1)):
        np.add.at(change, (i, j), sign * np.arange(1, len(box_ek) + 1))
    owner = change.cumsum(0).cumsum(1) - 1
    e_q = owner[cell_qk[0], cell_qk[1]]
    low, high = _corners(mesh, box_ek[e_q])
    return e_q, (x_qi - low) / (high - low)


def _functionals(elements: Extraction, n_A: int) -> tuple[np.ndarray, np.ndarray]:
    """Element (n_A,) on which each function is read, and the weights (n_A, 16) of the samples there.

    Of all elements in its support the one is taken that magnifies a field least.
    """
    V_qb = tensor(bernstein(DEGREE, np.tile(SAMPLES, DEGREE + 1)), bernstein(DEGREE, np.repeat(SAMPLES, DEGREE + 1)))
    from_values = np.linalg.inv(V_qb)
    size_A, e_A, weight_Aq = np.full(n_A, np.inf), np.zeros(n_A, dtype=int), np.zeros((n_A, V_qb.shape[0]))
    for number, block in enumerate(elements.blocks):
        e = np.flatnonzero(elements.block_e == number)
        weights_eaq = (from_values.T @ np.linalg.pinv(block.C_eab[elements.place_e[e]])).swapaxes(1, 2)
        A_n = block.conn_ea[elements.place_e[e]].ravel()
        weights_nq = weights_eaq.reshape(len(A_n), -1)
        size_n = np.abs(weights_nq).sum(1)
        order = np.lexsort((size_n, A_n))
        A, first = np.unique(A_n[order], return_index=True)
        best = order[first]
        better = size_n[best] < size_A[A]
        A, best = A[better], best[better]
        size_A[A], e_A[A], weight_Aq[A] = size_n[best], e[best // block.conn_ea.shape[1]], weights_nq[best]
    return e_A, weight_Aq


def _sample_points(mesh: TMesh, box_nk: np.ndarray) -> np.ndarray:
    """Points (n, 16, 2) in index boxes, in knot values."""
    xi_qs = np.stack([np.tile(SAMPLES, DEGREE + 1), np.repeat(SAMPLES, DEGREE + 1)], -1)
    low, high = _corners(mesh, box_nk)
    return low[:, None] + xi_qs * (high - low)[:, None]


def _corners(mesh: TMesh, box_nk: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Lower left and upper right corners (n, 2) of index boxes, in knot values."""
    i0, i1, j0, j1 = box_nk.T
    return (
        np.stack([mesh.knots_i[i0], mesh.knots_j[j0]], -1),
        np.stack([mesh.knots_i[i1], mesh.knots_j[j1]], -1),
    )
