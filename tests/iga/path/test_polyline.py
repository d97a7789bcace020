"""What steps keep that the path chooses: the straight line between its points, the largest load, the ledger."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from paths import column, loads, run
from specimens import PAPER

import iga.path.follow
from iga.dcb import Problem
from iga.path.polyline import ACCURACY, Accuracy, Largest, StepError, _maximum, step_error

BEND = 0.005

#: A stocky, finite, orthotropic specimen: at its peak the load falls at a kink, and rises and falls with every point.
LEAPING = Problem(
    length=84.2,
    arm_thickness=1.0,
    precrack=26.9,
    E1=3680.6,
    E2=1115.5,
    G12=236.8,
    nu12=0.0876,
    strength=1.75,
    toughness=0.069,
    ductility=4.0,
    penalty=2e4,
    opening=(17.8,),
    dofs=2500,
    steps=None,
)
#: Teeth of the load so steep that it nearly snaps back at every point, in plane strain, one half of the specimen.
LEAKING = Problem(
    length=51.0,
    arm_thickness=1.0,
    precrack=26.0,
    E1=16053.0,
    E2=1780.8,
    G12=3103.7,
    nu12=0.137,
    plane="strain",
    strength=1.524,
    toughness=4.18e-3,
    ductility=10.27,
    penalty=5e4,
    opening=(2.37,),
    symmetry=True,
    dofs=2500,
    steps=None,
)


@cache
def drawn(problem: Problem, steps: int | None):
    system, points, end = run(problem, steps)
    assert end.status == "complete"
    return column(points, "opening"), loads(points), points


def ledger(points) -> float:
    """Worst gap in parts of the largest work so far, as the check of a run has it."""
    work = column(points, "external_work")
    gap = np.abs(work - np.array([point.energies.total for point in points]))
    return float(np.max(gap[1:] / np.maximum.accumulate(np.abs(work))[1:]))


def off(curve, reference) -> float:
    """Largest distance of the points of a path from a polyline; openings in parts of the one at the largest load."""
    top = int(np.argmax(reference[1]))
    size = np.array([reference[0][top], reference[1][top]])
    a, x = np.stack(curve[:2], axis=1) / size, np.stack(reference[:2], axis=1) / size
    start, chord = a[:-1], np.diff(a, axis=0)
    part = np.sum((x[:, None] - start) * chord, axis=2) / np.sum(chord**2, axis=1)
    near = start + np.clip(part, 0.0, 1.0)[..., None] * chord
    return float(np.linalg.norm(x[:, None] - near, axis=2).min(axis=1).max())


@pytest.mark.slow
@pytest.mark.parametrize("problem", [LEAPING, LEAKING], ids=["leaping", "leaking"])
def test_the_polyline_of_chosen_steps_is_that_of_many_within_the_promise(problem):
    few, many = drawn(problem, None), drawn(problem, 1000)
    peak = few[1].max() / many[1].max() - 1.0
    print(f"{len(few[0]) - 1} steps, off by {off(few, many):.1e}, peak {peak:+.1e}, ledger {ledger(few[2]):.1e}")
    assert off(few, many) < 1.2 * BEND and abs(peak) < ACCURACY.peak * BEND and ledger(few[2]) <= ACCURACY.ledger


def test_a_step_across_a_maximum_is_cut(monkeypatch):
    """Of all that is promised the largest load alone is held; without it steps leap over it."""

    def largest(part: float) -> float:
        monkeypatch.setattr(iga.path.polyline, "ACCURACY", Accuracy(peak=part / 1e6))
        monkeypatch.setattr(iga.path.follow, "step_error", lambda *given: step_error(*given[:-1], 1e6))
        return loads(run(replace(LEAPING, opening=(11.0,)), None)[1]).max()

    kept, loose = largest(ACCURACY.peak * BEND), largest(np.inf)
    print(f"without the cut the largest load is {loose / kept - 1.0:+.2%} off")
    assert loose < (1.0 - 3.0 * ACCURACY.peak * BEND) * kept


@pytest.mark.parametrize(("slopes", "top"), [((1.0, -1.0), 0.25), ((1.0, 0.5), 0.0), ((-1.0, 1.0), 0.0)])
def test_a_load_that_rises_and_falls_on_a_step_is_that_of_the_cubic_between(slopes, top):
    start, end = (SimpleNamespace(slope=slope) for slope in slopes)
    assert _maximum(start, end, 1.0, np.array([1.0, 0.0])) == pytest.approx(top, abs=1e-3)


def test_a_ledger_that_is_open_shortens_the_step_that_opens_it(monkeypatch):
    """Of all that is promised the ledger alone is held: with a budget for the whole path, without it only each step."""

    def worst(budget: float) -> float:
        monkeypatch.setattr(iga.path.polyline, "ACCURACY", Accuracy(ledger=budget))
        monkeypatch.setattr(iga.path.follow, "step_error", lambda *given: step_error(*given[:-1], 1e6))
        return ledger(run(replace(LEAKING, opening=(1.7,)), None)[1])

    held, loose = worst(3e-4), worst(np.inf)
    print(f"ledger {held:.1e}, without a budget {loose:.1e}")
    assert held <= 3e-4 < 5e-4 < loose


def test_what_a_step_keeps_is_told_in_parts_of_the_promise():
    """A step on a branch that is nearly straight: all of it, and twice as far from a promise of half the size."""
    system, points, _ = run(replace(LEAPING, opening=(4.0,), dofs=400), 60)
    whole, half = (step_error(system, points[1], points[-1], Largest(), bend) for bend in (BEND, 0.5 * BEND))
    assert 0.0 < whole.distance < 1.0 and half.distance == pytest.approx(2.0 * whole.distance)
    assert whole == StepError(1.0, whole.distance, single=True, opened=whole.opened) and 0.0 < whole.opened < 1.0


def test_faces_that_were_pressed_together_make_no_step_of_the_opening_longer():
    """They bear ten times the peak: in parts of that a step leaps over the maximum."""
    problem = replace(PAPER, kinematics="linear", dofs=1956)
    pressed, many = drawn(replace(problem, opening=(-0.001, 1.0)), None), drawn(problem, 200)
    zero = int(np.argmax(pressed[0] > 0.0)) - 1
    few = pressed[0][zero:], pressed[1][zero:]
    peak = few[1].max() / many[1].max() - 1.0
    print(f"{len(few[0]) - 1} steps of the opening, off by {off(many, few):.1e}, peak {peak:+.1e}")
    assert -pressed[1].min() > 5.0 * few[1].max()
    assert off(many, few) < BEND and abs(peak) < ACCURACY.peak * BEND
