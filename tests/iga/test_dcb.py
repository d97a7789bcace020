"""The double cantilever beam as a whole: invariances, every degree, coarse meshes and snapshots."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from specimens import PAPER

from iga.dcb import solve
from iga.output.rows import reach

CZM1 = replace(PAPER, opening=(3.0,), dofs=1956)
SHORT = replace(CZM1, opening=(1.0,), dofs=800, steps=40)
#: Unknowns of two arms with the same elements.
MATCHED = 480


def column(solution, name):
    return np.array([row[name] for row in solution.rows])


@pytest.mark.parametrize("basis", ["tspline", "nurbs"])
def test_one_arm_against_its_mirror_image_is_the_whole(basis):
    """Linear kinematics: the same discrete problem. Energies and forces are those of both arms."""
    whole = replace(SHORT, basis=basis, kinematics="linear", dofs=MATCHED, steps=20)
    full, half = solve(whole), solve(replace(whole, symmetry=True))
    assert half.dofs == full.dofs // 2
    for name in (
        "opening",
        "load",
        "stored_energy",
        "dissipated_energy",
        "external_work",
        "tip_opening",
        "face_energy",
        "interface_force",
    ):
        assert np.allclose(
            column(half, name), column(full, name), rtol=1e-7, atol=1e-9 * abs(column(full, name)).max()
        ), name


def test_the_linear_curve_is_the_small_opening_limit_of_the_finite_one():
    """One step to a small opening: the two differ by second order."""

    def load(kinematics, opening):
        return solve(replace(SHORT, kinematics=kinematics, opening=(opening,), steps=1, dofs=400)).rows[-1]["load"]

    change = [abs(load("finite", d) / load("linear", d) - 1) for d in (0.08, 0.04)]
    assert change[0] < 2e-3 and change[1] < 0.6 * change[0]


def test_a_stiff_penalty_does_not_set_contact_against_cohesion_for_ever():
    """Far ahead of the crack the gaps alternate in sign below rounding."""
    assert solve(replace(SHORT, penalty=1e7, opening=(0.1,), steps=4)).status == "complete"


def test_snapshots_are_taken_where_asked():
    solution = solve(replace(SHORT, dofs=400, steps=20, snapshot_openings=(0.3, 0.8)))
    assert [s.opening >= o for s, o in zip(solution.snapshots, (0.3, 0.8), strict=True)] == [True, True]
    snap = solution.snapshots[-1]
    assert np.all(np.diff(snap.s_q) > 0) and len(snap.gap_q) == len(snap.traction_q) == len(snap.damage_q)
    assert snap.X_euvi.shape == snap.u_euvi.shape == (*snap.stress_euv.shape, 2)
    assert snap.stress_euv.shape[0] == solution.elements
    force = np.trapezoid(snap.traction_q, snap.s_q)
    assert force == pytest.approx(snap.load, rel=0.1)
    arm = np.all(snap.X_euvi[..., 0] < SHORT.precrack + 1e-9, axis=(1, 2))
    bending = 6.0 * snap.load * SHORT.precrack / SHORT.arm_thickness**2
    assert np.abs(snap.stress_euv[arm]).max() == pytest.approx(bending, rel=0.05), "along the arm"


@pytest.mark.parametrize("degree", [1, 2, 3, 4, 5])
@pytest.mark.parametrize("basis", ["nurbs", "lagrange"])
def test_every_degree_runs(basis, degree):
    solution = solve(replace(SHORT, basis=basis, degree=degree, opening=(0.3,), steps=6, dofs=600))
    assert solution.status == "complete" and solution.rows[-1]["load"] > 0.0


@pytest.mark.parametrize("basis", ["tspline", "nurbs", "lagrange"])
def test_a_small_mesh_has_most_of_its_elements_on_the_bond(basis):
    """280 unknowns: at least six elements on the bond, and a first stiffness not far from that of a fine mesh."""
    problem = replace(CZM1, strength=6.0, kinematics="linear", opening=(0.01,), steps=1, basis=basis)
    coarse, fine = solve(replace(problem, dofs=280)), solve(replace(problem, dofs=4000))
    assert coarse.dofs == pytest.approx(280, rel=0.02) and coarse.elements >= 14
    assert coarse.rows[0]["load_slope"] == pytest.approx(fine.rows[0]["load_slope"], rel=0.12)


def test_a_mesh_that_cannot_be_made_is_refused():
    with pytest.raises(ValueError, match="at least"):
        solve(replace(SHORT, dofs=40))
    with pytest.raises(ValueError, match="basis"):
        solve(replace(SHORT, basis="fourier"))


@pytest.mark.parametrize(
    ("k", "place"),
    [
        ((0.0, 0.0, 0.0, 0.0), 4.0),
        ((2.0, 1.5, 0.5, 0.0), 4.4),
        ((2.0, 1.0, 0.5, 0.0), 4.3),
        ((0.2, 1.5, 0.5, 0.0), 4.4),
        ((2.0, 2.0, 2.0, 1.25), 4.7),
        ((1.0, 0.0, 0.0, 0.0), 4.1),
    ],
)
def test_the_foremost_place_of_an_opening_lies_between_points(k, place):
    """Linear between the last point that has come to it and the next; where none has, at the tip."""
    order = np.array([2, 0, 3, 1])
    k_q = np.empty(4)
    k_q[order] = k
    specimen = SimpleNamespace(ordered=(np.array([4.1, 4.3, 4.5, 4.7]), order), layout=SimpleNamespace(free_length=4.0))
    assert reach(specimen, k_q, 1.0) == pytest.approx(place)
    specimen.layout.free_length = 4.6
    assert reach(specimen, k_q, 1.0) == pytest.approx(max(place, 4.6)), "never behind the tip"
