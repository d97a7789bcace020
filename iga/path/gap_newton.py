"""Newton on the gaps alone, with the bulk as it was when its tangent was factorised.

With bulk and normals linearised all that is left nonlinear of a step is the law, and of that only the points that
arrive on another branch. By the tractions ``w`` that leave their tangents there

    g = g0 - C w(g)

under the control, with ``g0`` the gaps after the linear step and ``C`` the compliance of the specimen for tractions at
the points: a few equations, solved by Newton before the bulk is evaluated again. Only columns of such points are needed
(Woodbury 1950), and where the law is piecewise linear it ends exactly, on the branches where all points belong.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import qr
from scipy.linalg.lapack import dgesv

from iga.algebra.factors import Bordered
from iga.interface.contact import Contact
from iga.interface.interface import Interface


@dataclass(frozen=True)
class GapLimits:
    """What this may cost before a new tangent is the better choice, and when it has converged.

    ``corrections`` of the gaps; from number ``damped`` on every other one goes half way as long as more than the part
    ``large`` of the traction is left, as they may go round in circles on a law that softens. Tractions agree with the
    law within ``agreed`` of the largest. There are at most ``solutions``, two tangents or so, each of which is worth 25
    to 40 of them; up to ``unknowns`` tangents are so little work that any number may be taken; with more than
    ``entries`` numbers in all solutions these are more work to move about than a tangent; ``sharing`` points share one.
    Fewer points than ``apart`` are solved for one by one; what they add is rounding below ``rounding`` of the largest.
    """

    corrections: int = 40
    damped: int = 6
    large: float = 0.1
    agreed: float = 1e-12
    solutions: int = 64
    unknowns: int = 256
    entries: int = 200_000
    sharing: int = 4
    apart: int = 6
    rounding: float = 1e-14


GAP_NEWTON = GapLimits()


@dataclass(frozen=True)
class GapLaw:
    """The law of an interface at a contact: tractions and slopes (n_q,) for gaps (n_q,), and those of the tangent."""

    interface: Interface
    touch: Contact
    at: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]
    p_q: np.ndarray
    dp_q: np.ndarray


@dataclass(frozen=True)
class Pulls:
    """Tractions at some ``points`` as sums of pulls, and the steps that a unit of each causes.

    ``parts_mr`` (n_m, n_r) is the part of each pull in the traction of a point, ``steps_dr`` (n_dof + 1, n_r) the steps
    and ``felt_mr`` (n_m, n_r) the change of the gaps there. All points and all unknowns are in it where ``every``.
    """

    law: GapLaw
    tied: Bordered
    points: np.ndarray | slice
    parts_mr: np.ndarray
    steps_dr: np.ndarray
    felt_mr: np.ndarray

    @property
    def every(self) -> bool:
        return isinstance(self.points, slice)

    def with_points(self, new: np.ndarray, n_dof: int) -> Pulls | None:
        """The same with more points; None where that would cost more than a new tangent."""
        assert isinstance(self.points, np.ndarray)
        limits, touch, points = GAP_NEWTON, self.law.touch, np.append(self.points, new)
        most = limits.entries // (n_dof + 1)
        most = most if n_dof <= limits.unknowns else min(limits.solutions, most)
        if points.size > limits.sharing * most:
            return None
        pulls_dr, more_rm = _spanned(touch.rows(new, n_dof) * self.law.interface.dA_q[new])
        if self.parts_mr.shape[1] + pulls_dr.shape[1] > most:
            return None
        steps_dr = np.concatenate([self.steps_dr, self.tied.solve(pulls_dr)], axis=1)
        felt_mr, parts_mr = touch.rates(steps_dr[:-1], points), _beside(self.parts_mr, more_rm.T)
        return replace(self, points=points, parts_mr=parts_mr, steps_dr=steps_dr, felt_mr=felt_mr)

    def sizes(self, w: np.ndarray, slope: np.ndarray, way: np.ndarray) -> np.ndarray | None:
        """Sizes z (n_r,) of the pulls with which all tractions are on their slopes; None where there are none.

        Only what the pulls feel of the tractions (n_m,) is unknown: ``z = P w``. ``way`` is how far the gaps of the
        linear step are from those at which ``w`` and ``slope`` are.
        """
        bent = slope.nonzero()[0]
        felt, parts = (v_mr.take(bent, axis=0) for v_mr in (self.felt_mr, self.parts_mr))  # twice as fast as indexing
        transposed_rr = felt.T @ (slope[bent, None] * parts)
        if not len(transposed_rr):  # a guess may have all points on their tangents
            return np.zeros(0)
        transposed_rr.flat[:: len(transposed_rr) + 1] += 1.0
        pull_r = (w + slope * way) @ self.parts_mr
        _, _, z_r, failed = dgesv(transposed_rr.T, pull_r, overwrite_a=True, overwrite_b=True)
        return None if failed else z_r  # just as soft as the specimen is stiff

    def change(self, z_r: np.ndarray) -> np.ndarray:
        """Change of all gaps (n_q,) by pulls of these sizes."""
        return self.felt_mr @ z_r if self.every else self.law.touch.rates(self.steps_dr[:-1] @ z_r)


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
    g0_q, pulls = touch.g_q + touch.rates(linear_d[:-1]), _first_pulls(law, tied, n_dof)
    known_q, z_r = np.zeros(g0_q.size), np.zeros(pulls.parts_mr.shape[1])
    g_q, guessed = (g0_q, False) if guess_q is None else (guess_q, True)
    for correction in range(1, GAP_NEWTON.corrections + 1):
        p_q, dp_q = law.at(g_q)
        w_q, slope_q = p_q - law.p_q - law.dp_q * (g_q - touch.g_q), dp_q - law.dp_q
        left_q, largest = np.abs(w_q - known_q), np.abs(p_q).max()
        left = left_q.max()
        if not guessed and left <= GAP_NEWTON.agreed * largest:
            return linear_d - pulls.steps_dr @ z_r
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
    if n_dof > GAP_NEWTON.solutions:
        return Pulls(law, tied, np.arange(0), np.zeros((0, 0)), np.zeros((n_dof + 1, 0)), np.zeros((0, 0)))
    every, dA_q = np.arange(law.touch.g_q.size), law.interface.dA_q
    parts_mr, steps_dr = law.touch.rows(every, n_dof).T * dA_q[:, None], tied.solve(np.eye(n_dof))
    return Pulls(law, tied, slice(None), parts_mr, steps_dr, law.touch.rates(steps_dr[:-1]))


def _spanned(rows_dm: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Vectors (n_dof, n_r) that span some others, and the parts (n_r, n_m) in which they make these up.

    Points of an element share its functions: there are less independent ones than points.
    """
    n_m = rows_dm.shape[1]
    if n_m < GAP_NEWTON.apart:
        return rows_dm, np.eye(n_m)
    used = np.flatnonzero(rows_dm.any(axis=1))
    if used.size <= n_m:  # there are no more unknowns that feel them: these are vectors enough
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
    """Both as blocks on the diagonal; SciPy's of that name takes as long as the solution with them."""
    both = np.zeros((a.shape[0] + b.shape[0], a.shape[1] + b.shape[1]))
    both[: a.shape[0], : a.shape[1]], both[a.shape[0] :, a.shape[1] :] = a, b
    return both
