"""Closest points on a surface: where each slave point meets the master."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from iga.interface.surface import Surface

#: Sample points of the broad phase: so many on a side, and no more than this on the whole surface.
SAMPLES, MOST = 8, 1024
#: Newton steps within which a point that stays on its side arrives.
STROLL = 5
#: A point that crosses more sides than this from its last pairing has lost it.
CROSSINGS = 8
#: Parts of the side at an end by which a point may be beyond it: up to the first it is held as if the surface went on
#: straight, from the second on it is free.
HELD, FREE = 0.1, 0.3


@dataclass(frozen=True)
class Pairing:
    """Where each point met: side ``c_q``, parameter ``xi_q`` in [0, 1]; ``on_q`` is False beyond the ends."""

    c_q: np.ndarray
    xi_q: np.ndarray
    on_q: np.ndarray

    def __getitem__(self, q: np.ndarray) -> Pairing:
        return Pairing(self.c_q[q], self.xi_q[q], self.on_q[q])

    def set(self, q: np.ndarray, other: Pairing) -> None:
        """Take over the points q from another pairing of as many."""
        self.c_q[q], self.xi_q[q], self.on_q[q] = other.c_q, other.xi_q, other.on_q


def nearest_samples(surface: Surface, x_qi: np.ndarray, y_AI: np.ndarray) -> Pairing:
    """Broad phase: the nearest of some sample points spread over the sides, by a k-d tree.

    They are no more than `MOST`, so that the cost of a point has a bound, however many sides there are.
    """
    number = min(SAMPLES * surface.sides, MOST)
    along = (np.arange(number) + 0.5) * (surface.sides / number)
    c = along.astype(int)
    xi = along - c
    (r,) = surface.coefficients(c, xi, 0)
    y = np.einsum("qb,qbi->qi", r, surface.bezier_points(y_AI, c))
    _, nearest = cKDTree(y).query(x_qi)
    return Pairing(c[nearest], xi[nearest], np.ones(len(x_qi), dtype=bool))


def closest_points(
    surface: Surface, x_qi: np.ndarray, y_AI: np.ndarray, guess: Pairing, tolerance: float = 1e-6, iterations: int = 60
) -> Pairing:
    """Project points on the surface: ``(x - y(xi)) . y'(xi) = 0`` by Newton, from the pairing before.

    A point that runs off a side goes on from the end of the neighbour; at the two ends of the chain it is held there
    and marked as off. At a kink between two sides, where it would jump for ever, it stays on the kink. Points that have
    lost their partner (that are free of the ends, have crossed many sides, lie deeper in the body than a side is long,
    or stand where the distance is not least) are searched for on the whole surface. Only sides that are met are looked
    at.

    Parameters
    ----------
    surface : the master.
    x_qi : (n_q, 2) points.
    y_AI : (n_A, 2) current control points.
    guess : start, usually the pairing of the step before.
    tolerance : on the last change of xi; Newton doubles the digits, so the result is good to its square.

    Returns
    -------
    Pairing of all points.
    """
    found = _stroll(surface, x_qi, y_AI, guess, tolerance)
    q = np.flatnonzero(~found.on_q)
    if q.size == 0:
        return found
    rest, apart_q, lost_q = _walk(surface, x_qi[q], y_AI, guess[q], CROSSINGS, tolerance, iterations)
    found.set(q, rest)
    if not np.any(lost_q):
        return found
    q, apart_q = q[lost_q], apart_q[lost_q]
    start, crossings = nearest_samples(surface, x_qi[q], y_AI), CROSSINGS + 2 * surface.sides // MOST
    again, apart, _ = _walk(surface, x_qi[q], y_AI, start, crossings, tolerance, iterations + crossings)
    nearer = apart < apart_q
    found.set(q[nearer], again[nearer])
    return found


def _stroll(surface: Surface, x_qi: np.ndarray, y_AI: np.ndarray, guess: Pairing, tolerance: float) -> Pairing:
    """Plain Newton for the points that stay near, on their side or the next ones: ``on_q`` tells which have arrived."""
    c_q, xi_q = guess.c_q.copy(), guess.xi_q.copy()
    Q_qbi, on_q = surface.bezier_points(y_AI, c_q), (xi_q > 0.0) & (xi_q < 1.0)
    for _ in range(STROLL):
        jet_qki = np.stack(surface.coefficients(c_q, xi_q, 2), 1) @ Q_qbi
        d_qi, t_qi = x_qi - jet_qki[:, 0], jet_qki[:, 1]
        m_q, pull_q = (t_qi * t_qi).sum(-1), (d_qi * t_qi).sum(-1)
        a_q = m_q - (d_qi * jet_qki[:, 2]).sum(-1)
        step_q = pull_q / np.where(a_q > 0.1 * m_q, a_q, m_q)
        goal_q = xi_q + step_q
        on_q &= (a_q > 0.1 * m_q) & (goal_q > -1.0) & (goal_q < 2.0)
        inside_q = (goal_q > -tolerance) & (goal_q < 1.0 + tolerance)
        xi_q = np.where(on_q & inside_q, np.clip(goal_q, 0.0, 1.0), xi_q)
        crossing = np.flatnonzero(on_q & ~inside_q)
        if crossing.size:
            way = np.where(goal_q[crossing] > 0.5, 1, -1)
            c = surface.following(c_q[crossing], way)
            on_q[crossing] = c != c_q[crossing]
            c_q[crossing], xi_q[crossing] = c, goal_q[crossing] - way
            Q_qbi[crossing] = surface.bezier_points(y_AI, c)
        arrived_q = inside_q & (np.abs(step_q) <= tolerance)
        if (arrived_q | ~on_q).all():
            break
    depth_q = surface.outward * (t_qi[:, 1] * d_qi[:, 0] - t_qi[:, 0] * d_qi[:, 1])
    on_q &= arrived_q & (depth_q >= -m_q)
    return Pairing(np.where(on_q, c_q, guess.c_q), np.where(on_q, xi_q, guess.xi_q), on_q)


def _walk(
    surface: Surface,
    x_qi: np.ndarray,
    y_AI: np.ndarray,
    guess: Pairing,
    crossings: int,
    tolerance: float,
    iterations: int,
) -> tuple[Pairing, np.ndarray, np.ndarray]:
    """Pairing next to a guess, how far apart it is (infinite where there is none), and which points have lost theirs.

    On a side Newton is kept between the places where the distance is known to fall and to rise. Where the curvature
    makes its denominator useless, ``|y'|^2`` alone takes its place (Gauss-Newton).
    """
    c_q, xi_q, on_q = guess.c_q.copy(), guess.xi_q.copy(), np.ones(len(x_qi), dtype=bool)
    apart_q, lost_q = np.full(len(x_qi), np.inf), np.ones(len(x_qi), dtype=bool)
    # the points under way: where they are, between which places the distance is least, and how they came to their side
    q, x, c, xi, Q = np.arange(len(x_qi)), x_qi, c_q, xi_q, surface.bezier_points(y_AI, c_q)
    low: np.ndarray = np.full(len(q), -1.0)  # off the side, as high is: nothing is known
    high: np.ndarray = np.full(len(q), 2.0)
    came: np.ndarray = np.zeros(len(q), dtype=int)
    crossed, aside = np.zeros(len(q), dtype=int), np.zeros(len(q))
    for _ in range(iterations):
        r0, r1, r2 = surface.coefficients(c, xi, 2)
        y, t, t_xi = ((r[:, None] @ Q)[:, 0] for r in (r0, r1, r2))
        d = x - y
        m, pull = np.sum(t * t, -1), np.sum(d * t, -1)
        a = m - np.sum(d * t_xi, -1)
        step = ((xi == 1.0) & (pull > 0.0)).astype(int) - ((xi == 0.0) & (pull < 0.0))
        low, high = np.where(pull > 0.0, xi, low), np.where(pull < 0.0, xi, high)
        goal = xi + pull / np.where(a > 0.1 * m, a, m)
        goal = np.where((goal >= low) & (goal <= high), goal, 0.5 * (low + high))
        at_end = (step != 0) & (surface.following(c, step) == c)
        # on a kink, seen from both sides: the side whose normal is nearer keeps the point
        on_kink = (step != 0) & (step == -came)
        steps_back = on_kink & (aside < np.abs(pull) / np.sqrt(m))
        stays = at_end | on_kink | ((step == 0) & (np.abs(goal - xi) <= tolerance))  # a goal beyond the side is no end
        over = np.where(step != 0, np.abs(pull) / m, 0.0)
        leaps = (step != 0) & ~stays & (over > 2.0)
        entry = np.where(leaps, 0.5, (step < 0).astype(float))
        xi_next = np.where(step == 0, np.clip(goal, 0.0, 1.0), np.where(at_end | (on_kink & ~steps_back), xi, entry))
        further = surface.following(c, step * np.where(leaps, over, 1.0).astype(int))
        c_next = np.where(at_end | (on_kink & ~steps_back), c, further)
        c_q[q], xi_q[q], on_q[q] = c_next, xi_next, ~at_end | (over <= tolerance)
        within = surface.outward * (t[:, 1] * d[:, 0] - t[:, 0] * d[:, 1]) < -m
        lost_q[q] = ~stays | within | (at_end & (over > FREE)) | ((step == 0) & (a <= 0.0))
        apart_q[q] = np.where(stays & ((step != 0) | (a > 0.0)), np.sqrt(np.sum(d * d, -1)), np.inf)
        crosses = (step != 0) & ~stays
        going = ~stays & (crossed + crosses <= crossings)
        if not np.any(going):
            break
        low, high = np.where(crosses, -1.0, low), np.where(crosses, 2.0, high)
        came, aside = np.where(crosses & ~leaps, step, 0), np.abs(pull) / np.sqrt(m)
        q, x, c, xi, Q, low, high, crossed, came, aside, moved = (
            v[going] for v in (q, x, c_next, xi_next, Q, low, high, crossed + crosses, came, aside, crosses)
        )
        if np.any(moved):
            Q[moved] = surface.bezier_points(y_AI, c[moved])
    return Pairing(c_q, xi_q, on_q), apart_q, lost_q
