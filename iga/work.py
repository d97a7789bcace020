"""The work of the load along a step, to fourth order, and whether the energies of the step say the same."""

from __future__ import annotations

import numpy as np

from iga.point import Point
from iga.quadrature import gauss
from iga.system import System

#: How far a step may leave the balance of energy open, in parts of the largest work so far: one that leaps over a part
#: of the path does by more.
LEAK = 1e-3


def step_work(system: System, start: Point, end: Point, away: float, back: float) -> float:
    """Integral of the load over the opening along one step, both cubic Hermite curves over the controlled quantity.

    ``away`` and ``back`` are the lengths of the tangents at both ends that change that quantity by the step. Unlike a
    rule over the opening it holds where the path turns back. Its error is of fourth order; three Gauss points
    integrate it exactly.
    """
    s, w = gauss(3)
    values = np.stack([(1 + 2 * s) * (1 - s) ** 2, s * s * (3 - 2 * s)])
    slopes = np.stack([s * (1 - s) ** 2, s * s * (s - 1)])
    d_values = np.stack([6 * s * (s - 1), 6 * s * (1 - s)])
    d_slopes = np.stack([(1 - s) * (1 - 3 * s), s * (3 * s - 2)])
    loads = np.array([away * start.tangent.d_load, back * end.tangent.d_load])
    openings = np.array([away * (system.load_d @ start.tangent.du_d), back * (system.load_d @ end.tangent.du_d)])
    load = np.array([start.state.load, end.state.load]) @ values + loads @ slopes
    d_opening = np.array([start.opening, end.opening]) @ d_values + openings @ d_slopes
    return float(np.sum(w * load * d_opening))


def straight_work(start: Point, end: Point) -> float:
    """The same over the opening itself, with the slopes that are told, for a step that does not turn round."""
    move = end.opening - start.opening
    return 0.5 * move * (start.state.load + end.state.load) + move**2 / 12.0 * (start.slope - end.slope)


def leaks(start: Point, end: Point, most: float) -> bool:
    """Whether the work of a step is not what its energies say: it did not go along the path.

    ``most`` is the largest work so far.
    """
    work = end.external_work - start.external_work
    return abs(work - (end.energy - start.energy)) > LEAK * max(most, abs(end.external_work))
