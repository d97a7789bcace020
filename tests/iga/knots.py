"""Knot insertion and B-spline values: routes to a spline that know nothing of extraction."""

import numpy as np
from scipy.interpolate import BSpline

from iga.bases.bspline import KnotVector


def values(kv: KnotVector, x: np.ndarray) -> np.ndarray:
    """All B-splines (n_x, n) at points (n_x,), by SciPy's recursion of Cox and de Boor."""
    return BSpline.design_matrix(x, kv.knots, kv.degree).toarray()


def insert_knot(kv: KnotVector, x: float) -> tuple[KnotVector, np.ndarray]:
    """Insert one knot (Boehm 1980; Piegl and Tiller 1997, eq. 5.15).

    Returns
    -------
    kv : the finer knot vector, n + 1 functions.
    T : (n + 1, n), new control points = T @ old control points.
    """
    t, p, n = kv.knots, kv.degree, kv.functions
    k = int(np.searchsorted(t, x, side="right")) - 1
    i = np.arange(n + 1)
    alpha = np.where(i <= k - p, 1.0, 0.0)
    inside = i[k - p + 1 : k + 1]
    alpha[inside] = (x - t[inside]) / (t[inside + p] - t[inside])
    T = np.zeros((n + 1, n))
    T[i[:-1], i[:-1]] = alpha[:-1]
    T[i[1:], i[1:] - 1] = 1.0 - alpha[1:]
    return KnotVector(p, np.insert(t, k + 1, x)), T
