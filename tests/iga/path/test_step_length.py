"""Steps before any is made: how long they are, what a failed one is tried with, and when there is no more."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from iga.path.polyline import Kept
from iga.path.step_length import BEND, CAREFUL, CORNERED, FEWEST, Pace, paced


@pytest.mark.parametrize(("programme", "whole"), [((3.0,), 3.0), ((1.5, -0.5, 1.0), 5.0), ((-2.0,), 2.0)])
def test_steps_that_are_counted_divide_the_whole_way(programme: tuple[float, ...], whole: float) -> None:
    pace = paced(np.array(programme), 100)
    assert (pace.step, pace.largest, pace.by_accuracy) == (whole / 100, whole / 100, False)
    assert pace.length == pace.step and not pace.careful and not pace.by_kinks and pace.front == 0.125


def test_few_steps_or_none_are_chosen_by_accuracy() -> None:
    """The first a thirtieth of the programme, the largest a quarter, none longer than what was asked for."""
    whole = np.array([3.0])
    for steps, first, largest in ((None, 0.1, 0.75), (2, 0.1, 0.75), (10, 0.1, 0.3), (FEWEST - 1, 3 / 39, 3 / 39)):
        pace = paced(whole, steps)
        assert pace.by_accuracy and pace.by_kinks and (pace.step, pace.largest) == pytest.approx((first, largest))
        assert pace.counted == pytest.approx(0.02) and pace.bend == BEND == 0.005
        assert paced(whole, steps, linear=True).step == pytest.approx(largest), "nothing bends there before damage"
    assert not paced(whole, FEWEST).by_accuracy and FEWEST == 40
    assert paced(whole, None, 0.02).bend == 0.02


def test_a_counted_step_that_fails_changes_its_control_before_its_length() -> None:
    pace, seen = paced(np.array([1.0]), 50), []
    for _ in range(8):
        seen.append((pace.control, pace.length / pace.step, pace.front / 0.125))
        pace = pace.slower()
    assert seen[0] == seen[1] == ("front", 1.0, 1.0), "the same once more, but up to the kinks of the law"
    assert seen[1:] == [(name, half, half) for half in (1.0, 0.5, 0.25) for name in CAREFUL][:7]
    assert CAREFUL == ("front", "dissipation", "arc length")


def test_a_counted_step_is_halved_a_dozen_times_and_no_more() -> None:
    pace, halvings = paced(np.array([1.0]), 50), set()
    while not pace.exhausted:
        halvings.add(pace.level)
        pace = pace.slower()
    assert halvings == set(range(13)) and pace.length < pace.step / 4096


@pytest.mark.parametrize(("attempt", "then"), [(1, 0), (2, 0), (3, 0), (4, 1), (6, 1), (7, 4), (9, 4), (10, 7)])
def test_a_careful_step_that_converged_is_followed_by_one_twice_as_long(attempt: int, then: int) -> None:
    """With the control that comes first."""
    pace = Pace(0.1, 0.1, attempt=attempt)
    after = pace.after(SimpleNamespace(), SimpleNamespace(), 1.0)
    assert after.attempt == then and after.control == "front"
    assert after.length == pytest.approx(min(2.0 * pace.length, 0.1) if attempt > 3 else 0.1)


def test_a_step_by_accuracy_may_fail_three_times_in_a_row_and_is_then_counted() -> None:
    pace = paced(np.array([3.0]), None)
    failed = [pace]
    for _ in range(4):
        failed.append(failed[-1].slower())
    assert [now.step / pace.step for now in failed[:4]] == [1.0, 0.5, 0.25, 0.125]
    assert [now.front for now in failed[:4]] == [1.0, 0.5, 0.25, 0.125]
    assert all(now.by_accuracy and not now.careful and now.largest == pace.largest for now in failed[:4])
    counted = failed[4]
    assert not counted.by_accuracy and (counted.step, counted.largest) == (0.02, 0.02) and counted.front == 0.125


def test_every_step_by_accuracy_that_converged_makes_up_for_one_that_failed() -> None:
    """So that a path with a failure now and then is never counted, and its front goes as far as before."""
    pace = start = paced(np.array([10.0]), None)
    for _ in range(20):
        pace = pace.slower().slower()
        assert pace.by_accuracy and pace.front == 0.25
        for front in (0.5, 1.0, 1.0):
            pace = pace.after(*ends(1.0, 0.1, 0.0), 4.0)
            assert pace.front == front
    assert pace.spared == start.spared


def test_the_front_goes_further_where_loads_may_leave_their_tangents_by_more() -> None:
    assert replace(paced(np.array([1.0]), None), bend=4 * BEND).front == pytest.approx(2.0)


def ends(opening: float, h: float, curvature: float):
    """Both ends of a step of a parabola, load = 2 d + c d^2."""

    def point(d: float) -> SimpleNamespace:
        load = 2.0 * d + curvature * d**2
        slope = 2.0 + 2.0 * curvature * d
        tangent = SimpleNamespace(departure=slope, rough=False)
        return SimpleNamespace(opening=d, state=SimpleNamespace(load=load), slope=slope, tangent=tangent)

    return point(opening), point(opening + h)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(("h", "factor"), [(0.1, 1.0), (0.08, 1.25), (0.15, 2 / 3), (0.02, 2.0), (0.5, 0.5)])
def test_the_next_step_leaves_its_tangent_by_what_it_may(h: float, factor: float, sign: float) -> None:
    """A parabola leaves it by c h^2, which is the bend times the peak for h = 0.1; at most twice or half as long."""
    pace = replace(paced(np.array([10.0]), None), bend=0.02)
    peak, curvature = 4.0, -0.02 * 4.0 / 0.1**2
    found = pace.after(*ends(1.0, sign * h, curvature), peak)
    assert found.step == pytest.approx(factor * h) and found.attempt == 0 and found.spared == pace.spared


def test_a_straight_step_is_followed_by_one_twice_as_long_within_the_largest() -> None:
    pace = paced(np.array([10.0]), None)
    assert pace.after(*ends(1.0, 0.25, 0.0), 4.0).step == pytest.approx(0.5)
    assert pace.after(*ends(1.0, 2.0, 0.0), 4.0).step == pace.largest == 2.5
    assert pace.after(*ends(1.0, 1e-9, 0.0), 4.0).step == pytest.approx(2.5 / 4096)
    counted = paced(np.array([10.0]), 100)
    assert counted.after(*ends(1.0, 0.25, 0.0), 4.0) is counted


@pytest.mark.parametrize(("kept", "growth"), [(Kept(away=0.2, few=True, broken=True), 2.0), (Kept(away=1.0), 0.5)])
def test_teeth_do_not_shorten_a_step_whose_straight_line_is_near(kept: Kept, growth: float) -> None:
    """A load that leaves the tangent of its tooth by a lot; the step before it was asked to be as long."""
    pace = replace(paced(np.array([10.0]), None), step=0.1)
    assert pace.after(*ends(1.0, 0.1, -20.0), 1.0, kept).step == pytest.approx(growth * 0.1)


def test_a_step_that_breaks_its_promise_is_cut_and_a_cornered_arc_ends_at_every_kink() -> None:
    pace = replace(paced(np.array([10.0]), None), step=0.3)
    cut = pace.cut(Kept(part=0.5, away=4.0), -0.2)
    assert (cut.step, cut.cuts, cut.every_kink) == (pytest.approx(0.1), 1, False)
    cornered = pace.cut(Kept(part=0.5, away=4.0, few=True), 0.2)
    assert cornered.every_kink and cornered.spared == pace.spared
    for _ in range(CORNERED):
        assert cornered.every_kink
        cornered = cornered.after(*ends(1.0, 0.1, 0.0), 4.0)
    assert not cornered.every_kink and cornered.cuts == 0


def test_steps_that_are_counted_after_failures_keep_the_promise_and_those_of_the_user_make_none() -> None:
    pace = replace(paced(np.array([3.0]), None, 0.02), spared=0).slower()
    assert pace.promised and pace.bend == 0.02 and not pace.by_accuracy
    assert pace.cut(Kept(part=0.5), 0.02).after(*ends(1.0, 0.01, 0.0), 4.0).step == pace.step
    assert not paced(np.array([3.0]), 150).promised
