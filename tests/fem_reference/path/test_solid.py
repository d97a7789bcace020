"""Solids: the width held or without contraction is the plane, halves are the whole, the front of a free width."""

from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("dolfinx", reason="DOLFINx is not installed")

from dolfinx_runs import CZM1, built, columns, ledger_error, solve, tangent_error
from opening_specimens import Dcb
from sliding_specimens import ENF, LAW, pulled_apart

from fem_reference.problem.delamination import Problem
from fem_reference.problem.law import Law
from fem_reference.problem.material import Moduli, Rectangle

#: The smallest one: 24 elements, one through the arm and one across half of the width.
SMALL = replace(CZM1, elements=24, precrack=9.0, opening=(2.4, 1.2), steps=6, width=2.0)
SOLID = {"plane": "solid", "n_Z": 1}
#: Both kinematics with three laws; what differs from the others by its time alone is slow.
RUNS = [
    *(("linear", law) for law in ("bilinear", "trapezoidal", "exponential")),
    ("finite", "bilinear"),
    *(pytest.param("finite", law, marks=pytest.mark.slow) for law in ("trapezoidal", "exponential")),
]
#: Zero or rounding, and sums that depend on the place of the origin.
OF_ROUNDING = {"end_opening", "reaction_x", "reaction_y", "load_moment", "interface_moment", "newton_iterations"}


def assert_same_run(solid, plane, within=1e-8, but=OF_ROUNDING):
    for name in set(plane) - but:
        assert solid[name] == pytest.approx(plane[name], rel=within, abs=within * np.max(np.abs(plane[name]))), name


@pytest.mark.parametrize(("kinematics", "law"), RUNS)
def test_a_width_that_is_held_is_plane_strain(kinematics, law):
    changes = {"kinematics": kinematics, "law_name": law, "E2": 20e3, "G12": 8e3}
    plane = replace(SMALL, plane="strain", **changes)
    assert_same_run(columns(replace(plane, **SOLID, width_held=True)), columns(plane))


@pytest.mark.parametrize(("kinematics", "law"), RUNS)
def test_without_contraction_a_solid_is_plane_stress(kinematics, law):
    plane = replace(SMALL, kinematics=kinematics, law_name=law, nu12=0.0, G12=60e3)
    solid = columns(replace(plane, **SOLID))
    assert_same_run(solid, columns(plane))
    assert solid["front_edge"] == pytest.approx(solid["front_middle"], rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("kinematics", ["linear", "finite"])
def test_a_bond_that_slides_below_a_held_width_is_that_of_plane_strain(kinematics):
    """The slip keeps its sign: the arms slide back on the way to 3.5."""
    plane = replace(ENF, elements=48, layers=1, steps=8, opening=(4.2, 3.5), kinematics=kinematics)
    rounding = OF_ROUNDING | {"arm_force_x", "arm_force_y", "arm_moment"}
    assert_same_run(columns(replace(plane, **SOLID, width_held=True)), columns(plane), but=rounding)


def test_an_arm_and_its_mirror_image_are_two_arms():
    """Arms whose constants are given in two ways are not known to be alike."""
    arm = Rectangle(14.0, 0.2, Moduli(120e3, 20e3, 8e3, 0.2))
    other = replace(arm, moduli=replace(arm.moduli, nu23=0.2))
    numbers = {"width": 2.0, "elements": 24, "opening": (2.4,), "steps": 4, "kinematics": "linear", **SOLID}
    quarter, half = (
        Problem(bodies=(arm, lower), bonded=(9.0, 14.0), bond=Law(4.0, 0.1, 12.5, 1e5), **numbers)
        for lower in (arm, other)
    )
    assert len(quarter.specimen().bodies) == 1 and len(half.specimen().bodies) == 2
    assert_same_run(columns(quarter), columns(half))


WIDE = replace(
    SMALL,
    width=8.0,
    plane="solid",
    n_Z=2,
    nu12=0.35,
    G12=120e3 / 2.7,
    elements=28,
    opening=(3.0,),
    steps=8,
    kinematics="linear",
)


def test_the_front_of_a_free_width_runs_ahead_in_its_middle():
    """Anticlastic arms close at their edges. J by the loads is that by the bond, and energy is kept."""
    solution, run = solve(replace(WIDE, snapshot_openings=(3.0,)))
    assert run["crack_length"][-1] > SMALL.precrack + 0.5
    ahead = run["front_middle"] - run["front_edge"]
    assert 0.05 < ahead[-1] < 1.0
    assert run["front_edge"][-1] < run["crack_length"][-1] < run["front_middle"][-1]
    grown = run["J_bond"] > 0.5 * SMALL.toughness
    assert np.count_nonzero(grown) > 2
    J = run["load"] * (run["face_slope_bottom"] - run["face_slope_top"]) / WIDE.width - run["face_energy"]
    assert J[grown] == pytest.approx(run["J_bond"][grown], rel=0.01)
    assert ledger_error(run) < 1e-3
    snapshot = solution.snapshots[0]
    assert snapshot["front_s"][[0, -1]] == pytest.approx([run["front_middle"][-1], run["front_edge"][-1]], rel=0.01)
    assert np.all(np.diff(snapshot["front_z"]) > 0) and 0.0 < snapshot["front_z"][0] < snapshot["front_z"][-1] < 4.0
    assert snapshot["front_G"] == pytest.approx(SMALL.toughness, rel=0.2)
    assert np.all(np.abs(np.diff(snapshot["s_q"])) > 0)


def test_stress_and_strain_bound_the_load_of_a_solid():
    """By the stiffness of the arms, before damage."""
    first = {"opening": (0.1,), "steps": 1}
    stress, strain = (columns(replace(WIDE, plane=plane, **first))["load"][-1] for plane in ("stress", "strain"))
    assert stress * (1 + 1e-3) < columns(replace(WIDE, **first))["load"][-1] < strain * (1 - 1e-3)


@pytest.mark.parametrize("kinematics", ["linear", "finite"])
@pytest.mark.parametrize("slides", [False, True])
def test_tangent_of_a_solid_is_the_derivative_of_its_residual(kinematics, slides):
    """Faces open, turn and slide in both directions."""
    small = {"kinematics": kinematics, "elements": 10, **SOLID}
    problem = replace(pulled_apart(**small), bond=LAW) if slides else replace(SMALL, **small)
    model, rng = built(problem), np.random.default_rng(4)
    L, (X, Y, Z) = model.specimen.X[-1], model.X_nI[::3].T
    side = np.where(model.upper_n[::3], 1.0, -1.0)
    scale = 0.004 if slides else 0.1
    field = np.stack([side * np.sin(9 * X / L), side * (1 - X / L) ** 2, side * np.cos(7 * X / L) * Z], -1)
    turn = np.stack([0.1 * Y, 0.1 * X + 0.05 * Z, -0.05 * Y], -1) * (kinematics == "finite")
    u_n = model.free_n * (scale * field + turn + 1e-5 * rng.standard_normal(field.shape)).ravel()
    k_q = 0.5 * model.history(model.jump(u_n), model.law.intact(model.bonded_q))
    direction_n = model.free_n * rng.standard_normal(u_n.size)
    assert tangent_error(model, u_n, k_q, direction_n) < 1e-6


def test_a_solid_is_refused_where_it_has_no_model():
    for change, key in (
        ({"load_at": "node"}, "plane"),
        ({"n_Z": 0}, "n_Z"),
        ({"interface_points": 1}, "interface_points"),
    ):
        with pytest.raises(ValueError, match=f"{key}: must"):
            Dcb(**(SMALL.__dict__ | {"plane": "solid"} | change))
