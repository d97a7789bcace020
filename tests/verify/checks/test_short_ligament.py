"""J on ligaments so short that the far end takes part: its faces count, and what it cannot explain is a fault."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from verify.checks.between_codes import cross_checks
from verify.checks.identities import run_checks
from verify.checks.mechanics.j_integral import J_TOLERANCE, far_end_energy, j_deviation
from verify.checks.orders import ARMS, ARMS_SECOND, BEAM_RUN
from verify.methods.dolfinx import dolfinx_installed
from verify.methods.solve import solve
from verify.result import Result
from verify.scene.load import load_scene
from verify.scene.schema import Scene
from verify.verdict import Check

METHODS = ["beam", "nurbs", "tspline", "lagrange", pytest.param("dolfinx", marks=pytest.mark.skipif(
    not dolfinx_installed(), reason="DOLFINx is not installed"))]  # fmt: skip


def short(ligament: float, penalty: float) -> Scene:
    """dcb-czm1 with a ligament as long as 0.8 to 3.4 process zones, on contact that is much stiffer than the bond."""
    changes = (f"specimen.length={4.0 + ligament}", "load.opening=0.6", f"interface.penalty={penalty}")
    return load_scene("dcb-czm1", [*changes, "discretization.dofs=1200", "discretization.steps=40"])


def j_of(scene: Scene, result: Result) -> Check:
    return next(check for check in run_checks(scene, result) if check.name == "j-integral")


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(("ligament", "penalty"), [(0.7, 1e6), (0.7, 1e8), (1.5, 1e7), (3.0, 1e6)])
def test_j_raises_no_alarm_and_no_wrong_j_passes(method: str, ligament: float, penalty: float) -> None:
    scene = short(ligament, penalty)
    result = solve(scene, method)
    check = j_of(scene, result)
    assert result.complete and check.state == "holds" or ligament < 1.0 and check.state == "unresolved"
    if check.unresolved:
        assert "a larger specimen.length resolves it" in check.unresolved or "elements of the mesh" in check.unresolved
    for column in ("face_slope_top", "tip_opening"):
        wrong = replace(result, steps={**result.steps, column: 1.2 * result.steps[column]})
        assert j_of(scene, wrong).state in (
            ("broken",) if method == "beam" or ligament > 1.0 else ("broken", "unresolved")
        )
    gross = replace(result, steps={**result.steps, "face_slope_top": 100.0 * result.steps["face_slope_top"]})
    assert j_of(scene, gross).state == "broken", "more than the far end explains"


def test_a_curve_beside_the_beam_is_not_judged_where_the_mesh_at_the_far_end_explains_the_distance() -> None:
    """An element is a tenth of the ligament. Of 5000 unknowns it is a fortieth: NURBS meet the curve of the beam."""
    scene = load_scene("dcb-czm1", ["specimen.precrack=13.5", "discretization.dofs=1000", "load.opening=2.0"])
    beam, right = solve(scene, "beam"), solve(scene, "nurbs")
    double = replace(right, steps={**right.steps, "load": 2.0 * right.load})

    def against_beam(result: Result) -> Check:
        arms = dict.fromkeys((BEAM_RUN, ARMS, ARMS_SECOND), beam)
        (check,) = [one for one in cross_checks(scene, {"nurbs": result, **arms}) if one.name == "beam-curve"]
        return check

    check = against_beam(right)
    assert check.state == "unresolved" and "a larger specimen.length resolves it" in check.unresolved
    assert against_beam(double).state == "broken"


@pytest.mark.parametrize("method", ["nurbs", "tspline"])
def test_what_ties_the_arms_lengthwise_holds_no_energy(method: str) -> None:
    """Stocky arms that turn by a sixth: tilted tractions pull on the tie, which in a corner would be 0.7 % of J."""
    changes = {
        "specimen.length": 13.357, "specimen.arm_thickness": 1, "specimen.precrack": 4.198,
        "specimen.plane": '"strain"',
        "material.young": 33.8e3, "material.poisson": 0.02, "interface.strength": 181.4, "interface.toughness": 35.13,
        "interface.ductility": 35.6, "load.opening": 1.976, "discretization.steps": 40,
    }  # fmt: skip
    scene = load_scene("dcb-czm1", [f"{key}={value}" for key, value in changes.items()])
    deviation = j_deviation(scene, solve(scene, method).steps)
    assert deviation is not None and deviation < 0.002


@pytest.mark.parametrize("method", ["nurbs", "tspline"])
def test_j_deviates_by_what_the_far_faces_hold_where_they_do_not_count(method: str) -> None:
    """About as much as the contact does, where that is as stiff as the arm."""
    scene = short(0.7, 1e7)
    result = solve(scene, method)
    early = {name: column[result.opening < 0.1] for name, column in result.steps.items()}
    G, none = scene.interface.toughness, np.zeros_like(early["load"])
    far = np.max(-early["face_energy"]) / G
    assert far > 2.0 * J_TOLERANCE and np.max(far_end_energy(scene, early)) > 1.3 * far
    assert j_deviation(scene, early) == pytest.approx(0.0, abs=0.1 * far)
    assert j_deviation(scene, {**early, "face_energy": none}) == pytest.approx(far, rel=0.1)
