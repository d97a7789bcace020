"""Meshes of the two bodies that do not match along the interface."""

from dataclasses import replace

import numpy as np
import pytest

from iga.dcb import arm_meshes, build, solve
from iga.interface import pair
from iga.sizes import element_length
from tests.iga.test_dcb import CZM1

END = 0.8
PROBLEM = replace(CZM1, kinematics="linear", opening=(END,), steps=30)


def envelope(solution) -> np.ndarray:
    """Load at equal openings; the envelope never turns back."""
    opening, load = (np.array([row[name] for row in solution.rows]) for name in ("opening", "load"))
    ahead = np.append(True, opening[1:] > np.maximum.accumulate(opening)[:-1])
    return np.interp(np.linspace(0.0, END, 201)[1:], opening[ahead], load[ahead])


@pytest.fixture(scope="module")
def matched():
    return envelope(solve(replace(PROBLEM, dofs=2600)))


@pytest.mark.parametrize("slave", ["upper", "lower"])
@pytest.mark.parametrize("mismatch", [1.37, 10.0])
def test_curve_is_that_of_matching_meshes(matched, mismatch, slave):
    """At 1 : 10 the coarse arm resolves the zone, 0.9 mm long, with 3600 unknowns: three elements in it."""
    dofs = 1956 if mismatch < 2.0 else 3600
    curve = envelope(solve(replace(PROBLEM, dofs=dofs, mismatch=mismatch, slave=slave)))
    error = np.linalg.norm(curve - matched) / np.linalg.norm(matched)
    print(f"mismatch {mismatch} slave {slave}: curve {error:.2e}")
    assert error < 0.005


@pytest.mark.parametrize("kinematics", ["linear", "finite"])
def test_forces_and_moments_are_in_balance(kinematics):
    problem = replace(PROBLEM, kinematics=kinematics, dofs=800, mismatch=1.37, opening=(0.7,), steps=12)
    rows = solve(problem).rows
    load, force, moment, other = (
        np.array([row[name] for row in rows]) for name in ("load", "interface_force", "load_moment", "interface_moment")
    )
    assert np.max(np.abs(load - force)) < 1e-8 * load.max()
    assert np.max(np.abs(moment + other)) < 1e-8 * load.max() * problem.precrack


@pytest.mark.parametrize("basis", ["nurbs", "lagrange"])
@pytest.mark.parametrize("mismatch", [0.05, 0.73, 1.0, 1.37, 10.0, 20.0])
def test_length_ratio_and_size_of_the_mesh(mismatch, basis):
    problem = replace(PROBLEM, basis=basis, mismatch=mismatch, dofs=4000)
    upper, lower = arm_meshes(problem)
    assert 0.98 * 4000 <= upper.P_AI.size + lower.P_AI.size <= 4000
    assert lower.elements * mismatch == pytest.approx(upper.elements, rel=0.2)
    longest = element_length(build(problem))
    coarse = min((upper, lower), key=lambda mesh: mesh.elements)
    assert longest == pytest.approx(10.0 / coarse.elements, rel=0.25)


def test_points_meet_elements_of_another_length():
    interface = build(replace(PROBLEM, mismatch=1.37, dofs=400)).system.interface
    met = pair(interface)
    assert np.all(met.on_q) and np.ptp(met.xi_q) > 0.9
    assert len(np.unique(np.round(met.xi_q, 6))) > 4, "on matching meshes every point meets the same places"
