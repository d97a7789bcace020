"""A reference judges where it has proven itself on a second mesh; where curves disagree the odd one out is named."""

from __future__ import annotations

from dataclasses import replace
from math import inf

import numpy as np
import pytest

from verify.checks.between_codes import allowed, cross_checks, distance
from verify.checks.odd_one_out import odd_one
from verify.checks.proof import MATCHED, SECOND, Proof, held_against, proof
from verify.methods import zone_resolution
from verify.methods.reference_mesh import ReferenceMesh, reference_mesh, second_mesh, thickness_error
from verify.methods.solve import prepare
from verify.result import Result
from verify.scene.load import load_scene
from verify.scene.parse import parse_scene
from verify.scene.schema import Scene
from verify.verdict import Check

OPENING = np.linspace(0.0, 3.0, 60)


def runs(**factors: float) -> dict[str, Result]:
    """Curves that differ by factors; names with dashes are written with underscores."""
    curve = np.minimum(OPENING, 1.0 / np.maximum(OPENING, 0.1))
    named = {name.replace("_", "-"): factor for name, factor in factors.items()}
    return {name: Result(name.split("-")[0], {"opening": OPENING, "load": f * curve}) for name, f in named.items()}


def stocky(**dolfinx: object) -> Scene:
    """An orthotropic arm with a0/h = 7, which one quadratic element misses by 2.3 %."""
    return parse_scene({
        "specimen": {"kind": "dcb", "length": 69.0, "arm_thickness": 4.07, "precrack": 28.9, "plane": "strain"},
        "material": {"E1": 4000.0, "E2": 273.0, "G12": 139.0, "nu12": 0.001},
        "interface": {"strength": 0.283, "toughness": 0.00288, "ductility": 2.4},
        "load": {"opening": 0.465}, "effects": {"kinematics": "linear"}, "dolfinx": {"elements": 112, **dolfinx},
    })  # fmt: skip


@pytest.mark.parametrize(
    ("value", "second", "state"),
    [
        (1.004, 1.0005, "holds"),
        (1.006, 1.0005, "broken"),
        (1.004, 1.004, "holds"),  # uncertain, but within the tolerance in any case
        (1.006, 1.004, "unresolved"),
        (1.02, 1.004, "broken"),  # beyond what the reference may be off
        (1.001, 1.006, "unresolved"),  # two wrong curves agree as well
    ],
)
def test_a_reference_judges_as_far_as_it_is_right_itself(value, second, state):
    found = cross_checks(load_scene("dcb-czm1"), runs(nurbs=value, dolfinx=1.0, dolfinx_second=second))
    curve = next(check for check in found if check.name == "curve")
    assert curve.state == state and curve.uncertainty == pytest.approx(second - 1.0)
    assert ("second mesh" in curve.unresolved) == (state == "unresolved")


def test_a_reference_without_a_second_mesh_cannot_judge():
    known = proof(runs(dolfinx=1.0), (3.0,))
    assert known.error["curve"] == inf
    check = held_against(
        load_scene("dcb-czm1"), Check("curve", "nurbs / dolfinx", 0.001, 0.005, "cross-code", ""), known
    )
    assert check.state == "unresolved" and "has not been solved on a second mesh" in check.unresolved


@pytest.mark.parametrize(("goals", "stiffness"), [((-0.01, 0.0, 3.0), 0.004), ((1.0, 0.0, -0.01, 0.0, 3.0), 0.0)])
def test_the_stiffness_of_a_reference_is_that_of_its_first_leg(goals, stiffness):
    """Pressed faces are a hundred times as stiff as what opens, and make no load of the other leg vanish."""
    opening = np.concatenate([np.linspace(*ends, 9) for ends in zip((0.0, *goals[:-1]), goals, strict=True)])
    loads = (np.where(opening < 0.0, stiff * opening, opening) for stiff in (1.0e4, 1.004e4))
    first, second = (Result("dolfinx", {"opening": opening, "load": load}) for load in loads)
    known = proof({"dolfinx": first, SECOND: second}, goals)
    assert known.error["stiffness"] == pytest.approx(stiffness) and known.error["curve"] == known.error["peak"] == 0.0


def test_a_difference_of_models_is_named_and_equal_models_are_held_against_each_other():
    scene = load_scene("dcb-czm1")
    given = runs(nurbs=1.006, nurbs_matched=1.0001, dolfinx=1.0, dolfinx_second=1.0002)
    found = {check.subject: check for check in cross_checks(scene, given) if check.name == "curve"}
    assert found[f"{MATCHED} / dolfinx"].state == "holds" and found["nurbs / dolfinx"].state == "unresolved"
    assert "which changes the curve by 0.0059" in found["nurbs / dolfinx"].unresolved
    alone = {**given, **runs(tspline=1.0)}
    found = {check.subject: check for check in cross_checks(scene, alone) if check.name == "curve"}
    assert found["nurbs / dolfinx"].state == "broken", "T-splines search as well, and do not find that difference"
    wrong = {**given, **runs(nurbs_matched=1.007)}
    found = {check.subject: check for check in cross_checks(scene, wrong) if check.name == "curve"}
    assert found[f"{MATCHED} / dolfinx"].state == "broken", "equal models have no excuse"


@pytest.mark.parametrize(("at", "state"), [(2.9, "unresolved"), (1.5, "broken")])
def test_the_farthest_point_is_as_uncertain_as_the_models_are_apart_there(at, state):
    """Kept pairs change the last tenth of the curve by 2 %, and excuse a distance of 3.5 % there alone."""
    given = runs(nurbs=1.0, tspline=1.0, nurbs_matched=1.0, dolfinx=1.0, dolfinx_second=1.0)
    changes = {MATCHED: np.where(OPENING > 2.7, 1.02, 1.0)}
    changes |= dict.fromkeys(("dolfinx", SECOND), np.where(np.abs(OPENING - at) < 0.1, 1.035, 1.0))
    changed = {name: Result("", {"opening": OPENING, "load": f * given[name].load}) for name, f in changes.items()}
    found = cross_checks(load_scene("dcb-czm1"), given | changed)
    (check,) = (one for one in found if (one.name, one.subject) == ("farthest-point", "nurbs / dolfinx"))
    assert check.state == state and check.at == pytest.approx(at, abs=0.12)


def test_the_odd_one_out_is_whom_no_other_code_confirms():
    said = odd_one(runs(nurbs=1.0, tspline=1.0005, dolfinx=1.023, dolfinx_second=1.001, beam=1.002), (3.0,))
    assert said.startswith("odd one out: dolfinx, 2.05% or more")
    assert odd_one(runs(nurbs=1.03, tspline=1.0, dolfinx=1.0, beam=1.0), (3.0,)).startswith("odd one out: nurbs, 2.91%")
    close = odd_one(runs(nurbs=1.006, dolfinx=1.0, beam=1.003), (3.0,))
    assert close.startswith("odd one out, though not by much: ")
    coarse = odd_one(runs(lagrange=1.015, nurbs=1.0, dolfinx=1.0, mine=0.9), (3.0,))
    assert coarse.startswith("odd one out: mine, "), "Lagrange is within its own tolerance"


def test_a_run_that_unloads_otherwise_is_the_odd_one_out():
    """All draw one envelope; one run returns on another line between the openings 1.5 and 0.2."""
    opening = np.concatenate([OPENING[OPENING < 1.5], [1.5, 0.2, 1.5], OPENING[OPENING > 1.5]])
    inside = int(np.argmax(np.diff(opening) < 0.0)) + 1

    def unloads_to(load: float) -> Result:
        curve = np.minimum(opening, 1.0 / np.maximum(opening, 0.1))
        curve[inside] = load
        return Result("", {"opening": opening, "load": curve})

    given = {
        "nurbs": unloads_to(0.09),
        "dolfinx": unloads_to(0.09),
        "lagrange": unloads_to(0.0901),
        "mine": unloads_to(0.3),
    }
    assert odd_one(given, (1.5, 0.2, 3.0)).startswith("odd one out: mine, ")
    assert "mine" not in odd_one(given, (3.0,)), "the envelopes alone do not tell"


def test_a_mesh_that_is_too_coarse_through_the_thickness_says_so_before_a_run():
    coarse = stocky(degree=2, layers=1)
    (said,) = zone_resolution.too_few_layers(prepare(coarse, "dolfinx"))
    assert (
        said.startswith("1 element of degree 2 through the arm: the load may be off by 4.1%")
        and "dolfinx.layers" in said
    )
    assert zone_resolution.too_few_layers(prepare(stocky(), "dolfinx")) == ()
    assert zone_resolution.too_few_layers(prepare(coarse, "nurbs")) == ()
    quadratic = coarse.model_copy(update={"discretization": coarse.discretization.model_copy(update={"degree": 2})})
    assert "discretization.degree = 3 resolves it" in zone_resolution.too_few_layers(prepare(quadratic, "nurbs"))[0]
    assert zone_resolution.too_few_layers(prepare(load_scene("dcb-czm1", ["discretization.degree=2"]), "nurbs")) == ()
    pair = runs(nurbs=1.0, dolfinx=1.02, dolfinx_second=1.02)
    found = next(check for check in cross_checks(quadratic, pair) if check.name == "curve")
    assert found.state == "unresolved" and "through the arm" in found.unresolved


def test_the_mesh_through_the_thickness_follows_the_geometry_and_a_scene_may_set_it():
    assert reference_mesh(load_scene("dcb-czm1")) == ReferenceMesh(2, 112, None, 1)
    assert reference_mesh(stocky()) == ReferenceMesh(3, 112, None, 1)
    assert reference_mesh(stocky(degree=2)) == ReferenceMesh(2, 112, None, 3)
    assert reference_mesh(stocky(layers=1, degree=2)) == ReferenceMesh(2, 112, None, 1)
    assert thickness_error(stocky(), 2, 1) > 0.0227, "as much as was measured, or more"
    assert "dolfinx.layers=2" in second_mesh(stocky()) and SECOND == "dolfinx-second"


def test_two_codes_are_compared_along_what_is_drawn_between_their_steps():
    """Of four steps and of sixty, on P = d - d^2 / 6, whose chords are up to 2 % below it."""

    def run(rows: int) -> Result:
        d = np.linspace(0.0, 2.0, rows)
        energy = 0.5 * d**2 - d**3 / 18.0
        columns = {"opening": d, "load": d - d**2 / 6.0, "load_slope": 1.0 - d / 3.0, "heading": np.ones(rows)}
        columns |= {"stored_energy": energy, "dissipated_energy": 0.0 * d}
        return Result("nurbs", columns, "complete", "", "", 0.0, 10, 10)

    few, many = run(5), run(61)
    assert abs(distance(few, many, 2.0)) < 1e-4
    without = [replace(one, steps={name: one.steps[name] for name in ("opening", "load")}) for one in (few, many)]
    assert distance(*without, 2.0) > 5e-3


@pytest.mark.parametrize(("asked", "share"), [(0.0001, 0.001), (0.003, 0.001), (0.009, 0.003), (0.09, 0.005)])
def test_a_reference_is_allowed_what_its_steps_are(asked, share):
    scene = load_scene("dcb-czm1", [f"discretization.accuracy={asked}"])
    assert allowed("dolfinx", Proof({"curve": 0.0}, {"curve": 0.0}), scene) == pytest.approx(share)
    assert allowed("dolfinx", Proof({"curve": 0.002}, {"curve": 0.0}), scene) == pytest.approx(
        min(share + 0.002, 0.005)
    )
    assert allowed("nurbs", Proof({"curve": 0.0}, {"curve": 0.0}), scene) == 0.005
