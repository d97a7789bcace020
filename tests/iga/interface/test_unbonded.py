"""Points without cohesion: whatever the law, they only touch and rub."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from bent_specimens import bond, flexure, mixed_bending
from made_up_laws import both

from iga.delamination.solution import build, solve
from iga.laws.law import History


@pytest.mark.parametrize("irreversible", [True, False])
@pytest.mark.parametrize("history", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("left", [0.0, 0.1])
def test_neither_history_nor_what_a_law_keeps_gives_cohesion_to_what_is_not_bonded(
    irreversible, history, left, monkeypatch
):
    law, n = bond(irreversible=irreversible), 5
    monkeypatch.setattr(type(law), "kept", lambda _, d: (np.maximum(1.0 - d, left), -1.0))
    g, s = np.linspace(-1e-3, 1e-3, n), np.linspace(-2e-3, 2e-3, n)
    found = both(law, g, s, History(np.full(n, history)), bonded=np.zeros(n, dtype=bool))
    assert np.array_equal(found.p, np.where(g < 0.0, law.penalty * g, 0.0)) and not found.t.any()
    assert np.array_equal(found.dp_dg, np.where(g < 0.0, law.penalty, 0.0)) and not found.dt_ds.any()
    assert np.all(found.history.d == 1.0)


GROWING = {
    "flexure": flexure(opening=(3.6,), dofs=600),
    "mixed bending": mixed_bending(opening=(7.0,)),
    "shorter lever": mixed_bending(lever=30.0, opening=(6.0,)),
    "rubs": flexure(opening=(4.0,), bond=bond(friction=0.3), steps=60),
    "finite": flexure(opening=(3.6,), kinematics="finite", search=False),
}


LONG = {"mixed bending", "shorter lever", "rubs"}


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow if name in LONG else ()) for name in GROWING]
)
def test_a_bond_that_is_only_loaded_does_not_know_whether_it_heals(name):
    """The precrack slides freely under both; a glued one would raise the peak by a factor of 3."""
    problem = GROWING[name]
    one, other = (solve(replace(problem, bond=replace(problem.bond, irreversible=on))) for on in (True, False))
    assert one.status == other.status == "complete"
    assert other.load[-1] == pytest.approx(one.load[-1], rel=2e-3)
    assert np.max(other.load) == pytest.approx(np.max(one.load), rel=2e-3)
    rubbed = other.steps["friction_energy"]
    assert np.array_equal(other.steps["dissipated_energy"], rubbed), "only friction dissipates"


def test_faces_without_a_bond_are_in_every_bent_specimen():
    assert all(not build(problem).system.interface.all_bonded for problem in GROWING.values())
