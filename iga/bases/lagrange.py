"""Lagrange elements by extraction: the nodal basis in terms of Bernstein polynomials."""

from __future__ import annotations

import numpy as np

from iga.bases.basis import Basis
from iga.mesh.bernstein import bernstein
from iga.mesh.extraction import Mesh, Spans, tensor_mesh


def lagrange_extraction(degree: int) -> np.ndarray:
    """Extraction operator (p + 1, p + 1) of the equidistant Lagrange basis: L_a = sum_b C_ab B_b.

    ``L_a(x_c) = delta_ac`` at the nodes x_c gives ``C = V^{-T}`` with ``V_cb = B_b(x_c)``.
    """
    return np.linalg.inv(bernstein(degree, np.linspace(0.0, 1.0, degree + 1))).T


def lagrange_rectangle(breaks_s: np.ndarray, breaks_t: np.ndarray, degree: int, degree_t: int | None = None) -> Mesh:
    """Rectangle of Lagrange elements with boundaries at ``breaks_s`` (n_s + 1,) and ``breaks_t`` (n_t + 1,).

    ``degree`` is that of both directions unless ``degree_t`` gives another one for the second.

    Raises
    ------
    ValueError : a degree below 1, boundaries that do not rise.
    """
    degree_t = degree if degree_t is None else degree_t
    if min(degree, degree_t) < 1:
        raise ValueError(f"degree: must be >= 1, got {min(degree, degree_t)}")
    y, x = np.meshgrid(_nodes(breaks_t, degree_t), _nodes(breaks_s, degree), indexing="ij")
    P_AI = np.stack([x.ravel(), y.ravel()], -1)
    spans = _spans(len(breaks_s) - 1, degree), _spans(len(breaks_t) - 1, degree_t)
    return tensor_mesh(*spans, P_AI, np.ones(len(P_AI)))


def _nodes(breaks: np.ndarray, degree: int) -> np.ndarray:
    """Equidistant nodes (n_e p + 1,) of all elements."""
    breaks = np.asarray(breaks, dtype=float)
    if not np.all(np.diff(breaks) > 0.0):
        raise ValueError(f"breaks: must rise, got {breaks.tolist()}")
    within = np.linspace(0.0, 1.0, degree + 1)[:-1]
    inner = breaks[:-1, None] + np.diff(breaks)[:, None] * within
    return np.append(inner.ravel(), breaks[-1])


def _spans(n_e: int, degree: int) -> Spans:
    C_eab = np.broadcast_to(lagrange_extraction(degree), (n_e, degree + 1, degree + 1))
    return Spans(C_eab, np.arange(n_e)[:, None] * degree + np.arange(degree + 1))


# Its elements are three times longer than those of NURBS at equal unknowns, with about three of them in the process
# zone: J is 1.0 to 1.9 % off on the packaged scenes, by the mesh and not by the solver.
LAGRANGE = Basis(
    name="lagrange",
    label="Lagrange",
    what="isogeometric code, Lagrange basis",
    columns=lambda degree, elements: elements * degree + 1,
    rectangle=lambda degrees, breaks_s, breaks_t: lagrange_rectangle(breaks_s, breaks_t, *degrees),
    smooth=False,
    mesh_error=0.02,
    in_a_zone=0.75,  # of three times as many nodes
    in_fading=0.75,
    coarsest={2: 1.0, 3: 0.7, 4: 0.5},
    colours=("#bf5400", "#ff9a52"),
    dashes=(5.0, 2.0),
    place=2,
)
