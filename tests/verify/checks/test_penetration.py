"""Penetration where a programme closes a specimen: what the mesh explains, and what only a fault does."""

from __future__ import annotations

from collections.abc import Mapping

import pytest

from verify.checks.identities import run_checks
from verify.methods.solve import solve
from verify.scene.load import load_scene
from verify.verdict import Check

SCENES: Mapping[str, tuple[str, ...]] = {
    "thin": ("load.opening=[1.2, 0.3, 2.0, 0.0, 3.0]",),
    "stiff contact": (
        "specimen={kind='dcb', length=40.0, arm_thickness=1.0, precrack=12.0}",
        "material={young=70e3, poisson=0.3}",
        "interface={strength=12.0, toughness=0.15, penalty=1e6}",
        "load.opening=[1.2, 0.0, 2.0]",
    ),
    "orthotropic": (
        "specimen={kind='dcb', length=50.0, arm_thickness=1.5, precrack=16.0, width=20.0, plane='strain'}",
        "material={E1=150e3, E2=8e3, G12=3e3, nu12=0.3, nu23=0.5}",
        "interface={strength=30.0, toughness=0.3}",
        "load.opening=[1.0, -0.002, 2.0]",
    ),
    "far turned": ("load.opening=[1.5, 0.0, 2.5, 0.0]",),
}


def found(name: str, method: str, dofs: int, planted: str = "") -> Check:
    """The check of a run; the scene that is judged lacks the fault of the run."""
    kinematics = "finite" if name == "far turned" else "linear"
    words = (*SCENES[name], f"discretization.dofs={dofs}", f"effects.kinematics={kinematics}")
    result = solve(load_scene("dcb-czm1", [*words, planted] if planted else words), method)
    checks = run_checks(load_scene("dcb-czm1", words), result)
    return next(check for check in checks if check.name == "penetration")


@pytest.mark.parametrize(
    ("name", "method", "dofs"),
    [
        ("thin", "lagrange", 900),
        ("thin", "lagrange", 500),
        ("thin", "nurbs", 300),
        ("stiff contact", "lagrange", 400),
        ("orthotropic", "lagrange", 400),
        ("orthotropic", "lagrange", 600),
        ("far turned", "lagrange", 700),
    ],
)
def test_faces_of_long_elements_bulge_into_each_other(name: str, method: str, dofs: int) -> None:
    check = found(name, method, dofs)
    assert check.value > check.tolerance and check.state == "unresolved"
    resolved = int(check.unresolved.rpartition("discretization.dofs = ")[2].split()[0])
    assert resolved > dofs and found(name, method, resolved).state == "holds"


@pytest.mark.parametrize("planted", ["effects.contact=false", "interface.penalty=1e4"])
@pytest.mark.parametrize(("name", "method", "dofs"), [("thin", "nurbs", 1956), ("thin", "lagrange", 900)])
def test_a_fault_of_the_contact_is_found_on_a_fine_and_on_a_coarse_mesh(
    name: str, method: str, dofs: int, planted: str
) -> None:
    assert found(name, method, dofs, planted).state == "broken"


def test_contact_that_is_off_is_found_on_a_mesh_without_any_resolution() -> None:
    assert found("thin", "lagrange", 300, "effects.contact=false").state == "broken"
