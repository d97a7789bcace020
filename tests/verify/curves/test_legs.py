"""The legs of a programme: found on curves of any steps, compared one by one, and every doctored curve is found out."""

from __future__ import annotations

import warnings
from pathlib import Path

import doctored
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from verify.checks.foreign_curves import checks_of
from verify.curves.compare import checks, compare
from verify.curves.legs import path, programme_of
from verify.curves.nearness import distances
from verify.curves.read import read_curve
from verify.methods.solve import solve
from verify.result import Result
from verify.scene.load import load_scene
from verify.support.programme import only_opens, turns
from verify.verdict import Check

PROGRAMME = (1.5, 0.2, 3.0)
STOCKY = Path(__file__).parents[4] / "shared" / "stocky"


@pytest.fixture(scope="module")
def envelope() -> Result:
    return solve(load_scene("dcb-czm1"), "beam")


def loops(envelope: Result, steps: int) -> list[doctored.Leg]:
    """What a bond without healing makes of the programme: unloading along the secant, and the way back."""
    first, down, last = (
        np.linspace(a, b, round(abs(b - a) * steps / 5.6)) for a, b in ((0.0, 1.5), (1.5, 0.2), (0.2, 3.0))
    )
    P, grown = (np.interp(at, envelope.opening, envelope.load) for at in (1.5, last))
    reloaded = np.where(last < 1.5, P * last / 1.5, grown)
    return [(first, np.interp(first, envelope.opening, envelope.load)), (down, P * down / 1.5), (last, reloaded)]


def as_result(legs: doctored.Legs) -> Result:
    d, P = doctored.joined(legs)
    return Result("mine", {"opening": d, "load": P})


def judged(envelope: Result, doctor: doctored.Doctor, loop: bool) -> list[Check]:
    """The checks of a doctored curve of 300 steps against a code of 150."""
    if not loop:
        fine = np.linspace(0.0, 3.0, 301)
        legs = doctor([(fine, np.interp(fine, envelope.opening, envelope.load))])
        return list(checks_of(load_scene("dcb-czm1"), "mine", as_result(legs), {"nurbs": envelope}))
    scene = load_scene("dcb-czm1", [f"load.opening={list(PROGRAMME)}"])
    reference = as_result(loops(envelope, 150))
    return list(checks_of(scene, "mine", as_result(doctor(loops(envelope, 300))), {"nurbs": reference}))


@pytest.mark.parametrize("name", doctored.WRONG_LOOPS)
def test_no_wrong_loop_passes(envelope: Result, name: str) -> None:
    doctor, says = doctored.WRONG_LOOPS[name]
    assert says in {check.name for check in judged(envelope, doctor, True) if not check.passed}


@pytest.mark.parametrize("loop", [False, True])
@pytest.mark.parametrize("name", doctored.WRONG)
def test_no_wrong_curve_passes(envelope: Result, name: str, loop: bool) -> None:
    doctor, says = doctored.WRONG[name]
    assert says in {check.name for check in judged(envelope, doctor, loop) if not check.passed}


@pytest.mark.parametrize(
    ("name", "loop"),
    [*((name, loop) for name in doctored.RIGHT for loop in (False, True)), *((n, True) for n in doctored.RIGHT_LOOPS)],
)
def test_no_right_curve_fails(envelope: Result, name: str, loop: bool) -> None:
    doctor = {**doctored.RIGHT, **doctored.RIGHT_LOOPS}[name]
    assert [check for check in judged(envelope, doctor, loop) if not check.passed] == []


@pytest.mark.parametrize(
    ("name", "loop"),
    [
        *((name, loop) for name in doctored.IN_PART for loop in (False, True)),
        *((n, True) for n in doctored.IN_PART_OF_LOOPS),
    ],
)
def test_what_a_curve_does_not_contain_is_not_covered(envelope: Result, name: str, loop: bool) -> None:
    doctor, absent = {**doctored.IN_PART, **doctored.IN_PART_OF_LOOPS}[name]
    found = judged(envelope, doctor, loop)
    assert {check.state for check in found} == {"holds", "not covered"}
    assert absent == {check.name for check in found if check.state != "holds" and check.kind != "certified"}


@pytest.mark.skipif(not STOCKY.is_dir(), reason="../shared/stocky is not there")
@pytest.mark.parametrize(
    ("name", "says"), [("healing", "slope-leg-2"), ("nounload", "legs"), ("garbage_unload", "curve-leg-2")]
)
def test_curves_whose_unloading_is_wrong(envelope: Result, name: str, says: str) -> None:
    d, P = read_curve(STOCKY / f"u_{name}.csv")
    scene = load_scene("dcb-czm1", [f"load.opening={list(PROGRAMME)}"])
    found = checks_of(
        scene, "mine", Result("mine", {"opening": d, "load": P}), {"nurbs": as_result(loops(envelope, 150))}
    )
    assert says in {check.name for check in found if not check.passed}
    assert all(check.passed for check in found if check.name in ("curve", "peak", "end")), "the envelope is right"


def test_goals_in_one_direction_are_one_leg() -> None:
    assert turns((1.0, 2.0, 0.5, 0.2, -0.1, 3.0)) == (2.0, -0.1, 3.0)
    assert turns((3.0,)) == (3.0,) and turns((1.0, 2.0)) == (2.0,) and turns((-0.2, -0.3)) == (-0.3,)
    assert only_opens((1.0, 2.0)) and not only_opens((-0.2,)) and not only_opens((1.0, 0.5))


@given(st.lists(st.floats(-2.0, 3.0), min_size=1, max_size=6), st.integers(3, 40))
def test_the_legs_are_those_of_the_programme(goals: list[float], steps: int) -> None:
    """Whatever the steps, and with a snap-back on the way, which is no turn."""
    programme = [goal for goal, before in zip(goals, [0.0, *goals], strict=False) if abs(goal - before) > 0.1]
    programme = [goal for i, goal in enumerate(programme) if i == 0 or abs(goal - programme[i - 1]) > 0.1]
    if not programme or abs(programme[0]) < 0.1:
        return
    d, here = [0.0], 0.0
    for goal in programme:
        way = np.linspace(here, goal, steps)[1:]
        d += [*way[:-1].tolist(), *(here + (goal - here) * np.array([0.9, 0.4, 0.95])).tolist(), goal]
        here = goal
    found = path((np.array(d), np.zeros(len(d))), programme)
    assert found.misfit == 0.0 and [leg.end for leg in found.legs] == list(turns(programme))
    for leg in found.legs:
        assert leg.opening[-1] == leg.end and leg.heading * (leg.end - leg.begin) > 0.0
    assert [leg.opening[0] for leg in found.legs[1:]] == [leg.end for leg in found.legs[:-1]]


def test_a_snap_back_is_no_unloading() -> None:
    """It comes back at smaller loads: without a programme that tells them apart."""
    loop = np.array([0.0, 1.0, 2.0, 0.5, 2.0, 3.0]), np.array([0.0, 2.0, 1.6, 0.4, 1.6, 1.0])
    assert programme_of(loop) == (2.0, 0.5, 3.0)
    snap = np.array([0.0, 1.0, 0.5, 1.0, 3.0]), np.array([0.0, 2.0, 0.8, 0.7, 0.5])
    assert programme_of(snap) == (3.0,)
    both = np.concatenate((snap[0], [0.4, 3.0, 4.0])), np.concatenate((snap[1], [0.07, 0.5, 0.4]))
    assert programme_of(both) == (3.0, 0.4, 4.0)
    assert programme_of((loop[0][:4], loop[1][:4])) == (2.0, 0.5), "it ends unloaded"
    assert programme_of((snap[0][:3], snap[1][:3])) == (1.0,), "it ends in a snap-back"


def test_distances_are_those_of_the_definition() -> None:
    """Of a point over a slope, beside a drop, behind a kink that a chord cuts, and in a snap-back."""
    drop = np.array([0.0, 1.0, 1.0, 2.0]), np.array([0.0, 1.0, 0.5, 0.5])
    size = 2.0, 1.0

    def off(d: float, P: float, graph: tuple = drop) -> float:
        return float(distances((np.array([d]), np.array([P])), graph, size)[0])

    assert off(0.5, 0.5) == off(1.0, 0.7) == off(2.0, 0.5) == 0.0
    assert off(0.5, 0.54) == pytest.approx(0.04 / 0.54)  # at the same opening; 0.04 / 0.5 at the same load
    assert off(1.01, 0.7) == pytest.approx(0.01 / 1.01) and off(1.5, 0.55) == pytest.approx(0.05 / 0.55)
    kink = np.array([0.0, 0.4, 0.8, 1.2, 1.6]), np.array([0.0, 0.4, 0.8, 0.8, 0.4])  # it is at opening 1, load 1
    assert off(1.0, 1.0, kink) == pytest.approx(0.0, abs=1e-15)
    snap = np.array([0.0, 1.0, 0.5, 2.0]), np.array([0.0, 1.0, 0.4, 0.4])
    assert off(0.75, 0.7, snap) == pytest.approx(0.0, abs=1e-15) == off(1.0, 0.7, snap)


@pytest.mark.parametrize(
    ("below", "above", "legs"), [(1.0, 1.0, ""), (1.03, 1.0, "23"), (1.0, 1.03, "123"), (1.0, 1.003, "")]
)
def test_pressed_faces_hide_nothing_that_is_wrong_where_the_bond_opens(below: float, above: float, legs: str) -> None:
    """They bear a hundred times as much on a hundredth of the way, or the other way round."""
    scene, goals = load_scene("dcb-czm1", ["load.opening=[1.0, -0.01, 1.5]"]), (0.0, 1.0, 0.0, -0.01, 0.0, 1.5)
    d = np.concatenate([np.linspace(*ends, 51) for ends in zip(goals[:-1], goals[1:], strict=True)])
    load = np.where(d < 0.0, 1e4 * d, d)
    mine, reference = (Result("", {"opening": d, "load": P}) for P in (load * np.where(d < 0.0, below, above), load))
    broken = {check.name for check in checks_of(scene, "mine", mine, {"nurbs": reference}) if not check.passed}
    assert {name for name in broken if name.startswith("curve-leg")} == {f"curve-leg-{number}" for number in legs}
    assert ("farthest-point" in broken) == bool(legs)


def test_odd_curves_are_judged_without_a_warning() -> None:
    """A vertical beginning, a curve without a load, numbers at the end of the range."""
    d = np.linspace(0.0, 3.0, 31)
    scene = load_scene("dcb-czm1", [f"load.opening={list(PROGRAMME)}"])
    way = np.concatenate((d[:16], d[15:1:-1], d[3:]))
    reference = {"nurbs": Result("nurbs", {"opening": way, "load": way})}
    for opening, load in (
        (np.append(0.0, way), np.append(0.0, 1.0 + way)),
        (way, 0.0 * way),
        (way, 1e30 * way),
        (np.array([0.0, 1.5]), np.array([0.0, 1.0])),
        (np.array([1.5, 0.2]), np.array([1.0, 1.0])),
        (-way, way),
    ):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            found = checks_of(scene, "mine", Result("mine", {"opening": opening, "load": load}), reference)
        assert not all(check.passed for check in found)


def test_a_loop_that_loses_work_is_an_unloading_and_no_snap_back() -> None:
    """Reloading is softer by 5 % of the work, as in a laminate; to zero load no crack grows on the way."""
    up, t = np.linspace(0.0, 1.5, 90), np.linspace(0.0, 1.0, 60)[1:]
    envelope = np.where(up < 1.0, 4.0 * up, 4.0 / np.sqrt(np.maximum(up, 1.0)))
    on, softer = np.linspace(1.5, 2.5, 60)[1:], t - 0.15 * t * (1.0 - t)
    d = np.concatenate([up, 1.5 * (1.0 - t), 1.5 * t, on])
    P = np.concatenate([envelope, envelope[-1] * (1.0 - t), envelope[-1] * softer, 4.0 / np.sqrt(on)])
    assert programme_of((d, P)) == pytest.approx((1.5, 0.0, 2.5))


@pytest.mark.parametrize("reference", ["snap-back", "drop"])
def test_a_snap_back_is_compared_where_the_reference_has_one(reference: str) -> None:
    d, P = np.array([0.0, 1.0, 0.9, 0.6, 1.0, 2.0]), np.array([0.0, 4.0, 3.3, 1.2, 2.0, 4.0])
    wrong = np.where(d == 0.9, 0.1, P)
    known = (d, P) if reference == "snap-back" else (d[[0, 1, 4, 5]] + [0.0, 0.0, 1e-9, 0.0], P[[0, 1, 4, 5]])
    found = {check.name: check.passed for check in checks(compare((d, wrong), known), curve=1e-3)}
    assert found["farthest-point"] == (reference == "drop") and found["curve-error"]
