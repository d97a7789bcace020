"""Corners of a tabular law: their area by another route."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from verify.scene.bond.interface import numbers_of, stiffness_of


@st.composite
def tables(draw: st.DrawFn) -> list[tuple[float, float]]:
    """Secants that fall to zero at rising openings."""
    n = draw(st.integers(1, 6))
    steps = draw(st.lists(st.floats(0.01, 2.0), min_size=n + 1, max_size=n + 1))
    falls = draw(st.lists(st.floats(0.1, 0.99), min_size=n, max_size=n))
    openings, secants = np.cumsum(steps), np.append(1e3 * np.cumprod(falls), 0.0)
    return list(zip(openings.tolist(), (openings * secants).tolist(), strict=True))


@given(tables())
def test_numbers_of_a_table_are_those_of_its_lines(table):
    """The area is that of a polygon, by the products of its corners."""
    g_n, p_n = np.array([(0.0, 0.0), *table]).T
    area = 0.5 * (g_n[1:] @ p_n[:-1] - g_n[:-1] @ p_n[1:])
    found = numbers_of([list(corner) for corner in table])
    assert found == {"strength": p_n.max(), "toughness": pytest.approx(area, rel=1e-12)}
    assert stiffness_of(table) == p_n[1] / g_n[1]
    assert 2.0 * stiffness_of(table) * area > found["strength"] ** 2, "its ductility is above 1"


@pytest.mark.parametrize(
    "value", [None, 3, "ab", [[1]], [["a", "b"]], [[10**400, 1.0]], {"a": 1}, [[1.0, float("nan")]]]
)
def test_numbers_of_what_is_no_table_are_ones(value):
    assert numbers_of(value) == {"strength": 1.0, "toughness": 1.0}
