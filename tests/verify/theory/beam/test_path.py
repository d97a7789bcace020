"""The path behind the damage front: how a step is guessed, how long it may be, and where it lands."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from verify.theory.beam import path as front
from verify.theory.beam.arm import FORCE, V
from verify.theory.beam.equilibrium import BEAM_NEWTON, State, intact
from verify.theory.beam.path import BEAM_PATH, Pace, follow
from verify.theory.beam.problem import BeamProblem
from verify.theory.beam.rows import Units
from verify.theory.beam.solve import model
from verify.theory.beam.zones import OPEN, SOFTENING

PROBLEM = BeamProblem(14.0, 0.2, 4.0, 1.0, 120e3, 50e3, 4.0, 0.1, 12.5, 1e5, opening=1.0, points=60)
MODEL = model(PROBLEM)


@pytest.fixture(scope="module")
def path() -> tuple[Pace, list[State]]:
    """The pace that a solution has, and all its states, the undamaged one first."""
    units = Units.of(PROBLEM)
    pace = Pace(units.deflection(PROBLEM.end), units.reference_load, 2.0 / PROBLEM.points)
    first = intact(MODEL)
    *states, status = [state for state in follow(MODEL, first, pace) if state is not None]
    assert status == "complete"
    return pace, [first, *states]


def test_the_path_lands_where_the_bond_opens_and_at_its_end(path: tuple[Pace, list[State]]) -> None:
    """The front only advances; one state has the tip of the precrack at the end of the law, the last one the goal."""
    pace, states = path
    tip = np.array([state.field.at(np.array(MODEL.ends.precrack))[V] for state in states])
    assert np.abs(tip / MODEL.base.v_open - 1.0).min() < 1e-8
    assert states[-1].field.node[0, V] == pytest.approx(pace.end, rel=1e-10)
    fronts = np.array([state.front for state in states])
    assert np.all(np.diff(fronts) >= 0.0) and fronts[0] == MODEL.ends.precrack < fronts[-1] < MODEL.ends.length
    assert all(1 <= state.iterations <= BEAM_NEWTON.iterations for state in states)


def test_steps_go_as_far_and_turn_as_much_as_they_may(path: tuple[Pace, list[State]]) -> None:
    pace, states = path
    place = np.array([[s.field.node[0, V] / pace.end, -s.field.node[0, FORCE] / pace.load] for s in states])
    strides = np.hypot(*np.diff(place, axis=0).T)  # the first begins where damage does, and is none
    damaged = [i for i, state in enumerate(states[:-1]) if np.any(state.kind == SOFTENING)]
    assert max(strides[1:]) < 1.05 * pace.stride and np.median(strides[damaged]) > 0.5 * pace.stride
    elastic = strides[1 : damaged[0] - 1]
    assert np.ptp(elastic) < 1e-6 * pace.stride, "equal steps, two or more of them, where nothing is damaged"
    turns = [pace.turned(states[i], states[i + 1]) for i in damaged]
    assert max(t for t, i in zip(turns, damaged, strict=True) if strides[i] > pace.stride / 32) <= pace.turn


def test_rates_of_the_path_are_those_of_its_curve(path: tuple[Pace, list[State]]) -> None:
    """Load over opening along the tangent against a difference quotient over neighbouring states."""
    pace, states = path
    peak = int(np.argmax([-state.field.node[0, FORCE] for state in states]))
    assert not pace.fading(states[peak - 2]) and pace.fading(states[peak + 2])
    before, here, after = states[-4:-1]
    (d0, P0), (d1, P1) = ((s.field.node[0, V] / pace.end, -s.field.node[0, FORCE] / pace.load) for s in (before, after))
    a, b = pace.rate(here.tangent)
    assert b / a == pytest.approx((P1 - P0) / (d1 - d0), rel=0.02)
    assert pace.turned(here, here) == 0.0
    back = replace(here, tangent=replace(here.tangent, node=-here.tangent.node))
    assert pace.turned(here, back) == pytest.approx(np.pi)


@pytest.fixture
def guessed(monkeypatch: pytest.MonkeyPatch):
    """The places of the nodes of the guesses of a step that nothing comes of, in their order."""

    def ask(state: State, ds: float) -> list[np.ndarray]:
        found: list[np.ndarray] = []
        with monkeypatch.context() as patch:
            patch.setattr(front, "settle", lambda m, guess, zones, control: found.append(guess.x))
            assert front._step(MODEL, state, ds) is None
        return found

    return ask


def test_a_long_step_of_a_whole_zone_moves_it_along(path: tuple[Pace, list[State]], guessed) -> None:
    """By a quarter of the zone or more; a zone that is still forming, and a short step, go along the tangent."""
    _, states = path
    whole = next(state for state in states[::-1] if np.any(state.kind == OPEN))
    zone = np.diff(whole.field.x)[whole.kind == SOFTENING].sum()
    for part, moved_first in ((0.24, False), (0.26, True)):
        first, second = guessed(whole, part * zone)
        tangent = first if not moved_first else second
        assert np.array_equal(tangent, whole.field.x) and not np.array_equal(first, second)
    forming = next(s for s in states if np.any(s.kind == SOFTENING) and not np.any(s.kind == OPEN))
    assert np.array_equal(guessed(forming, 0.5 * (MODEL.ends.length - forming.front))[0], forming.field.x)


def test_what_is_moved_along_is_the_same_further_on(path: tuple[Pace, list[State]]) -> None:
    """The arm in front of it goes straight on, with the slope that it has there; elements keep their kind."""
    state, ds = path[1][-1], 0.3
    moved, kind = front._moved(MODEL, state, ds)
    assert moved.x[0] == 0.0 and moved.x[-1] == MODEL.ends.length and len(kind) == len(moved.x) - 1
    at = np.linspace(ds, MODEL.ends.length, 50)
    assert moved.at(at) == pytest.approx(state.field.at(at - ds), rel=1e-6, abs=1e-9)
    ahead = moved.at(np.array([0.0, 0.5 * ds, ds]))[:, V]
    slope = MODEL.arm.rates(state.field.node[0], np.zeros(3))[0][V]
    assert np.diff(ahead) == pytest.approx([0.5 * ds * slope] * 2, rel=1e-6)
    lengths = [np.diff(x)[k == SOFTENING].sum() for x, k in ((state.field.x, state.kind), (moved.x, kind))]
    assert lengths[0] == pytest.approx(lengths[1])


def test_a_front_that_does_not_advance_is_said_with_its_place(
    path: tuple[Pace, list[State]], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Every step that fails is halved and told, until it is too short."""
    pace, _ = path
    monkeypatch.setattr(front, "_step", lambda m, state, ds: None)
    found = list(follow(MODEL, intact(MODEL), pace))
    place = MODEL.ends.precrack / MODEL.ends.length
    assert found[-1] == f"stopped: the damage front did not advance beyond {place:.4g} of the length"
    halved = found.count(None)
    room = 0.2 * (MODEL.ends.length - MODEL.ends.precrack) / (BEAM_PATH.smallest_step * MODEL.ends.length)
    assert 10 < halved <= np.log2(room) + 1 and found.index(None) == len(found) - 1 - halved


def test_an_arm_that_cannot_be_solved_before_any_damage_is_where_the_path_stops(
    path: tuple[Pace, list[State]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(front, "resettle", lambda m, state, guess, control: None)
    (status,) = follow(MODEL, intact(MODEL), path[0])
    assert status.startswith("stopped: the undamaged arm was not solved") and "interface.strength" in status


def test_a_path_ends_where_little_of_the_bond_or_of_the_load_is_left(
    path: tuple[Pace, list[State]], monkeypatch: pytest.MonkeyPatch
) -> None:
    """At once, and not before the load falls: a load that grows from nothing is no end."""
    (pace, states), little = path, 0.9
    monkeypatch.setattr(front, "BEAM_PATH", replace(BEAM_PATH, separated=little))
    *found, status = follow(MODEL, intact(MODEL), pace)
    bond = MODEL.ends.length - MODEL.ends.precrack
    left = [(MODEL.ends.length - state.front) / bond for state in found if state is not None]
    load = [-state.field.node[0, FORCE] for state in found if state is not None]
    assert status == front.HAS_SEPARATED and BEAM_PATH.separated < little
    assert (left[-1] < little or load[-1] <= little * max(load)) and left[-2] > little and len(left) < len(states)
