"""Meshes of the two bodies that do not match along the interface."""

from dataclasses import replace

import numpy as np
import pytest

from iga.dcb import build, solve
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


@pytest.mark.parametrize(("mismatch", "slave"), [(1.37, "upper"), (10.0, "lower")])
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


def test_points_meet_elements_of_another_length():
    interface = build(replace(PROBLEM, mismatch=1.37, dofs=400)).system.interface
    met = interface.pairing
    assert np.all(met.on_q) and np.ptp(met.xi_q) > 0.9
    assert len(np.unique(np.round(met.xi_q, 6))) > 4, "on matching meshes every point meets the same places"
