"""The peel test as a whole: J at every step, mesh sizes, pose, hard contrasts."""

from dataclasses import replace

import numpy as np
import pytest

from iga.peel import Moduli, Problem, build, solve


def isotropic(young: float, poisson: float) -> Moduli:
    return Moduli(E1=young, nu12=poisson)


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
    opening=(1.0,),
    dofs=1600,
    steps=30,
)


def column(solution, name):
    return np.array([row[name] for row in solution.rows])


PEELED = [
    ("finite", "lower", "nurbs"),
    ("linear", "upper", "tspline"),
]


@pytest.fixture(scope="module", params=PEELED, ids="-".join)
def peel(request):
    kinematics, slave, basis = request.param
    problem = replace(PEEL, kinematics=kinematics, slave=slave, basis=basis)
    return solve(replace(problem, dofs=2600, opening=(0.8,), steps=30))


def test_first_row_and_distances_from_the_loaded_end(peel):
    assert peel.status == "complete" and peel.rows[-1]["opening"] == 0.8
    first, last = peel.rows[0], peel.rows[-1]
    assert first["crack_length"] == first["damage_front"] == 30.0
    assert 35.0 < last["crack_length"] < last["damage_front"] < 50.0
    assert first["load"] == first["face_slope_bottom"] == last["face_slope_bottom"] == 0.0


def test_j_integral_equals_the_work_of_the_tractions_at_the_tip(peel):
    """With the energy on the right end of the substrate, half of J in the beginning, and on both left ends."""
    J = column(peel, "load") * column(peel, "face_slope_top") - column(peel, "face_energy")
    area = PEEL.law.work(np.maximum(column(peel, "tip_opening"), 0.0))
    assert np.max(np.abs(J - area)) < 0.01 * PEEL.toughness
    early = np.argmin(np.abs(area - 0.5 * PEEL.toughness))
    assert abs(column(peel, "face_energy")[early]) > 0.1 * PEEL.toughness


def test_in_linear_kinematics_the_spring_carries_nothing():
    solution = solve(replace(PEEL, kinematics="linear", dofs=700, opening=(0.5,), steps=6))
    assert np.max(np.abs(column(solution, "anchor_pull"))) < 1e-8 * column(solution, "load").max()


def test_peak_and_plateau_of_an_independent_computation():
    """DOLFINx, 300 quadratic elements along: peak 5.0152 at 0.545, load 2.4681 at opening 2."""
    solution = solve(replace(PEEL, opening=(2.0,), dofs=2600, steps=40))
    assert column(solution, "load").max() == pytest.approx(5.0152, rel=0.005)
    assert solution.rows[-1]["load"] == pytest.approx(2.4681, rel=0.01)


def test_rows_are_the_same_in_any_pose():
    problem = replace(PEEL, dofs=700, opening=(0.4,), steps=6)
    there, here = solve(problem), solve(replace(problem, angle=37.0, mirror=True, shift=(1e4, -3e3)))
    assert len(here.rows) == len(there.rows)
    small = {
        "reaction_x": "load",
        "reaction_y": "load",
        "interface_pull": "load",
        "anchor_pull": "load",
        "interface_moment": "load_moment",
        "end_opening": "tip_opening",
    }
    for name in set(there.rows[0]) - {"newton_iterations", "residual"}:
        scale = np.abs(column(there, small.get(name, name))).max()
        assert np.max(np.abs(column(here, name) - column(there, name))) <= 1e-8 * scale, name


@pytest.mark.parametrize("basis", ["tspline", "nurbs", "lagrange"])
@pytest.mark.parametrize("bond_length", [60.0, 120.0])
@pytest.mark.parametrize("dofs", [400, 3700])
def test_size_of_the_mesh_is_met(dofs, bond_length, basis):
    both = build(replace(PEEL, dofs=dofs, bond_length=bond_length, basis=basis)).meshes
    assert 0.98 * dofs <= sum(mesh.P_AI.size for mesh in both) <= dofs


@pytest.mark.parametrize("contrast", [1e-6, 1.0, 1e6])
def test_any_contrast_of_stiffness_is_solved(contrast):
    young = 250e3 / contrast
    problem = replace(PEEL, substrate=isotropic(young, 0.2), dofs=700, opening=(0.5,), steps=10)
    solution = solve(problem)
    load = column(solution, "load")
    print(f"contrast {contrast:.0e}: condition {solution.condition:.1e}, status {solution.status}")
    assert solution.status == "complete" and np.all(np.isfinite(load)) and load[1] > 0.0
    assert np.max(np.abs(load - column(solution, "interface_force"))) < 1e-6 * load.max()


def test_snapshots_and_clamped_base():
    problem = replace(PEEL, dofs=400, opening=(0.3,), steps=4, snapshot_openings=(0.3,))
    snap = solve(problem).snapshots[0]
    base = np.isclose(snap.X_euvi[..., 1], -10.0)
    assert base.any() and np.all(snap.u_euvi[base] == 0.0)
    assert np.all(np.diff(snap.s_q) > 0.0) and snap.s_q[0] > 30.0 and snap.s_q[-1] < 150.0


def test_bad_lengths_and_names_are_refused():
    with pytest.raises(ValueError, match="bond_length: must be < strip_length = 150 and <= substrate_length"):
        build(replace(PEEL, bond_length=150.0))
    with pytest.raises(ValueError, match="at least"):
        build(replace(PEEL, dofs=60))
    with pytest.raises(ValueError, match="slave"):
        build(replace(PEEL, slave="top"))
