"""Newton on the gaps alone, with the bulk as it was when its tangent was factorised.

With bulk and normals linearised only the law remains nonlinear, and only at points that arrive on another of its
branches. With ``w``, the part of their tractions that the tangent does not give,

    g = g0 - C w(g)

under the control, with ``g0`` the gaps after the linear step and ``C`` the compliance of the specimen for tractions at
the points: a few equations, solved by Newton before the bulk is evaluated again. Only columns of such points are needed
(Woodbury 1950), and where the law is piecewise linear it ends exactly, on the branches where all points belong. It is
for bonds that only open: with two jumps a point it takes longer than the tangents that it saves.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag, qr
from scipy.linalg.lapack import dgesv

from iga.algebra.factors import Bordered
from iga.interface.contact import Contact


@dataclass(frozen=True)
class GapLimits:
    """How much work Newton on the gaps may take before a new tangent is cheaper, and when it has converged.

    - ``corrections``: largest number of corrections of the gaps.
    - ``damped``: from this correction on every other one goes half way while the error of the traction is above the
      part ``large`` of the largest traction: on a softening law full corrections may go round in circles.
    - ``agreed``: converged when tractions agree with the law within this part of the largest.
    - ``loads``: largest number of load vectors that are solved for. A new tangent costs as much as 50 to 100 of them.
    - ``entries``: largest number of numbers in all solutions; to move more takes longer than a tangent.
    - ``sharing``: number of points that may share one load vector.
    - ``single``: with fewer new points than this each has a load vector of its own; otherwise linearly dependent ones,
      below ``rounding`` of the largest, are left out.
    """

    corrections: int = 40
    damped: int = 6
    large: float = 0.1
    agreed: float = 1e-12
    loads: int = 192
    entries: int = 800_000
    sharing: int = 4
    single: int = 6
    rounding: float = 1e-14


GAP_NEWTON = GapLimits()


@dataclass(frozen=True)
class Loads:
    """Tractions at some ``points`` (n_p,) as sums of load vectors, and the steps ``steps_dr`` (n_dof + 1, n_r) that
    these cause with an unchanged control.

    ``rows_pr`` (n_p, n_r) combine the load vectors to the gradient of the gap at each point; ``gaps_pr`` (n_p, n_r) are
    the changes of the gaps at the points under a unit of each.
    """

    points: np.ndarray
    rows_pr: np.ndarray
    steps_dr: np.ndarray
    gaps_pr: np.ndarray

    def with_points(self, new: np.ndarray, touch: Contact, tied: Bordered) -> Loads | None:
        """The same with more points; None where that would cost more than a new tangent."""
        n_dof, points = tied.a_d.size, np.append(self.points, new)
        most = min(GAP_NEWTON.loads, GAP_NEWTON.entries // (n_dof + 1))
        if points.size > GAP_NEWTON.sharing * most:
            return None
        loads_dr, parts_rm = spanned(touch.rows(new, n_dof))
        if self.steps_dr.shape[1] + loads_dr.shape[1] > most:
            return None
        steps_dr = np.concatenate([self.steps_dr, tied.solve(loads_dr)], axis=1)
        return Loads(points, block_diag(self.rows_pr, parts_rm.T), steps_dr, touch.rates(steps_dr[:-1], points))


def settled_step(
    touch: Contact,
    dA_q: np.ndarray,
    known: tuple[np.ndarray, np.ndarray],
    law: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]],
    linear_d: np.ndarray,
    tied: Bordered,
    guess_q: np.ndarray | None = None,
) -> np.ndarray | None:
    """The step (n_dof + 1,) of displacements and load with all tractions on the law; None where none is found.

    Parameters
    ----------
    touch : contact where the step begins, of points with the areas dA_q (n_q,).
    known : tractions and slopes (n_q,) there, those of the tangent.
    law : tractions and slopes (n_q,) for gaps (n_q,).
    linear_d : the step (n_dof + 1,) with all points on their tangents.
    tied : the tangent and the control.
    guess_q : gaps (n_q,) to begin with, those of the linear step if left out.
    """
    start_q, none = touch.g_q, np.arange(0)
    g0_q, (p0_q, dp0_q) = start_q + touch.rates(linear_d[:-1]), known
    loads = Loads(none, np.zeros((0, 0)), np.zeros((linear_d.size, 0)), np.zeros((0, 0)))
    carried_q, z_r = np.zeros(g0_q.size), np.zeros(0)
    g_q, guessed = (g0_q, False) if guess_q is None else (guess_q, True)
    for correction in range(1, GAP_NEWTON.corrections + 1):
        p_q, dp_q = law(g_q)
        w_q, slope_q = p_q - p0_q - dp0_q * (g_q - start_q), dp_q - dp0_q
        left_q, largest = np.abs(w_q - carried_q), np.abs(p_q).max()
        left = left_q.max()
        if not guessed and left <= GAP_NEWTON.agreed * largest:
            return linear_d - loads.steps_dr @ z_r
        left_q[loads.points] = 0.0
        new = np.flatnonzero(left_q > GAP_NEWTON.agreed * largest)
        more = loads.with_points(new, touch, tied) if new.size else loads
        if more is None:
            return None
        loads, p = more, more.points
        # sizes z of the load vectors with which all tractions satisfy the linearised law
        parts_pr = loads.rows_pr * dA_q[p, None]
        small_rr = parts_pr.T @ (slope_q[p, None] * loads.gaps_pr) + np.eye(parts_pr.shape[1])
        if p.size:  # at a guess all points may be on their tangents
            _, _, z_r, failed = dgesv(small_rr, parts_pr.T @ (w_q + slope_q * (g0_q - g_q))[p], overwrite_a=True)
            if failed:  # the law softens as much as the specimen is stiff
                return None
        next_q = g0_q - touch.rates(loads.steps_dr[:-1] @ z_r)
        carried_q[p] = w_q[p] + slope_q[p] * (next_q - g_q)[p]
        guessed = not guessed and correction >= GAP_NEWTON.damped and left > GAP_NEWTON.large * largest
        g_q = 0.5 * (g_q + next_q) if guessed else next_q
    return None


def spanned(rows_dm: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Vectors (n_dof, n_r) that span ``rows_dm``, and the coefficients (n_r, n_m) that combine them to ``rows_dm``.

    Points of an element share its functions: there are fewer independent vectors than points.
    """
    n_m = rows_dm.shape[1]
    if n_m < GAP_NEWTON.single:
        return rows_dm, np.eye(n_m)
    used = np.flatnonzero(rows_dm.any(axis=1))
    if used.size <= n_m:  # unit vectors of the unknowns that are involved span all
        Q, parts_rm = np.eye(used.size), rows_dm[used]
    else:
        Q, R, order = qr(rows_dm[used], mode="economic", pivoting=True, check_finite=False)
        size_r = np.abs(np.diagonal(R))
        rank = int(np.count_nonzero(size_r > GAP_NEWTON.rounding * size_r[0]))
        Q, parts_rm = Q[:, :rank], np.empty((rank, n_m))
        parts_rm[:, order] = R[:rank]
    vectors_dr = np.zeros((len(rows_dm), len(parts_rm)), order="F")
    vectors_dr[used] = Q
    return vectors_dr, parts_rm
