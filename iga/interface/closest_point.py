"""Closest points on a surface: where each slave point meets the master."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np

from iga.interface.surface import Surface


@dataclass(frozen=True)
class ProjectionLimits:
    """How far and how long a closest point is searched for.

    - ``samples``, ``most``: sample points of the broad phase, on each side and at most on the whole surface.
    - ``near``: Newton steps within which points arrive that stay near their side. Others walk along the chain for at
      most ``iterations``; one that crosses more than ``crossings`` sides is searched for anew.
    - ``tolerance``: on the last change of xi. Newton converges quadratically: the error is about its square.
    - ``held``: distance beyond an end of the chain, in parts of the side, up to which a point meets the straight
      continuation of the surface in full; from the distance ``free`` on it meets nothing.
    """

    samples: int = 8
    most: int = 1024
    near: int = 5
    crossings: int = 8
    iterations: int = 60
    tolerance: float = 1e-6
    held: float = 0.1
    free: float = 0.3


PROJECTION = ProjectionLimits()


@dataclass(frozen=True)
class Pairing:
    """Where each point met: side ``c_q``, parameter ``xi_q`` in [0, 1]; ``on_q`` is False beyond the ends."""

    c_q: np.ndarray
    xi_q: np.ndarray
    on_q: np.ndarray

    def __getitem__(self, q: np.ndarray) -> Pairing:
        return Pairing(self.c_q[q], self.xi_q[q], self.on_q[q])

    def set(self, q: np.ndarray, other: Pairing) -> None:
        """Replace the pairing of the points q by ``other``, a pairing of these points alone."""
        self.c_q[q], self.xi_q[q], self.on_q[q] = other.c_q, other.xi_q, other.on_q


def nearest_samples(surface: Surface, x_qi: np.ndarray, y_AI: np.ndarray) -> Pairing:
    """Broad phase: the nearest of some sample points spread over the sides, ``|y|^2 / 2 - x . y`` being the least.

    At most `ProjectionLimits.most` samples bound the cost, however many sides there are.
    """
    number = min(PROJECTION.samples * surface.sides, PROJECTION.most)
    along = (np.arange(number) + 0.5) * (surface.sides / number)
    c = along.astype(int)
    xi = along - c
    (r,) = surface.coefficients(c, xi, 0)
    y = np.einsum("qb,qbi->qi", r, surface.bezier_points(y_AI, c))
    x_qi, y = x_qi - y.mean(0), y - y.mean(0)
    parts = np.array_split(x_qi, 1 + len(x_qi) // PROJECTION.most)
    nearest = np.concatenate([np.argmin(0.5 * np.sum(y**2, axis=1) - part @ y.T, axis=1) for part in parts])
    return Pairing(c[nearest], xi[nearest], np.ones(len(x_qi), dtype=bool))


def closest_points(surface: Surface, x_qi: np.ndarray, y_AI: np.ndarray, guess: Pairing) -> Pairing:
    """Project points on the surface: ``(x - y(xi)) . y'(xi) = 0`` by Newton, from the pairing before.

    The projection of a point that runs off a side goes on from the end of the neighbour; at the two ends of the chain
    it stays and is marked as off. At a kink between two sides, where it would jump for ever, it stays on the kink. Some
    points are then searched for on the whole surface: those beyond an end by more than `ProjectionLimits.free`, those
    that have crossed too many sides, lie deeper in the body than a side is long, or have found no minimum of the
    distance. Only sides that points meet are evaluated.

    Parameters
    ----------
    surface : the master.
    x_qi : (n_q, 2) points.
    y_AI : (n_A, 2) current control points.
    guess : start, usually the pairing of the step before.

    Returns
    -------
    Pairing of all points.
    """
    found, limits = _nearby(surface, x_qi, y_AI, guess), PROJECTION
    q = np.flatnonzero(~found.on_q)
    if q.size == 0:
        return found
    rest, apart_q, lost_q = _along_chain(surface, x_qi[q], y_AI, guess[q], limits.crossings, limits.iterations)
    found.set(q, rest)
    if not np.any(lost_q):
        return found
    q, apart_q = q[lost_q], apart_q[lost_q]
    start, crossings = _anew(surface, x_qi[q], y_AI, guess.c_q[q]), limits.crossings + 2 * surface.sides // limits.most
    again, apart, _ = _along_chain(surface, x_qi[q], y_AI, start, crossings, limits.iterations + crossings)
    nearer = apart < apart_q
    found.set(q[nearer], again[nearer])
    return found


def _anew(surface: Surface, x_qi: np.ndarray, y_AI: np.ndarray, c_q: np.ndarray) -> Pairing:
    """The nearest samples on the chains of the sides c_q."""
    if surface.chains == 1:
        return nearest_samples(surface, x_qi, y_AI)
    sides = surface.sides // surface.chains
    found = Pairing(c_q.copy(), np.zeros(len(c_q)), np.ones(len(c_q), dtype=bool))
    for number in np.unique(c_q // sides):
        here = np.flatnonzero(c_q // sides == number)
        met = nearest_samples(surface.chain(number), x_qi[here], y_AI)
        found.set(here, replace(met, c_q=met.c_q + sides * number))
    return found


def _nearby(surface: Surface, x_qi: np.ndarray, y_AI: np.ndarray, guess: Pairing) -> Pairing:
    """Newton for the points that stay on their side or the next ones; ``on_q`` is True for those that have arrived."""
    tolerance = PROJECTION.tolerance
    c_q, xi_q = guess.c_q.copy(), guess.xi_q.copy()
    Q_qbi, on_q = surface.bezier_points(y_AI, c_q), (xi_q > 0.0) & (xi_q < 1.0)
    for _ in range(PROJECTION.near):
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


@dataclass(frozen=True)
class Moving:
    """Points under way along the chain: their numbers q, places x, sides c with Bezier points Q, parameters xi there.

    The parameter of least distance lies between ``low`` and ``high`` (-1 and 2 where nothing is known yet).
    ``crossed``: number of sides crossed. ``came``: whether the last iteration crossed an end forwards (1), backwards
    (-1) or not (0). ``aside``: distance of the point from the place of the last iteration, along the tangent there.
    """

    q: np.ndarray
    x: np.ndarray
    c: np.ndarray
    xi: np.ndarray
    Q: np.ndarray
    low: np.ndarray
    high: np.ndarray
    crossed: np.ndarray
    came: np.ndarray
    aside: np.ndarray

    def those(self, going: np.ndarray) -> Moving:
        return Moving(*(getattr(self, field.name)[going] for field in fields(self)))


def _along_chain(
    surface: Surface, x_qi: np.ndarray, y_AI: np.ndarray, guess: Pairing, crossings: int, iterations: int
) -> tuple[Pairing, np.ndarray, np.ndarray]:
    """The pairing of each point, its distance (infinite where it has not arrived), and which points are lost.

    On a side Newton is kept between the parameters where the distance is known to fall and to rise. Where curvature
    makes its denominator small or negative, ``|y'|^2`` replaces it (Gauss-Newton).
    """
    n, tolerance = len(x_qi), PROJECTION.tolerance
    c_q, xi_q, on_q = guess.c_q.copy(), guess.xi_q.copy(), np.ones(n, dtype=bool)
    apart_q, lost_q, none_q = np.full(n, np.inf), np.ones(n, dtype=bool), np.zeros(n, dtype=int)
    Q_qbi, low_q, high_q = surface.bezier_points(y_AI, c_q), np.full(n, -1.0), np.full(n, 2.0)
    now = Moving(np.arange(n), x_qi, c_q, xi_q, Q_qbi, low_q, high_q, none_q, none_q, np.zeros(n))
    for _ in range(iterations):
        y, t, t_xi = ((r[:, None] @ now.Q)[:, 0] for r in surface.coefficients(now.c, now.xi, 2))
        d = now.x - y
        m, pull = np.sum(t * t, -1), np.sum(d * t, -1)
        a, aside = m - np.sum(d * t_xi, -1), np.abs(pull) / np.sqrt(m)
        step = ((now.xi == 1.0) & (pull > 0.0)).astype(int) - ((now.xi == 0.0) & (pull < 0.0))
        low, high = np.where(pull > 0.0, now.xi, now.low), np.where(pull < 0.0, now.xi, now.high)
        goal = now.xi + pull / np.where(a > 0.1 * m, a, m)
        goal = np.where((goal >= low) & (goal <= high), goal, 0.5 * (low + high))
        at_end = (step != 0) & (surface.following(now.c, step) == now.c)
        # on a kink, seen from both sides: the side whose normal is nearer keeps the point
        on_kink = (step != 0) & (step == -now.came)
        rests = at_end | (on_kink & ~(now.aside < aside))
        stays = at_end | on_kink | ((step == 0) & (np.abs(goal - now.xi) <= tolerance))  # not with a goal off the side
        over = np.where(step != 0, np.abs(pull) / m, 0.0)
        leaps = (step != 0) & ~stays & (over > 2.0)
        entry = np.where(leaps, 0.5, (step < 0).astype(float))
        xi = np.where(step == 0, np.clip(goal, 0.0, 1.0), np.where(rests, now.xi, entry))
        further = surface.following(now.c, step * np.where(leaps, over, 1.0).astype(int))
        c = np.where(rests, now.c, further)
        within = surface.outward * (t[:, 1] * d[:, 0] - t[:, 0] * d[:, 1]) < -m
        c_q[now.q], xi_q[now.q], on_q[now.q] = c, xi, ~at_end | (over <= tolerance)
        lost_q[now.q] = ~stays | within | (at_end & (over > PROJECTION.free)) | ((step == 0) & (a <= 0.0))
        apart_q[now.q] = np.where(stays & ((step != 0) | (a > 0.0)), np.sqrt(np.sum(d * d, -1)), np.inf)
        crosses = (step != 0) & ~stays
        crossed, came = now.crossed + crosses, np.where(crosses & ~leaps, step, 0)
        going = ~stays & (crossed <= crossings)
        if not np.any(going):
            break
        low, high = np.where(crosses, -1.0, low), np.where(crosses, 2.0, high)
        now, moved = Moving(now.q, now.x, c, xi, now.Q, low, high, crossed, came, aside).those(going), crosses[going]
        if np.any(moved):
            now.Q[moved] = surface.bezier_points(y_AI, now.c[moved])
    return Pairing(c_q, xi_q, on_q), apart_q, lost_q
