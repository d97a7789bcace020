"""The double cantilever beam of Dimitri, De Lorenzis, Zavarise (2013): identities of mechanics, reference curves."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("dolfinx", reason="DOLFINx is not installed")

from dolfinx_runs import CZM1, built, columns
from opening_specimens import Dcb

from fem_reference.path.control import opening_control
from fem_reference.path.newton import Step, find_equilibrium
from fem_reference.path.path import path
from fem_reference.problem.bond_law import HELD
from fem_reference.problem.law import Law
from fem_reference.solve import solve_debonding

SHORT = replace(CZM1, opening=(1.2,), steps=40)
REFERENCE = Path(__file__).parents[4] / "shared" / "reference"


@pytest.fixture(params=["finite", pytest.param("linear", marks=pytest.mark.slow)])
def run(request):
    return columns(replace(SHORT, kinematics=request.param))


def test_run_starts_unloaded_and_ends_at_the_programme(run):
    assert run["opening"][0] == run["load"][0] == run["external_work"][0] == 0.0
    assert run["opening"][-1] == 1.2
    assert run["crack_length"][0] == CZM1.precrack
    assert 5.5 < run["crack_length"][-1] < 6.5


@pytest.mark.parametrize("unit", [1e-15, 1e9])
def test_the_unit_of_force_does_not_matter(unit):
    """Nothing in the solver has a size of its own; the free rotation has no pivot to speak of."""
    stresses = ("E1", "E2", "G12", "strength", "toughness", "penalty")
    small = replace(SHORT, kinematics="linear", opening=(0.6,), steps=15)
    scaled = replace(small, **{name: unit * getattr(small, name) for name in stresses})
    load = columns(small)["load"]
    assert np.max(np.abs(columns(scaled)["load"] / unit - load)) < 1e-9 * np.max(load)


def test_j_integral_is_the_area_under_the_law(run):
    law = Law(CZM1.strength, CZM1.toughness, CZM1.ductility, CZM1.penalty)
    J = run["load"] * (np.abs(run["face_slope_top"]) + np.abs(run["face_slope_bottom"])) - run["face_energy"]
    assert np.max(run["tip_opening"]) > law.failed
    assert np.max(np.abs(J - law.area(run["tip_opening"]))) < 0.002 * CZM1.toughness


def test_energy_ledger_closes(run):
    gap = run["external_work"] - run["stored_energy"] - run["dissipated_energy"]
    assert np.max(np.abs(gap[1:]) / run["external_work"][1:]) < 2e-4
    parts = run["bulk_energy"] + run["cohesive_energy"] + run["contact_energy"]
    assert run["stored_energy"] == pytest.approx(parts, rel=1e-13)


def test_forces_and_moments_balance(run):
    peak = np.max(run["load"])
    assert np.max(np.abs(run["load"] + run["interface_force"])) < 1e-8 * peak
    assert np.max(np.abs(run["load_moment"] + run["interface_moment"])) < 1e-8 * peak * CZM1.length
    assert np.max(np.hypot(run["reaction_x"], run["reaction_y"])) < 1e-8 * peak


@pytest.mark.parametrize("opening", [0.1, 1.0])
def test_slope_of_the_path_is_exact(opening):
    """Elastic and on the falling branch: the slope is that of the chord over two tiny steps."""
    run = columns(replace(SHORT, opening=(opening, opening + 2e-5), steps=int(40 * opening)))
    before, after = -2, -1
    assert run["opening"][after] - run["opening"][before] == pytest.approx(2e-5, rel=1e-6)
    chord = (run["load"][after] - run["load"][before]) / (run["opening"][after] - run["opening"][before])
    assert 0.5 * (run["load_slope"][before] + run["load_slope"][after]) == pytest.approx(chord, rel=1e-3)


def test_newton_converges_quadratically_between_kinks():
    """Thick elastic arms, large rotation: each residual is below the square of the one before, down to rounding."""
    thick = Dcb(
        length=6.0,
        arm_thickness=1.0,
        precrack=2.0,
        E1=130.0,
        E2=130.0,
        G12=50.0,
        nu12=0.3,
        strength=0.4,
        toughness=20.0,
        ductility=5.0,
        contact=False,
        elements=12,
        layers=2,
        opening=(0.05,),
        steps=1,
    )
    model = built(thick)
    start = list(path(model))[-1]
    move = 0.8 - start.opening
    guess = start.u_n + move * start.rate_n, start.load + move * start.slope
    attempt = find_equilibrium(model, Step(opening_control(model, 0.8), start.k_q, 0.0), *guess)
    residuals = np.array(attempt.residuals)
    print("residuals of one step over the load:", ", ".join(f"{r:.1e}" for r in residuals))
    assert attempt.converged
    last_three = residuals[-3:]
    assert last_three[0] > 1e-3
    assert np.all(last_three[1:] < np.maximum(last_three[:-1] ** 2, 1e-9))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("scene", "degree", "most"),
    [("czm1_finite", 2, 0.0005), ("czm2_linear", 2, 0.0005), ("czm2_finite", 3, 0.0003)],
)
def test_curve_agrees_with_the_fine_reference(scene, degree, most):
    """Relative L2 distance of the load over 400 equal openings."""
    file = REFERENCE / f"dcb_{scene}.csv"
    if not file.exists():
        pytest.skip(f"the reference curve {file.name} is not at hand")
    strength, kinematics = {"czm1": 4.0, "czm2": 6.0}[scene[:4]], scene[5:]
    run = columns(replace(CZM1, strength=strength, kinematics=kinematics, degree=degree))
    reference = np.loadtxt(file, delimiter=",", skiprows=1)
    grid = np.linspace(0.0, 3.0, 401)[1:]
    expected = np.interp(grid, reference[:, 0], reference[:, 1])
    assert np.linalg.norm(np.interp(grid, run["opening"], run["load"]) - expected) < most * np.linalg.norm(expected)


def test_contact_carries_what_a_soft_bond_would_not():
    brief = replace(SHORT, opening=(0.3,), steps=6)
    with_contact, without = (columns(replace(brief, contact=contact)) for contact in (True, False))
    assert np.all(with_contact["contact_energy"][1:] > 0)
    assert not np.any(without["contact_energy"])
    assert with_contact["load"][-1] > 1.01 * without["load"][-1]


def test_plane_strain_is_stiffer_by_its_modulus():
    brief = replace(SHORT, opening=(0.1,), steps=2)
    stress, strain = (columns(replace(brief, plane=plane))["load"][-1] for plane in ("stress", "strain"))
    assert 1.01 < strain / stress < 1 / (1 - CZM1.nu12**2)


def test_snapshots_hold_the_fields_of_their_step():
    rows = []
    solution = solve_debonding(replace(SHORT, steps=12, snapshot_openings=(0.25, 1.2)), on_step=rows.append)
    assert rows == list(solution.rows)
    assert [s["opening"] for s in solution.snapshots] == pytest.approx([0.3, 1.2])
    first, last = solution.snapshots
    k = SHORT.degree + 1
    assert first["X_euvi"].shape == first["u_euvi"].shape == (solution.elements, k, k, 2)
    assert first["stress_euv"].shape == (solution.elements, k, k)
    assert np.all(np.diff(first["s_q"]) > 0)
    assert last["damage_q"][0] == 1.0
    assert last["traction_q"][0] == 0.0
    X_uv, Y_uv = last["X_euvi"][0].transpose(2, 0, 1)
    assert np.all(np.diff(X_uv, axis=0) > 0)
    assert np.all(np.diff(Y_uv, axis=1) > 0)
    face_euvi = last["u_euvi"][np.abs(last["X_euvi"][:, 0, 0, 0]) < 1e-9]
    assert face_euvi[0, 0, :, 1].mean() - face_euvi[1, 0, :, 1].mean() == pytest.approx(1.2, rel=1e-3)
    assert last["stress_euv"].max() > 100.0


def test_unknowns_count_two_a_node_of_both_arms():
    solution = solve_debonding(replace(CZM1, opening=(0.02,), steps=1))
    assert solution.dofs == 2 * 2 * (2 * 112 + 1) * 3
    assert solution.elements == 224


@pytest.mark.parametrize("kinematics", ["linear", "finite"])
def test_the_tie_carries_nothing(kinematics):
    problem = replace(SHORT, kinematics=kinematics, opening=(0.9,), steps=12)
    model = built(problem)
    last = list(path(model))[-1]
    tie_force = abs(model.tie_n @ last.u_n) * np.max(np.abs(model.tie_n))
    assert tie_force < 1e-7 * last.load


def test_history_is_committed_by_converged_steps_only():
    model = built(replace(SHORT, steps=12))
    states = list(path(model))
    for before, after in zip(states, states[1:], strict=False):
        assert np.array_equal(after.k_q[:, HELD], np.maximum(before.k_q[:, HELD], after.g_q[:, 0]))
