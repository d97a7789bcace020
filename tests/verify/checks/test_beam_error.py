"""The error that the cohesive beam states of itself bounds its distance from plane specimens, and is no excuse."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from verify.checks import beam_error
from verify.checks.between_codes import beam_check, cross_checks, distance, remarks
from verify.checks.foreign_curves import checks_of
from verify.checks.odd_one_out import odd_one
from verify.methods.solve import solve
from verify.result import Result
from verify.scene.load import load_scene
from verify.scene.schema import Scene

#: h, a0 / h, nu, strength, toughness, ductility, plane, kinematics: none of the scenes that the bound was fitted to.
STOCKY = [
    (2.0, 4.5, 0.3, 20.0, 0.3, 5.0, "stress", "linear"),
    (1.0, 6.0, 0.35, 40.0, 0.5, 8.0, "strain", "finite"),
    (1.5, 9.0, 0.0, 60.0, 0.4, 4.0, "stress", "linear"),
    (3.0, 12.0, 0.2, 30.0, 1.0, 10.0, "strain", "linear"),
]


def stocky(h, slenderness, nu, strength, toughness, ductility, plane, kinematics) -> Scene:
    precrack, young = h * slenderness, 70e3
    grown = 1.3 * precrack + 2.0 * h
    opening = 2.0 / 3.0 * grown**2 * (toughness / (young * h**3 / 12.0)) ** 0.5
    changes = {
        "specimen.length": grown + 6.0 * h, "specimen.arm_thickness": h, "specimen.precrack": precrack,
        "specimen.plane": f'"{plane}"', "material.young": young, "material.poisson": nu,
        "interface.strength": strength, "interface.toughness": toughness, "interface.ductility": ductility,
        "load.opening": opening, "effects.kinematics": f'"{kinematics}"',
        "discretization.dofs": 3000, "discretization.steps": 60,
    }  # fmt: skip
    return load_scene("dcb-czm1", [f"{key}={value}" for key, value in changes.items()])


@pytest.mark.parametrize("numbers", STOCKY, ids=str)
def test_a_plane_specimen_is_as_near_as_the_theory_says_and_not_much_nearer(numbers) -> None:
    scene = stocky(*numbers)
    away = distance(solve(scene, "nurbs"), solve(scene, "beam"), max(scene.load.opening))
    stated = beam_error.theory_error(scene)
    assert away <= stated < 5.0 * away


def scene_of(*changes: str) -> Scene:
    return load_scene("dcb-czm1-linear", list(changes))


def curve(scene: Scene, factor: float = 1.0) -> Result:
    opening = np.linspace(0.0, max(scene.load.opening), 50)
    return Result("beam", {"opening": opening, "load": factor * opening})


@pytest.mark.parametrize(("kinematics", "tolerance"), [("linear", 0.002), ("finite", 0.005)])
def test_slender_arms_are_held_to_what_they_always_were(kinematics: str, tolerance: float) -> None:
    for name in ("dcb-czm1", "dcb-czm2"):
        scene = load_scene(name, [f'effects.kinematics="{kinematics}"'])
        assert beam_error.tolerance(scene) == tolerance and beam_error.theory_error(scene) < 0.0012
    assert beam_error.tolerance(load_scene("peel-60")) == 0.015


def test_the_error_goes_by_thickness_over_length_until_the_beam_is_no_judge() -> None:
    scenes = [scene_of("interface.strength=120", f"specimen.arm_thickness={h}") for h in (0.2, 0.4, 0.8, 1.2)]
    errors = [beam_error.theory_error(scene) for scene in scenes]
    assert np.all(np.diff(errors) > 0.0) and errors[0] < beam_error.NO_JUDGE < errors[-1]
    for scene, error in zip(scenes, errors, strict=True):
        results = {name: replace(curve(scene), method=name) for name in ("nurbs", "dolfinx", "beam")}
        checks = {check.subject: check for check in cross_checks(scene, results) if check.name == "beam-curve"}
        foreign = [check for check in checks_of(scene, "mine", curve(scene), results) if check.name == "beam-curve"]
        if error > beam_error.NO_JUDGE:
            assert not checks and not foreign and f"{100 * error:.2g} %" in remarks(scene, results)[0]
            continue
        assert remarks(scene, results) == ()
        for check in (*checks.values(), *foreign):
            assert check.tolerance == max(error, 0.002) and check.uncertainty == error
            assert f"up to {100 * error:.2g} %" in check.meaning and check.kind == "analytical"


def test_ten_times_the_error_is_a_fault() -> None:
    scene = scene_of("interface.strength=60", "specimen.arm_thickness=0.5")
    fault = 10.0 * beam_error.theory_error(scene)
    assert fault > 0.02
    results = {"nurbs": replace(curve(scene, 1.0 + fault), method="nurbs"), "beam": curve(scene)}
    (check,) = cross_checks(scene, results)
    assert check.name == "beam-curve" and check.state == "broken"


def test_a_bond_that_slides_is_judged_by_the_beam() -> None:
    """The identities hold for any toughness, and two codes may have the same wrong one."""
    sets = ["discretization.dofs=2500", "load.opening=1.7"]
    scene, wrong = (load_scene("enf-codeaster", [*sets, *more]) for more in ([], ["interface.shear_toughness=1.05"]))
    beam = solve(scene, "beam")
    for problem, state in ((scene, "holds"), (wrong, "broken")):
        (check,) = cross_checks(scene, {"nurbs": solve(problem, "nurbs"), "beam": beam})
        assert (check.name, check.state) == ("beam-curve", state)


def test_a_beam_that_cannot_judge_a_sliding_bond_says_why() -> None:
    scene = load_scene("adcb-czmtestkit-a")
    (said,) = remarks(scene, {"beam": curve(scene)})
    assert (
        said == "beam: held against no code: the arms rotate, and the beam on a bond that slides has linear kinematics"
    )
    assert beam_error.tolerance(load_scene("adcb-czmtestkit-a", ['effects.kinematics="linear"'])) == 0.005


def test_a_bond_squeezes_an_arm_by_the_whole_opening_where_the_strength_is_so_large() -> None:
    """At p_max^2 h = 2 E2 G_Ic."""
    strength = float(np.sqrt(2.0 * 120e3 * 0.1 / 0.2))
    assert beam_error.squeeze(scene_of(f"interface.strength={strength}")) == pytest.approx(1.0)
    assert beam_error.squeeze(load_scene("peel-80", [f"interface.strength={strength}"])) == 0.0


def apart(method: str, at: float, factor: float = 1.0) -> Result:
    """A load that rises, falls slowly, and up to ``at`` all at once."""
    opening = np.concatenate([np.linspace(0.0, at, 200), [0.9 * at], np.linspace(at, 3.0, 50)])
    load = np.minimum(opening, np.maximum(opening, 1e-9) ** -0.5)
    return Result(method, {"opening": opening, "load": factor * np.where(np.arange(251) < 200, load, 0.01)})


def compared(method: str, at: float, factor: float = 1.0) -> dict[str, str]:
    scene = load_scene("dcb-czm1-linear")
    right = {name: apart(name.partition("-")[0], 2.5) for name in ("beam", "tspline", "dolfinx", "dolfinx-second")}
    found = cross_checks(scene, {**right, method: apart(method, at, factor)})
    return {check.name: check.state for check in found if check.subject.startswith(method)}


@pytest.mark.usefixtures("nothing_certified")
@pytest.mark.parametrize("at", [2.49, 2.495, 2.505, 2.51])
def test_of_a_sudden_fall_the_opening_is_compared(at: float) -> None:
    """The difference of the loads is nine tenths of the peak where one curve has fallen and the other has not."""
    assert set(compared("nurbs", at).values()) == {"holds"}
    right = {name: apart(name, 2.5) for name in ("dolfinx", "beam", "tspline")}
    assert "though not by much" in odd_one({**right, "nurbs": apart("nurbs", at)}, (3.0,))


@pytest.mark.usefixtures("nothing_certified")
@pytest.mark.parametrize("at", [2.2, 2.35, 2.65, 2.8])
def test_a_fall_at_a_wrong_opening_is_found(at: float) -> None:
    found = compared("nurbs", at)
    assert {name for name, state in found.items() if state == "broken"} == {"curve", "farthest-point", "beam-curve"}
    right = {name: apart(name, 2.5) for name in ("dolfinx", "beam", "tspline")}
    assert odd_one({**right, "nurbs": apart("nurbs", at)}, (3.0,)).startswith("odd one out: nurbs, ")


@pytest.mark.usefixtures("nothing_certified")
def test_a_curve_that_is_wrong_before_it_falls_is_found() -> None:
    found = compared("nurbs", 2.5, 1.02)
    assert {name for name, state in found.items() if state == "broken"} >= {"curve", "peak", "beam-curve"}


def test_a_specimen_that_separates_too_early_is_found_though_its_curve_ends_there() -> None:
    beam, result = apart("beam", 2.5), apart("nurbs", 2.2)
    kept = {name: column[:201] for name, column in result.steps.items()}
    ended = replace(result, steps=kept, ending="separated at opening 2.2")
    check = beam_check(load_scene("dcb-czm1-linear"), "nurbs", ended, beam, 0.002)
    assert check.state == "broken"
