"""Paths of a bond whose damage follows in time: point by point, without viscosity as a limit, and in their energy."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from iga.delamination.problem import Problem
from iga.delamination.solution import build, solve
from iga.laws.laws import ShapedLaw
from iga.laws.mode_ratio import ModeRatio
from iga.path.follow import follow
from iga.path.point import Point
from iga.path.solver import Solver
from iga.path.step_length import PACE
from iga.specimen.layout import Load, Moduli, Rectangle, Support

MODES = ModeRatio((0.969, 1.719), (40.0, 50.0), (1e5, 1e5), "bk", 2.284, "turon")
LAW = ShapedLaw(MODES, 1e5)
ARM = Rectangle(102.0, 1.56, Moduli(E1=122.7e3, E2=10.1e3, G12=5.5e3, nu12=0.25))
BASE = {
    **{"bodies": (ARM, ARM), "bonded": (39.3, 102.0), "loaded_at": 0.0},
    **{"width": 25.4, "plane": "strain", "kinematics": "linear", "basis": "nurbs", "degree": 2, "dofs": 700},
}
ENF = Problem(
    **BASE,
    supports=(Support(1, "bottom", (0.0, 0.5)), Support(1, "bottom", (101.5, 102.0))),
    loads=(Load(0, "top", -1.0, (50.5, 51.5)),),
    opening=(4.5,),
    bond=LAW,
    steps=None,
)
DCB = replace(ENF, supports=(), loads=(Load(0, "left", 1.0), Load(1, "left", -1.0)), opening=(6.0,))


def with_viscosity(problem: Problem, viscosity: float, **more) -> Problem:
    return replace(problem, bond=replace(LAW, viscosity=viscosity), **more)


@cache
def columns(problem: Problem) -> dict[str, np.ndarray]:
    solution = solve(problem)
    assert solution.status == "complete"
    return {name: np.array([row[name] for row in solution.rows]) for name in solution.rows[0]}


@pytest.mark.parametrize("problem", [ENF, DCB], ids=["enf", "dcb"])
def test_every_point_follows_its_law_in_time(problem):
    """Damage ``d + dt / (dt + v) <D - d>`` over the jumps of every step, where time is the way of the opening."""
    problem = with_viscosity(problem, 0.01)
    system = build(problem).system
    points = [one for one in follow(Solver(system), problem.opening, None) if isinstance(one, Point)]
    d_q = points[0].state.k_q
    for before, now in zip(points, points[1:], strict=False):
        dt = abs(now.opening - before.opening) / problem.opening[0]
        driven_q = LAW.driven(now.response.contact.g_q, now.response.contact.slip.s_q)
        grown_q = dt / (dt + 0.01) * np.maximum(driven_q - d_q, 0.0)
        assert np.max(grown_q) <= PACE.growth * (1.0 + 1e-9)
        d_q = d_q + grown_q
        assert now.state.k_q == pytest.approx(d_q, abs=1e-9)
    assert np.max(d_q[system.interface.bonded_q]) > 0.9


@pytest.mark.slow
def test_less_and_less_viscosity_is_none():
    """The distance from the curve without falls with the viscosity; so does what the peak gains."""
    exact = columns(ENF)
    at = np.linspace(0.1, 4.5, 200)
    known = np.interp(at, exact["opening"], exact["load"])
    off, higher = [], []
    for viscosity in (1e-2, 1e-3, 1e-4):
        run = columns(with_viscosity(ENF, viscosity))
        off.append(float(np.linalg.norm(np.interp(at, run["opening"], run["load"]) - known) / np.linalg.norm(known)))
        higher.append(run["load"].max() / exact["load"].max() - 1.0)
    print(off, higher)
    assert off[0] > 2.0 * off[1] > 4.0 * off[2] and off[2] < 0.01
    assert higher[0] > 2.0 * higher[1] > 4.0 * higher[2] and abs(higher[2]) < 0.01


@pytest.mark.parametrize("programme", [(4.5,), (4.0, 1.0, 4.5)], ids=["loading", "unloading"])
def test_the_ledger_closes(programme):
    run = columns(with_viscosity(ENF, 1e-2, opening=programme))
    left = run["external_work"] - run["stored_energy"] - run["dissipated_energy"]
    assert np.max(np.abs(left)) < 1e-9 * run["external_work"].max()
    assert np.diff(run["dissipated_energy"]).min() > -1e-9 * run["external_work"].max()
