"""Lagrange elements through the seam: the nodal basis written in Bernstein polynomials."""

from __future__ import annotations

import numpy as np

from iga.mesh.bernstein import bernstein
from iga.mesh.extraction import Mesh, tensor_mesh


def lagrange_extraction(degree: int) -> np.ndarray:
    """Extraction operator (p + 1, p + 1) of the equidistant Lagrange basis: L_a = sum_b C_ab B_b.

    From ``L_a(x_c) = delta_ac`` at the nodes x_c follows ``C = V^{-T}`` with ``V_cb = B_b(x_c)``.
    """
    return np.linalg.inv(bernstein(degree, np.linspace(0.0, 1.0, degree + 1))).T


def lagrange_rectangle(breaks_s: np.ndarray, breaks_t: np.ndarray, degree: int, degree_t: int | None = None) -> Mesh:
    """Rectangle of Lagrange elements with boundaries at ``breaks_s`` x ``breaks_t``, ``degree`` in both directions.

    ``degree_t`` is the degree of the second direction where it is another.
    """
    degrees = (degree, degree_t or degree)
    (x_s, conn_s, C_s), (x_t, conn_t, C_t) = (
        (x, conn, np.broadcast_to(lagrange_extraction(p), (len(conn), p + 1, p + 1)))
        for p, breaks in zip(degrees, (breaks_s, breaks_t), strict=True)
        for x, conn in [_nodes(np.asarray(breaks, dtype=float), p)]
    )
    y, x = np.meshgrid(x_t, x_s, indexing="ij")
    P_AI = np.stack([x.ravel(), y.ravel()], -1)
    return tensor_mesh(degrees, C_s, conn_s, C_t, conn_t, P_AI, np.ones(len(P_AI)))


def _nodes(breaks: np.ndarray, degree: int) -> tuple[np.ndarray, np.ndarray]:
    within = np.linspace(0.0, 1.0, degree + 1)[:-1]
    inner = breaks[:-1, None] + np.diff(breaks)[:, None] * within
    conn = np.arange(len(breaks) - 1)[:, None] * degree + np.arange(degree + 1)
    return np.append(inner.ravel(), breaks[-1]), conn
