"""The peel test of Dimitri, De Lorenzis, Zavarise (2013): identities of mechanics, reference curves, separation."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("dolfinx", reason="DOLFINx is not installed")

from fem_reference.law import Law
from fem_reference.material import Moduli
from fem_reference.peel import Problem
from fem_reference.solve import solve_debonding


def isotropic(young, poisson):
    return Moduli(young, young, young / (2 * (1 + poisson)), poisson)


PEEL = Problem(
    strip_length=150.0,
    strip_thickness=2.0,
    substrate_length=120.0,
    substrate_thickness=10.0,
    bond_length=120.0,
    strip=isotropic(250e3, 0.2),
    substrate=isotropic(5e3, 0.2),
    strength=6.0,
    toughness=0.1,
    ductility=10.0,
    penalty=1e3,
    elements=150,
)
SHORT = replace(PEEL, opening=(0.8,), steps=30, elements=75)
REFERENCE = Path(__file__).parents[3] / "shared" / "reference"


@cache
def solve(problem):
    solution = solve_debonding(problem)
    assert solution.status == "complete"
    return solution, {name: np.array([row[name] for row in solution.rows]) for name in solution.rows[0]}


@pytest.fixture(params=["finite", "linear"])
def run(request):
    return solve(replace(SHORT, kinematics=request.param))[1]


def test_distances_are_those_from_the_loaded_end(run):
    assert run["opening"][0] == run["load"][0] == 0.0
    assert run["opening"][-1] == 0.8
    assert run["crack_length"][0] == run["damage_front"][0] == 30.0
    assert 36.0 < run["crack_length"][-1] < run["damage_front"][-1] < 60.0


def j_deviation(problem, run):
    J = run["load"] * run["face_slope_top"] / problem.width - run["face_energy"]
    law = Law(problem.strength, problem.toughness, problem.ductility, problem.penalty)
    return np.max(np.abs(J - law.area(run["tip_opening"]))) / problem.toughness


def test_j_integral_counts_the_end_faces_of_both_bodies(run):
    assert np.max(run["tip_opening"]) > 2 * SHORT.toughness / SHORT.strength
    assert j_deviation(SHORT, run) < 0.005
    assert np.max(np.abs(run["face_energy"])) > 0.2 * SHORT.toughness


def test_energy_ledger_closes(run):
    gap = run["external_work"] - run["stored_energy"] - run["dissipated_energy"]
    assert np.max(np.abs(gap[1:]) / run["external_work"][1:]) < 1e-3


def test_forces_and_moments_balance(run):
    peak = np.max(run["load"])
    assert np.max(np.abs(run["load"] + run["interface_force"])) < 1e-10 * peak
    assert np.max(np.abs(run["load_moment"] + run["interface_moment"])) < 1e-10 * peak * PEEL.strip_length
    assert np.max(np.hypot(run["reaction_x"], run["reaction_y"])) < 1e-10 * peak
    assert not np.any(run["face_slope_bottom"])


@pytest.mark.slow
@pytest.mark.parametrize(("bond_length", "end"), [(120.0, 6.0), (60.0, 6.5)])
def test_quadratic_curve_agrees_with_the_fine_reference(bond_length, end):
    file = REFERENCE / f"peel_gpa_{bond_length:.0f}.csv"
    if not file.exists():
        pytest.skip(f"the reference curve {file.name} is not at hand")
    _, run = solve(replace(PEEL, bond_length=bond_length, opening=(end,)))
    reference = np.loadtxt(file, delimiter=",", skiprows=1)
    grid = np.linspace(0.0, 6.0, 401)[1:]
    top = np.maximum.accumulate(run["opening"])
    outward = np.concatenate([[True], top[1:] > top[:-1]])
    load = np.interp(grid, run["opening"][outward], run["load"][outward])
    expected = np.interp(grid, reference[:, 0], reference[:, 1])
    assert np.linalg.norm(load - expected) < 0.002 * np.linalg.norm(expected)
