"""Steps before any is made: how long they are, what a failed one is tried with, and when there is no more."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from iga.path.polyline import Kept
from iga.path.step_length import CONTROLS, LENGTHS, ByAccuracy, Careful, Counted, step_length


@pytest.mark.parametrize(("programme", "whole"), [((3.0,), 3.0), ((1.5, -0.5, 1.0), 5.0), ((-2.0,), 2.0)])
def test_steps_that_are_counted_divide_the_whole_way(programme: tuple[float, ...], whole: float) -> None:
    lengths = step_length(np.array(programme), 100)
    assert lengths == Counted(whole / 100, whole / 100) and lengths.front == 0.125


def test_few_steps_or_none_are_chosen_by_accuracy() -> None:
    """The first a thirtieth of the programme, the largest a quarter, none longer than what was asked for."""
    whole = np.array([3.0])
    for steps, first, largest in ((None, 0.1, 0.75), (2, 0.1, 0.75), (10, 0.1, 0.3), (39, 3 / 39, 3 / 39)):
        lengths = step_length(whole, steps)
        assert isinstance(lengths, ByAccuracy)
        assert (lengths.length, lengths.largest) == pytest.approx((first, largest))
        assert lengths.counted.length == pytest.approx(0.02) and lengths.bend == 0.005
        assert step_length(whole, steps, linear=True).length == pytest.approx(largest), "nothing bends before damage"
    assert isinstance(step_length(whole, LENGTHS.fewest), Counted) and LENGTHS.fewest == 40
    assert step_length(whole, None, 0.02).bend == 0.02


def test_a_counted_step_that_fails_changes_its_control_before_its_length() -> None:
    lengths, seen = step_length(np.array([1.0]), 50).failed(0.0), []
    assert lengths == Careful(Counted(0.02, 0.02)), "the same once more, but up to the kinks of the law"
    for _ in range(7):
        seen.append((CONTROLS[lengths.number], lengths.length / 0.02, lengths.front / 0.125))
        lengths = lengths.failed(0.0)
    assert seen == [(name, half, half) for half in (1.0, 0.5, 0.25) for name in CONTROLS][:7]
    assert CONTROLS == ("front", "dissipation", "arc length")


def test_a_counted_step_is_halved_a_dozen_times_and_no_more() -> None:
    lengths, tried = step_length(np.array([1.0]), 50).failed(0.0), []
    while lengths is not None:
        tried.append(lengths.length)
        lengths = lengths.failed(0.0)
    assert len(tried) == 3 * 13 and tried[-1] == 0.02 / 4096


def test_a_careful_step_that_converged_is_followed_by_one_twice_as_long() -> None:
    """With the control that comes first; in the end by those that are usual."""
    usual = Counted(0.1, 0.1)
    for halvings, number in ((0, 0), (0, 2), (1, 0), (1, 2), (2, 1)):
        after = Careful(usual, halvings, number).after(SimpleNamespace(), SimpleNamespace(), 1.0, Kept())
        assert after == (Careful(usual, halvings - 1) if halvings else usual)


def test_a_step_by_accuracy_may_fail_three_times_in_a_row_and_is_then_counted() -> None:
    lengths = step_length(np.array([3.0]), None)
    failed = [lengths]
    for _ in range(4):
        failed.append(failed[-1].failed(1.5))
    assert [now.length / lengths.length for now in failed[:4]] == [1.0, 0.5, 0.25, 0.125]
    assert [now.front for now in failed[:4]] == [1.0, 0.5, 0.25, 0.125]
    assert all(isinstance(now, ByAccuracy) and now.largest == lengths.largest for now in failed[:4])
    assert failed[4] == Counted(0.02, 0.02, 0.005, since=1.5)


def test_every_step_by_accuracy_that_converged_makes_up_for_one_that_failed() -> None:
    """So that a path with a failure now and then is never counted, and its front goes as far as before."""
    lengths = start = step_length(np.array([10.0]), None)
    for _ in range(20):
        lengths = lengths.failed(0.0).failed(0.0)
        assert isinstance(lengths, ByAccuracy) and lengths.front == 0.25
        for front in (0.5, 1.0, 1.0):
            lengths = lengths.after(*ends(1.0, 0.1, 0.0), 4.0, Kept())
            assert lengths.front == front
    assert lengths.left == start.left


def test_the_front_goes_further_where_loads_may_leave_their_tangents_by_more() -> None:
    assert step_length(np.array([1.0]), None, 4 * LENGTHS.bend).front == pytest.approx(2.0)


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
    lengths = step_length(np.array([10.0]), None, 0.02)
    peak, curvature = 4.0, -0.02 * 4.0 / 0.1**2
    found = lengths.after(*ends(1.0, sign * h, curvature), peak, Kept())
    assert found.length == pytest.approx(factor * h) and found.left == lengths.left


def test_a_straight_step_is_followed_by_one_twice_as_long_within_the_largest() -> None:
    lengths = step_length(np.array([10.0]), None)
    assert lengths.after(*ends(1.0, 0.25, 0.0), 4.0, Kept()).length == pytest.approx(0.5)
    assert lengths.after(*ends(1.0, 2.0, 0.0), 4.0, Kept()).length == lengths.largest == 2.5
    assert lengths.after(*ends(1.0, 1e-9, 0.0), 4.0, Kept()).length == pytest.approx(2.5 / 4096)
    counted = step_length(np.array([10.0]), 100)
    assert counted.after(*ends(1.0, 0.25, 0.0), 4.0, Kept()) == counted


@pytest.mark.parametrize(("kept", "growth"), [(Kept(away=0.2, few=True, broken=True), 2.0), (Kept(away=1.0), 0.5)])
def test_teeth_do_not_shorten_a_step_whose_straight_line_is_near(kept: Kept, growth: float) -> None:
    """A load that leaves the tangent of its tooth by a lot; the step before it was asked to be as long."""
    lengths = replace(step_length(np.array([10.0]), None), length=0.1)
    assert lengths.after(*ends(1.0, 0.1, -20.0), 1.0, kept).length == pytest.approx(growth * 0.1)


def test_a_step_that_is_not_accurate_is_cut_and_a_cornered_arc_ends_at_every_kink() -> None:
    lengths = replace(step_length(np.array([10.0]), None), length=0.3)
    cut = lengths.cut(Kept(part=0.5, away=4.0), -0.2)
    assert (cut.length, cut.cuts, cut.at_kinks) == (pytest.approx(0.1), 1, 0)
    cornered = lengths.cut(Kept(part=0.5, away=4.0, few=True), 0.2)
    assert cornered.at_kinks == LENGTHS.at_kinks and cornered.left == lengths.left
    for _ in range(LENGTHS.at_kinks):
        assert cornered.at_kinks > 0
        cornered = cornered.after(*ends(1.0, 0.1, 0.0), 4.0, Kept())
    assert cornered.at_kinks == 0 and cornered.cuts == 0


def test_a_path_that_crawls_from_point_to_point_counts_its_steps() -> None:
    """As soon as attempts that get less far than counted steps outnumber the others; a front that opens is no crawl."""
    start = lengths = replace(step_length(np.array([3.0]), None), length=0.1)
    small = ends(1.0, 0.5 * start.counted.length, 0.0)
    for opened, moved in ((0.5, small), (0.0, ends(1.0, 0.1, 0.0))):
        for _ in range(2 * LENGTHS.crawl):
            lengths = lengths.after(*moved, 4.0, Kept(opened=opened))
        assert isinstance(lengths, ByAccuracy) and lengths.crawl == 0
    for _ in range(LENGTHS.crawl // 2):
        lengths = lengths.cut(Kept(part=0.5), 0.01).after(*small, 4.0, Kept(opened=0.0))
    assert isinstance(lengths, ByAccuracy) and lengths.crawl == LENGTHS.crawl
    assert lengths.after(*small, 4.0, Kept(opened=0.0)) == Counted(0.02, 0.02, since=1.01)


def test_steps_that_are_counted_after_failures_are_accurate_and_those_of_the_user_as_they_are() -> None:
    counted = replace(step_length(np.array([3.0]), None, 0.02), left=0).failed(0.0)
    assert isinstance(counted, Counted) and counted.bend == 0.02
    assert counted.cut(Kept(part=0.5), 0.02).after(*ends(1.0, 0.01, 0.0), 4.0, Kept()) == counted
    assert step_length(np.array([3.0]), 150).bend is None


def test_what_is_cut_of_a_careful_step_is_cut_of_the_usual_one() -> None:
    careful = Careful(Counted(0.02, 0.02, 0.005), halvings=2)
    cut = careful.cut(Kept(part=0.5), 0.004)
    assert cut.length == pytest.approx(0.002) and cut.usual.length == pytest.approx(0.008) and cut.cuts == 1
