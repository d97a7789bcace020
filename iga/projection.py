"""Closest points on a surface: where each slave point meets the master."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from iga.surface import Surface


@dataclass(frozen=True)
class Pairing:
    """Where each point met: side ``c_q``, parameter ``xi_q`` in [0, 1]; ``on_q`` is False beyond the ends."""

    c_q: np.ndarray
    xi_q: np.ndarray
    on_q: np.ndarray


def nearest_samples(surface: Surface, x_qi: np.ndarray, y_AI: np.ndarray, samples: int = 8) -> Pairing:
    """Broad phase: the nearest of a few sample points on every side, by a k-d tree."""
    c = np.repeat(np.arange(surface.sides), samples)
    xi = np.tile((np.arange(samples) + 0.5) / samples, surface.sides)
    (r,) = surface.coefficients(c, xi, 0)
    y = np.einsum("qb,qbi->qi", r, surface.bezier_points(y_AI)[c])
    _, nearest = cKDTree(y).query(x_qi)
    return Pairing(c[nearest], xi[nearest], np.ones(len(x_qi), dtype=bool))


def closest_points(
    surface: Surface, x_qi: np.ndarray, y_AI: np.ndarray, guess: Pairing, tolerance: float = 1e-6, iterations: int = 60
) -> Pairing:
    """Project points on the surface: ``(x - y(xi)) . y'(xi) = 0`` by Newton, from the pairing before.

    A point that runs off a side goes on from the end of the neighbour; at the two ends of the chain it is held there
    and marked as off. At a kink between two sides, where it would jump for ever, it stays on the kink. Where the
    curvature makes Newton's denominator useless, ``|y'|^2`` alone takes its place (Gauss-Newton).

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
    Q_cbi = surface.bezier_points(y_AI)
    c, xi = guess.c_q.copy(), guess.xi_q.copy()
    crossings, off = np.zeros(len(c), dtype=int), np.zeros(len(c), dtype=bool)
    active = np.arange(len(c))
    for _ in range(iterations):
        d_xi = _newton_step(surface, x_qi[active], Q_cbi, c[active], xi[active])
        goal = xi[active] + d_xi
        step = (goal > 1.0).astype(int) - (goal < 0.0)
        neighbour = c[active] + step
        at_end = (neighbour < 0) | (neighbour >= surface.sides)
        cross = (step != 0) & ~at_end & (crossings[active] < surface.sides)
        back_and_forth = cross & (xi[active] == np.where(step > 0, 1.0, 0.0)) & (crossings[active] > 4)
        cross &= ~back_and_forth
        xi[active] = np.where(cross, np.where(step > 0, 0.0, 1.0), np.clip(goal, 0.0, 1.0))
        c[active] = np.where(cross, neighbour, c[active])
        crossings[active] += cross
        off[active] = at_end & (step != 0) & (np.abs(goal - xi[active]) > tolerance)
        active = active[cross | ((np.abs(d_xi) > tolerance) & (step == 0))]
        if active.size == 0:
            break
    return Pairing(c, xi, ~off)


def _newton_step(
    surface: Surface, x_qi: np.ndarray, Q_cbi: np.ndarray, c_q: np.ndarray, xi_q: np.ndarray
) -> np.ndarray:
    r0, r1, r2 = surface.coefficients(c_q, xi_q, 2)
    y, t, t_xi = (np.einsum("qb,qbi->qi", r, Q_cbi[c_q]) for r in (r0, r1, r2))
    d = x_qi - y
    m = np.sum(t * t, -1)
    a = m - np.sum(d * t_xi, -1)
    return np.sum(d * t, -1) / np.where(a > 0.1 * m, a, m)
