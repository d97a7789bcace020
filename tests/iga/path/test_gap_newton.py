"""Newton on the gaps alone: what it says of a step against the forces themselves."""

from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from specimens import PAPER

from iga.algebra.factors import Bordered, Inverse, bordered
from iga.dcb import build
from iga.interface.contact import Contact, Rows
from iga.path import gap_newton
from iga.path.control import Prescribed, gap_control, opening_control
from iga.path.follow import follow
from iga.path.gap_newton import GAP_NEWTON
from iga.path.newton import correction, residual_norm
from iga.path.point import Point
from iga.path.solver import Solver
from iga.system.system import System, factorise, respond, untimed

CZM1 = replace(PAPER, opening=(1.5,), dofs=700)


@cache
def walked(**effects) -> tuple[System, list[Point]]:
    """A system and its path."""
    system = build(replace(CZM1, **effects)).system
    return system, [point for point in follow(Solver(system), (1.5,), 60) if isinstance(point, Point)]


def leap(system, point: Point, control, by: float):
    """State and response where a step that changes the control ``by`` so much leads; whether the law is settled."""
    old = point.state
    response = respond(system, old, decide=False)
    solver, (value, _, _) = Solver(system), control(old, response)
    solver.factorise(response)
    found = correction(solver, old, response, Prescribed(control, value + by, by), on_gaps=True)
    moved = old.moved(found[0])
    return moved, respond(system, moved), found[1]


@pytest.mark.parametrize("contact", [True, False])
@pytest.mark.parametrize("at", [0.0, 0.2, 0.6, 0.9])
def test_a_linear_bulk_is_in_equilibrium_after_one_step(at, contact):
    """Whatever breaks, begins to soften or closes on the way: nothing else is nonlinear."""
    system, points = walked(kinematics="linear", contact=contact)
    start = points[int(at * (len(points) - 1))]
    before = start.response.dp_q
    moved, response, settled = leap(system, start, opening_control(system), 0.3)
    changed = int(np.count_nonzero(np.abs(response.dp_q - before) > 1e-9 * np.abs(before).max()))
    assert settled and changed > 2, f"only {changed} points changed their branch"
    assert residual_norm(system, moved.load, response) < 1e-8
    assert float(system.load_d @ (moved.u_d - start.state.u_d)) == pytest.approx(0.3, rel=1e-9)


@pytest.mark.parametrize("search", [True, False])
def test_of_a_finite_bulk_only_its_own_curvature_is_left(search):
    """Twice the step leaves four times the residual, though twice as many points change their branch."""
    system, points = walked(search=search)
    left = []
    for by in (0.01, 0.02, 0.04):
        moved, response, settled = leap(system, points[40], opening_control(system), by)
        assert settled
        left.append(residual_norm(system, moved.load, response))
    order = np.diff(np.log2(left))
    assert np.all(np.abs(order - 2.0) < 0.2), order


def test_a_leap_of_the_front_breaks_points_in_order():
    system, points = walked(kinematics="linear", contact=True)
    start = points[40]
    g_q, law = start.response.contact.g_q, system.interface.law
    q = int(np.argmax(np.where(g_q < law.g_u, g_q, -np.inf)))
    moved, response, settled = leap(system, start, gap_control(system, q), 2.0 * law.g_u)
    assert settled and np.count_nonzero((response.contact.g_q > law.g_u) & (g_q < law.g_u)) > 3
    assert response.contact.g_q[q] == pytest.approx(g_q[q] + 2.0 * law.g_u, rel=1e-9)
    assert residual_norm(system, moved.load, response) < 1e-8


def test_too_many_points_are_left_to_a_new_tangent(monkeypatch):
    system, points = walked(kinematics="linear", contact=True)
    monkeypatch.setattr(gap_newton, "GAP_NEWTON", gap_newton.GapLimits(loads=2))
    moved, response, settled = leap(system, points[40], opening_control(system), 0.3)
    assert not settled and residual_norm(system, moved.load, response) > 1e-6, "the plain step is no equilibrium"


def unit_springs(n_dof: int) -> Bordered:
    """Unknowns on springs of stiffness 1 each, under a load that does not change."""
    return Bordered(Inverse(SimpleNamespace(solve=lambda b_dm: b_dm), np.zeros(n_dof)), np.zeros(n_dof), 1.0)


def step_of_a_point(law, plain: float, guess: float | None = None, n_dof: int = 1) -> float | None:
    """How far one point on a spring of stiffness 1 goes, the first of some unknowns: ``g = plain - w(g)``."""
    rows = Rows(np.array([[0]]), np.ones((1, 1)))
    touch = Contact(None, np.zeros(1), np.array([[0.0, 1.0]]), np.ones(1), rows)
    spring = unit_springs(n_dof)
    flat, guess_q = (np.zeros(1), np.zeros(1)), None if guess is None else np.array([guess])
    linear_d = np.append(plain, np.zeros(n_dof))
    found = gap_newton.settled_step(touch, np.ones(1), flat, law, linear_d, spring, guess_q)
    return None if found is None else float(found[0])


@pytest.mark.parametrize(("softening", "gap"), [(-1.0, None), (-0.5, 2.0)])
def test_a_point_as_soft_as_the_specimen_is_stiff_has_no_gap(softening, gap):
    def law(g_q):
        return softening * g_q, np.full(1, softening)

    found = step_of_a_point(law, 1.0)
    assert found is None if gap is None else found == pytest.approx(gap)


def test_a_search_that_goes_round_in_circles_is_thrown_off(monkeypatch):
    """Beyond 1 the law takes two thirds of every step away: from 2 Newton goes to -2, and from there to 2."""

    def law(g_q):
        beyond = np.abs(g_q) > 1.0
        return np.where(beyond, 2.0 / 3.0 * (np.sign(g_q) - g_q), 0.0), np.where(beyond, -2.0 / 3.0, 0.0)

    assert step_of_a_point(law, 0.0, 2.0) == pytest.approx(0.0, abs=1e-12)
    monkeypatch.setattr(gap_newton, "GAP_NEWTON", gap_newton.GapLimits(damped=GAP_NEWTON.corrections + 1))
    assert step_of_a_point(law, 0.0, 2.0) is None


@pytest.mark.parametrize("chosen", ["opening", "load and opening"])
def test_a_bordered_step_meets_both_equations(chosen, rng):
    system = build(CZM1).system
    response = respond(system, system.start(), decide=False)
    known, a_load = factorise(system, response, system.pattern(response), untimed), 0.0 if chosen == "opening" else 3.0
    tied = bordered(known, system.load_d, a_load)
    b_dm = rng.standard_normal((system.n_dof, 2))
    step_dm = tied.solve(b_dm, 0.7)
    again = known.solve(b_dm + np.outer(system.load_d, step_dm[-1]))
    assert np.allclose(step_dm[:-1], again, rtol=0, atol=1e-9 * np.abs(again).max())
    assert system.load_d @ step_dm[:-1] + a_load * step_dm[-1] == pytest.approx([0.7, 0.7])
    assert bordered(known, np.zeros(system.n_dof), 0.0) is None, "nothing feels the load"


def test_more_points_than_unknowns_that_they_touch_are_told_by_these(rng):
    rows_dm = np.zeros((300, 40))
    rows_dm[50:62] = rng.standard_normal((12, 40))
    vectors_dr, parts_rm = gap_newton.spanned(rows_dm)
    assert vectors_dr.shape[1] == 12 and np.count_nonzero(vectors_dr) == 12
    assert np.array_equal(vectors_dr @ parts_rm, rows_dm)


def test_points_of_one_element_span_no_more_than_its_functions(rng):
    functions_rd, parts_mr = rng.standard_normal((5, 300)), rng.standard_normal((40, 5))
    rows_dm = (parts_mr @ functions_rd).T
    vectors_dr, parts_rm = gap_newton.spanned(rows_dm)
    assert vectors_dr.shape[1] == 5
    assert np.allclose(vectors_dr @ parts_rm, rows_dm, rtol=0, atol=1e-12 * np.abs(rows_dm).max())
    few = gap_newton.spanned(rows_dm[:, :3])
    assert np.array_equal(few[0] @ few[1], rows_dm[:, :3])


@pytest.mark.parametrize(("off", "agrees"), [(0.9e-12, True), (1.1e-12, False), (-1.1e-12, False)])
def test_tractions_agree_with_the_law_to_a_part_of_the_largest(off, agrees):
    """Of a traction of 5, all of which the tangent knows but for what it is off by."""
    rows = Rows(np.array([[0]]), np.ones((1, 1)))
    touch = Contact(None, np.zeros(1), np.array([[0.0, 1.0]]), np.ones(1), rows)
    spring, plain_d, known = unit_springs(1), np.array([1.0, 0.0]), (np.full(1, 5.0), np.zeros(1))

    def law(g_q):
        return np.full(1, 5.0 * (1.0 + off)), np.zeros(1)

    found = gap_newton.settled_step(touch, np.ones(1), known, law, plain_d, spring)
    assert (found[0] == 1.0) == agrees and found[0] == pytest.approx(1.0, abs=1e-11)
