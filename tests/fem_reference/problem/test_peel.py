"""The peel test of Dimitri, De Lorenzis, Zavarise (2013): identities of mechanics, reference curves, separation."""

from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("dolfinx", reason="DOLFINx is not installed")

from dolfinx_runs import solve
from opening_specimens import Peel

from fem_reference.problem.law import Law
from fem_reference.problem.material import Moduli


def isotropic(young, poisson):
    return Moduli(young, young, young / (2 * (1 + poisson)), poisson)


PEEL = Peel(
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


@pytest.fixture(params=["finite", pytest.param("linear", marks=pytest.mark.slow)])
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


SOFT = replace(
    PEEL,
    strip_length=60.0,
    strip_thickness=1.0,
    substrate_length=40.0,
    substrate_thickness=5.0,
    bond_length=35.0,
    strip=isotropic(50.0, 0.2),
    strength=0.2,
    opening=(30.0,),
    elements=112,
    steps=40,
)


def end_face(snapshot):
    """Angle of the strip's axis at its loaded face, in the middle of the height."""
    X_euvi, u_euvi = snapshot["X_euvi"], snapshot["u_euvi"]
    x_uvi = (X_euvi + u_euvi)[np.argmax(X_euvi[..., 0].max(axis=(1, 2)))]
    middle = x_uvi.shape[1] // 2
    along = x_uvi[-1, middle] - x_uvi[-2, middle]
    return np.degrees(np.arctan2(along[1], along[0]))


def test_a_soft_strip_is_peeled_until_its_end_is_upright():
    """There dP sin(theta) = G_Ic w: the identity of J holds at every step, and the load tends to G_Ic w."""
    solution, run = solve(replace(SOFT, snapshot_openings=(30.0,)))
    assert j_deviation(SOFT, run) < 0.005
    assert end_face(solution.snapshots[-1]) > 87.0
    assert run["load"][-1] == pytest.approx(SOFT.toughness, rel=0.005)
    assert run["crack_length"][-1] > 30.0
    peak = np.max(run["load"])
    assert np.max(np.abs(run["load_moment"] + run["interface_moment"])) < 1e-10 * peak * SOFT.strip_length
    assert np.max(np.hypot(run["reaction_x"], run["reaction_y"])) < 1e-10 * peak


def test_snapshots_hold_both_bodies_and_the_base_does_not_move():
    solution, _ = solve(replace(SHORT, steps=4, opening=(0.3,), snapshot_openings=(0.3,)))
    (snapshot,) = solution.snapshots
    X_euvi, u_euvi = snapshot["X_euvi"], snapshot["u_euvi"]
    assert X_euvi.shape == u_euvi.shape == (solution.elements, 3, 3, 2)
    base = np.isclose(X_euvi[..., 1], -10.0)
    assert base.any() and not np.any(u_euvi[base])
    above, below = X_euvi[X_euvi.mean(axis=(1, 2))[:, 1] > 0], X_euvi[X_euvi.mean(axis=(1, 2))[:, 1] < 0]
    assert (above[..., 0].max(), above[..., 1].max()) == (150.0, 2.0)
    assert (below[..., 0].max(), below[..., 1].max()) == pytest.approx((120.0, 0.0), abs=1e-12)
    assert np.all(np.diff(snapshot["s_q"]) > 0)
    assert 30.0 < snapshot["s_q"][0] < snapshot["s_q"][-1] < 150.0
