"""Numbers and words of the page: what is read is the number, in as many digits as were asked for."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

pytest.importorskip("markupsafe")

from verify.command_line.scenes.listing import page  # noqa: E402
from verify.pages.text import (
    NO_VALUE,
    Units,
    axis,
    inputs,
    modelled,
    number,
    percent,
    power_of_ten,
    quantity,
    seconds,
    sentence,
    span,
    symbols,
)
from verify.scene.load import load_scene  # noqa: E402

DIGITS = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻−", "0123456789--")
SIZES = st.floats(1e-30, 1e30) | st.floats(1e-5, 1e7)


def read(text: str) -> float:
    """The number that a reader takes from a text."""
    plain = text.replace("\u00a0", " ").replace("\u202f", "").translate(DIGITS)
    mantissa, _, power = plain.partition(" × 10")
    return float(mantissa) * 10.0 ** int(power or 0)


@given(SIZES, st.integers(2, 6), st.booleans(), st.booleans())
def test_a_number_reads_as_what_it_is(size, digits, negative, pad):
    """To half a unit of its last digit; with all digits before the point."""
    value = -size if negative else size
    text = number(value, digits, pad)
    unit = 10.0 ** (math.floor(math.log10(size)) - digits + 1)
    unit = min(unit, 1.0) if 1e-4 <= size < 1e6 else unit
    assert abs(read(text) - value) <= 0.5 * unit * (1.0 + 1e-9)
    assert ("×" in text) == (math.floor(math.log10(size)) not in range(-4, 6)) and (
        "−" in text.split("×")[0]
    ) == negative
    assert "-" not in text, "minus signs are those of print"
    assert pad or "." not in text.split("\u00a0")[0] or not text.split("\u00a0")[0].endswith(("0", "."))


def test_numbers_that_are_none_and_long_ones():
    assert [number(v) for v in (None, math.nan, math.inf, -math.inf, 0.0)] == [NO_VALUE, NO_VALUE, "∞", "−∞", "0"]
    assert [number(v, 6) for v in (1234.0, 12345.0, -123456.0)] == ["1234", "12\u202f345", "−123\u202f456"]
    assert (
        number(1.2e-9, 2) == "1.2\u00a0×\u00a010⁻⁹" and number(1e6) == "1\u00a0×\u00a010⁶" and number(1e-4) == "0.0001"
    )
    assert number(0.5, 3, pad=True) == "0.500" and number(0.5, 3) == "0.5"


def test_parts_in_per_cent():
    assert [percent(v).replace("\u00a0", " ") for v in (0.0012, 0.5, -0.031, 0.0, 4.9e-6, -4.9e-6, 5.1e-6)] == [
        "0.12 %", "50 %", "−3.1 %", "0 %", "< 0.0005 %", "< 0.0005 %", "0.00051 %"
    ]  # fmt: skip
    assert percent(None) == percent(math.nan) == NO_VALUE


def test_durations_have_two_digits_or_minutes():
    told = [seconds(v).replace("\u00a0", " ") for v in (0.0, 0.0949, 0.095, 0.31, 8.94, 99.4, 99.5, 125.0, 3601.4)]
    assert told == ["< 0.1 s", "< 0.1 s", "0.095 s", "0.31 s", "8.9 s", "99 s", "1 min 40 s", "2 min 5 s", "60 min 1 s"]
    assert seconds(None) == seconds(math.nan) == NO_VALUE and seconds(math.nan, "–") == "–"


def test_labels_have_units_where_there_are_any():
    assert (axis("load", "N"), axis("load", "")) == ("load (N)", "load")
    assert quantity(14.0, "mm") == "14\u00a0mm" and quantity(14.0, "") == "14"
    mm, none = Units.of(" N, mm ,MPa"), Units.of("whatever")
    assert (mm.force, mm.length, mm.stress) == ("N", "mm", "MPa")
    assert (mm.energy, mm.stiffness, mm.toughness) == ("N mm", "MPa/mm", "N/mm")
    assert none == Units() and (none.energy, none.stiffness, none.toughness) == ("", "", "")
    assert [power_of_ten(v) for v in (1e-4, 1.0, 1e12, 0.0, -1.0)] == ["10⁻⁴", "10⁰", "10¹²", "", ""]
    assert span([3.0, 1.0, 2.0], str) == "1.0 to 3.0" and span([1.01, 1.04], lambda v: f"{v:.1f}") == "1.0"
    assert symbols("p_max < 3, a_max") == "<i>p</i><sub>max</sub> &lt; 3, a_max"


@pytest.mark.parametrize(
    ("name", "overrides", "words"),
    [
        ("dcb-czm1", (), "finite kinematics (large rotations), irreversible damage, contact on closing, points look"),
        ("dcb-czm1", ("effects.contact=false",), "irreversible damage, no contact, "),
        ("dcb-czm1", ("effects.irreversible=false",), "reversible damage (nothing is dissipated), "),
        ("dcb-czm1", ("effects.search=false",), "points keep their places on the other face, both arms modelled."),
        ("dcb-czm1", ("effects.symmetry=true",), "one arm against the symmetry plane."),
        ("dcb-czm1", ("effects.kinematics=linear",), "linear kinematics (small displacements), "),
        ("dcb-czm1", ("effects.contact=auto",), ", chosen automatically"),
        ("peel-60", (), "both bodies modelled."),
        ("dcb-czm1", ("load.opening=[1.0, 0.5, 2.0]",), "is opened to 1 → 0.5 → 2 mm, in plane "),
    ],
)
def test_a_sentence_says_every_effect_and_the_way(name, overrides, words):
    text = sentence(load_scene(name, overrides)).replace("\u00a0", " ")
    assert words in text and (", chosen automatically" in text) == ("chosen" in words)


def test_what_a_method_models_in_short():
    plain = load_scene("dcb-czm1")
    bare = load_scene("dcb-czm1", ["effects.contact=false", "effects.irreversible=false", "effects.symmetry=true"])
    assert modelled(plain, "nurbs") == "finite kinematics, irreversible damage, contact, both arms"
    assert modelled(bare, "nurbs") == "finite kinematics, reversible damage, no contact, one arm"
    assert modelled(plain, "lefm") == "finite kinematics, one arm"


def of_inputs(*keys: str, name: str = "dcb-czm1") -> dict[str, str]:
    return {name: value.replace("\u00a0", " ") for _, name, value in inputs(load_scene(name, keys))}


def test_inputs_are_those_of_the_scene_and_what_follows_from_them():
    """g_u = 2 G_Ic / p_max and g_max = g_u / ductility."""
    rows = of_inputs("interface.strength=5.0", "interface.ductility=8.0")
    assert rows["full opening g_u = 2 G_Ic / p_max"] == "0.04 mm" and rows["opening at peak g_max"] == "0.005 mm"
    assert rows["ductility 2 G_Ic / (p_max g_max)"] == "8" and rows["strength p_max"] == "5 MPa"
    assert (rows["length"], rows["Young's modulus"], rows["interface points"]) == (
        "14 mm", "120\u202f000 MPa", "2 per element",
    )  # fmt: skip
    assert not {"shear strength t_max", "criterion", "plateau", "table"} & set(rows)
    sliding = of_inputs(name="dcb-as4peek")
    assert (sliding["shear strength t_max"], sliding["shear toughness G_IIc"]) == ("100 MPa", "1.719 N/mm")
    assert (sliding["criterion"], sliding["exponent"], sliding["onset"]) == ("bk", "2.284", "turon")
    assert of_inputs("discretization.interface_rule=lumped")["interface points"] == "at control points"


@pytest.mark.parametrize(
    ("keys", "row", "words"),
    [
        (["interface.plateau=0.3"], ("plateau", "0.3"), "plateau 0.3"),
        (
            ["interface={law='tabular', table=[[0.001, 4.0], [0.02, 1.0], [0.08, 0.0]]}"],
            ("table", "0.001, 4; 0.02, 1; 0.08, 0"),
            "corners (0.001, 4), (0.02, 1), (0.08, 0)",
        ),
    ],
)
def test_the_numbers_of_a_law_define_it(keys, row, words):
    rows = of_inputs("interface.law=trapezoidal", *keys)
    assert rows[row[0]] == row[1] and "full opening g_u = 2 G_Ic / p_max" not in rows
    assert words in " ".join(page(load_scene("dcb-czm1", ["interface.law=trapezoidal", *keys]), 200).split())
