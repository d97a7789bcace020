"""Paths of the paper's specimen, and what is read from their points."""

from dataclasses import replace

import numpy as np
from scipy.interpolate import CubicHermiteSpline
from specimens import PAPER

from iga.dcb import build
from iga.path.follow import follow
from iga.path.newton import residual_norm
from iga.path.solver import DEFAULT, Solver
from iga.system.system import respond

CZM1 = replace(PAPER, opening=(3.0,))
BOTH = [("nurbs", "finite"), ("lagrange", "linear")]


def run(problem, steps=150, newton=DEFAULT):
    """System, points and end of a problem's path."""
    system = build(problem).system
    *points, end = follow(Solver(system, newton), problem.opening, steps)
    return system, points, end


def column(points, name):
    return np.array([getattr(point, name) for point in points])


def loads(points):
    return np.array([point.state.load for point in points])


def curve(points, openings):
    """Load at given openings, cubic between the points with their slopes; the path must not turn back."""
    opening, load, slope = column(points, "opening"), loads(points), column(points, "slope")
    return CubicHermiteSpline(opening, load, slope)(openings)


def decided(system, before, point):
    """Relative residual of a committed point with the history before it, contact by the signs of the gaps."""
    response = respond(system, replace(point.state, k_q=before.state.k_q), decide=True)
    return residual_norm(system, point.state.load, response)


def ledger(system, points):
    """Largest gap in the ledger over the path, in parts of what is dissipated by its end."""
    gap = column(points, "external_work") - np.array([p.energies.total for p in points])
    return float(np.max(np.abs(gap))) / points[-1].energies.dissipated


def stops(points, opening):
    return [i for i, p in enumerate(points) if p.opening == opening]
