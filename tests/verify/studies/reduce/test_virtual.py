"""Reductions of runs give back the toughness that went in where the process zone is short, not where it is long."""

import pytest

from verify.cli import main
from verify.methods.solve import solve
from verify.scene.load import load_scene
from verify.studies.reduce.bias import biases, of_run

LONG_DCB = ("specimen.precrack=50", "specimen.length=130", "load.opening=18.0", "interface.strength=300")
LONG_ENF = (
    "published=[]", "specimen.length=204", "specimen.precrack=78", "load.opening=20.0",
    "interface.shear_strength=150", "discretization.steps=60",
)  # fmt: skip
LONG_MMB = (
    "published=[]", "specimen.length=204", "specimen.precrack=68", "specimen.lever=88.8", "load.opening=44.0",
    "discretization.steps=60",
)  # fmt: skip


def off(name: str, overrides: tuple[str, ...] = ()) -> dict:
    """Scheme -> deviation of its propagation value from the toughness of the scene, solved by the cohesive beam."""
    scene = load_scene(name, overrides)
    found = of_run(scene, solve(scene, "beam"))
    assert found is not None
    return {one.scheme.name: one for one in biases(found, scene)}


@pytest.mark.slow
def test_dcb_with_a_short_zone():
    found = off("dcb-as4peek", LONG_DCB)
    assert set(found) == {"MBT", "CC", "MCC", "CBT", "CBBM", "J"}
    assert all(abs(one.propagation) < 0.02 and abs(one.five) < 0.02 for one in found.values()), found


@pytest.mark.slow
@pytest.mark.parametrize(("name", "overrides"), [("enf-as4peek", LONG_ENF), ("mmb50-as4peek", LONG_MMB)])
def test_enf_and_mmb_with_a_short_zone(name, overrides):
    found = off(name, overrides)
    assert set(found) >= {"CBBM", "J"} and len(found) >= 3
    assert all(abs(one.propagation) < 0.02 for one in found.values()), found


def test_dcb_with_a_long_zone():
    """Of the scene of the paper the zone is a quarter of the precrack: what fits the compliance to crack lengths
    holds on growth, what takes a modulus fails, and so do all initiation values."""
    found = off("dcb-czm1")
    for name in ("MBT", "CC", "MCC", "J"):
        assert abs(found[name].propagation) < 0.02
    assert -0.30 < found["CBT"].propagation < -0.20 and 0.08 < found["CBBM"].propagation < 0.15
    assert all(one.nonlinear < -0.8 and one.five < -0.6 for one in found.values())


def test_the_folder_of_a_run(tmp_path, capsys):
    """Its scene is known, and so is its toughness; a scene beside it and other columns make it a file."""
    run = str(tmp_path / "run")
    assert main(["solve", "dcb-as4peek", "--method", "beam", "--out", run]) == 0
    capsys.readouterr()
    assert main(["reduce", run]) == 0
    said = capsys.readouterr().out
    assert "against input" in said and "needs rotations" not in said
    table = {line.split()[0]: line for line in said.splitlines() if line}
    assert abs(float(table["MBT"].split()[-2])) < 0.02 and float(table["CBT"].split()[-2]) < -1.0
    assert main(["reduce", run, "--opening", "opening"]) == 0
    assert "J: needs rotations" in capsys.readouterr().out


def test_no_reduction_of_what_has_none():
    """Programmes that turn, and specimens without a formula."""
    for name, overrides in (("dcb-czm1", ("load.opening=[1.0, 0.2, 1.5]", "discretization.steps=30")), ("moments", ())):
        scene = load_scene(name, overrides)
        short = solve(load_scene("dcb-czm1", ("discretization.steps=20", "load.opening=0.5")), "lefm")
        assert of_run(scene, short) is None
