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
from functools import cached_property

import numpy as np
from scipy.linalg import qr
from scipy.linalg.lapack import dgesv

from iga.algebra.caused import Caused
from iga.algebra.factors import Bordered
from iga.interface.contact import Contact
from iga.interface.interface import Interface


@dataclass(frozen=True)
class GapLimits:
    """How much work Newton on the gaps may take before a new tangent is cheaper, and when it has converged.

    - ``corrections``: largest number of corrections of the gaps; ``patience`` times as many where the law is patient.
    - ``damped``: from this correction on every other one goes half way while the error of the traction is above the
      part ``large`` of the largest traction: on a softening law full corrections may go round in circles.
    - ``agreed``: converged when tractions agree with the law within this part of the largest.
    - ``solutions``: largest number of solutions with the factors. A new tangent costs as much as 50 to 100 of them
      with a Cholesky factor. Up to ``unknowns`` unknowns this limit does not apply.
    - ``small``: number of unknowns up to which each is a pull.
    - ``entries``: largest number of numbers in all solutions; to move more takes longer than a tangent.
    - ``sharing``: number of points that may share one solution.
    - ``apart``: with fewer tractions than this each has a solution of its own; otherwise linearly dependent ones,
      below ``rounding`` of the largest, are left out.
    """

    corrections: int = 40
    patience: int = 10
    damped: int = 6
    large: float = 0.1
    agreed: float = 1e-12
    solutions: int = 192
    unknowns: int = 256
    small: int = 64
    entries: int = 800_000
    sharing: int = 4
    apart: int = 6
    rounding: float = 1e-14


GAP_NEWTON = GapLimits()


@dataclass(frozen=True)
class GapLaw:
    """The law of an interface at a contact: ``at`` gives tractions and slopes (n_q,) for gaps (n_q,); ``p_q`` and
    ``dp_q`` are those of the tangent. ``patient``: accept any number of points that arrive on another branch."""

    interface: Interface
    touch: Contact
    at: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]
    p_q: np.ndarray
    dp_q: np.ndarray
    patient: bool = False


@dataclass(frozen=True)
class Pulls:
    """Tractions at some ``points`` as sums of load vectors (pulls), and the steps that these cause.

    ``rows_pr`` (n_p, n_r) are the coefficients that combine the pulls to the gradient of the gap at each point.
    ``every``: all points are included, and each unknown is a pull.
    """

    law: GapLaw
    points: np.ndarray | slice
    rows_pr: np.ndarray
    caused: Caused

    @property
    def every(self) -> bool:
        return isinstance(self.points, slice)

    @cached_property
    def parts_pr(self) -> np.ndarray:
        """Part (n_p, n_r) of each pull in the traction of a point."""
        return self.rows_pr * self.law.interface.dA_q[self.points, None]

    @cached_property
    def felt_pr(self) -> np.ndarray:
        """Change (n_p, n_r) of the gaps at the points by a unit of each pull."""
        return self.rows_pr @ self.caused.work_rr

    def with_points(self, new: np.ndarray, n_dof: int) -> Pulls | None:
        """The same with more points; None where that would cost more than a new tangent."""
        assert isinstance(self.points, np.ndarray)
        limits, points = GAP_NEWTON, np.append(self.points, new)
        most = limits.entries // (n_dof + 1)
        most = most if n_dof <= limits.unknowns else min(limits.solutions, most)
        most = n_dof if self.law.patient else most
        if points.size > limits.sharing * most:
            return None
        pulls_dr, rows_rm = _spanned(self.law.touch.rows(new, n_dof))
        if self.rows_pr.shape[1] + pulls_dr.shape[1] > most:
            return None
        return Pulls(self.law, points, _beside(self.rows_pr, rows_rm.T), self.caused.with_loads(pulls_dr))

    def sizes(self, w_p: np.ndarray, slope_p: np.ndarray, way_p: np.ndarray) -> np.ndarray | None:
        """Sizes z (n_r,) of the pulls with which all tractions satisfy the linearised law; None where it is singular.

        Of the tractions w_p (n_p,) only their sums over the pulls are unknown: ``z = P w``. ``way_p`` are the gaps of
        the linear step less those at which ``w_p`` and ``slope_p`` were evaluated.
        """
        bent = slope_p.nonzero()[0]
        felt, parts = (v_pr.take(bent, axis=0) for v_pr in (self.felt_pr, self.parts_pr))  # faster than indexing
        transposed_rr = felt.T @ (slope_p[bent, None] * parts)
        if not len(transposed_rr):  # at a guess all points may be on their tangents
            return np.zeros(0)
        transposed_rr.flat[:: len(transposed_rr) + 1] += 1.0
        pull_r = (w_p + slope_p * way_p) @ self.parts_pr
        _, _, z_r, failed = dgesv(transposed_rr.T, pull_r, overwrite_a=True, overwrite_b=True)
        return None if failed else z_r  # singular: the law softens as much as the specimen is stiff

    def change(self, z_r: np.ndarray) -> np.ndarray:
        """Change of all gaps (n_q,) by pulls of these sizes."""
        return self.felt_pr @ z_r if self.every else self.law.touch.rates(self.caused.step(z_r)[:-1])


def settled_step(
    law: GapLaw, linear_d: np.ndarray, tied: Bordered, guess_q: np.ndarray | None = None
) -> np.ndarray | None:
    """The step (n_dof + 1,) of displacements and load with all tractions on the law; None where none is found.

    Parameters
    ----------
    law : at the contact where the step begins.
    linear_d : the step (n_dof + 1,) with all points on their tangents.
    tied : the tangent and the control.
    guess_q : gaps (n_q,) to begin with, those of the linear step if left out.
    """
    touch, n_dof = law.touch, linear_d.size - 1
    start_q = touch.g_q
    g0_q, pulls = start_q + touch.rates(linear_d[:-1]), _first_pulls(law, tied, n_dof)
    known_q, z_r = np.zeros(g0_q.size), np.zeros(pulls.caused.loads)
    g_q, guessed = (g0_q, False) if guess_q is None else (guess_q, True)
    most = GAP_NEWTON.corrections * (GAP_NEWTON.patience if law.patient else 1)
    for correction in range(1, most + 1):
        p_q, dp_q = law.at(g_q)
        w_q, slope_q = p_q - law.p_q - law.dp_q * (g_q - start_q), dp_q - law.dp_q
        left_q, largest = np.abs(w_q - known_q), np.abs(p_q).max()
        left = left_q.max()
        if not guessed and left <= GAP_NEWTON.agreed * largest:
            return linear_d - pulls.caused.step(z_r)
        if not pulls.every:
            left_q[pulls.points] = 0.0
            new = (left_q > GAP_NEWTON.agreed * largest).nonzero()[0]
            more = pulls.with_points(new, n_dof) if new.size else pulls
            if more is None:
                return None
            pulls = more
        at = pulls.points
        found_r = pulls.sizes(w_q[at], slope_q[at], (g0_q - g_q)[at])
        if found_r is None:
            return None
        z_r, next_q = found_r, g0_q - pulls.change(found_r)
        known_q[at] = w_q[at] + slope_q[at] * (next_q - g_q)[at]
        guessed = not guessed and correction >= GAP_NEWTON.damped and left > GAP_NEWTON.large * largest
        g_q = 0.5 * (g_q + next_q) if guessed else next_q
    return None


def _first_pulls(law: GapLaw, tied: Bordered, n_dof: int) -> Pulls:
    """No points, or all of them where there are only a few unknowns."""
    none = Caused.none(tied)
    if n_dof > GAP_NEWTON.small:
        return Pulls(law, np.arange(0), np.zeros((0, 0)), none)
    every = np.arange(law.touch.g_q.size)
    return Pulls(law, slice(None), law.touch.rows(every, n_dof).T, none.with_loads(np.eye(n_dof)))


def _spanned(rows_dm: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Vectors (n_dof, n_r) that span ``rows_dm``, and the coefficients (n_r, n_m) that combine them to ``rows_dm``.

    Points of an element share its functions: there are fewer independent vectors than points.
    """
    n_m = rows_dm.shape[1]
    if n_m < GAP_NEWTON.apart:
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


def _beside(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Both as blocks on the diagonal; `scipy.linalg.block_diag` takes as long as the solution with them."""
    both = np.zeros((a.shape[0] + b.shape[0], a.shape[1] + b.shape[1]))
    both[: a.shape[0], : a.shape[1]], both[a.shape[0] :, a.shape[1] :] = a, b
    return both
