"""Elements in Bezier form: homogeneous control points of each element, by its extraction operator."""

from __future__ import annotations

import numpy as np

from iga.mesh.bernstein import bernstein, bernstein_derivative, tensor
from iga.mesh.extraction import ElementBlock


def homogeneous(P_AI: np.ndarray, w_A: np.ndarray, block: ElementBlock) -> np.ndarray:
    """Homogeneous Bezier points ``sum_a C_ab w_a (P_a, 1)`` (Borden, Scott, Evans, Hughes 2011, eq. 62).

    Parameters
    ----------
    P_AI : (n_A, d) control points, or control values of any field.
    w_A : (n_A,) weights.

    Returns
    -------
    H_ebI : (n_e, n_b, d + 1), the Bezier weights last.
    """
    H_AI = np.column_stack([P_AI * w_A[:, None], w_A])
    return block.C_eab.swapaxes(1, 2) @ H_AI[block.conn_ea]


def jacobian(H_ebI: np.ndarray, degrees: tuple[int, ...], points_q: np.ndarray) -> np.ndarray:
    """Jacobian determinants (n_e, n_q) at points (n_q, 2), of any sign.

    With homogeneous positions h = (W X, W) the determinant is ``det[h, h_s, h_t] / W^3``: the terms with derivatives of
    W are multiples of h and drop out.
    """
    (p, q), (s, t) = degrees, points_q.T
    h_eqI = tensor(bernstein(p, s), bernstein(q, t)) @ H_ebI
    h_s_eqI = tensor(bernstein_derivative(p, s), bernstein(q, t)) @ H_ebI
    h_t_eqI = tensor(bernstein(p, s), bernstein_derivative(q, t)) @ H_ebI
    return np.linalg.det(np.stack([h_s_eqI, h_t_eqI, h_eqI], -1)) / h_eqI[..., 2] ** 3
