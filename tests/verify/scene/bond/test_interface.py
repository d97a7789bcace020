"""Keys of a bond: defaults, and which go together; others are in `refused.toml`."""

from __future__ import annotations

from math import e
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fem_reference.problem.mixed_laws import MODELLED_MIXED_LAWS
from iga.laws.laws import LAWS, ExponentialLaw, ShapedLaw
from iga.laws.mode_ratio import ModeRatio
from verify.checks.mechanics.columns import law_of
from verify.methods.bonds import modelled_law
from verify.scene.bond.bond import bond_of
from verify.scene.bond.interface import LEFT_OUT, Interface
from verify.scene.effects import simulated
from verify.scene.laws import known, mixed
from verify.scene.load import load_scene
from verify.scene.parse import parse_scene
from verify.scene.schema import Scene

OPENING = {"strength": 4.0, "toughness": 0.1}
SHEAR = {"shear_strength": 5.0, "shear_toughness": 0.2}
TABLE = [[0.001, 4.0], [0.02, 1.0], [0.08, 0.0]]  # of area 0.0795


@pytest.fixture(autouse=True)
def tabular(monkeypatch):
    """A solver with a law of that name, whose numbers are not asked for here."""
    monkeypatch.setitem(LAWS, "tabular", ShapedLaw)


def scene_with(table: dict[str, Any]) -> Scene:
    return parse_scene(load_scene("dcb-czm1").model_dump() | {"interface": table})


def bond(**table: Any) -> Interface:
    return scene_with(table).interface


def test_what_is_left_out_of_a_bond_that_slides():
    found = bond(**OPENING, **SHEAR)
    assert (found.criterion, found.exponent, found.onset) == ("bk", 2.0, "turon")
    assert (found.friction, found.viscosity, found.pressure_strength) == (0.0, 0.0, 0.0)
    assert found.slides and not bond(**OPENING).slides and bond(**OPENING).shear_stiffness is None
    assert bond(**OPENING, **SHEAR, criterion="power").onset == "quadratic"
    assert bond(**OPENING, **SHEAR, onset="quadratic").onset == "quadratic"


@given(*[st.floats(0.1, 10.0)] * 4, st.floats(1.5, 100.0))
def test_the_shear_stiffness_that_is_left_out_is_the_consistent_one(p, t, G_I, G_II, ductility):
    """2 G_c over lambda0^2 is then the ductility in both pure modes."""
    found = bond(strength=p, toughness=G_I, ductility=ductility, shear_strength=t, shear_toughness=G_II)
    expected = found.bond_stiffness * G_I / G_II * (t / p) ** 2
    assert found.shear_stiffness == pytest.approx(expected, rel=1e-14)
    assert 2.0 * G_II * found.shear_stiffness / t**2 == pytest.approx(ductility, rel=1e-12)


@given(st.floats(0.1, 10.0), st.floats(0.1, 10.0), st.floats(1.5, 100.0))
def test_a_stiffness_says_what_a_ductility_says(strength, toughness, ductility):
    by_ductility = bond(strength=strength, toughness=toughness, ductility=ductility)
    stiffness = by_ductility.bond_stiffness
    by_stiffness = bond(strength=strength, toughness=toughness, stiffness=stiffness)
    assert by_stiffness.bond_stiffness == stiffness and by_stiffness.penalty == 100.0 * stiffness
    assert by_stiffness.ductility == pytest.approx(ductility, rel=1e-14)
    assert by_ductility.penalty == 100 * strength / (2 * toughness / strength / ductility), "as it always was"


def test_the_exponential_law_has_its_own_stiffness():
    found = bond(law="exponential", **OPENING, **SHEAR, friction=0.3)
    assert (found.bond_stiffness, found.shear_stiffness) == pytest.approx(
        ExponentialLaw(ModeRatio((0.1, 0.2), (4.0, 5.0), (1e4, 1e4)), 1.0).stiffness, rel=1e-14
    )
    assert found.ductility == pytest.approx(2.0 * e**2, rel=1e-14)


def test_a_table_says_strength_toughness_and_stiffness():
    found = bond(law="tabular", table=TABLE)
    assert (found.strength, found.bond_stiffness) == (4.0, 4000.0)
    assert found.toughness == pytest.approx(0.5 * (4.0 * 0.001 + 5.0 * 0.019 + 1.0 * 0.06), rel=1e-14)
    assert found.penalty == pytest.approx(4e5) and found.table == tuple(map(tuple, TABLE))
    near = bond(law="tabular", table=TABLE, strength=4.0 * (1.0 + 9e-7), toughness=found.toughness * (1.0 - 9e-7))
    assert (near.strength, near.toughness) == (found.strength, found.toughness)


TAKEN = [
    OPENING,
    OPENING | {"stiffness": 1e4},
    OPENING | SHEAR,
    OPENING | SHEAR | {"criterion": "power", "exponent": 1.5, "friction": 0.2, "viscosity": 0.01},
    OPENING | SHEAR | {"stiffness": 1e4, "shear_stiffness": 1e4, "onset": "quadratic", "pressure_strength": 0.3},
    OPENING | SHEAR | {"law": "trapezoidal", "plateau": 0.2},
    OPENING | {"law": "exponential"},
    OPENING | SHEAR | {"law": "trilinear", "knee": 0.3, "knee_traction": 0.4},
    OPENING | SHEAR | {"law": "exponential-softening", "decay": 2.0},
    {"law": "tabular", "table": TABLE} | SHEAR,
    {"law": "tabular", "table": TABLE},
]


@pytest.mark.parametrize("table", TAKEN)
def test_a_bond_is_written_down_as_it_was_given(table):
    scene = scene_with(table)
    written = scene.model_dump()["interface"]
    assert parse_scene(scene.model_dump()) == scene and parse_scene(scene.model_dump(mode="json")).interface
    assert set(LEFT_OUT) & set(written) == set(LEFT_OUT) & set(table)
    assert ("ductility" in written) == ("stiffness" not in table and table.get("law") not in ("exponential", "tabular"))


def test_a_key_of_no_value_is_left_out():
    """As a program may give it; a file cannot."""
    scene = scene_with(OPENING | {"stiffness": None, "ductility": 1.5, "shear_strength": None})
    assert parse_scene(scene.model_dump()) == scene and "stiffness" not in scene.model_dump()["interface"]


def test_an_override_of_what_was_written_down_finds_its_defaults_again():
    """Studies change keys of scenes that were written down."""
    written = scene_with(OPENING | SHEAR).model_dump()
    found = parse_scene(written, ["interface.criterion=power", "interface.shear_strength=2.5"]).interface
    assert found.onset == "quadratic" and found.shear_stiffness == pytest.approx(781.25 / 4.0)


def test_laws_and_their_numbers_reach_solvers_and_checks():
    assert set(mixed()) == {*LAWS, *MODELLED_MIXED_LAWS} <= set(known()) >= {"exponential", "trapezoidal"}
    flat = scene_with(OPENING | {"law": "trapezoidal", "plateau": 0.2})
    corners = scene_with({"law": "tabular", "table": TABLE})
    assert law_of(flat).plateau == 0.2 and law_of(corners).table == corners.interface.table
    assert bond_of(flat, simulated(flat)).plateau == 0.2
    level, table = (modelled_law(bond_of(scene, simulated(scene))) for scene in (flat, corners))
    assert level.plateau == 0.2 and table.table == corners.interface.table
