"""Corners of a tabular law: what is one, what is refused, area by another route."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from iga.laws.opening import LAWS, BilinearLaw
from verify.scene.bond.corners import CORNERS, numbers_of, stiffness_of, strength_of, toughness_of
from verify.scene.load import load_scene
from verify.scene.parse import SceneError, parse_scene

#: What no table is -> the sentence that must come.
BROKEN = [
    (3, f"table: must be {CORNERS}, got 3"),
    ("ab", f"table: must be {CORNERS}, got 'ab'"),
    ([[0.1, 0.0]], f"table: must be {CORNERS}, got [[0.1, 0.0]]"),
    ([[0.1, 1.0], [0.2]], "table[1]: must be a corner [opening, traction], got [0.2]"),
    ([[0.1, 1.0], 5], "table[1]: must be a corner [opening, traction], got 5"),
    ([[0.1, "x"], [0.2, 0.0]], "table[0][1]: must be a number, got 'x'"),
    ([[0.0, 1.0], [0.2, 0.0]], "table[0][0]: must be > 0, got 0"),
    ([[0.1, 0.0], [0.2, 0.0]], "table[0][1]: must be > 0, up to the last corner, got 0"),
    ([[0.2, 1.0], [0.1, 0.0]], "table[1][0]: must be > 0.2, the opening before it, got 0.1"),
    ([[0.1, 1.0], [0.2, 0.5]], "table[1][1]: must be 0, at the end of the law, got 0.5"),
    (
        [[0.1, 1.0], [0.2, 2.0], [0.3, 0.0]],
        "table[1][1]: must be < 2, as traction over opening falls from corner to corner, got 2",
    ),
    (
        [[0.1, 1.0], [0.2, -0.1], [0.3, 0.0]],
        "table[1][1]: must be > 0, up to the last corner, got -0.1",
    ),
]


@pytest.fixture(autouse=True)
def tabular(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(LAWS, "tabular", BilinearLaw)


@pytest.mark.parametrize(("table", "told"), BROKEN, ids=[told.partition(":")[0] for _, told in BROKEN])
def test_what_is_no_table_is_refused_alone(table: object, told: str) -> None:
    """Nothing is said of the strength and the toughness that it would have had."""
    with pytest.raises(SceneError) as caught:
        parse_scene(load_scene("dcb-czm1").model_dump() | {"interface": {"law": "tabular", "table": table}})
    assert caught.value.sentences == (f"interface.{told}",)


@st.composite
def tables(draw: st.DrawFn) -> list[tuple[float, float]]:
    """Secants that fall to zero at rising openings."""
    n = draw(st.integers(1, 6))
    steps = draw(st.lists(st.floats(0.01, 2.0), min_size=n + 1, max_size=n + 1))
    falls = draw(st.lists(st.floats(0.1, 0.99), min_size=n, max_size=n))
    openings, secants = np.cumsum(steps), np.append(1e3 * np.cumprod(falls), 0.0)
    return list(zip(openings.tolist(), (openings * secants).tolist(), strict=True))


@given(tables())
def test_numbers_of_a_table_are_those_of_its_lines(table: list[tuple[float, float]]) -> None:
    """The area is that of a polygon, by the products of its corners."""
    g_n, p_n = np.array([(0.0, 0.0), *table]).T
    area = 0.5 * (g_n[1:] @ p_n[:-1] - g_n[:-1] @ p_n[1:])
    assert toughness_of(table) == pytest.approx(area, rel=1e-12)
    assert strength_of(table) == p_n.max() and stiffness_of(table) == p_n[1] / g_n[1]
    assert numbers_of([list(corner) for corner in table]) == {"strength": p_n.max(), "toughness": toughness_of(table)}
    assert 2.0 * stiffness_of(table) * toughness_of(table) > strength_of(table) ** 2, "its ductility is above 1"


@pytest.mark.parametrize(
    "value", [None, 3, "ab", [[1]], [["a", "b"]], [[10**400, 1.0]], {"a": 1}, [[1.0, float("nan")]]]
)
def test_numbers_of_what_is_no_table_are_ones(value: object) -> None:
    assert numbers_of(value) == {"strength": 1.0, "toughness": 1.0}
