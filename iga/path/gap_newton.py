"""Newton on the gaps alone, with the bulk as it was when its tangent was factorised.

With bulk and normals linearised all that is left nonlinear of a step is the law, and of that only the points that
arrive on another branch. By the tractions ``w`` that leave their tangents there

    g = g0 - C w(g)

under the control, with ``g0`` the gaps after the plain step and ``C`` the compliance of the specimen for tractions at
the points: a few equations, solved by Newton before the bulk is evaluated again. Only columns of such points are needed
(Woodbury 1950), and where the law is piecewise linear it ends exactly, on the branches where all points belong.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.linalg import qr
from scipy.linalg.lapack import dgesv

from iga.algebra.factors import Bordered
from iga.interface.interface import Contact, Interface

#: Corrections of the gaps; after how many of them every other one goes half way as long as so large a part of the
#: traction is left, as they may go round in circles on a law that softens; and how far tractions may be from the law,
#: in parts of the largest.
CORRECTIONS, ROUND, LARGE, AGREED = 40, 6, 0.1, 1e-12
#: Solutions that this may take, two tangents or so, each of which is worth 25 to 40 of them; unknowns up to which
#: tangents are so little work that any number may be taken; numbers in all solutions, which are more work to move about
#: than a tangent where there are more; and points that share a solution.
MOST, SMALL, ENTRIES, SHARING = 64, 256, 200_000, 4
#: Fewer points than these are solved for one by one; part of the largest below which what they add is rounding.
FEW, NOTHING = 6, 1e-14


def settled_step(
    interface: Interface,
    touch: Contact,
    law: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]],
    tangents: tuple[np.ndarray, np.ndarray],
    plain_d: np.ndarray,
    system: Bordered,
    guess_q: np.ndarray | None = None,
) -> np.ndarray | None:
    """The step (n_dof + 1,) of displacements and load with all tractions on the law; None where none is found.

    Parameters
    ----------
    touch : gaps and their gradients where the step begins.
    law : tractions and slopes (n_q,) for gaps (n_q,).
    tangents : tractions and slopes (n_q,) there, as the tangent has them.
    plain_d : the step (n_dof + 1,) with all points on their tangents.
    guess_q : gaps (n_q,) to begin with, those of the plain step if left out.
    """
    (p0_q, dp0_q), g0_q = tangents, touch.g_q + touch.rates(plain_d[:-1])
    n_dof, most = plain_d.size - 1, ENTRIES // plain_d.size
    most, every = most if n_dof <= SMALL else min(MOST, most), n_dof <= MOST  # every: for all points, from the start
    points = np.arange(g0_q.size if every else 0)
    at = slice(None) if every else points
    parts_mr = touch.rows(points, n_dof).T * interface.dA_q[points, None] if every else np.zeros((0, 0))
    steps_dr = system.solve(np.eye(n_dof)) if every else np.zeros((plain_d.size, 0))
    felt_mr, told_q, z_r = touch.rates(steps_dr[:-1], at), np.zeros(g0_q.size), np.zeros(parts_mr.shape[1])
    g_q, guessed = (g0_q, False) if guess_q is None else (guess_q, True)
    for correction in range(1, CORRECTIONS + 1):
        p_q, dp_q = law(g_q)
        w_q, slope_q = p_q - p0_q - dp0_q * (g_q - touch.g_q), dp_q - dp0_q
        left_q, largest = np.abs(w_q - told_q), np.abs(p_q).max()
        left = left_q.max()
        if not guessed and left <= AGREED * largest:
            return plain_d - steps_dr @ z_r
        if not every:
            left_q[points] = 0.0
            new = (left_q > AGREED * largest).nonzero()[0]
            if new.size:
                if points.size + new.size > SHARING * most:
                    return None
                pulls_dr, more_rm = _spanned(touch.rows(new, n_dof) * interface.dA_q[new])
                if parts_mr.shape[1] + pulls_dr.shape[1] > most:
                    return None
                points, parts_mr = np.append(points, new), _beside(parts_mr, more_rm.T)
                steps_dr, at = np.concatenate([steps_dr, system.solve(pulls_dr)], axis=1), points
                felt_mr = touch.rates(steps_dr[:-1], points)
        # of the tractions only what the pulls feel is unknown: z = P w
        slope, w = slope_q[at], w_q[at]
        bent = slope.nonzero()[0]
        felt, parts = (v_mr.take(bent, axis=0) for v_mr in (felt_mr, parts_mr))  # twice as fast as indexing
        transposed_rr = felt.T @ (slope[bent, None] * parts)
        transposed_rr.flat[:: len(transposed_rr) + 1] += 1.0
        if len(transposed_rr):  # a guess may have all points on their tangents
            pull_r = (w + slope * (g0_q - g_q)[at]) @ parts_mr
            _, _, z_r, failed = dgesv(transposed_rr.T, pull_r, overwrite_a=True, overwrite_b=True)
            if failed:  # just as soft as the specimen is stiff
                return None
        next_q = g0_q - (felt_mr @ z_r if every else touch.rates(steps_dr[:-1] @ z_r))
        told_q[at] = w + slope * (next_q - g_q)[at]
        guessed = not guessed and correction >= ROUND and left > LARGE * largest
        g_q = 0.5 * (g_q + next_q) if guessed else next_q
    return None


def _spanned(rows_dm: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Vectors (n_dof, n_r) that span some others, and the parts (n_r, n_m) in which they make these up.

    Points of an element share its functions: there are less independent ones than points.
    """
    n_m = rows_dm.shape[1]
    if n_m < FEW:
        return rows_dm, np.eye(n_m)
    used = np.flatnonzero(rows_dm.any(axis=1))
    if used.size <= n_m:  # there are no more unknowns that feel them: these are vectors enough
        Q, parts_rm = np.eye(used.size), rows_dm[used]
    else:
        Q, R, order = qr(rows_dm[used], mode="economic", pivoting=True, check_finite=False)
        size_r = np.abs(np.diagonal(R))
        rank = int(np.count_nonzero(size_r > NOTHING * size_r[0]))
        Q, parts_rm = Q[:, :rank], np.empty((rank, n_m))
        parts_rm[:, order] = R[:rank]
    vectors_dr = np.zeros((len(rows_dm), len(parts_rm)), order="F")
    vectors_dr[used] = Q
    return vectors_dr, parts_rm


def _beside(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Both as blocks on the diagonal; SciPy's of that name takes as long as the solution with them."""
    both = np.zeros((a.shape[0] + b.shape[0], a.shape[1] + b.shape[1]))
    both[: a.shape[0], : a.shape[1]], both[a.shape[0] :, a.shape[1] :] = a, b
    return both
