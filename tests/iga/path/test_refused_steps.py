"""What a path does when a step fails: it is taken back, sought otherwise, or the path ends and says why."""

import dataclasses
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
from iga.laws.opening import BilinearLaw
from iga.path.follow import follow
from iga.path.point import End
from iga.path.polyline import Kept
from iga.path.solver import DEFAULT, Newton, Solver


def test_a_path_that_cannot_go_on_says_why_and_keeps_what_it_has(monkeypatch):
    """Newton without an iteration: the straight elastic part needs none, the first point that softens does.

    On the gaps alone, too: else a linear bulk never needs any.
    """
    monkeypatch.setattr(iga.path.gap_newton, "GAP_NEWTON", iga.path.gap_newton.GapLimits(solutions=0))
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


LEAKING = [("nurbs", 4.0, "linear", 20), ("nurbs", 6.0, "finite", 20), ("lagrange", 20.0, "finite", None)]


@pytest.mark.parametrize(("basis", "strength", "kinematics", "steps"), LEAKING)
def test_no_step_leaks_energy(basis, strength, kinematics, steps, monkeypatch):
    """A step that leaps over a part of the path is taken back; each of these paths has one, were it let pass."""

    def leak():
        _, points, _ = run(replace(CZM1, basis=basis, strength=strength, kinematics=kinematics), steps)
        work, energy = column(points, "external_work"), np.array([p.energies.total for p in points])
        return float(np.max(np.abs(np.diff(work - energy)) / np.maximum.accumulate(np.abs(work))[1:]))

    guarded = leak()
    monkeypatch.setattr(iga.path.follow, "leaks", lambda *_: False)
    monkeypatch.setattr(iga.path.follow, "judged", lambda *_: Kept())
    loose = leak()
    print(f"largest leak {guarded:.1e}, were it let pass {loose:.1e}")
    assert guarded <= iga.path.energy.BALANCE.leak < loose


class Rounded(BilinearLaw):
    """The bilinear law, its energy off in the last digit, so that what is not damaged dissipates by rounding."""

    def work(self, k):
        return super().work(k) * (1.0 + 4e-16)


def test_rounding_in_the_energies_does_not_refuse_the_step_on_which_damage_begins():
    system = build(CZM1).system
    law = system.interface.law
    off = replace(system, interface=replace(system.interface, law=Rounded(**dataclasses.asdict(law))))
    ends = {}
    for name, tried in (("exact", system), ("off", off)):
        *points, ends[name] = follow(Solver(tried), (0.8,), 40)
        print(f"{name}: {len(points)} points, {ends[name].rejected} rejected")
    assert points[1].energies.dissipated > 0.0 and points[-1].energies.dissipated > 0.1  # by rounding, and in truth
    assert ends["off"] == ends["exact"] == End("complete", 0)


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


@pytest.mark.parametrize(("steps", "again"), [(None, True), (60, False)])
def test_a_shorter_step_is_foreseen_with_the_law_and_a_careful_one_along_the_tangent(steps, again, monkeypatch):
    """What the tangent was read from is read once more where steps are chosen by accuracy; it is the same."""
    known, refused, predicted, leaks = [], [], iga.path.step.predicted, iga.path.follow.leaks

    def recorded(solver, *given):
        known.append(solver.linearised)
        return predicted(solver, *given)

    def once(system, before, after, most):
        refuse = not refused and after.tangent.growing_q.any()
        if refuse:
            refused.append(len(known) - 1)
        return refuse or leaks(system, before, after, most)

    monkeypatch.setattr(iga.path.step, "predicted", recorded)
    monkeypatch.setattr(iga.path.follow, "leaks", once)
    _, points, end = run(replace(CZM1, kinematics="linear", opening=(0.5,)), steps)
    (at,) = refused
    first, second = known[at], known[at + 1]
    assert end.rejected >= 1 and first is not None and (second is not None) == again
    if again:
        b_d = np.arange(1.0, first.response.internal_d.size + 1.0)[:, None]
        x_d = first.inverse.solve(b_d)
        assert np.abs(second.inverse.solve(b_d) - x_d).max() < 1e-9 * np.abs(x_d).max()


def test_contact_too_stiff_to_be_found_is_searched_for_from_softer_on(monkeypatch):
    """Ever stiffer, each search from what the last one found but with the history of the first, the last as stiff."""
    system, asked = build(CZM1).system, []

    def search(solver, trial, goal, newton, searches):
        part = solver.system.interface.law.penalty / system.interface.law.penalty
        asked.append((part, trial.load, trial.k_q is history, *searches))
        if len(asked) in (1, 3):
            return None
        return SimpleNamespace(state=replace(trial, load=10.0 * len(asked), k_q=None))

    monkeypatch.setattr(iga.path.follow, "equilibrium", search)
    start = system.start()
    history = start.k_q
    found = iga.path.follow._touching(Solver(system), start, 0.1, 0.1)
    parts, loads_before, same, searched = zip(*asked, strict=True)
    assert parts == pytest.approx((1.0, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0)) and all(same)
    assert loads_before == (0.0, 0.0, 20.0, 20.0, 40.0, 50.0, 60.0) and found.state.load == 70.0
    assert searched == (False, *[True] * 6)
