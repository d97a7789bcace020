"""Keys of shear before any method solves a bond that slides: a remark where nothing slides, else a refusal."""

from __future__ import annotations

from pathlib import Path

import pytest

from verify.cli import main
from verify.methods.names import METHODS, Unsuitable
from verify.methods.sliding import NO_EFFECT, remarks
from verify.methods.solve import prepare, require, solve
from verify.scene.load import load_scene

SHEAR = ("interface.shear_strength=5.0", "interface.shear_toughness=0.2")
COARSE = ("discretization.dofs=280", "discretization.steps=4", "load.opening=0.2")


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(("key", "value"), [("friction", 0.3), ("viscosity", 0.01)])
def test_friction_and_viscosity_are_refused_by_every_method(method: str, key: str, value: float) -> None:
    with pytest.raises(Unsuitable) as caught:
        require(prepare(load_scene("dcb-czm1", [*SHEAR, f"interface.{key}={value}"]), method))
    assert str(caught.value) == f"interface.{key}: must be 0 for {method}, as no method has it, got {value:g}"


@pytest.mark.parametrize("method", METHODS)
def test_a_peel_that_slides_is_refused_by_every_method(method: str) -> None:
    with pytest.raises(Unsuitable) as caught:
        require(prepare(load_scene("peel-60", SHEAR), method))
    told = f"must be left out for {method}, as no method solves a peel whose bond slides, got 5 and 0.2"
    assert str(caught.value) == f"interface.shear_strength, shear_toughness: {told}"


def test_the_command_line_refuses_it_with_two(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    sets = [word for key in (*SHEAR, "interface.friction=0.3") for word in ("--set", key)]
    assert main(["solve", "dcb-czm1", "--method", "lefm", *sets, "--out", str(tmp_path / "run")]) == 2
    assert "interface.friction: must be 0 for lefm" in capsys.readouterr().err and not (tmp_path / "run").exists()


def test_two_equal_arms_open_as_without_shear_keys(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    """To the last bit, and the user is told once."""
    plain, sheared = load_scene("dcb-czm1", COARSE), load_scene("dcb-czm1", (*COARSE, *SHEAR))
    assert remarks(plain) == () and remarks(sheared) == (NO_EFFECT,)
    assert solve(plain, "nurbs").load.tolist() == solve(sheared, "nurbs").load.tolist()
    sets = [word for key in (*COARSE, *SHEAR) for word in ("--set", key)]
    assert main(["solve", "dcb-czm1", "--method", "nurbs", *sets, "--out", str(tmp_path / "run")]) in (0, 1)
    assert capsys.readouterr().err.count(NO_EFFECT) == 1
