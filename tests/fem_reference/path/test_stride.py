"""Steps that the path chooses: the curve of many counted steps by few, kinks and tops that none leaps over."""

from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("dolfinx", reason="DOLFINx is not installed")

from dolfinx_runs import CZM1, built, solve
from scipy.interpolate import CubicHermiteSpline

from fem_reference.model.model import BondEnergies
from fem_reference.path.path import astray, path
from fem_reference.path.state import Largest, State
from fem_reference.path.stride import CHOSEN_STEPS, Drawn, chosen

DCB = replace(CZM1, elements=56, kinematics="linear")


def test_a_programme_that_turns_back_shares_its_error_among_its_legs():
    loose, turning = chosen(3.0, 0.1), chosen(9.0, 0.1, turns=3.0)
    drawn = Drawn(1.0, 0.0, CHOSEN_STEPS.most, 0.0)
    assert loose._excess(drawn)[1] == pytest.approx(1.0) and turning._excess(drawn)[1] == pytest.approx(3.0)


@pytest.mark.parametrize("kinematics", ["linear", pytest.param("finite", marks=pytest.mark.slow)])
def test_few_chosen_steps_draw_the_curve_of_many_counted_ones(kinematics):
    problem = replace(DCB, kinematics=kinematics)
    solution, few = solve(replace(problem, steps=None))
    _, many = solve(replace(problem, steps=150))
    assert len(solution.rows) < 60 < 150 < many["load"].size
    at = np.linspace(0.02, 3.0, 200)
    drawn = CubicHermiteSpline(few["opening"], few["load"], few["load_slope"])(at)
    known = np.interp(at, many["opening"], many["load"])
    assert np.linalg.norm(drawn - known) < 2e-3 * np.linalg.norm(known)
    assert few["load"].max() == pytest.approx(many["load"].max(), rel=1e-3)
    assert few["external_work"][-1] == pytest.approx(many["external_work"][-1], rel=1e-3)
    gap = few["external_work"] - few["stored_energy"] - few["dissipated_energy"]
    assert np.max(np.abs(gap)) < 1e-3 * few["external_work"][-1]


def test_a_larger_bend_takes_fewer_steps():
    counts = [len(solve(replace(DCB, steps=None, bend=bend))[0].rows) for bend in (0.002, 0.005, 0.05)]
    assert counts[0] > counts[1] > counts[2]


def test_unloading_is_straight_and_the_path_lands_where_damage_grows_again():
    """One row stands where the envelope is met, with the secant of unloading; the row before is far away."""
    _, run = solve(replace(DCB, steps=None, opening=(1.5, 0.3, 3.0)))
    turn, back = (int(np.flatnonzero(run["opening"] == opening)[0]) for opening in (1.5, 0.3))
    lost = run["dissipated_energy"]
    assert lost[back] == pytest.approx(lost[turn], rel=1e-12) and back - turn <= 8
    landed = back + int(np.argmax(lost[back:] > lost[turn] * (1 + 1e-9))) - 1
    assert run["opening"][landed] == pytest.approx(1.5, rel=1e-4)
    assert run["load"][landed] == pytest.approx(run["load"][turn], rel=1e-4)
    assert run["opening"][landed + 1] - run["opening"][landed] < 0.02
    _, straight = solve(replace(DCB, steps=None))
    assert run["load"][-1] == pytest.approx(straight["load"][-1], rel=1e-4)


@pytest.mark.parametrize(("strength", "elements"), [pytest.param(4.0, 56, marks=pytest.mark.slow), (6.0, 14)])
def test_a_reversible_bond_closes_as_it_opened(strength, elements):
    """Steps that end at the next edge, as on opening, would open it on and on. The second path has snap-backs."""
    problem = replace(DCB, strength=strength, elements=elements, kinematics="finite", irreversible=False, steps=None)
    _, run = solve(replace(problem, opening=(1.0, 0.2, 1.1)))
    assert run["load"].size < 400 and run["opening"].max() == 1.1
    turn = int(np.argmax(run["opening"] == 1.0))
    assert np.any(np.diff(run["opening"][: turn + 1]) < 0) == (strength == 6.0)
    for opening in (0.2, 1.1):
        _, once = solve(replace(problem, opening=(opening,)))
        i = int(np.flatnonzero(run["opening"] == opening)[0])
        assert run["load"][i] == pytest.approx(once["load"][-1], rel=1e-6)
        assert run["stored_energy"][i] == pytest.approx(once["stored_energy"][-1], rel=1e-6)


def test_no_state_on_the_way_back_is_further_open_than_the_turn():
    def leaves(before, reached, *lines):
        return astray(state(before, 1.0, 0.0, 0.0, 0.0), state(reached, 1.0, 0.0, 0.0, 0.0), np.array(lines))

    assert leaves(0.99, 1.01, 1.0, 0.5) and leaves(-0.99, -1.01, -1.0, 0.0) and leaves(0.01, -0.01, 0.0, 1.0)
    assert not leaves(0.9, 0.8, 1.0, 0.5) and not leaves(0.6, 0.4, 1.0, 0.5)  # beyond the goal it is repeated
    assert not leaves(0.5, 0.4, 0.5, 1.0)  # a snap-back


@pytest.mark.parametrize("opening", [(-0.0002, 0.7), (0.05, -0.001, 0.7)])
def test_a_bond_opens_after_pressing_as_it_does_without(opening):
    """Pressed faces bear twice and ten times the peak: as parts of that the forces of the first step are nothing."""
    _, run = solve(replace(DCB, steps=None, opening=opening))
    _, many = solve(replace(DCB, steps=100, opening=(0.7,)))
    gap = run["external_work"] - run["stored_energy"] - run["dissipated_energy"]
    zero = np.flatnonzero(run["opening"] < 0.0)[-1] + 1
    assert run["opening"][zero] == 0.0 and -run["load"].min() > 2.0 * run["load"].max()
    assert np.all(np.abs(gap - gap[zero])[zero + 1 :] <= 2e-3 * run["external_work"][zero + 1 :])
    assert run["load"].max() == pytest.approx(many["load"].max(), rel=1e-3)


def test_pressing_has_steps_of_its_own():
    """Unjudged they never grew again after a kink, and were nine hundred; as long as those of the opening they are one,
    whose chord has another area."""
    _, straight = solve(replace(DCB, steps=None, opening=(-0.001,)))
    assert straight["load"].size < 30
    _, run = solve(replace(DCB, steps=None, kinematics="finite", opening=(1.0, -0.02)))
    d, P, work = (
        run[name][np.flatnonzero(run["opening"] == 1.0)[0] :] for name in ("opening", "load", "external_work")
    )
    zero = int(np.flatnonzero(d == 0.0)[0])
    assert np.trapezoid(P[zero:], d[zero:]) == pytest.approx(work[-1] - work[zero], rel=5e-3)


def test_snap_backs_are_followed_by_chosen_steps():
    solution, run = solve(replace(DCB, strength=6.0, elements=14, steps=None))
    assert solution.ending == "" and run["opening"][-1] == 3.0
    assert np.any(np.diff(run["opening"]) < 0)
    gap = run["external_work"] - run["stored_energy"] - run["dissipated_energy"]
    assert np.max(np.abs(gap)) < 2e-3 * run["dissipated_energy"][-1]


def test_cracks_grow_from_edge_to_edge_of_elements():
    """There all slopes of a long step belong to the same place between two points that break."""
    model = built(replace(DCB, steps=None))
    order, ends = np.argsort(model.X_q), []
    for point in path(model):
        if isinstance(point, State) and 0.8 < point.opening < 3.0:
            open_q = point.g_q[order, 0] >= model.law.failed
            ends.append(model.X_q[order][np.count_nonzero(open_q) - 1 : np.count_nonzero(open_q) + 1].mean())
    from_edge = np.abs(np.array(ends)[:, None] - model.specimen.X).min(axis=1)
    assert len(ends) > 5 and np.median(from_edge) < 1e-9


PEAK = Largest(1.0, 1.0)


def state(opening, load, slope, work, energy, heading=1.0):
    none = np.zeros(0)
    return State(none, load, opening, none, none, none, slope, heading, PEAK, work, energy, BondEnergies(), 1)


def test_a_step_is_too_long_where_chord_energy_or_maximum_say_so():
    stride = replace(chosen(3.0, 0.005), reach=0.5)
    start = state(1.0, 1.0, -1.0, 1.0, 1.0)
    area = 0.9 * 0.2
    straight = state(1.2, 0.8, -1.0, 1.0 + area, 1.0 + area)
    kept, longer = stride.judged(start, straight)
    assert kept and longer.reach > stride.reach * 0.8
    for energy, slope in ((area + 0.004, -1.0), (area, 2.0)):
        kept, shorter = stride.judged(start, state(1.2, 0.8, slope, 1.0 + energy, 1.0 + energy))
        assert kept == (slope == 2.0) and (kept or shorter.reach < stride.reach)
    kept, shorter = stride.judged(start, state(1.2, 0.8, -1.0, 1.0 + area + 0.001, 1.0 + area))
    assert not kept and shorter.reach < stride.reach and shorter.slow < 1.0
    rising = state(0.8, 0.97, 0.5, 1.0, 1.0)
    kept, _ = stride.judged(rising, state(1.0, 0.97, -0.5, 1.0 + 0.1956, 1.0 + 0.1956))
    assert not kept, "the cubic rises by more than a part of the peak above both ends"
    tiny = replace(stride, slow=0.125 / CHOSEN_STEPS.front)
    assert tiny.judged(start, state(1.2, 0.8, -1.0, 1.0 + area + 0.001, 1.0 + area))[0], "the teeth of the mesh"


def test_a_failure_is_remembered_for_some_steps():
    stride = chosen(3.0, 0.005).failed()
    assert stride.front == 0.5 * chosen(3.0, 0.005).front and stride.reach == 0.5 * chosen(3.0, 0.005).reach
    here = state(0.0, 0.0, 1.0, 0.0, 0.0)
    for n in range(3):
        ahead = state(0.01 * (n + 1), 0.01 * (n + 1), 1.0, 0.5e-4 * (n + 1) ** 2, 0.5e-4 * (n + 1) ** 2)
        _, stride = stride.judged(here, ahead)
        here = ahead
    assert 0.5 < stride.slow < 0.9
    while stride is not None:
        last, stride = stride, stride.failed()
    assert last.slow < 1e-3 and last.patience and not chosen(3.0, 0.005).patience
