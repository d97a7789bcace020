"""A surface as a chain of element sides: rational Bezier curves, evaluated at one point a quadrature point, all at once."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from iga.bernstein import bernstein_derivative
from iga.extraction import SIDES, Chain, Mesh


@dataclass(frozen=True)
class Surface:
    """A chain of n_c rational Bezier curves of degree p over n_A control points.

    ``H_bA`` (n_c (p+1), n_A), sparse: homogeneous extraction, row ``c (p + 1) + b`` is ``w_A C_Ab`` of side c. Working on Bezier
    points makes sides with different numbers of functions alike. ``w_cb`` (n_c, p+1) are the Bezier weights.
    ``outward`` is +1 where the body lies to the left of the walking direction, -1 where to the right.
    """

    degree: int
    H_bA: csr_array
    w_cb: np.ndarray
    outward: float

    @property
    def sides(self) -> int:
        return len(self.w_cb)

    def bezier_points(self, x_AI: np.ndarray) -> np.ndarray:
        """Homogeneous Bezier points (n_c, p + 1, 2) of a configuration x_AI (n_A, 2) of the control points."""
        return (self.H_bA @ x_AI).reshape(self.sides, self.degree + 1, 2)

    def coefficients(self, c_q: np.ndarray, xi_q: np.ndarray, orders: int) -> tuple[np.ndarray, ...]:
        """Rational Bernstein values and derivatives (n_q, p + 1) at xi_q on the sides c_q, up to the order asked for.

        Quotient rule (Piegl and Tiller 1997, eq. 4.8): ``r_k = (B^(k) - sum_{i=1..k} binom(k, i) W^(i) r_{k-i}) / W``.
        """
        B = [bernstein_derivative(self.degree, xi_q, k) for k in range(orders + 1)]
        W = [np.sum(self.w_cb[c_q] * b, -1, keepdims=True) for b in B]
        r = [B[0] / W[0]]
        if orders > 0:
            r.append((B[1] - W[1] * r[0]) / W[0])
        if orders > 1:
            r.append((B[2] - 2.0 * W[1] * r[1] - W[2] * r[0]) / W[0])
        return tuple(r)

    def rows(self, c_q: np.ndarray, r_qb: np.ndarray) -> csr_array:
        """Functions at points, over all control points: (n_q, n_A), from coefficients r_qb on the sides c_q."""
        n_q, n_b = r_qb.shape
        columns = (c_q[:, None] * n_b + np.arange(n_b)).ravel()
        return csr_array((r_qb.ravel(), columns, np.arange(0, n_q * n_b + 1, n_b)), shape=(n_q, self.H_bA.shape[0])) @ self.H_bA


def surface(mesh: Mesh, chain: Chain, first: int, n_A: int) -> Surface:
    """The surface of a chain of one body whose control points are numbers ``first`` .. of the n_A of the whole model.

    Raises
    ------
    ValueError : sides of different degrees in one chain.
    """
    direction, value = SIDES[chain.side]
    degrees = {mesh.blocks[b].degrees[1 - direction] for b in np.unique(chain.block_c)}
    if len(degrees) != 1:
        raise ValueError(f"a surface needs sides of one degree, got degrees {sorted(degrees)}")
    p = degrees.pop()
    row, col, data = [], [], []
    for number in np.unique(chain.block_c):
        block, here = mesh.blocks[number], np.flatnonzero(chain.block_c == number)
        e, q = chain.element_c[here], block.degrees[direction]
        on_side = np.arange((p + 1) * (q + 1)).reshape(block.degrees[1] + 1, block.degrees[0] + 1)
        on_side = np.take(on_side, 0 if value == 0.0 else -1, axis=1 - direction)
        conn_ca = block.conn_ea[e]
        wC_cab = block.C_eab[e][:, :, on_side] * mesh.w_A[conn_ca][..., None]
        shape = wC_cab.shape
        row.append(np.broadcast_to((here[:, None, None] * (p + 1) + np.arange(p + 1)), shape).ravel())
        col.append(np.broadcast_to(conn_ca[..., None] + first, shape).ravel())
        data.append(wC_cab.ravel())
    row, col, data = (np.concatenate(v) for v in (row, col, data))
    keep = data != 0.0
    n_rows = len(chain.element_c) * (p + 1)
    H_bA = csr_array((data[keep], (row[keep], col[keep])), shape=(n_rows, n_A))
    w_cb = np.asarray(H_bA.sum(axis=1)).reshape(-1, p + 1)
    outward = 1.0 if chain.side in ("BOTTOM", "RIGHT") else -1.0
    return Surface(p, H_bA, w_cb, outward)


def normal(tangent_qi: np.ndarray, outward: float) -> np.ndarray:
    """Unit outward normal (n_q, 2): the tangent turned clockwise where the body lies to the left (``outward`` +1)."""
    n = outward * np.stack([tangent_qi[:, 1], -tangent_qi[:, 0]], -1)
    return n / np.linalg.norm(n, axis=1, keepdims=True)
