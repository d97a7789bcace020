"""What is predicted of a step, before its equilibrium is sought."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from specimens import PAPER

import iga.path.step
from iga.dcb import build
from iga.path.follow import follow
from iga.path.kinks import Kink, StepEnd
from iga.path.solver import Solver
from iga.path.step import advance, predicted


@pytest.fixture(scope="module")
def asked():
    """What is known where a step sets out from a growing front, as the path asks for it."""
    given = []

    def recorded(solver, point, step):
        given.append((solver.system, point, step, solver.linearised))
        return predicted(solver, point, step)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(iga.path.step, "predicted", recorded)
        list(follow(Solver(build(replace(PAPER, opening=(1.0,), dofs=400)).system), (1.0,), 20))
    return next(words for words in reversed(given) if words[3] is not None and words[1].tangent.growing_q.any())


def knowing(system, known):
    """A solver that keeps the factors of a tangent, or none."""
    solver = Solver(system)
    solver.linearised = known
    return solver


def foreseen(asked, part, monkeypatch):
    """Where a step sets out by whose tangent the front opens by a part of g_u, and by how much that part travels."""
    system, point, step, known = asked
    path, moved = point.tangent, []
    away = part * system.interface.law.g_u / path.rate_q[point.front]

    def recorded(interface, g_q, q, goal):
        moved.append((q, goal - g_q[q]))
        return run_to(interface, g_q, q, goal)

    run_to = iga.path.step.run_to
    with monkeypatch.context() as patch:
        patch.setattr(iga.path.step, "run_to", recorded)
        return predicted(knowing(system, known), point, replace(step, away=away)), moved


@pytest.mark.parametrize("part", [0.05, 0.09, 0.11, 0.9])
def test_gaps_travel_where_the_front_leaps_by_a_tenth_of_the_opening_that_breaks_it(asked, part, monkeypatch):
    system, point = asked[:2]
    found, moved = foreseen(asked, part, monkeypatch)
    leap = [(point.front, pytest.approx(part * system.interface.law.g_u))]
    assert moved == (leap if part > 0.1 else []) and found.state.u_d.shape == point.state.u_d.shape


def test_without_a_known_tangent_a_step_sets_out_along_the_last_one(asked):
    system, point, step, _ = asked
    found, path = predicted(Solver(system), point, replace(step, by_kinks=True)), point.tangent
    assert np.array_equal(found.state.u_d, point.state.u_d + step.away * path.du_d)
    assert found.state.load == point.state.load + step.away * path.d_load
    assert not found.settled and found.spent == () and found.end is None


def made(asked, monkeypatch, **changed):
    """The step as the path makes it, with some of what it is made of changed."""
    system, point, step, known = asked
    with monkeypatch.context() as patch:
        for name, value in changed.items():
            patch.setattr(iga.path.step, name, value)
        return advance(knowing(system, known), point, step, 1.0)


@pytest.mark.parametrize("lost", ["equilibrium", "tangent"])
def test_a_step_without_equilibrium_or_tangent_is_none(asked, lost, monkeypatch):
    nothing = {lost: lambda *given, **more: None}
    if lost == "equilibrium":
        nothing["_at_kink"] = lambda *given: None
    assert made(asked, monkeypatch, **nothing) is None
    assert made(asked, monkeypatch) is not None


def test_what_stands_still_leads_nowhere(asked, monkeypatch):
    """A control that neither displacements nor the load change."""
    system, point, step, *rest = asked
    still = replace(step, control=lambda state, response: (0.0, np.zeros(system.n_dof), 0.0))
    assert advance(knowing(system, *rest), point, still, 1.0) is None


def test_what_slides_off_is_spent(asked, monkeypatch):
    _, point, *_ = asked
    plain = made(asked, monkeypatch)
    monkeypatch.setattr("iga.path.energy.unstored_work", lambda *given: (0.25, 0.0))
    slid = made(asked, monkeypatch)
    assert slid.state.lost == point.state.lost + 0.25 and plain.state.lost == point.state.lost
    assert slid.energies.dissipated == pytest.approx(plain.energies.dissipated + 0.25, rel=1e-12)
    assert slid.external_work == plain.external_work and slid.energies.stored == plain.energies.stored


@pytest.mark.parametrize(("gap", "lands"), [(0.9, False), (1.0, True), (1.1, True)])
def test_a_landing_short_of_its_kink_is_none(asked, gap, lands, monkeypatch):
    system, point, *_ = asked
    end = StepEnd(Kink(3, 1.0), 1.05)
    found = SimpleNamespace(response=SimpleNamespace(x_q=np.full(system.interface.points, gap)))
    monkeypatch.setattr(iga.path.step, "equilibrium", lambda *given: found)
    assert iga.path.step._at_kink(Solver(system), point, point.state, end) == (found if lands else None)
