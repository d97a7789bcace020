"""Bonds that slide, unloaded and loaded the other way: at zero all faces touch, and rates alone do not tell which stay
closed."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from bent_specimens import MODES, bond, flexure, mixed_bending

from iga.delamination.solution import solve
from iga.laws.laws import ExponentialLaw

EXPONENTIAL = ExponentialLaw(MODES, 1e5)


def _at(found: Any, opening: float) -> np.ndarray:
    """Loads where the programme comes to an opening."""
    return found.load[np.abs(found.opening - opening) < 1e-9]


def test_the_way_back_by_zero_ends_where_it_began():
    """Pulled up and loaded again: where it unloaded the load is the same, as nothing rubs."""
    found = solve(flexure(opening=(4.0, -1.0, 4.0), dofs=1600))
    first, second = _at(found, 4.0)
    assert found.status == "complete" and second == pytest.approx(first, rel=1e-9)


REVERSED = {
    "small": flexure(opening=(2.0, -2.0)),
    "far": flexure(opening=(4.5, -4.5)),
    "exponential": flexure(opening=(3.5, -3.5), bond=EXPONENTIAL),
    "mixed bending": mixed_bending(opening=(6.0, -2.0)),
    "reversible": flexure(opening=(3.0, -1.0, 3.0), bond=bond(irreversible=False)),
    "rubs": flexure(opening=(3.5, 0.0, 4.5), bond=bond(friction=0.3), steps=60),
}


LONG = {"far", "exponential", "mixed bending"}


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow if name in LONG else ()) for name in REVERSED]
)
def test_a_reversal_is_completed(name):
    problem = REVERSED[name]
    found = solve(problem)
    assert found.status == "complete"
    assert found.opening[-1] == problem.opening[-1] and np.sign(found.load[-1]) == np.sign(problem.opening[-1])
    spent = found.steps["dissipated_energy"]
    assert np.diff(spent).min() >= -1e-6 * np.abs(found.steps["external_work"]).max(), "energy comes back"
