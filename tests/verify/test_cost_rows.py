"""Rows of a study of the cost: what cannot be measured, and what they say together."""

from __future__ import annotations

from dataclasses import replace
from math import isnan

import numpy as np
from test_cost import a_row, profile

from verify.cost.findings import cheapest
from verify.cost.row import traction_error


def test_of_a_theory_alone_nothing_is_called_the_cheapest() -> None:
    found = cheapest([a_row("beam", 1e-4, 0.1), a_row("nurbs", 0.02, 1.0)], "1%")
    assert found.best is None and found.ratio == {} and list(found.of_method) == ["beam"]
    assert found.summary() == {"method": None, "ratio": {}}


def test_without_a_zone_there_is_no_error_of_tractions() -> None:
    exact = (profile(0.0), profile(0.0))
    assert isnan(traction_error(exact, exact[:1])) and traction_error(exact, exact) == 0.0
    for damage in (np.zeros(exact[0].s_q.size), np.ones(exact[0].s_q.size)):
        without = (replace(exact[0], damage_q=damage), exact[1])
        assert isnan(traction_error(without, exact)) and isnan(traction_error(exact, without))
