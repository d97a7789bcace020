"""A law in the table is all that the solver needs: a specimen solved with laws that the solver has never seen."""

from dataclasses import replace

import numpy as np
import pytest
from made_up_laws import MADE_UP
from specimens import PAPER

from iga.dcb import build, solve
from iga.laws.laws import LAWS
from iga.path.kinks import Kink, nearest_end
from iga.system.system import respond


@pytest.fixture
def table(monkeypatch):
    """The table with the laws of the tests in it."""
    for name, law in MADE_UP.items():
        monkeypatch.setitem(LAWS, name, law)


@pytest.mark.parametrize(("name", "basis", "steps"), [("bridged", "nurbs", 80), ("a-parabola", "tspline", None)])
def test_energies_and_j_integral_hold_of_a_law_from_elsewhere(table, name, basis, steps):
    """Work is stored or dissipated; crack costs G_Ic for each new area of it, and J is G_Ic once the tip is open."""
    problem = replace(PAPER, law_name=name, basis=basis, dofs=1200, opening=(2.0,), steps=steps)
    solution = solve(problem)
    assert solution.status == "complete"
    rows = {key: np.array([row[key] for row in solution.rows]) for key in solution.rows[0]}
    gap = rows["external_work"] - rows["stored_energy"] - rows["dissipated_energy"]
    worst = np.max(np.abs(gap)) / rows["external_work"].max()
    grown = np.flatnonzero(rows["crack_length"] > problem.precrack)
    crack, lost = (rows[key][grown[-1]] - rows[key][grown[0]] for key in ("crack_length", "dissipated_energy"))
    J = rows["load"] * (rows["face_slope_bottom"] - rows["face_slope_top"]) - rows["face_energy"]
    off = np.max(np.abs(J[grown] / problem.toughness - 1.0))
    cost = lost / (problem.toughness * crack) - 1.0
    print(f"{name} {basis} {steps}: ledger {worst:.1e}, cost of crack {cost:.1e} over {crack:.2f}, J {off:.1e}")
    assert crack > 1.0 and worst < 1e-3 and abs(cost) < 0.02 and off < 0.005


def test_a_law_that_is_not_in_the_table_is_refused():
    with pytest.raises(ValueError, match="law_name: must be one of bilinear.*, got 'no-such-law'"):
        solve(replace(PAPER, law_name="no-such-law"))


@pytest.mark.parametrize("name", MADE_UP)
def test_a_step_ends_on_the_nearest_kink(table, name):
    system = build(replace(PAPER, law_name=name)).system
    law, start = system.interface.law, system.start()
    touch = respond(system, start, decide=False).contact
    for kink in (law.g_max, law.g_u):
        g_q = np.linspace(0.0, 1.001 * kink, system.interface.points)
        found = nearest_end(system, start.k_q, touch, g_q)
        assert found.on and found.kink == Kink(int(np.argmin(np.abs(g_q - kink))), kink)
