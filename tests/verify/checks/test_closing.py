"""Programmes that go below zero: faces beyond the bond meet, and nothing of one body passes through the other."""

from dataclasses import replace

import numpy as np
import pytest

from verify.checks.identities import run_checks
from verify.checks.mechanics.columns import zone_is_new
from verify.checks.mechanics.penetration import penetration
from verify.checks.neglected import of_run
from verify.methods.solve import solve
from verify.result import Result
from verify.scene.load import load_scene
from verify.scene.schema import Scene

#: Press, open until a crack grows, press again, and open on; linear kinematics, for speed.
DCB = ("dcb-czm1-linear", "discretization.steps=60", "load.opening=[-0.002, 0.8, -0.004, 1.0]")
PEEL = ("peel-60", "discretization.dofs=2000", "discretization.steps=40", "load.opening=[1.0, -0.5, 1.5]")
#: Of these a pressed specimen must show all.
SHOWN = {
    "completed",
    "penetration",
    "j-integral",
    "j-pressed",
    "energy-ledger",
    "interface-force",
    "moment-balance",
    "reactions",
}


def scene_of(name: str, *sets: str) -> Scene:
    return load_scene(name, sets)


def failing(scene: Scene, result: Result) -> set[str]:
    return {check.name for check in run_checks(scene, result) if not check.passed}


def load_at(result: Result, opening: float) -> float:
    return float(result.load[np.flatnonzero(result.opening == opening)[0]])


@pytest.mark.parametrize(
    ("words", "method"),
    [
        ((*DCB,), "nurbs"),
        ((*DCB, "effects.symmetry=true"), "tspline"),
        ((*DCB, "discretization.interface_rule=lumped"), "nurbs"),
        ((*DCB, "discretization.adaptive=true"), "tspline"),
        ((*DCB, "discretization.slave=lower", "discretization.mismatch=1.37"), "nurbs"),
        ((*DCB, "effects.kinematics=finite", "load.opening=[-0.002, 0.5]"), "nurbs"),
        ((*PEEL,), "tspline"),
    ],
)
def test_pressed_faces_keep_every_identity(words: tuple[str, ...], method: str) -> None:
    """The end of an arm holds up to six times G_Ic as contact, which J has to count."""
    scene = scene_of(*words)
    result = solve(scene, method)
    found = {check.name: check.value for check in run_checks(scene, result)}
    assert set(found) >= SHOWN and failing(scene, result) == set(), found
    assert result.steps["mouth_opening"].min() < 0.0 < result.steps["mouth_opening"].max()


@pytest.mark.parametrize(("words", "method"), [(DCB, "nurbs"), (PEEL, "tspline")])
def test_faces_without_contact_beyond_the_bond_are_found(
    words: tuple[str, ...], method: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Contact planted out there: of all checks this one alone sees the bodies pass through each other."""
    scene = scene_of(*words)
    monkeypatch.setattr("iga.specimen.specimen.touches", lambda problem: False)
    result = solve(scene, method)
    assert penetration(scene, result.steps) > 10.0
    assert "penetration" in failing(scene, result)
    assert failing(scene, result) == {"penetration"}


def test_j_without_what_the_pressed_faces_hold_is_found() -> None:
    scene = scene_of(*DCB, "load.opening=-0.004", "discretization.steps=4")
    result = solve(scene, "nurbs")
    open_ = replace(result, steps={**result.steps, "mouth_opening": np.zeros(result.opening.size)})
    other = replace(result, steps={**result.steps, "mouth_opening": 1.5 * result.steps["mouth_opening"]})
    assert failing(scene, result) == set()
    assert failing(scene, open_) == failing(scene, other) == {"j-pressed"}


def test_contact_that_is_left_out_on_purpose_is_no_fault_and_said() -> None:
    scene = scene_of(*DCB, "effects.contact=false")
    result = solve(scene, "nurbs")
    assert "penetration" not in {check.name for check in run_checks(scene, result)}
    (said,) = (one for one in of_run(scene, result) if one.key == "contact")
    assert not said.negligible and "ran into each other" in said.seen
    assert said.value > 0.0035 / 0.004, "at the loaded end, far from the bond"


@pytest.mark.parametrize("words", [("dcb-czm1-linear",), ("peel-60", "discretization.dofs=2000")])
def test_unloading_alone_closes_nothing(words: tuple[str, ...]) -> None:
    """Faces come together at no opening, all at once: there is nothing to press, and no gap is negative before."""
    scene = scene_of(*words, "discretization.steps=40", "load.opening=[0.6, 0.05, 0.0, 0.8]")
    result = solve(scene, "nurbs")
    assert failing(scene, result) == set() and "mouth_opening" not in result.steps
    assert penetration(scene, result.steps) < 0.1


def test_where_nothing_goes_down_nothing_is_looked_at() -> None:
    scene = scene_of("dcb-czm1-linear", "discretization.steps=40", "load.opening=0.6")
    result = solve(scene, "nurbs")
    assert not {"penetration", "contact_pressure", "mouth_opening"} & set(result.steps)
    assert penetration(scene, result.steps) is None


def test_j_waits_until_the_zone_of_an_earlier_leg_has_been_left() -> None:
    scene = scene_of("dcb-czm1", "load.opening=[1.0, -0.01, 1.5]")
    steps = {
        "opening": np.array([0.0, 0.5, 1.0, 0.0, -0.01, 0.0, 1.0, 1.2, 1.5]),
        "damage_front": np.array([4.0, 4.5, 6.0, 6.0, 6.0, 6.0, 6.2, 6.6, 7.5]),
        "crack_length": np.array([4.0, 4.0, 5.4, 5.4, 5.4, 5.4, 5.5, 6.0, 6.9]),
    }
    assert zone_is_new(scene, steps).tolist() == [True] * 3 + [False] * 4 + [True] * 2
    opened = scene_of("dcb-czm1", "load.opening=[1.0, 0.0, 1.5]")
    assert zone_is_new(opened, steps).all()


@pytest.mark.parametrize(
    ("words", "openings"), [(DCB, (-0.002, 0.8, -0.004, 1.0)), ((*PEEL, "discretization.dofs=3700"), (1.0, -0.5, 1.5))]
)
def test_both_codes_press_alike(words: tuple[str, ...], openings: tuple[float, ...]) -> None:
    pytest.importorskip("dolfinx", reason="DOLFINx is not installed")
    scene = scene_of(*words)
    ours, theirs = solve(scene, "nurbs"), solve(scene, "dolfinx")
    assert failing(scene, ours) == failing(scene, theirs) == set()
    assert {"penetration", "j-pressed"} <= {check.name for check in run_checks(scene, theirs)}
    for opening in openings:
        assert load_at(ours, opening) == pytest.approx(load_at(theirs, opening), rel=0.005)


def test_faces_that_pass_through_each_other_are_found_in_dolfinx(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("dolfinx", reason="DOLFINx is not installed")
    from fem_reference.problem.delamination import Problem

    scene = scene_of(*DCB, "load.opening=[0.3, -0.004, 0.4]")
    monkeypatch.setattr(Problem, "presses", False)
    assert penetration(scene, solve(scene, "dolfinx").steps) > 10.0


def test_a_specimen_that_rotates_about_its_far_end_passes_through_nothing() -> None:
    """Pressed at its mouth it comes apart but for a spot at the far end, where it then turns under nearly no load."""
    scene = scene_of("dcb-czm1-linear", "load.opening=[1.0, 0.0, 0.6, -0.05, 1.5]")
    result = solve(scene, "nurbs")
    assert result.steps["penetration"][-1] > 100.0 * result.steps["contact_pressure"][-1] / scene.interface.penalty
    assert "penetration" not in failing(scene, result)
    deep = replace(result, steps={**result.steps, "penetration": 2.0 * result.steps["penetration"]})
    assert "penetration" in failing(scene, deep)
