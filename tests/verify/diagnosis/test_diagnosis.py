"""Curves with one planted cause, drawn by NURBS on other meshes than those of the diagnosis."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from verify.curves.of_run import cubics
from verify.diagnosis.causes import SCALED_NUMBERS
from verify.diagnosis.classify import diagnose
from verify.diagnosis.causes import percent
from verify.methods.solve import solve
from verify.scene.load import load_scene
from verify.scene.parse import parse_scene

SCENE = "dcb-czm1-linear"
TOLERANCE = 0.005
MESH = ("discretization.dofs=1400", "discretization.steps=60", "interface.penalty=1e5")


@cache
def curve(*overrides: str) -> tuple[np.ndarray, np.ndarray]:
    d, P = cubics(solve(load_scene(SCENE, [*MESH, *overrides]), "nurbs"))
    return np.asarray(d), np.asarray(P)


def found(given):
    return diagnose("mine", given, curve(), load_scene(SCENE, ["interface.penalty=1e5"]), TOLERANCE)


def rows(n: int) -> tuple[np.ndarray, np.ndarray]:
    at = np.linspace(0.0, 3.0, n)
    return at, np.interp(at, *curve())


#: Name -> overrides of the scene of the curve, and the amount that the diagnosis must state.
IN_THE_SCENE = [
    ("modulus", "material.young=112e3", -0.0667),
    ("modulus", "material.young=140e3", 0.1667),
    ("thickness", "specimen.arm_thickness=0.19", -0.05),
    ("thickness", "specimen.arm_thickness=0.206", 0.03),
    ("precrack", "specimen.precrack=4.1", 0.025),
    ("precrack", "specimen.precrack=3.5", -0.125),
    ("toughness", "interface.toughness=0.09", -0.1),
    ("toughness", "interface.toughness=0.103", 0.03),
    ("strength", "interface.strength=3.2", -0.2),
    ("plane", "specimen.plane=strain", 1.0),
]
#: Name, curve, amount; the peak is at an opening of about 0.8.
IN_THE_CURVE = [
    ("toe", lambda d, P: (d + 0.03, P), 0.03),
    ("toe", lambda d, P: (np.append(0.0, d + 0.1), np.append(0.0, P)), 0.1),
    ("machine compliance", lambda d, P: (d + 0.1 * P, P), 0.1),
    ("width", lambda d, P: (d, 1.03 * P), 0.03),
    ("load x 2", lambda d, P: (d, 2.0 * P), 2.0),
    ("load x 0.001", lambda d, P: (d, 1e-3 * P), 1e-3),
    ("load x -1", lambda d, P: (d, -P), -1.0),
    ("opening x 0.5", lambda d, P: (0.5 * d, P), 0.5),
    ("opening x 0.001", lambda d, P: (1e-3 * d, P), 1e-3),
    ("width", lambda d, P: (d, 1.5 * P), 0.5),
    ("load factor", lambda d, P: (d, 50.0 * P), 50.0),
    ("load factor", lambda d, P: (d, 1e-6 * P), 1e-6),
    ("load x 0.2248", lambda d, P: (d, P / 4.448), 0.2248),
    ("load x 0.102", lambda d, P: (d, P / 9.81), 0.102),
    ("opening factor", lambda d, P: (1.05 * d, P), 0.05),
    ("opening factor", lambda d, P: (1.3 * d, P), 0.3),
    ("opening x 0.001, load x 0.001", lambda d, P: (1e-3 * d, 1e-3 * P), 1e-3),
    ("opening x 0.5, load x -1", lambda d, P: (0.5 * d, -P), -1.0),
    ("few steps", lambda d, P: rows(12), 12.0),
]


@pytest.mark.parametrize(("name", "override", "amount"), IN_THE_SCENE)
def test_a_cause_in_the_scene_is_named_with_its_amount(name, override, amount):
    """Modulus and thickness of slender arms do the same, E h^3; the sentence then names both."""
    said = found(curve(override))
    by_name = {one.name: one for one in said.causes}
    assert said.explained and name in (said.causes[0].name, *said.alike), said
    assert by_name[name].amount == pytest.approx(amount, rel=0.1, abs=0.002), said
    assert by_name[name].words in said.sentence


@pytest.mark.parametrize(("name", "change", "amount"), IN_THE_CURVE)
def test_a_cause_in_the_curve_is_named_with_its_amount(name, change, amount):
    said = found(change(*curve()))
    assert said.explained and said.causes[0].name == name and not said.alike, said
    assert said.causes[0].amount == pytest.approx(amount, rel=0.05), said


#: Arms so thick for their process zone that four elements in it leave 0.7 % of the curve.
SHORT_ZONE = {
    "name": "short-zone",
    "specimen": {"kind": "dcb", "length": 100.0, "arm_thickness": 2.0, "precrack": 30.0, "width": 20.0},
    "material": {"young": 70e3, "poisson": 0.3},
    "interface": {"strength": 6.0, "toughness": 0.5, "stiffness": 1e4},
    "load": {"opening": 4.0},
    "effects": {"kinematics": "linear"},
    "discretization": {"dofs": 1200},
}


def in_a_short_zone(*overrides: str):
    d, P = cubics(solve(parse_scene(SHORT_ZONE, overrides), "nurbs"))
    return np.asarray(d), np.asarray(P)


@pytest.mark.parametrize(
    ("name", "override", "amount"),
    [
        ("modulus", "material.young=67.9e3", -0.03),
        ("toughness", "interface.toughness=0.515", 0.03),
        ("precrack", "specimen.precrack=31.0", 0.0333),
        ("thickness", "specimen.arm_thickness=2.1", 0.05),
    ],
)
def test_the_mesh_is_fine_enough_for_a_short_process_zone(name, override, amount):
    said = diagnose("mine", in_a_short_zone(override), in_a_short_zone(), parse_scene(SHORT_ZONE, ()), TOLERANCE)
    assert said.explained and name in (said.causes[0].name, *said.alike), said
    assert {one.name: one.amount for one in said.causes}[name] == pytest.approx(amount, rel=0.1, abs=0.002), said


@pytest.mark.parametrize("ductility", [2.0, 25.0, 125.0])
def test_a_stiffness_is_found_though_it_is_ten_times_off(ductility):
    said = found(curve(f"interface.ductility={ductility}"))
    assert said.explained and said.causes[0].name == "initial stiffness of the bond", said
    assert 1.0 + said.causes[0].amount == pytest.approx(ductility / 12.5, rel=0.3), said


def test_a_shear_stiffness_that_follows_from_the_others_is_a_number_as_well():
    scene = load_scene("enf-as4peek")
    without = {key: value for key, value in scene.interface.model_dump().items() if key != "shear_stiffness"}
    left_out = parse_scene({**scene.model_dump(), "interface": without}, ())
    (number,) = (one for one in SCALED_NUMBERS if one.name == "initial shear stiffness of the bond")
    assert number.overrides(left_out, 2.0) == [f"interface.shear_stiffness={2.0 * left_out.interface.shear_stiffness}"]


def test_a_cause_that_leaves_more_than_there_was_is_not_named():
    d, P = curve()
    said = found((d, P + 0.3 * np.sin(40.0 * d) * P.max()))
    assert all(one.error_with < one.error_without for one in said.causes)
    assert "e+" not in said.sentence


def test_percents_are_whole_from_100_on():
    assert [percent(part) for part in (0.00123, 0.5, 0.998, 2.0, 9.876)] == [
        "0.12 %",
        "50 %",
        "100 %",
        "200 %",
        "988 %",
    ]


def test_a_right_curve_has_no_diagnosis():
    assert found(curve()) is None
    assert found(rows(200)) is None


def test_two_causes_are_not_explained_by_one():
    d, P = curve("interface.toughness=0.115")
    said = found((d + 0.06, P))
    assert not said.explained
    assert "no single cause explains" in said.sentence
