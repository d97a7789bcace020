"""Keys of shear: a remark where nothing slides, a refusal by methods whose bond opens alone, the law of the solvers."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from verify.cli import main
from verify.methods.mixed import sliding_law
from verify.methods.names import METHODS, Unsuitable
from verify.methods.sliding import NO_EFFECT, remarks
from verify.methods.solve import prepare, require, solve
from verify.scene.bond.mixed import mixed_bond
from verify.scene.effects import simulated
from verify.scene.load import load_scene

SHEAR = ("interface.shear_strength=5.0", "interface.shear_toughness=0.2")
COARSE = ("discretization.dofs=280", "discretization.steps=4", "load.opening=0.2")


@pytest.fixture
def opens_alone(monkeypatch: pytest.MonkeyPatch) -> str:
    """A method that solves the opening of a bond alone."""
    monkeypatch.setitem(METHODS, "lefm", replace(METHODS["lefm"], slides=False))
    return "lefm"


@pytest.mark.parametrize(
    ("name", "more"), [("enf-as4peek", ()), ("peel-60", SHEAR), ("dcb-czm1", (*SHEAR, "effects.shear=true"))]
)
def test_a_bond_that_slides_is_refused_by_who_has_its_opening_alone(
    name: str, more: tuple[str, ...], opens_alone: str
) -> None:
    scene = load_scene(name, more)
    with pytest.raises(Unsuitable) as caught:
        require(prepare(scene, opens_alone))
    told = f"must be left out for {opens_alone}, which solves no {scene.specimen.kind} whose bond slides; "
    assert str(caught.value).startswith(f"interface.shear_strength, shear_toughness: {told}")


def test_the_command_line_refuses_it_with_two(tmp_path: Path, capsys: pytest.CaptureFixture, opens_alone: str) -> None:
    sets = [word for key in (*SHEAR, "effects.shear=true") for word in ("--set", key)]
    assert main(["solve", "dcb-czm1", "--method", opens_alone, *sets, "--out", str(tmp_path / "run")]) == 2
    said = f"interface.shear_strength, shear_toughness: must be left out for {opens_alone}"
    assert said in capsys.readouterr().err and not (tmp_path / "run").exists()


def test_two_equal_arms_open_as_without_shear_keys(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
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
def test_the_law_of_the_solver_is_that_of_the_scene(more: tuple[str, ...]) -> None:
    scene = load_scene("mmb50-as4peek", more)
    bond, law = mixed_bond(scene), sliding_law(scene, simulated(scene))
    assert bond is not None and law is not None
    assert (law.friction, law.contact, law.irreversible) == (bond.friction, bond.contact, bond.irreversible)
    g, s = np.array([2e-3]), np.array([-5e-3])
    found = law.traction(g, s, law.start(1))
    assert found.history.d == pytest.approx(bond.driving(g, s)) and 0.0 < found.history.d[0] < 1.0
