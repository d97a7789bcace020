"""Paths that finish: snap-backs, unloading and reloading, separation, stiff contact."""

from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("dolfinx", reason="DOLFINx is not installed")

from dolfinx_runs import CZM1, built, ledger_error, solve
from scipy.interpolate import CubicHermiteSpline

from fem_reference.path import newton
from fem_reference.path import step as stepping
from fem_reference.path.control import front_of, opening_control
from fem_reference.path.path import path
from fem_reference.path.state import State
from fem_reference.path.step import Failure, departing, leaps, step, work_along
from fem_reference.path.stride import Counted
from fem_reference.problem.law import Law

COARSE = replace(CZM1, strength=10.0, elements=28)
KINEMATICS = pytest.mark.parametrize("kinematics", [pytest.param("linear", marks=pytest.mark.slow), "finite"])


@pytest.mark.parametrize(
    ("strength", "elements", "kinematics"),
    [
        (6.0, 14, "finite"),
        *(
            pytest.param(*row, marks=pytest.mark.slow)
            for row in (
                (6.0, 14, "linear"),
                (10.0, 28, "linear"),
                (10.0, 28, "finite"),
                (20.0, 28, "linear"),
                (20.0, 28, "finite"),
            )
        ),
    ],
)
def test_snap_backs_are_followed_to_the_end(strength, elements, kinematics):
    problem = replace(COARSE, strength=strength, elements=elements, kinematics=kinematics)
    solution, run = solve(problem)
    assert solution.status == "complete"
    assert solution.ending == ""
    assert run["opening"][-1] == 3.0
    assert np.any(np.diff(run["opening"]) < 0)
    assert np.any(run["heading"] < 0)
    assert ledger_error(run) < 0.0006
    assert np.all(np.diff(run["dissipated_energy"]) >= -1e-12)
    paid = np.diff(run["dissipated_energy"][[np.argmax(run["crack_length"] > 5), -1]])
    grown = np.diff(run["crack_length"][[np.argmax(run["crack_length"] > 5), -1]])
    assert paid == pytest.approx(problem.toughness * grown, rel=0.03)


@pytest.mark.slow
def test_a_zone_far_below_the_element_completes():
    solution, run = solve(replace(COARSE, strength=40.0, opening=(1.5,)))
    assert solution.status == "complete"
    assert run["opening"][-1] == 1.5
    assert ledger_error(run) < 0.0006


def test_steps_of_the_opening_are_equal_where_the_path_is_smooth():
    _, run = solve(replace(COARSE, strength=4.0, elements=56))
    on_line = np.isclose(run["opening"] % 0.02, 0.0, atol=1e-9) | np.isclose(run["opening"] % 0.02, 0.02, atol=1e-9)
    assert np.count_nonzero(on_line) > 0.97 * on_line.size
    assert on_line.size <= 155


def test_the_damage_front_is_ahead_of_the_crack():
    _, run = solve(replace(COARSE, strength=4.0, elements=56))
    law = Law(4.0, 0.1, 12.5, 1e5)
    assert run["damage_front"][0] == 4.0
    begun = np.argmax(run["damage_front"] > 4.0)
    assert run["tip_opening"][begun - 1] < law.begun * 1.05
    zone = run["damage_front"] - run["crack_length"]
    assert np.all(zone >= 0)
    assert np.all((zone[run["opening"] > 1.0] > 0.4) & (zone[run["opening"] > 1.0] < 1.6))


@KINEMATICS
def test_separation_is_reached_and_said(kinematics):
    solution, run = solve(replace(COARSE, strength=4.0, opening=(8.0,), kinematics=kinematics))
    assert solution.status == "complete"
    assert solution.ending == f"separated at opening {run['opening'][-1]:.6g}"
    assert run["opening"][-1] < 8.0
    assert run["load"][-1] < 1e-3 * np.max(run["load"])
    assert np.all(run["load"] >= 0)
    whole = 0.1 * 10.0
    assert 0.98 * whole < run["dissipated_energy"][-1] < whole
    assert run["bulk_energy"][-1] < 1e-4 * whole
    assert np.min(np.diff(run["opening"])) < 0
    assert ledger_error(run) < 0.0002


@pytest.mark.parametrize(
    ("programme", "kinematics"),
    [
        pytest.param((1.5, 0.0, 1.5, 3.0), "finite", marks=pytest.mark.slow),
        ((1.5, -0.002, 3.0), "linear"),
    ],
)
def test_unloading_and_closing_come_back_to_the_envelope(programme, kinematics):
    problem = replace(COARSE, strength=4.0, elements=56, kinematics=kinematics)
    solution, run = solve(replace(problem, opening=programme))
    assert solution.status == "complete"
    assert solution.ending == ""
    assert [goal in run["opening"] for goal in programme] == [True] * len(programme)
    assert np.min(run["opening"]) == min(programme[1], 0.0)
    assert ledger_error(run) < 0.002
    _, straight = solve(problem)
    other_mesh = min(programme) < 0.0  # finer where the arms are pressed together
    assert run["load"][-1] == pytest.approx(straight["load"][-1], rel=5e-4 if other_mesh else 1e-4)
    closed = run["opening"] <= 0
    assert np.all(run["load"][closed][1:] <= 1e-9)
    lost = run["dissipated_energy"][np.flatnonzero(run["opening"] == programme[1])[-1]]
    assert lost == pytest.approx(run["dissipated_energy"][np.flatnonzero(run["opening"] == 1.5)[0]], rel=1e-9)


def test_closed_arms_do_not_pass_through_each_other():
    """Penetration is the contact pressure over the penalty, also at the loaded end, where nothing is bonded."""
    depths = []
    for penalty in (1e6, 1e8):
        problem = replace(COARSE, strength=4.0, kinematics="linear", penalty=penalty, opening=(0.5, -0.002))
        model = built(replace(problem, steps=5, elements=14))
        last = [point for point in path(model) if isinstance(point, State)][-1]
        assert last.opening == -0.002
        p_q = model.respond(last.g_q, last.k_q)[0][:, 0]
        assert np.argmin(p_q) == np.argmin(model.X_q) and not model.bonded_q[np.argmin(p_q)]
        assert np.min(last.g_q) == pytest.approx(np.min(p_q) / penalty, rel=1e-12)
        depths.append(-np.min(last.g_q))
    assert 0 < depths[1] < 0.1 * depths[0]


def test_unloading_has_the_slope_of_frozen_damage():
    """The secant of the whole specimen, by one linear solve: every point has the stiffness that its damage left."""
    problem = replace(COARSE, strength=4.0, kinematics="linear", opening=(1.5, 0.0), steps=30)
    _, run = solve(problem)
    model = built(replace(problem, opening=(1.5,)))
    turn = [point for point in path(model) if isinstance(point, State)][-1]
    model.bulk_matrix.copy(model.tangent_matrix)
    left_q = (1 - model.damage(turn.k_q)) * model.law.K0
    secant_q = np.where(turn.g_q[:, 0] < 0, problem.penalty, left_q)
    model.tangent_matrix.axpy(1.0, model.bond.tangent(secant_q[:, None, None]))
    dense = model.tangent_matrix.convert("dense").getDenseArray()
    secant = 1.0 / (model.load_n @ np.linalg.solve(dense, model.free_n * model.load_n))
    back = np.argmax(run["opening"]) + np.arange(1, 10)
    chords = np.diff(run["load"][back]) / np.diff(run["opening"][back])
    assert run["load_slope"][back] == pytest.approx(secant, rel=1e-6)
    assert chords == pytest.approx(secant, rel=1e-6)
    assert turn.load == pytest.approx(secant * 1.5, rel=1e-6)
    assert np.all(run["heading"][back] == -1)


@pytest.mark.parametrize(
    "penalty", [1e2, *(pytest.param(penalty, marks=pytest.mark.slow) for penalty in (1e4, 1e7)), 1e10]
)
def test_no_penalty_stops_the_path(penalty):
    brief = replace(COARSE, strength=4.0, kinematics="linear", opening=(0.7, -0.002, 0.7), steps=20, elements=17)
    solution, run = solve(replace(brief, penalty=penalty))
    assert solution.status == "complete"
    assert run["opening"][-1] == 0.7
    assert ledger_error(run) < 0.01


def test_few_requested_steps_give_the_same_envelope():
    few, many = (solve(replace(COARSE, strength=4.0, elements=56, steps=steps))[1] for steps in (5, 150))
    tops = np.linspace(0.1, 3.0, 30)
    rough, fine = (CubicHermiteSpline(run["opening"], run["load"], run["load_slope"])(tops) for run in (few, many))
    assert np.linalg.norm(rough - fine) < 0.002 * np.linalg.norm(fine)
    assert few["load"][-1] == pytest.approx(many["load"][-1], rel=1e-3)
    assert ledger_error(few) < 0.0015


def test_the_front_is_the_most_open_point_that_softens():
    model = built(replace(COARSE, strength=4.0, opening=(1.0,)))
    last = [point for point in path(model) if isinstance(point, State)][-1]
    front = front_of(model, last, 0.02)
    softens_q = (last.g_q > model.law.begun) & (last.g_q < model.law.failed)
    assert front.gap == np.max(last.g_q[softens_q])
    assert front.row_n @ last.u_n == pytest.approx(front.gap, rel=1e-12)
    unloading = departing(model, last, 0.0, Counted(0.02))
    assert unloading.heading == -1
    assert front_of(model, unloading, 0.02) is None


def test_a_path_that_cannot_go_on_says_why(monkeypatch):
    never = replace(newton.REFERENCE_NEWTON, tolerance=0.0, rounding=0.0)
    monkeypatch.setattr(newton, "REFERENCE_NEWTON", never)
    model = built(replace(COARSE, opening=(0.1,), steps=2, elements=14))
    points = list(path(model))
    assert isinstance(points[0], State)
    assert isinstance(points[-1], Failure)
    assert points[-1].final
    assert "no equilibrium beyond opening 0" in points[-1].reason
    assert "more elements" in points[-1].reason


def test_a_singular_tangent_ends_the_path_with_a_sentence(monkeypatch):
    model = built(replace(COARSE, opening=(0.1,), steps=2))
    states = path(model)
    first, zeros = next(states), model.tangent_matrix.duplicate()
    zeros.assemble()
    with monkeypatch.context() as patch:
        patch.setattr(type(model), "tangent", lambda *_: zeros)
        last = list(states)[-1]
    assert isinstance(last, Failure) and last.final
    assert last.reason.startswith("the tangent is singular beyond opening 0,")
    model.factorise(first.u_n, first.k_q)  # the next matrix is none the worse for it
    assert step(model, first, opening_control(model, 0.05), Counted(0.05)).opening == 0.05


def test_a_step_onto_another_branch_is_a_failure(monkeypatch):
    """Its work is not the change of the energy; whoever converges there has left the path."""
    model = built(replace(COARSE, opening=(0.5,)))
    states = path(model)
    before, after = next(states), next(states)
    assert not leaps(before, after)
    assert leaps(before, replace(after, bulk=0.8 * after.bulk)) and leaps(before, replace(after, work=1.2 * after.work))
    monkeypatch.setattr(stepping, "leaps", lambda state, reached: True)
    assert "energy leaps at opening" in next(states).reason


@pytest.mark.parametrize("turn", [0.5, 3.0])
def test_work_converges_with_fourth_order_round_a_turning_point(turn):
    """Load and opening over the gap s: the opening turns back at ``turn``, or not at all within the way."""

    def error(n):
        s = np.linspace(0.0, 1.0, n + 1)
        opening, rate = np.sin(np.pi * s / (2 * turn)), np.pi / (2 * turn) * np.cos(np.pi * s / (2 * turn))
        load, load_rate = np.exp(-s), -np.exp(-s)
        work = 0.0
        for i in range(n):
            ends = [i, i + 1]
            work += work_along(opening[ends], load[ends], load_rate[ends] / rate[ends], rate[ends] / n)
        a = np.pi / (2 * turn)
        exact = a * (np.exp(-1) * (a * np.sin(a) - np.cos(a)) + 1) / (1 + a**2)
        return abs(work - exact)

    errors = np.array([error(n) for n in (3, 7, 15)])
    assert errors[-1] < 1e-5
    assert np.all(errors[1:] < 1.3 * errors[:-1] * (np.array([3, 7]) / np.array([7, 15])) ** 4)
