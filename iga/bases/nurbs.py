"""NURBS patches by extraction."""

from __future__ import annotations

import numpy as np

from iga.bases.basis import Basis
from iga.bases.bspline import KnotVector, bezier_extraction, open_knots
from iga.mesh.extraction import Mesh, Spans, tensor_mesh


def nurbs_mesh(kv_s: KnotVector, kv_t: KnotVector, P_AI: np.ndarray, w_A: np.ndarray | None = None) -> Mesh:
    """One NURBS patch.

    Parameters
    ----------
    kv_s, kv_t : knot vectors with n_s and n_t functions.
    P_AI : (n_s n_t, 2) control points, not homogeneous, index along s running fastest.
    w_A : (n_s n_t,) positive weights; default: all 1.

    Raises
    ------
    ValueError : a wrong number of control points or weights, or a weight that is not positive.
    """
    n_A = kv_s.functions * kv_t.functions
    w_A = np.ones(n_A) if w_A is None else np.asarray(w_A, dtype=float)
    if P_AI.shape != (n_A, 2) or w_A.shape != (n_A,):
        raise ValueError(f"the knot vectors ask for {n_A} control points and weights, got {len(P_AI)} and {w_A.size}")
    if not np.all(w_A > 0):
        raise ValueError(f"weights must be > 0, the smallest is {w_A.min()}")
    return tensor_mesh(_spans(kv_s), _spans(kv_t), P_AI, w_A)


def nurbs_rectangle(kv_s: KnotVector, kv_t: KnotVector) -> Mesh:
    """The rectangle of the two knot ranges; parameters are positions."""
    y, x = np.meshgrid(kv_t.greville, kv_s.greville, indexing="ij")
    return nurbs_mesh(kv_s, kv_t, np.stack([x.ravel(), y.ravel()], -1))


def _spans(kv: KnotVector) -> Spans:
    return Spans(bezier_extraction(kv), kv.spans[:, None] - kv.degree + np.arange(kv.degree + 1))


def _rectangle(degrees: tuple[int, int], breaks_s: np.ndarray, breaks_t: np.ndarray) -> Mesh:
    return nurbs_rectangle(*(open_knots(breaks, p) for breaks, p in zip((breaks_s, breaks_t), degrees, strict=True)))


NURBS = Basis(
    name="nurbs",
    label="NURBS",
    what="isogeometric, NURBS",
    columns=lambda degree, elements: elements + degree,
    rectangle=_rectangle,
    coarsest={2: 1.4, 3: 1.4, 4: 1.4},
    colours=("#0072b2", "#5bb8f0"),
    place=1,
    row=1,
)
