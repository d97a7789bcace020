"""Keys of shear: a remark where nothing slides, and the laws of the solvers of any bond."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

from iga.laws.law import Law
from verify.checks.judgement import NO_DEMANDS, judged
from verify.cli import main
from verify.methods.bonds import NO_EFFECT, iga_law, modelled_law, remarks
from verify.methods.problems import known_law
from verify.methods.solve import solve
from verify.runs.verdict_file import content
from verify.scene.bond.bond import bond_of
from verify.scene.bond.mixed import mixed_bond
from verify.scene.effects import simulated
from verify.scene.load import load_scene
from verify.studies.one_scene import scene_report
from verify.theory.bond import Bond
from verify.theory.mixed_law import MixedBond

SHEAR = ("interface.shear_strength=5.0", "interface.shear_toughness=0.2")
COARSE = ("discretization.dofs=280", "discretization.steps=4", "load.opening=0.2")


def test_two_equal_arms_open_as_without_shear_keys(tmp_path, capsys):
    """To the last bit, and the user is told once."""
    plain, sheared = load_scene("dcb-czm1", COARSE), load_scene("dcb-czm1", (*COARSE, *SHEAR))
    assert remarks(plain) == () and remarks(sheared) == (NO_EFFECT,)
    assert solve(plain, "nurbs").load.tolist() == solve(sheared, "nurbs").load.tolist()
    sets = [word for key in (*COARSE, *SHEAR) for word in ("--set", key)]
    assert main(["solve", "dcb-czm1", "--method", "nurbs", *sets, "--out", str(tmp_path / "run")]) in (0, 1)
    assert capsys.readouterr().err.count(NO_EFFECT) == 1


@pytest.mark.parametrize(
    "more", [(), ("interface.friction=0.3", "effects.contact=true"), ("effects.irreversible=false",)]
)
def test_the_law_of_the_solver_is_that_of_the_scene(more):
    scene = load_scene("mmb50-as4peek", more)
    bond, law = mixed_bond(scene), iga_law(bond_of(scene, simulated(scene)))
    assert bond is not None and law.slides
    assert (law.friction, law.contact, law.irreversible) == (bond.friction, bond.contact, bond.irreversible)
    g, s = np.array([2e-3]), np.array([-5e-3])
    _, _, after = law.respond(np.stack([g, s], axis=1), law.start(1))
    assert after.d == pytest.approx(bond.driving(g, s)) and 0.0 < after.d[0] < 1.0


#: Every law in the modes that it has, and how damage answers.
BONDS = [
    *((law, False, f"effects.irreversible={on}") for law in ("bilinear", "trapezoidal") for on in ("true", "false")),
    *((law, True, f"effects.irreversible={on}") for law in ("bilinear", "trapezoidal") for on in ("true", "false")),
    *((law, slides, "") for law in ("trilinear", "exponential-softening") for slides in (True, False)),
]


@pytest.mark.parametrize(("law", "slides", "more"), BONDS)
def test_solvers_and_judge_have_one_law_of_one_bond(law, slides, more):
    """Tractions on loading to damage, unloading and pressing, of three laws that share nothing but their numbers."""
    own = {"trapezoidal": ["plateau=0.2"], "trilinear": ["knee=0.4", "knee_traction=0.6"], "bilinear": []}
    own_keys = [f"interface.{key}" for key in own.get(law, ["decay=2.0"])]
    keys = [*filter(None, (more,)), f"interface.law={law}", *own_keys]
    scene = load_scene("dcb-as4peek", keys)
    bond = bond_of(scene, {**simulated(scene), "shear": slides})
    assert bond.slides == slides == iga_law(bond).slides == modelled_law(bond).slides
    jumps = 2e-3 * np.array([[1.0, 0.5], [4.0, 2.0], [2.0, -1.0], [-0.01, 0.0]])[:, : 1 + slides]
    expected = _judged(bond, jumps)
    assert _by_iga(iga_law(bond), jumps) == pytest.approx(expected, rel=1e-9, abs=1e-9)
    assert _by_fem(modelled_law(bond), jumps) == pytest.approx(expected, rel=1e-9, abs=1e-9)


def _judged(bond: Bond, jumps: np.ndarray) -> np.ndarray:
    law = known_law(bond)
    if isinstance(law, MixedBond):
        found = law.path(*jumps.T)
        return np.stack([found.p, found.t], axis=1)
    k = np.maximum.accumulate(jumps[:, 0]) if law.irreversible else np.maximum(jumps[:, 0], 0.0)
    return law.traction(jumps[:, 0], k)[:, None]


def _by_iga(law: Law, jumps: np.ndarray) -> np.ndarray:
    rows, past = [], law.start(1)
    for jump in jumps:
        traction, _, past = law.respond(jump[None], past, 1.0, None, None)
        rows.append(traction[0])
    return np.array(rows)


def _by_fem(law: Any, jumps: np.ndarray) -> np.ndarray:
    rows, k, slip = [], np.zeros(1), np.zeros(1)
    for g, *s in jumps[:, :, None]:
        p, t, _, k, slip = law.traction(g, *(s or [np.zeros(1)]), k, slip)
        rows.append([p[0], t[0]][: 1 + law.slides])
    return np.array(rows)


#: A bond between opening and sliding as of a data sheet with one toughness, by specimen.
EXPONENTIAL = """
load.opening = {opening}
specimen = {{ kind = "{kind}", precrack = 35.0, arm_thickness = 1.5, width = 25.0, {more} }}
material = {{ E1 = 130e3, E2 = 9e3, G12 = 5e3, nu12 = 0.3, nu23 = 0.4 }}

[interface]
law = "exponential"
strength = 30.0
toughness = {first}
shear_strength = 50.0
shear_toughness = {second}
"""
KINDS = {
    "mmb": (3.0, "length = 100.0, lever = 40.0", 0.5, 0.5),
    "enf": (3.0, "length = 100.0", 0.3, 1.2),
    "slb": (3.0, "length = 120.0", 0.8, 0.6),
}


@pytest.mark.parametrize("kind", ["enf", *(pytest.param(kind, marks=pytest.mark.slow) for kind in ("mmb", "slb"))])
def test_where_a_law_does_not_keep_its_criterion_every_command_says_so_once(kind, tmp_path, capsys, monkeypatch):
    """`scenes`, `solve` and `law` print the sentence; `law` and `verify` keep it in their files."""
    monkeypatch.setattr("verify.studies.law.laws.PROBED", 2)
    opening, more, first, second = KINDS[kind]
    file = tmp_path / f"{kind}.toml"
    file.write_text(EXPONENTIAL.format(kind=kind, opening=opening, more=more, first=first, second=second))
    scene = load_scene(str(file))
    (told,) = remarks(scene)
    assert told.startswith("interface.law: the toughness of the exponential law is ")

    assert main(["scenes", str(file)]) == 0
    assert " ".join(capsys.readouterr().out.split()).count(told) == 1
    coarse = ("--set", "discretization.dofs=600", "--set", "discretization.steps=3", "--set", "load.opening=0.01")
    assert main(["solve", str(file), *coarse, "--out", str(tmp_path / "run")]) in (0, 1)
    assert capsys.readouterr().err.count(told) == 1
    assert main(["law", str(file), "--out", str(tmp_path / "law")]) == 0
    assert capsys.readouterr().err.count(told) == 1
    assert told in json.loads((tmp_path / "law" / "law.json").read_text())["remarks"]
    assert "the toughness of the exponential law is" in (tmp_path / "law" / "law.html").read_text()
    report = scene_report(scene, [], tmp_path)
    assert report.remarks.count(told) == 1
    assert told in content([report], judged([report], NO_DEMANDS))["remarks"][scene.name]


@pytest.mark.parametrize("name", ["mmb50-as4peek", "enf-as4peek", "slb", "dcb-czm1"])
def test_a_law_that_keeps_its_criterion_is_not_remarked(name):
    assert remarks(load_scene(name)) == ()
