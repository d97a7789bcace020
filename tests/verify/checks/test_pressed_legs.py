"""Legs on which faces are pressed: one layer of NURBS is not enough there, and a right curve does not suffer by it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from verify.checks.between_codes import cross_checks
from verify.checks.foreign_curves import checks_of
from verify.checks.odd_one_out import odd_one_out
from verify.checks.proof import REFERENCE, SECOND, proof
from verify.methods.second_meshes import SECONDS, SINGLE, presses, second_runs
from verify.methods.solve import solve
from verify.result import Result
from verify.scene.load import load_scene
from verify.scene.schema import Scene
from verify.verdict import Check

SCENES: Mapping[str, tuple[str, ...]] = {
    "slender": (
        "specimen={kind='dcb', length=40.0, arm_thickness=1.0, precrack=12.0}",
        "material={young=70e3, poisson=0.3}",
        "interface={strength=6.0, toughness=0.15}",
        "load.opening=[1.2, -0.005, 2.0]",
    ),
    "stocky": (
        "specimen={kind='dcb', length=40.0, arm_thickness=2.0, precrack=10.0, width=5.0}",
        "material={young=10e3, poisson=0.3}",
        "interface={strength=4.0, toughness=0.3}",
        "load.opening=[1.0, -0.01, 1.5]",
    ),
    "orthotropic": (
        "specimen={kind='dcb', length=50.0, arm_thickness=1.5, precrack=16.0, width=20.0, plane='strain'}",
        "material={E1=150e3, E2=8e3, G12=3e3, nu12=0.3, nu23=0.5}",
        "interface={strength=20.0, toughness=0.3}",
        "load.opening=[-0.002, 1.0, -0.004]",
    ),
}
LINEAR = "effects.kinematics=linear"


@cache
def scene_of(name: str, *more: str) -> Scene:
    return load_scene("dcb-czm1", [*SCENES[name], LINEAR, *more])


@cache
def runs(name: str) -> Mapping[str, Result]:
    """NURBS on both meshes, and what is right: degree 4, four layers of elements half as long."""
    scene = scene_of(name)
    second = next(finer for method, _, finer in second_runs(scene) if method == "nurbs")
    fine = ("discretization.degree=4", "discretization.layers=4", "discretization.dofs=5000")
    solved = {"nurbs": (), SECONDS["nurbs"]: second, "right": fine}
    return {run: solve(scene_of(name, *more), "nurbs") for run, more in solved.items()}


def judged(name: str, right: Result, **others: Result) -> tuple[Check, ...]:
    """A curve of another code against NURBS."""
    given = {run: result for run, result in runs(name).items() if run != "right"} | others
    return tuple(check for check in checks_of(scene_of(name), "mine", right, given) if " / " in check.subject)


def pressed_off(result: Result, by: float) -> Result:
    factor = np.where(result.opening < 0.0, 1.0 + by, 1.0)
    return replace(result, steps=result.steps | {"load": factor * result.load})


@pytest.mark.slow
@pytest.mark.parametrize("name", SCENES)
def test_a_right_curve_is_not_broken_by_one_layer(name):
    found = judged(name, runs(name)["right"])
    states = {check.name: check.state for check in found}
    assert "broken" not in states.values()
    known = proof(runs(name), scene_of(name).load.opening).others["nurbs"]
    off = max(abs(check.value) for check in found if check.name.startswith("curve-leg"))
    own = max(far for check, far in known.items() if "-leg-" in check)
    assert 0.004 < off <= own, "one layer is that much off, and knows it"
    assert max(known["curve"], known["peak"]) < 0.002, "where the specimen opens it is enough"
    (far,) = (check for check in found if check.name == "farthest-point")
    assert far.uncertainty > known["curve"], "the farthest point is one of any leg"


@pytest.mark.slow
@pytest.mark.parametrize("name", SCENES)
def test_a_fault_that_no_mesh_explains_is_still_found(name):
    found = judged(name, pressed_off(runs(name)["right"], 0.05))
    assert any(check.state == "broken" and check.name.startswith("curve-leg") for check in found)


@pytest.mark.slow
def test_the_remedy_resolves_it():
    """The number that the report names, with its own second mesh."""
    (said,) = {check.unresolved for check in judged("slender", runs("slender")["right"]) if check.name == "curve-leg-2"}
    assert "discretization.layers = 4 and discretization.dofs = 3423 resolve it" in said
    finer = ("discretization.layers=4", "discretization.dofs=3423")
    scene = scene_of("slender", *finer)
    by_name = {name: more for method, name, more in second_runs(scene) if method == "nurbs"}
    assert list(by_name) == [SECONDS["nurbs"], SINGLE], "T-splines are as coarse as they were"
    second = solve(scene_of("slender", *finer, *by_name[SECONDS["nurbs"]]), "nurbs")
    given = {"nurbs": solve(scene, "nurbs"), SECONDS["nurbs"]: second}
    found = checks_of(scene, "mine", runs("slender")["right"], given)
    assert all(check.state == "holds" for check in found if check.subject == "mine / nurbs")
    single = proof(given | {SINGLE: runs("slender")["nurbs"], "tspline": given["nurbs"]}, scene.load.opening).others
    assert single["nurbs"]["curve-leg-2"] < 0.0025 < single["tspline"]["curve-leg-2"]


@pytest.mark.slow
def test_the_right_code_is_not_the_odd_one_out():
    """The reference has the right curve, and its second mesh is off by as much as that of NURBS."""
    scene, solved = scene_of("slender"), runs("slender")
    as_reference = {name: replace(run, method=REFERENCE) for name, run in solved.items()}
    given = {
        "nurbs": solved["nurbs"],
        "tspline": solved["nurbs"],
        SECONDS["nurbs"]: solved[SECONDS["nurbs"]],
        REFERENCE: as_reference["right"],
        SECOND: as_reference["nurbs"],
    }
    checks = cross_checks(scene, given)
    states = {check.name: check.state for check in checks if check.subject == "nurbs / dolfinx"}
    assert states["curve-leg-2"] == "unresolved" and "broken" not in states.values()
    assert odd_one_out(scene, checks, given) == ()
    faulty = given | {name: pressed_off(given[name], 0.05) for name in ("nurbs", SECONDS["nurbs"])}
    found = cross_checks(scene, faulty)
    states = {check.name: check.state for check in found if check.subject == "nurbs / dolfinx"}
    assert states["curve-leg-2"] == "broken", "a fault on both meshes is none of the mesh"
    assert odd_one_out(scene, found, faulty)[0].startswith("odd one out: nurbs, ")


def test_a_programme_that_only_presses_is_proven_too():
    opening = np.linspace(0.0, -0.01, 5)
    given = {
        name: Result(name.partition("-")[0], {"opening": opening, "load": factor * opening})
        for name, factor in (("nurbs", 1.0), ("nurbs-second", 1.001), (REFERENCE, 1.0), (SECOND, 1.002))
    }
    scene = load_scene("dcb-czm1", ["load.opening=-0.01"])
    found = {check.name: check for check in cross_checks(scene, given)}
    assert {check.state for check in found.values()} == {"holds"}
    assert found["curve-leg-1"].uncertainty == pytest.approx(0.004)
    known = proof(given, scene.load.opening)
    assert known.error["curve"] == known.others["nurbs"]["peak"] == 0.0


def test_second_meshes_of_nurbs_are_for_pressed_arms_alone():
    def methods(*words: str) -> list[str]:
        return [name for _, name, _ in second_runs(load_scene(words[0], words[1:]))]

    assert methods("dcb-czm1") == methods("peel-60", "load.opening=[1.0, -0.5]") == [SECOND]
    assert methods("enf-as4peek", "load.opening=[1.0, -1.0]") == [SECOND]
    assert methods("dcb-czm1", "load.opening=[1.0, -0.001]") == [SECOND, "nurbs-second"]
    assert presses(load_scene("dcb-czm1", ["load.opening=-0.001"]))
    most = load_scene("dcb-czm1", ["load.opening=[1.0, -0.001]", "discretization.layers=8"])
    assert "discretization.layers=4" in dict((name, more) for _, name, more in second_runs(most))["nurbs-second"]
