"""Transfer of fields from one T-mesh to another, exact if the new space contains the old one.

The control value of a function is the blossom, at the function's inner local knots, of the polynomial piece of the
field on any one Bezier element of the support (Ramshaw 1989; for T-splines the dual basis of Beirao da Veiga, Buffa,
Sangalli, Vazquez 2013); sixteen values of the field determine that piece. If the field is not a polynomial on the
element (coarsening), the same functional is a quasi-interpolant that reproduces cubics.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy.sparse import csr_array

from iga.mesh.bernstein import bernstein, tensor
from iga.tsplines.tmesh import DEGREE, TMesh
from iga.tsplines.tspline import Extraction, extracted

#: Points in [0, 1] at which cubics are sampled, the zeros of the Chebyshev polynomial of degree 4.
SAMPLES_OF_CUBIC = 0.5 - 0.5 * np.cos((2 * np.arange(DEGREE + 1) + 1) * np.pi / (2 * DEGREE + 2))

#: Points whose extraction operators are gathered at a time, for the sake of memory.
POINTS_AT_ONCE = 16_384


def transfer(old: TMesh, new: TMesh) -> csr_array:
    """Matrix (n_new, n_old) from the control values on one T-mesh to those on another, homogeneous ones if rational.

    If the spaces are nested, ``N_old = M N_new`` gives ``P_new = M^T P_old``; the result is M^T.

    Raises
    ------
    ValueError : the T-meshes have different domains.
    """
    for ours, theirs in ((old.knots_i, new.knots_i), (old.knots_j, new.knots_j)):
        if ours[0] != theirs[0] or ours[-1] != theirs[-1]:
            raise ValueError(f"T-meshes must share their domain, got {ours[[0, -1]]} and {theirs[[0, -1]]}")
    elements = extracted(new)
    e_A, weight_Aq = _functionals(new, elements)
    x_Aqi = _sample_points(new, elements.box_ek[e_A])
    n_A, n_q = weight_Aq.shape
    rows = np.repeat(np.arange(n_A), n_q), np.arange(n_A * n_q)
    functional = csr_array((weight_Aq.ravel(), rows), shape=(n_A, n_A * n_q))
    return functional @ collocation(old, x_Aqi.reshape(-1, 2))


def collocation(mesh: TMesh, x_qi: np.ndarray) -> csr_array:
    """Values (n_q, n_A) of all functions at points (n_q, 2) of the domain, in knot values."""
    elements = extracted(mesh)
    e_q, xi_qs = locate(mesh, elements.box_ek, x_qi)
    B_qb = tensor(bernstein(DEGREE, xi_qs[:, 0]), bernstein(DEGREE, xi_qs[:, 1]))
    value, row, column = [], [], []
    for number, block in enumerate(elements.blocks):
        q_n = np.flatnonzero(elements.block_e[e_q] == number)
        for q in np.array_split(q_n, len(q_n) // POINTS_AT_ONCE + 1):
            e = elements.place_e[e_q[q]]
            N_qa = (block.C_eab[e] @ B_qb[q, :, None])[..., 0]
            value.append(N_qa.ravel())
            row.append(np.repeat(q, N_qa.shape[1]))
            column.append(block.conn_ea[e].ravel())
    entries = np.concatenate(value), (np.concatenate(row), np.concatenate(column))
    return csr_array(entries, shape=(len(x_qi), len(mesh.anchors)))


def locate(mesh: TMesh, box_ek: np.ndarray, x_qi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Bezier element (n_q,) of each point, and its parameters (n_q, 2) there."""
    cell_qk = [
        np.clip(np.searchsorted(knots, x, side="right") - 1, DEGREE, len(knots) - DEGREE - 2)
        for knots, x in zip((mesh.knots_i, mesh.knots_j), x_qi.T, strict=True)
    ]
    # number of the element on every index cell, as the cumulative sum of its changes from cell to cell
    i0, i1, j0, j1 = box_ek.T
    change = np.zeros((len(mesh.knots_i), len(mesh.knots_j)), dtype=int)
    for (i, j), sign in (((i0, j0), 1), ((i1, j0), -1), ((i0, j1), -1), ((i1, j1), 1)):
        np.add.at(change, (i, j), sign * np.arange(1, len(box_ek) + 1))
    owner = change.cumsum(0).cumsum(1) - 1
    e_q = owner[cell_qk[0], cell_qk[1]]
    low, high = _corners(mesh, box_ek[e_q])
    return e_q, (x_qi - low) / (high - low)


def _functionals(mesh: TMesh, elements: Extraction) -> tuple[np.ndarray, np.ndarray]:
    """Element (n_A,) of each function's functional, and the weights (n_A, 16) of the samples there.

    Of the elements in the support of a function, that with the smallest norm of the functional is taken.
    """
    e_n, A_n = (np.concatenate(parts) for parts in zip(*_pairs(elements), strict=True))
    i0, i1, j0, j1 = elements.box_ek[e_n].T
    s, t = mesh.local_knots
    s_nb = blossom_weights(s[A_n, 1:-1], mesh.knots_i[i0], mesh.knots_i[i1])
    t_nb = blossom_weights(t[A_n, 1:-1], mesh.knots_j[j0], mesh.knots_j[j1])
    size_n = np.abs(s_nb).sum(1) * np.abs(t_nb).sum(1)
    order = np.lexsort((size_n, A_n))
    _, first = np.unique(A_n[order], return_index=True)
    best = order[first]
    from_values = np.linalg.inv(bernstein(DEGREE, SAMPLES_OF_CUBIC))
    return e_n[best], tensor(s_nb[best] @ from_values, t_nb[best] @ from_values)


def blossom_weights(knots_nk: np.ndarray, start_n: np.ndarray, end_n: np.ndarray) -> np.ndarray:
    """Weights (n, 4) of the Bernstein coefficients on spans [start, end] in the blossom at knots (n, 3)."""
    xi_nk = (knots_nk - start_n[:, None]) / (end_n - start_n)[:, None]
    weight_njb = np.broadcast_to(np.eye(DEGREE + 1), (len(xi_nk), DEGREE + 1, DEGREE + 1))
    for xi_n in xi_nk.T[:, :, None, None]:
        weight_njb = (1.0 - xi_n) * weight_njb[:, :-1] + xi_n * weight_njb[:, 1:]
    return weight_njb[:, 0]


def _pairs(elements: Extraction) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """All pairs of an element and a function with support on it, block by block."""
    for number, block in enumerate(elements.blocks):
        e = np.flatnonzero(elements.block_e == number)
        conn_ea = block.conn_ea[elements.place_e[e]]
        yield np.repeat(e, conn_ea.shape[1]), conn_ea.ravel()


def _sample_points(mesh: TMesh, box_nk: np.ndarray) -> np.ndarray:
    """Points (n, 16, 2) in index boxes, in knot values."""
    xi_qs = np.stack([np.tile(SAMPLES_OF_CUBIC, DEGREE + 1), np.repeat(SAMPLES_OF_CUBIC, DEGREE + 1)], -1)
    low, high = _corners(mesh, box_nk)
    return low[:, None] + xi_qs * (high - low)[:, None]


def _corners(mesh: TMesh, box_nk: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Lower left and upper right corners (n, 2) of index boxes, in knot values."""
    i0, i1, j0, j1 = box_nk.T
    return (
        np.stack([mesh.knots_i[i0], mesh.knots_j[j0]], -1),
        np.stack([mesh.knots_i[i1], mesh.knots_j[j1]], -1),
    )
