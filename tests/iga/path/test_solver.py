"""The solver of a path: the factors of one tangent at a time."""

import weakref
from dataclasses import replace

import pytest
from specimens import PAPER

import iga.path.solver
from iga.dcb import build
from iga.path.follow import follow
from iga.path.solver import Solver


@pytest.mark.parametrize("steps", [20, None])
@pytest.mark.parametrize("kinematics", ["linear", "finite"])
def test_factors_are_gone_before_others_are_made(kinematics, steps, monkeypatch):
    """They are the largest object of a run: whoever holds on to them makes it need twice the memory."""
    made, factorise = [], iga.path.solver.factorise

    def recorded(*given):
        assert all(inverse() is None for inverse in made), "factors are held where others are made"
        inverse = factorise(*given)
        made.append(weakref.ref(inverse))
        return inverse

    monkeypatch.setattr(iga.path.solver, "factorise", recorded)
    system = build(replace(PAPER, opening=(0.8, 0.2, 1.0), kinematics=kinematics)).system
    *_, end = follow(Solver(system), (0.8, 0.2, 1.0), steps)
    assert end.status == "complete" and len(made) > 30
