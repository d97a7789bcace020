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
from verify.curves.curve import Curve, point_distances
from verify.curves.leg_checks import farthest, stiffness
from verify.curves.legs import path, programme_of
from verify.curves.read import read_curve
from verify.methods.solve import solve
from verify.result import Result
from verify.scene.load import load_scene
from verify.support.programme import only_opens, turns
from verify.verdict import Check

PROGRAMME = (1.5, 0.2, 3.0)
STOCKY = Path(__file__).parents[4] / "shared" / "stocky"


@pytest.fixture(scope="module")
def envelope():
    return solve(load_scene("dcb-czm1"), "beam")


def legs_of(envelope: Result, steps: int) -> list[doctored.Leg]:
    """What a bond without healing makes of the programme: unloading along the secant, and the way back."""
    found = []
    for begin, end in zip((0.0, *PROGRAMME[:-1]), PROGRAMME, strict=True):
        d = np.linspace(begin, end, round(abs(end - begin) * steps / 5.6))
        top, grown = (np.interp(at, envelope.opening, envelope.load) for at in (1.5, d))
        found.append((d, np.where((begin > 0.0) & (d < 1.5), top * d / 1.5, grown)))
    return found


def checked(curve: Curve, envelope: Result, loop: bool) -> list[Check]:
    """A curve of 300 steps against a code of 150."""
    scene = load_scene("dcb-czm1", [f"load.opening={list(PROGRAMME)}"] if loop else [])
    d, P = doctored.joined(legs_of(envelope, 150))
    reference = Result("", {"opening": d, "load": P}) if loop else envelope
    mine = Result("mine", dict(zip(("opening", "load"), curve, strict=True)))
    return list(checks_of(scene, "mine", mine, {"nurbs": reference}))


def doctored_checks(envelope: Result, doctor: doctored.Doctor, loop: bool) -> list[Check]:
    fine = np.linspace(0.0, 3.0, 301)
    legs = legs_of(envelope, 300) if loop else [(fine, np.interp(fine, envelope.opening, envelope.load))]
    return checked(doctored.joined(doctor(legs)), envelope, loop)


def table(of_any: dict, of_loops: dict) -> list:
    rows = [(*row, loop) for row in of_any.items() for loop in (False, True)] + [
        (*row, True) for row in of_loops.items()
    ]
    return [pytest.param(*entry, loop, id=f"{name}{', loop' * loop}") for name, entry, loop in rows]


def test_a_stiffness_is_told_before_a_long_step_over_half_the_load():
    """On that step the chord of the coarse curve is softer, and says nothing of its stiffness."""
    coarse, fine = (
        path((d, np.minimum(d, 1.0)), (2.0,)).legs[0] for d in (np.array([0.0, 0.45, 2.0]), np.linspace(0.0, 2.0, 201))
    )
    assert stiffness(coarse, fine) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(("doctor", "says", "loop"), table(doctored.WRONG, doctored.WRONG_LOOPS))
def test_no_wrong_curve_passes(envelope, doctor, says, loop):
    assert says in {check.name for check in doctored_checks(envelope, doctor, loop) if check.state == "broken"}


@pytest.mark.parametrize(("doctor", "absent", "loop"), table(doctored.RIGHT, doctored.RIGHT_LOOPS))
def test_no_right_curve_fails(envelope, doctor, absent, loop):
    """What it does not contain is not covered."""
    found = {check.name: check.state for check in doctored_checks(envelope, doctor, loop) if check.kind != "certified"}
    assert {name: state for name, state in found.items() if state != "holds"} == dict.fromkeys(absent, "not covered")


@pytest.mark.skipif(not STOCKY.is_dir(), reason="../shared/stocky is not there")
@pytest.mark.parametrize(
    ("name", "says"), [("healing", "slope-leg-2"), ("nounload", "legs"), ("garbage_unload", "curve-leg-2")]
)
def test_curves_whose_unloading_is_wrong(envelope, name, says):
    found = checked(read_curve(STOCKY / f"u_{name}.csv"), envelope, True)
    assert says in {check.name for check in found if not check.passed}
    assert all(check.passed for check in found if check.name in ("curve", "peak", "end")), "the envelope is right"


def test_goals_in_one_direction_are_one_leg():
    assert turns((1.0, 2.0, 0.5, 0.2, -0.1, 3.0)) == (2.0, -0.1, 3.0)
    assert turns((1.0, 2.0)) == (2.0,) and turns((-0.2, -0.3)) == (-0.3,)
    assert only_opens((1.0, 2.0)) and not only_opens((-0.2,)) and not only_opens((1.0, 0.5))


@given(st.lists(st.floats(-2.0, 3.0), min_size=1, max_size=6), st.integers(3, 40))
def test_the_legs_are_those_of_the_programme(goals, steps):
    """Whatever the steps, and with a snap-back on the way, which is no turn."""
    programme: list[float] = []
    for goal in goals:
        programme += [goal] if abs(goal - (programme[-1] if programme else 0.0)) > 0.1 else []
    if not programme:
        return
    d = [0.0]
    for goal in programme:
        here = d[-1]
        way = np.linspace(here, goal, steps)[1:-1].tolist()
        d += [*way, *(here + (goal - here) * np.array([0.9, 0.4, 0.95])).tolist(), goal]
    found = path((np.array(d), np.zeros(len(d))), programme)
    assert found.misfit == 0.0 and [leg.end for leg in found.legs] == list(turns(programme))
    for leg, begin in zip(found.legs, (0.0, *turns(programme)), strict=False):
        assert (leg.opening[0], leg.opening[-1]) == (begin, leg.end) and leg.heading * (leg.end - begin) > 0.0
        if begin * leg.end < 0.0:
            assert np.array_equal(leg.above_zero(leg.opening), leg.opening >= 0.0)


T = np.linspace(0.0, 1.0, 60)
#: Openings, loads, and the programme that the curve shows: a snap-back comes back at smaller loads as its crack grows.
SHOWN = {
    "a loop": ((0, 1, 2, 0.5, 2, 3), (0, 2, 1.6, 0.4, 1.6, 1), (2, 0.5, 3)),
    "a loop of which the unloading is the end": ((0, 1, 2, 0.5), (0, 2, 1.6, 0.4), (2, 0.5)),
    "a loop that leaves a third of its opening": (
        (0, 1, 2, 1.2, 0.8, 1.2, 2, 3),
        (0, 2, 1.6, 0.53, 0, 0.53, 1.6, 1),
        (2, 0.8, 3),
    ),
    "a snap-back": ((0, 1, 0.5, 1, 3), (0, 2, 0.8, 0.7, 0.5), (3,)),
    "two snap-backs": ((0, 1, 0.5, 1, 1.5, 0.7, 1.5, 2.5), (0, 2, 0.8, 0.7, 0.6, 0.2, 0.18, 0.15), (2.5,)),
    "a snap-back at the end": ((0, 1, 0.5), (0, 2, 0.8), (1,)),
    "both": ((0, 1, 0.5, 1, 3, 0.4, 3, 4), (0, 2, 0.8, 0.7, 0.5, 0.07, 0.5, 0.4), (3, 0.4, 4)),
    "softer on the way back by 5 % of the work, as a laminate": (
        (0, *(1.5 - 1.3 * T), *(0.2 + 1.3 * T), 2.5),
        (0, *(4.0 - 3.5 * T), *(0.5 + 3.5 * (T - 0.15 * T * (1.0 - T))), 2.5),
        (1.5, 0.2, 2.5),
    ),
}


@pytest.mark.parametrize("name", SHOWN)
def test_the_programme_that_a_curve_shows(name):
    d, P, shown = SHOWN[name]
    assert programme_of((np.array(d, dtype=float), np.array(P, dtype=float))) == pytest.approx(shown)


DROP = np.array([0.0, 1.0, 1.0, 2.0]), np.array([0.0, 1.0, 0.5, 0.5])
KINK = np.array([0.0, 0.4, 0.8, 1.2, 1.6]), np.array([0.0, 0.4, 0.8, 0.8, 0.4])  # at opening 1, load 1
SNAP = np.array([0.0, 1.0, 0.5, 2.0]), np.array([0.0, 1.0, 0.4, 0.4])


@pytest.mark.parametrize(
    ("d", "P", "graph", "off"),
    [
        (0.5, 0.5, DROP, 0.0),
        (1.0, 0.7, DROP, 0.0),
        (0.5, 0.54, DROP, 0.04 / 0.54),  # at the same opening; 0.04 / 0.5 at the same load
        (1.01, 0.7, DROP, 0.01 / 1.01),
        (1.5, 0.55, DROP, 0.05 / 0.55),
        (1.0, 1.0, KINK, 0.0),
        (0.75, 0.7, SNAP, 0.0),
        (1.0, 0.7, SNAP, 0.0),
    ],
)
def test_distances_are_those_of_the_definition(d, P, graph, off):
    """Of a point over a slope, beside a drop, behind a kink that a chord cuts, and in a snap-back."""
    assert point_distances(([d], [P]), graph, (2.0, 1.0))[0] == pytest.approx(off, abs=1e-15)


@pytest.mark.parametrize("enough", [np.inf, 0.02])
def test_a_drop_that_comes_a_little_later_is_that_much_off_and_not_its_height(enough):
    """Without a bound all loads counted as their difference at one opening: a reference seemed 3 % off."""
    d, P = np.array([0.0, 1.0, 1.0 + 1e-9, 2.0]), np.array([0.0, 1.0, 0.6, 0.5])
    worst = farthest(path((d, P), (2.0,)), path((d + 1e-4 * (d > 0.5), P), (2.0,)), enough)
    assert worst is not None and worst.value < 3e-4


@pytest.mark.parametrize(
    ("below", "above", "legs"), [(1.0, 1.0, ""), (1.03, 1.0, "23"), (1.0, 1.03, "123"), (1.0, 1.003, "")]
)
def test_pressed_faces_hide_nothing_that_is_wrong_where_the_bond_opens(below, above, legs):
    """They bear a hundred times as much on a hundredth of the way, or the other way round."""
    scene, goals = load_scene("dcb-czm1", ["load.opening=[1.0, -0.01, 1.5]"]), (0.0, 1.0, 0.0, -0.01, 0.0, 1.5)
    d = np.concatenate([np.linspace(*ends, 51) for ends in zip(goals[:-1], goals[1:], strict=True)])
    load = np.where(d < 0.0, 1e4 * d, d)
    mine, reference = (Result("", {"opening": d, "load": P}) for P in (load * np.where(d < 0.0, below, above), load))
    broken = {check.name for check in checks_of(scene, "mine", mine, {"nurbs": reference}) if not check.passed}
    assert {name for name in broken if name.startswith("curve-leg")} == {f"curve-leg-{number}" for number in legs}
    assert ("farthest-point" in broken) == bool(legs)


WAY = np.concatenate([np.linspace(0.0, 1.5, 16), np.linspace(1.4, 0.2, 13), np.linspace(0.3, 3.0, 28)])


@pytest.mark.parametrize(
    ("d", "P"),
    [
        (np.append(0.0, WAY), np.append(0.0, 1.0 + WAY)),  # begins vertically
        (WAY, 0.0 * WAY),
        (WAY, 1e30 * WAY),
        (np.array([0.0, 1.5]), np.array([0.0, 1.0])),
        (np.array([1.5, 0.2]), np.array([1.0, 1.0])),
        (-WAY, WAY),
    ],
)
def test_odd_curves_are_judged_without_a_warning(d, P):
    scene = load_scene("dcb-czm1", [f"load.opening={list(PROGRAMME)}"])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        reference = {"nurbs": Result("nurbs", {"opening": WAY, "load": WAY})}
        found = checks_of(scene, "mine", Result("mine", {"opening": d, "load": P}), reference)
    assert not all(check.passed for check in found)
