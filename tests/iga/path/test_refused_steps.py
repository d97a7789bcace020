"""What a path does when a step fails: it is taken back, sought otherwise, or the path ends and says why."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from paths import CZM1, column, decided, run

import iga.path.energy
import iga.path.follow
import iga.path.gap_newton
import iga.path.step
from iga.dcb import build
from iga.path.follow import follow
from iga.path.polyline import StepError
from iga.path.solver import DEFAULT, Newton, Solver


def test_a_path_that_cannot_go_on_says_why_and_keeps_what_it_has(monkeypatch):
    """Newton without an iteration: the straight elastic part needs none, the first point that softens does.

    On the gaps alone, too: else a linear bulk never needs any.
    """
    monkeypatch.setattr(iga.path.gap_newton, "GAP_NEWTON", iga.path.gap_newton.GapLimits(loads=0))
    problem = replace(CZM1, kinematics="linear")
    system, points, end = run(problem, 30, newton=Newton(tolerance=1e-9, iterations=0))
    _, whole, _ = run(problem, 30)
    assert end.status.startswith("stopped: ") and not end.separated and end.rejected > 10
    for told in ("Newton", f"{points[-1].opening:.6g}", "discretization.dofs", "interface.strength"):
        assert told in end.status
    assert 3 < len(points) < len(whole) and 0.0 < points[-1].opening < 0.3
    elastic = [(p.opening, p.state.load) for p in whole if p.opening <= points[-1].opening]
    kept = [(p.opening, p.state.load) for p in points[: len(elastic)]]
    assert np.allclose(kept, elastic, rtol=1e-9)
    assert all(decided(system, a, b) < DEFAULT.settle for a, b in zip(points[:-1], points[1:], strict=True))


LEAKING = [
    ("nurbs", 4.0, "linear", 20),
    pytest.param("nurbs", 6.0, "finite", 20, marks=pytest.mark.slow),
    pytest.param("lagrange", 20.0, "finite", None, marks=pytest.mark.slow),
]


@pytest.mark.parametrize(("basis", "strength", "kinematics", "steps"), LEAKING)
def test_no_step_leaks_energy(basis, strength, kinematics, steps, monkeypatch):
    """A step that leaps over a part of the path is taken back; each of these paths has one, were it let pass."""

    def leak():
        _, points, _ = run(replace(CZM1, basis=basis, strength=strength, kinematics=kinematics), steps)
        work, energy = column(points, "external_work"), np.array([p.energies.total for p in points])
        return float(np.max(np.abs(np.diff(work - energy)) / np.maximum.accumulate(np.abs(work))[1:]))

    guarded = leak()
    monkeypatch.setattr(iga.path.follow, "leaks", lambda *_: False)
    monkeypatch.setattr(iga.path.follow, "step_error", lambda *_: StepError())
    loose = leak()
    print(f"largest leak {guarded:.1e}, were it let pass {loose:.1e}")
    assert guarded <= iga.path.energy.BALANCE.leak < loose


def test_bodies_that_nothing_holds_are_refused(monkeypatch):
    monkeypatch.setattr(iga.path.follow, "_departing", lambda *given: None)
    with pytest.raises(ValueError, match="singular: the supports or the interface do not hold the bodies"):
        next(follow(Solver(build(CZM1).system), (1.0,), 10))


def test_a_new_mesh_that_nothing_can_be_solved_on_ends_the_path(monkeypatch):
    system, departing, asked = build(replace(CZM1, kinematics="linear")).system, iga.path.follow._departing, []

    def once(*given):
        asked.append(given)
        return departing(*given) if len(asked) == 1 else None

    monkeypatch.setattr(iga.path.follow, "_departing", once)
    *points, end = follow(Solver(system), (0.1,), 50, renew=lambda point: (system, point.state))
    assert end.status == "stopped: the new mesh at opening 0.1 has a singular tangent" and len(points) == 2


def test_a_path_that_leaps_however_short_the_step_is_told_what_to_do(monkeypatch):
    monkeypatch.setattr(iga.path.follow, "leaks", lambda system, before, after, most: before.opening > 0.0)
    problem = replace(CZM1, kinematics="linear", opening=(0.1,))
    _, points, end = run(problem, 50)
    assert end.status.startswith(f"stopped: the energy jumps at opening {points[-1].opening:.6g}, however short")
    assert "discretization.dofs" in end.status and "tspline, nurbs" in end.status and end.rejected > 12


@pytest.mark.parametrize(
    ("fails", "parts", "loads"),
    [
        ((1,), (1.0, 1e-2, 1e-1, 1.0), (0.0, 0.0, 20.0, 30.0)),
        (
            (1, 3, 4),
            (1.0, 1e-2, 1e-1, 1.0, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0),
            (0.0, 0.0, 20.0, 20.0, 20.0, 50.0, 60.0, 70.0, 80.0, 90.0),
        ),
    ],
)
def test_contact_too_stiff_to_be_found_is_searched_for_from_softer_on(fails, parts, loads, monkeypatch):
    """Ever stiffer, each search from what the last one found but with the history of the first, the last as stiff; from
    softer on where that fails."""
    system, asked = build(CZM1).system, []

    def search(solver, trial, goal, newton, searches):
        part = solver.system.interface.law.penalty / system.interface.law.penalty
        asked.append((part, trial.load, trial.k_q is history, *searches))
        if len(asked) in fails:
            return None
        return SimpleNamespace(state=replace(trial, load=10.0 * len(asked), k_q=None))

    monkeypatch.setattr(iga.path.follow, "equilibrium", search)
    start = system.start()
    history = start.k_q
    found = iga.path.follow._touching(Solver(system), start, 0.1, 0.1)
    tried, before, same, searched = zip(*asked, strict=True)
    assert tried == pytest.approx(parts) and all(same) and before == loads
    assert found.state.load == 10.0 * len(parts)
    assert searched == (False, *[True] * (len(parts) - 1))
