"""Steps before any is made: how long they are, what a failed one is tried with, and when there is no more."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from iga.path.polyline import StepError
from iga.path.step_length import CONTROLS, LENGTHS, StepLength, step_length

WHOLE = np.array([3.0])


@pytest.mark.parametrize(
    ("programme", "steps", "first", "largest"),
    [
        ((3.0,), 100, 0.03, 0.03),
        ((1.5, -0.5, 1.0), 100, 0.05, 0.05),
        ((-2.0,), LENGTHS.fewest, 0.05, 0.05),
        ((3.0,), None, 0.1, 0.75),
        ((3.0,), 2, 0.1, 0.75),
        ((3.0,), 10, 0.1, 0.3),
        ((3.0,), 39, 3 / 39, 3 / 39),
    ],
)
def test_steps_divide_the_whole_way_or_few_are_chosen_by_accuracy(programme, steps, first, largest):
    """The first a thirtieth of the programme, the largest a quarter, none longer than what was asked for."""
    found = step_length(np.array(programme), steps, 0.02)
    assert (found.length, found.largest) == pytest.approx((first, largest))
    chosen = steps is None or steps < 40
    assert found.by_accuracy == chosen and found.tolerance == (0.02 if chosen else None)
    assert found.front == pytest.approx(2.0 if chosen else 0.125)
    if chosen:
        assert found.safe == pytest.approx(0.02)
        assert step_length(WHOLE, steps, linear=True).length == pytest.approx(largest), "straight before damage"


def test_a_counted_step_that_fails_changes_its_control_before_its_length():
    """At first to the kinks of the law, then with each control, then halved a dozen times; each that converges takes
    back a halving."""
    now, seen = step_length(np.array([1.0]), 50).failed(0.0), []
    while now is not None:
        assert now.careful and now.front == pytest.approx(0.125 * now.length / 0.02)
        seen.append((CONTROLS[now.number], now.length / 0.02))
        last, now = now, now.failed(0.0)
    assert seen == [(name, 0.5**i) for i in range(13) for name in CONTROLS]
    for i in range(12, -1, -1):
        assert last.careful and last.halvings == i
        last = last.after(SimpleNamespace(), SimpleNamespace(), 1.0, StepError())
        assert last.number == 0
    assert last == step_length(np.array([1.0]), 50)


def test_a_step_by_accuracy_may_fail_three_times_in_a_row_and_is_then_counted():
    """Every one that converges makes up for one that failed."""
    now = start = step_length(WHOLE, None)
    for i in range(4):
        assert now.by_accuracy and (now.length, now.front) == (0.5**i * start.length, 0.5**i)
        now = now.failed(1.5)
    assert now == StepLength(0.02, 0.02, 0.005, since=1.5)
    now = start.failed(0.0).failed(0.0)
    fronts = [(now := now.after(*ends(1.0, 0.1, 0.0), 4.0, StepError())).front for _ in range(3)]
    assert fronts == [0.5, 1.0, 1.0] and now.left == start.left


def ends(opening: float, h: float, curvature: float):
    """Both ends of a step of a parabola, load = 2 d + c d^2."""

    def point(d: float) -> SimpleNamespace:
        load, slope = 2.0 * d + curvature * d**2, 2.0 + 2.0 * curvature * d
        tangent = SimpleNamespace(departure=slope, rough=False)
        return SimpleNamespace(opening=d, state=SimpleNamespace(load=load), slope=slope, tangent=tangent)

    return point(opening), point(opening + h)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(
    ("h", "after"), [(0.1, 0.1), (0.08, 0.1), (0.15, 0.1), (0.02, 0.04), (0.5, 0.25), (1e-9, 2.5 / 4096)]
)
def test_the_next_step_leaves_its_tangent_by_what_it_may(h, after, sign):
    """A parabola leaves it by c h^2, the tolerance times the peak for h = 0.1; at most twice or half as long."""
    lengths, peak = step_length(np.array([10.0]), None, 0.02), 4.0
    found = lengths.after(*ends(1.0, sign * h, -0.02 * peak / 0.1**2), peak, StepError())
    assert found.length == pytest.approx(after)
    straight = lengths.after(*ends(1.0, sign * 2.0, 0.0), peak, StepError())
    assert straight.length == lengths.largest == 2.5


@pytest.mark.parametrize(
    ("error", "growth"), [(StepError(distance=0.2, single=True, broken=True), 2.0), (StepError(distance=1.0), 0.5)]
)
def test_the_ripple_does_not_shorten_a_step_whose_straight_line_is_near(error, growth):
    """A load that leaves the tangent of its arc by a lot; the step before it was asked to be as long."""
    lengths = replace(step_length(np.array([10.0]), None), usual=0.1)
    assert lengths.after(*ends(1.0, 0.1, -20.0), 1.0, error).length == pytest.approx(growth * 0.1)


@pytest.mark.parametrize("single", [False, True])
def test_a_step_that_is_not_accurate_is_cut_and_after_a_single_arc_some_end_at_every_kink(single):
    lengths = replace(step_length(np.array([10.0]), None), usual=0.3)
    cut = lengths.cut(StepError(part=0.5, distance=4.0, single=single), -0.2)
    assert (cut.length, cut.cuts, cut.left) == (pytest.approx(0.1), 1, lengths.left)
    for left in range(LENGTHS.at_kinks, 0, -1):
        assert cut.at_kinks == (left if single else 0)
        cut = cut.after(*ends(1.0, 0.1, 0.0), 4.0, StepError())
    assert cut.at_kinks == 0 and cut.cuts == 0


def test_of_a_careful_step_the_usual_length_is_cut():
    cut = StepLength(0.02, 0.02, 0.005, careful=True, halvings=2).cut(StepError(part=0.5), 0.004)
    assert cut.length == pytest.approx(0.002) and cut.usual == pytest.approx(0.008) and cut.cuts == 1


def test_a_path_of_many_short_steps_counts_them():
    """As soon as attempts that get less far than counted steps outnumber the others; a front that opens is not slow."""
    lengths = replace(step_length(WHOLE, None), usual=0.1)
    short = ends(1.0, 0.5 * lengths.safe, 0.0)
    for opened, moved in ((0.5, short), (0.0, ends(1.0, 0.1, 0.0))):
        for _ in range(2 * LENGTHS.slow):
            lengths = lengths.after(*moved, 4.0, StepError(opened=opened))
        assert lengths.by_accuracy and lengths.slow == 0
    for _ in range(LENGTHS.slow // 2):
        lengths = lengths.cut(StepError(part=0.5), 0.01).after(*short, 4.0, StepError(opened=0.0))
    assert lengths.by_accuracy and lengths.slow == LENGTHS.slow
    assert lengths.after(*short, 4.0, StepError(opened=0.0)) == StepLength(0.02, 0.02, since=1.01)
