"""Balances are held to what Newton's tolerance and rounding leave: no alarm on slender arms, every fault found."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from iga.system.system import rounding
from verify.checks.identities import run_checks
from verify.checks.mechanics import balance
from verify.methods.dolfinx import dolfinx_installed
from verify.methods.solve import prepare, solve
from verify.result import Result
from verify.scene.load import load_scene
from verify.scene.schema import Scene
from verify.verdict import Check

COARSE = ["discretization.dofs=300", "interface.strength=7.5"]
SLENDER = ["specimen.arm_thickness=0.05", "load.opening=8", "discretization.steps=40"]
STIFF_CONTACT = ["interface.penalty=1e10", "discretization.steps=40"]
LONG = [
    "specimen.length=114.06236909598474", "specimen.arm_thickness=1", "specimen.precrack=56.228538432247156",
    "material.young=1e5", "material.poisson=0.3244093595137369", "interface.toughness=0.48117285123914466",
    "interface.strength=0.1628493795958447", "interface.ductility=2.017008049533789", "interface.penalty=1e5",
    "load.opening=36.77040374733115", "discretization.steps=80",
]  # fmt: skip
VERY_SLENDER = ["specimen.arm_thickness=0.02", "load.opening=20", "discretization.steps=40"]

BALANCES = {"interface-force": "interface_force", "moment-balance": "interface_moment", "reactions": "reaction_y"}


def balances(scene, result) -> dict[str, Check]:
    return {check.name: check for check in run_checks(scene, result) if check.name in BALANCES}


@pytest.mark.parametrize(
    ("name", "method", "changes"),
    [
        ("dcb-czm1", "lagrange", COARSE),
        ("dcb-czm1", "dolfinx", SLENDER),
        ("dcb-czm1-linear", "dolfinx", VERY_SLENDER),
        ("dcb-czm1-linear", "lagrange", LONG),
        ("dcb-czm1", "dolfinx", STIFF_CONTACT),
        ("dcb-czm1", "nurbs", SLENDER),
    ],
)
def test_long_elements_and_slender_arms_raise_no_alarm_and_ten_times_as_much_is_a_fault(name, method, changes) -> None:
    if method == "dolfinx" and not dolfinx_installed():
        pytest.skip("DOLFINx is not installed")
    scene = load_scene(name, changes)
    result = solve(scene, method)
    found = balances(scene, result)
    assert {check.state for check in found.values()} == {"holds"} and set(found) == set(BALANCES)
    if method != "nurbs":
        assert max(check.value for check in found.values()) > balance.RESIDUAL.least, (
            "what one tolerance for all would fail"
        )
    peak = abs(result.load).max()
    for check, column in BALANCES.items():
        lever = scene.specimen.free_length if check == "moment-balance" else 1.0
        fault = 10.0 * found[check].tolerance * lever * peak
        wrong = replace(result, steps={**result.steps, column: result.steps[column] + fault})
        assert [one.name for one in balances(scene, wrong).values() if one.state == "broken"] == [check]


def test_what_is_allowed_follows_from_the_scene() -> None:
    """Two decimals from the usual scene to one of arms ten times thinner; nothing is known of other methods."""
    scene, thin = load_scene("dcb-czm1"), load_scene("dcb-czm1", ["specimen.arm_thickness=0.02"])
    result = replace(solve(scene, "beam"), method="nurbs", dofs=1952, elements=238)
    (force, moment), (of_thin, moment_of_thin) = tolerances(scene, result), tolerances(thin, result)
    assert force == balance.RESIDUAL.least < moment < 5.0 * balance.RESIDUAL.least
    assert balance.RESIDUAL.least < of_thin < moment_of_thin <= balance.RESIDUAL.most
    assert tolerances(thin, replace(result, method="mycode")) == (balance.RESIDUAL.least, balance.RESIDUAL.least)


@pytest.mark.parametrize(("method", "measured"), [("dolfinx", 1.4e-7), ("beam", 1.8e-8)])
def test_couples_are_forces_on_a_lever(method: str, measured: float) -> None:
    """Twice the couples at half the load are the same specimen; measured are the residuals of converged runs."""
    found = []
    for factor in (1.0, 2.0):
        scene = load_scene("moments", [f"specimen.moments=[{factor}, {factor}]", "load.opening=1.0"])
        steps = {"opening": np.array([0.0, 0.86 * factor]), "load": np.array([0.0, 7596.0 / factor])}
        found.append(tolerances(scene, Result(method, steps, dofs=5796, elements=640)))
    assert found[0] == pytest.approx(found[1])
    assert measured < found[0][1] < 1e-4


def test_what_the_iteration_of_beams_leaves_is_allowed_and_ten_times_as_much_is_a_fault() -> None:
    """Thin arms that couples pull apart: their far ends move by more than 10,000 times the jump at onset."""
    changes = ["specimen.moments=[1.0, 1.0]", "specimen.arm_thickness=0.4", "load.opening=0.4"]
    scene = load_scene("moments", changes)
    result = solve(scene, "beam")

    def balance_of(run: Result) -> Check:
        return next(check for check in run_checks(scene, run) if check.name == "arm-balance")

    right = balance_of(result)
    assert right.value < right.tolerance < balance.RESIDUAL.most
    fault = 10.0 * right.tolerance * abs(result.load).max() * 2.0 / scene.specimen.lengths[0]
    wrong = replace(result, steps={**result.steps, "arm_force_y": result.steps["arm_force_y"] + fault})
    assert balance_of(wrong).state == "broken"


def test_near_incompressibility_leaves_as_much_as_newton_accepts() -> None:
    """The floor of Newton, at which `iga` takes a residual for rounding, grows with 1 / (1 - 2 nu)."""
    for nu in (0.3, 0.4999):
        changes = ["specimen.plane=strain", f"material.poisson={nu}", "discretization.dofs=700", "load.opening=1"]
        scene = load_scene("dcb-czm1", changes)
        result, floors = floors_of(scene)
        floor = max(floors) / abs(result.load).max()
        assert floor < balance.force_tolerance(prepare(scene, "nurbs"), result) < 5.0 * floor


def floors_of(scene: Scene) -> tuple[Result, list[float]]:
    """A run of NURBS, and the norms of forces that Newton took for rounding."""
    seen: list[float] = []

    def seeing(system, u_d, response) -> float:
        seen.append(rounding(system, u_d, response))
        return seen[-1]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("iga.path.newton.rounding", seeing)
        return solve(scene, "nurbs"), seen


def tolerances(scene: Scene, result: Result) -> tuple[float, float]:
    prepared = prepare(scene, result.method)
    return balance.force_tolerance(prepared, result), balance.moment_tolerance(prepared, result)
