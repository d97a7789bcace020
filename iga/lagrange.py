"""Lagrange elements through the seam: the nodal basis written in Bernstein polynomials."""

from __future__ import annotations

import numpy as np

from iga.bernstein import bernstein
from iga.extraction import Mesh, tensor_mesh


def lagrange_extraction(degree: int) -> np.ndarray:
    """Extraction operator (p + 1, p + 1) of the equidistant Lagrange basis: L_a = sum_b C_ab B_b.

    From ``L_a(x_c) = delta_ac`` at the nodes x_c follows ``C = V^{-T}`` with ``V_cb = B_b(x_c)``.
    """
    return np.linalg.inv(bernstein(degree, np.linspace(0.0, 1.0, degree + 1))).T


def lagrange_rectangle(breaks_s: np.ndarray, breaks_t: np.ndarray, degree: int) -> Mesh:
    """Rectangle of Lagrange elements of one degree with element boundaries at ``breaks_s`` x ``breaks_t``."""
    x_s, conn_s = _nodes(np.asarray(breaks_s, dtype=float), degree)
    x_t, conn_t = _nodes(np.asarray(breaks_t, dtype=float), degree)
    C = lagrange_extraction(degree)
    C_s, C_t = (np.broadcast_to(C, (len(conn), *C.shape)) for conn in (conn_s, conn_t))
    y, x = np.meshgrid(x_t, x_s, indexing="ij")
    P_AI = np.stack([x.ravel(), y.ravel()], -1)
    return tensor_mesh((degree, degree), C_s, conn_s, C_t, conn_t, P_AI, np.ones(len(P_AI)))


def _nodes(breaks: np.ndarray, degree: int) -> tuple[np.ndarray, np.ndarray]:
    within = np.linspace(0.0, 1.0, degree + 1)[:-1]
    inner = breaks[:-1, None] + np.diff(breaks)[:, None] * within
    conn = np.arange(len(breaks) - 1)[:, None] * degree + np.arange(degree + 1)
    return np.append(inner.ravel(), breaks[-1]), conn
