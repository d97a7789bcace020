"""A linear bulk condensed onto the interface, against the same system in all its unknowns."""

from dataclasses import replace

import numpy as np
import pytest
from specimens import PAPER

import iga.run
from iga.delamination import build, solve
from iga.path.condensation import condensed
from iga.path.follow import follow
from iga.path.point import End
from iga.path.solver import Solver
from tests.iga.test_peel import PEEL

BEAM = replace(PAPER, kinematics="linear", steps=40, dofs=600, opening=(1.5,))
STRIP = replace(PEEL, kinematics="linear", steps=40, dofs=900)

#: A quarter of a solid, whose front is curved.
SOLID = replace(
    BEAM, plane="solid", symmetry=True, width=3.0, opening=(2.5,), element=0.8, interface_points=4, elements_width=3
)

CASES = {
    "twins": BEAM,
    "mirror": replace(BEAM, symmetry=True),
    "Lagrange": replace(BEAM, basis="lagrange"),
    "T-spline": replace(BEAM, basis="tspline"),
    "lumped": replace(BEAM, interface_rule="lumped"),
    "unlike": replace(BEAM, mismatch=1.37),
    "lower slave": replace(BEAM, mismatch=1.37, slave="lower"),
    "posed": replace(BEAM, angle=37.0, mirror=True, shift=(1e3, -2e3)),
    "solid": SOLID,
    "peel": STRIP,
    "peel unlike": replace(STRIP, mismatch=1.37),
}


@pytest.mark.parametrize("name", CASES)
def test_the_condensed_path_is_that_of_the_whole(name, monkeypatch):
    """All that a run tells, at all its steps, to a part of 1e-7 of the largest value of its kind."""
    problem = CASES[name]
    small = solve(problem)
    monkeypatch.setattr(iga.run, "condensed", lambda system: None)
    whole = solve(problem)
    assert small.status == whole.status == "complete" and len(small.rows) == len(whole.rows)
    for key in small.rows[0]:
        if key == "newton_iterations":
            continue
        a, b = (np.array([row[key] for row in run.rows]) for run in (small, whole))
        scale = np.abs(b).max() + np.abs([row["load"] for row in whole.rows]).max()
        assert np.abs(a - b).max() < 1e-7 * scale, key


def test_a_bulk_that_moves_far_or_has_too_many_partners_is_not_condensed():
    assert condensed(build(replace(BEAM, kinematics="finite")).system) is None
    assert condensed(build(replace(BEAM, dofs=40_000)).system) is None


def test_a_step_to_a_kink_takes_one_look_at_the_forces():
    """With a linear bulk the law is settled on the way to where a step is to end: nothing is left to Newton."""
    problem = replace(BEAM, symmetry=True, steps=None, interface_points=4)
    points = [*follow(Solver(condensed(build(problem).system).system), problem.opening, None, tolerance=0.05)]
    looks = [point.iterations for point in points[1:] if not isinstance(point, End)]
    assert len(looks) > 5 and max(looks) == 1, looks


@pytest.mark.parametrize("name", ["mirror", "solid"])
def test_a_translation_asks_for_no_force(name):
    """Of what is kept of it, but for rounding of the stiffness: more would be lost of the balance of forces."""
    K_dd = condensed(build(CASES[name]).system).system.bulk.K_dd
    up_d = np.append(np.ones(len(K_dd) - 1), 2.0)  # the arm moves across, and its mirror image the other way
    assert np.array_equal(K_dd, K_dd.T) and np.abs(K_dd @ up_d).max() < 1e-12 * np.abs(K_dd).max()
