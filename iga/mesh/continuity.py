"""Continuity of the functions of a mesh across the sides of its elements."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array

from iga.mesh.bernstein import bernstein_derivative, tensor
from iga.mesh.edges import Sides
from iga.mesh.extraction import Mesh

#: Derivatives along s and t: the value, the gradient, the second derivatives ss, st, tt.
ORDERS = ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2))


def jumps(mesh: Mesh, sides: Sides) -> tuple[np.ndarray, np.ndarray]:
    """Largest jumps of the functions and their derivatives across the middle of every inner side.

    Returns
    -------
    k_n : (n,) sides.
    jump_no : (n, 3) jump of a value, of a gradient times the size of the element, and of a second derivative in space
        times the size squared; the largest of all functions.
    """
    k, other, t = sides.opposite
    if not k.size:
        return k, np.empty((0, 3))
    here = space_derivatives(mesh, sides, k, np.full(len(k), 0.5))
    there = space_derivatives(mesh, sides, other, t)
    size = np.minimum(sides.size_k[k], sides.size_k[other])
    jump_dn = np.array([abs(a - b).max(axis=1).toarray().ravel() for a, b in zip(here, there, strict=True)])
    return k, np.stack([jump_dn[0], size * jump_dn[1:3].max(0), size**2 * jump_dn[3:].max(0)], -1)


def space_derivatives(mesh: Mesh, sides: Sides, k_n: np.ndarray, t_n: np.ndarray) -> list[csr_array]:
    """Values, X and Y derivatives, XX, XY and YY derivatives of all functions (n, n_A) at points of sides."""
    rows, columns, values = [], [], []
    st_nd = sides.parameters(k_n, t_n)
    for number, block in enumerate(mesh.blocks):
        n = np.flatnonzero(sides.block_k[k_n] == number)
        e, (p, q), (s, t) = sides.element_k[k_n[n]], block.degrees, st_nd[n].T
        B_nbd = np.stack([tensor(bernstein_derivative(p, s, i), bernstein_derivative(q, t, j)) for i, j in ORDERS], -1)
        conn_na = block.conn_ea[e]
        f_dna = np.ascontiguousarray(np.moveaxis(block.C_eab[e] @ B_nbd, 2, 0)) * mesh.w_A[conn_na]
        values.append(_in_space(_rational(f_dna), mesh.P_AI[conn_na]).reshape(len(ORDERS), -1))
        rows.append(np.repeat(n, conn_na.shape[1]))
        columns.append(conn_na.ravel())
    place = np.concatenate(rows), np.concatenate(columns)
    shape = (len(k_n), len(mesh.P_AI))
    return [csr_array((v, place), shape=shape) for v in np.concatenate(values, axis=1)]


def _rational(f_dna: np.ndarray) -> np.ndarray:
    """Derivatives (6, n, a) of R = f / W from those of f = w N, W = sum f, by the quotient rule applied twice."""
    f, f_s, f_t, f_ss, f_st, f_tt = f_dna
    W, W_s, W_t, W_ss, W_st, W_tt = f_dna.sum(2, keepdims=True)
    R = f / W
    R_s, R_t = (f_s - R * W_s) / W, (f_t - R * W_t) / W
    R_ss = (f_ss - 2.0 * R_s * W_s - R * W_ss) / W
    R_st = (f_st - R_s * W_t - R_t * W_s - R * W_st) / W
    R_tt = (f_tt - 2.0 * R_t * W_t - R * W_tt) / W
    return np.stack([R, R_s, R_t, R_ss, R_st, R_tt])


def _in_space(R_dna: np.ndarray, P_naI: np.ndarray) -> np.ndarray:
    """The same derivatives with respect to X and Y: ``R_XX = J^-T (R_ss - R_X . X_ss) J^-1``."""
    X_dnI = (R_dna[:, :, None] @ P_naI)[:, :, 0]
    inverse_nsI = np.linalg.inv(np.stack([X_dnI[1], X_dnI[2]], -1))
    R_X_naI = np.stack([R_dna[1], R_dna[2]], -1) @ inverse_nsI
    second_dna = R_dna[3:] - (R_X_naI @ X_dnI[3:, ..., None])[..., 0]
    ss_na, st_na, tt_na = second_dna
    half_sna2 = [np.stack(pair, -1) @ inverse_nsI for pair in ((ss_na, st_na), (st_na, tt_na))]
    XX_na, XY_na = np.moveaxis(np.stack([half[..., 0] for half in half_sna2], -1) @ inverse_nsI, 2, 0)
    YY_na = (np.stack([half[..., 1] for half in half_sna2], -1) @ inverse_nsI)[..., 1]
    return np.stack([R_dna[0], R_X_naI[..., 0], R_X_naI[..., 1], XX_na, XY_na, YY_na])
