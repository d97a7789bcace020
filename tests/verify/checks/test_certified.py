"""Runs against certified values: which are held to what, what is found and what is not; the key of a problem."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import get_args

import numpy as np
import pytest

from verify.checks import certified as module
from verify.checks.between_codes import CODE_TOLERANCE, CROSS_CODE, cross_checks
from verify.checks.certified import certified_check, certified_checks, measured
from verify.checks.foreign_curves import checks_of
from verify.checks.orders import ARMS, ARMS_SECOND
from verify.methods.solve import solve
from verify.result import Result
from verify.scene.load import load_scene
from verify.scene.stated.certified import Certified, CertifiedKind, certified, entries, problem_key

END = 3.0
#: Relative uncertainty of the values here, and what keeping the pairs of points changes.
U, MATCHED = 0.0015, 0.002
KINDS: tuple[tuple[CertifiedKind, float | None], ...] = (
    ("peak", None), ("peak_opening", None), ("load_at", 0.5), ("load_at", 2.0), ("work", END), ("zone", END),
)  # fmt: skip
#: Scenes with certified values.
KEPT = sorted(entry["scene"] for entry in entries().values() if entry["values"])
#: Runs on fine meshes: those whose tolerance is that of two codes.
FINE = (*(name for name, tolerance in CROSS_CODE.items() if tolerance == CODE_TOLERANCE), "dolfinx", "abaqus")


def run(name: str = "nurbs", scale: float = 1.0, columns: bool = True) -> Result:
    """A load of peak 0.25 at 0.67; a front that moves on by 2 while the zone grows from 1 to 1.5."""
    d = np.linspace(0.0, END, 301)
    steps = {"opening": d, "load": scale * d * np.exp(-1.5 * d)}
    if columns:
        steps |= {"crack_length": 4.0 + np.maximum(0.0, d - 1.0), "damage_front": 5.0 + 1.25 * np.maximum(d - 1.0, 0.0)}
        steps["damage_front"][d <= 1.0] += d[d <= 1.0] * 1e-3
    return Result(name, steps, elements=100)


def values(matched: float = 0.0) -> tuple[Certified, ...]:
    found = [(kind, at, measured(run(), kind, at)) for kind, at in KINDS]
    return tuple(Certified(f"the {kind}", kind, at, x, U * x, matched * x) for kind, at, x in found)


@pytest.fixture
def scene(monkeypatch):
    monkeypatch.setattr(module, "certified", lambda scene: values())
    return load_scene("dcb-czm1")


def states(checks: Sequence) -> dict[str, str]:
    return {check.name: check.state for check in checks if check.kind == "certified"}


def test_the_work_of_a_theory_is_as_near_as_its_next_order_says(scene):
    """Not so its peak load."""
    more, second = run("beam", scale=1.012), run("beam-3")
    assert states(certified_checks(scene, "beam", more, CODE_TOLERANCE))["certified-work"] == "broken"
    found = states(certified_checks(scene, "beam", more, CODE_TOLERANCE, second))
    assert found["certified-work"] == "holds" and found["certified-peak"] == "broken"
    far = run("beam", scale=1.03)
    assert (
        states(certified_checks(scene, "beam", far, CODE_TOLERANCE, run("beam-3", scale=1.012)))["certified-work"]
        == "broken"
    )


def test_the_quantities_of_a_curve():
    found = {kind: measured(run(), kind, at) for kind, at in KINDS if kind != "load_at"}
    assert found["peak_opening"] == pytest.approx(1 / 1.5, abs=0.005) and found["peak"] == pytest.approx(
        0.24525, rel=1e-4
    )
    exact = (1.0 - np.exp(-4.5) * 5.5) / 2.25
    assert found["work"] == pytest.approx(exact, rel=1e-4)
    assert found["zone"] == pytest.approx(1.0 + 0.25 * 1.25, rel=1e-2)
    assert np.isnan(measured(run(columns=False), "zone", END)) and np.isnan(measured(run(), "load_at", 3.5))
    short = Result("abaqus", {key: one[:200] for key, one in run().steps.items()})
    assert np.isnan(measured(short, "work", END)) and np.isnan(measured(short, "zone", END))
    gone = Result("abaqus", {"opening": np.array([0.0, 1.0, 1.0]), "load": np.array([0.0, 1.0, 0.0])})
    assert measured(gone, "work", END) == pytest.approx(0.5), "a specimen that is separated takes no more work"


@pytest.mark.parametrize("name", FINE)
def test_one_percent_less_load_is_found_and_the_uncertainty_is_not(scene, name):
    def judged(scale: float) -> dict[str, str]:
        return states(certified_checks(scene, name, run(name, scale), CODE_TOLERANCE))

    of_load = {"certified-peak", "certified-load-0.5", "certified-load-2", "certified-work"}
    less = judged(0.99)
    assert {check for check, state in less.items() if state == "broken"} == of_load
    assert set(less) == of_load | {"certified-peak-opening", "certified-zone"}
    assert set(judged(1.0 + U).values()) == set(judged(1.0 - U).values()) == {"holds"}


def test_every_run_and_every_other_code_is_held_to_them(scene):
    runs = {name: run(name) for name in ("nurbs", "dolfinx", "beam", "lefm")}
    runs |= {name: run("beam") for name in (ARMS, ARMS_SECOND)}
    found = [check for check in cross_checks(scene, runs | {"nurbs": run(scale=0.9)}) if check.kind == "certified"]
    assert {check.subject for check in found} == {"nurbs", "dolfinx", "beam", ARMS}
    assert {check.subject for check in found if check.state == "broken"} == {"nurbs"}
    assert not any("zone" in check.name for check in found if check.subject in ("beam", ARMS))
    stalled = run()
    stalled.steps["damage_front"][250] = stalled.steps["damage_front"][249]
    assert "certified-zone" not in states(certified_checks(scene, "lagrange", stalled, CODE_TOLERANCE))
    of_other = states(checks_of(scene, "mine", run("mine", 0.98, columns=False), {}))
    assert of_other["certified-peak"] == "broken" and "certified-zone" not in of_other


@pytest.mark.parametrize("every", [3, 6, 10])
def test_a_right_curve_of_few_steps_is_right(scene, every):
    steps = {name: run().steps[name][::every] for name in ("opening", "load")}
    found = certified_checks(scene, "mine", Result("mine", steps), CODE_TOLERANCE)
    assert {check.name for check in found if not check.passed} == set()


def test_pairs_that_are_kept_are_held_to_what_that_changes():
    """Neither the scene nor the matched model is an error of a code of which nobody knows which it solves."""
    known = replace(values(MATCHED)[0], uncertainty=1e-6)
    exact = {True: 1.0 + MATCHED, False: 1.0}
    for kept, scale in exact.items():
        assert certified_check("a", run(scale=scale), known, 1e-3, kept).passed
        assert not certified_check("a", run(scale=scale), known, 1e-3, not kept).passed
        assert certified_check("a", run(scale=scale), known, 1e-4, None).passed
    assert (
        module.keeps_pairs(load_scene("dcb-czm1"), "dolfinx")
        and module.keeps_pairs(load_scene("dcb-czm1"), "nurbs") is False
    )
    assert (
        module.keeps_pairs(load_scene("dcb-czm1"), "nurbs-matched")
        and module.keeps_pairs(load_scene("dcb-czm1"), "x") is None
    )


@pytest.mark.parametrize(
    "other",
    [
        *("= discretization.dofs=900", "= dolfinx.elements=50", "= name=other", "= units=m", "= pose.angle=9"),
        "specimen.width=2", "material.young=121e3", "interface.toughness=0.11", "load.opening=2.9", "load.at=node",
        "effects.kinematics=linear", "effects.search=false", "interface.penalty=1e4", "specimen.plane=strain",
    ],
)  # fmt: skip
def test_every_number_of_the_physics_is_part_of_a_problem_and_no_mesh_or_name(other):
    same = problem_key(load_scene("dcb-czm1", [other.removeprefix("= ")])) == problem_key(load_scene("dcb-czm1"))
    assert same == other.startswith("= ")


def test_what_is_kept_is_of_packaged_scenes():
    for key, entry in entries().items():
        assert problem_key(load_scene(entry["scene"])) == key, (
            f"{entry['scene']} is another problem now: certify it again"
        )


@pytest.mark.parametrize("name", KEPT)
def test_one_percent_less_than_a_kept_load_is_found_and_its_uncertainty_is_not(monkeypatch, name):
    for known in certified(load_scene(name)):
        assert known.kind in get_args(CertifiedKind) and known.uncertainty > 0.0

        def state(value: float, known: Certified = known) -> str:
            monkeypatch.setattr(module, "measured", lambda *_: value)
            return certified_check("nurbs", run(), known, CODE_TOLERANCE, False).state

        assert {state(known.value + sign * known.uncertainty) for sign in (-1, 1)} == {"holds"}
        of_load = known.kind not in ("zone", "peak_opening")
        assert not of_load or state(0.99 * known.value) == "broken", f"{name}: {known.quantity}"


@pytest.mark.slow
@pytest.mark.parametrize("name", KEPT)
def test_plane_arms_have_the_certified_values(name):
    scene = load_scene(name, ["beam.order=3"])
    found = certified_checks(scene, "beam-3", solve(scene, "beam"), CODE_TOLERANCE)
    assert len(found) >= 2 and {one.name: one.value for one in found if one.state != "holds"} == {}


def test_the_error_of_a_theory_is_in_parts_of_the_largest_load(scene):
    """Its loads may be as many newtons off as its peak; those of a code by as many parts of themselves."""
    theory, code = (
        {one.name: one.tolerance for one in certified_checks(scene, of, run(of), 0.02)} for of in ("beam", "nurbs")
    )
    for name, known in zip(("certified-load-0.5", "certified-load-2"), values()[2:4], strict=True):
        allowed = np.hypot(0.02 * measured(run(), "peak") / known.value, U)
        assert theory[name] == pytest.approx(allowed) and allowed > 0.0205
        assert code[name] == pytest.approx(np.hypot(0.02, U))
    assert theory["certified-peak"] == code["certified-peak"] and theory["certified-work"] == code["certified-work"]
