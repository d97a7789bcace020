"""Numbers in units that do not belong together are named before a run, and none that do."""

from pathlib import Path

import pytest

import verify.scene
from verify.cli import main
from verify.scene.bond.plausible import remarks
from verify.scene.load import load_scene

PACKAGED = sorted(file.stem for file in Path(verify.scene.__file__).with_name("scenes").glob("*.toml"))
AS_IN = "4enf", "dcb-as4peek", "mmb50-as4peek"
IN_GPA = ["material.E1=122.7", "material.E2=10.1", "material.G12=5.5"]
PER_M2 = ["interface.toughness=969", "interface.shear_toughness=1719"]


@pytest.mark.parametrize("name", [*PACKAGED, "random", "plain"])
def test_no_scene_that_is_right_has_a_remark(name):
    for one in [f"{name}-{seed}" for seed in range(40)] if name in ("random", "plain") else [name]:
        assert remarks(load_scene(one)) == (), one


@pytest.mark.parametrize(
    ("name", "overrides", "likely"),
    [
        ("dcb-czm1", ["material.young=120"], "material.young = 120000, if 120 is in GPa"),
        ("dcb-czm1", ["material.young=120e9"], "material.young = 120000, if 1.2e+11 is in Pa"),
        ("dcb-czm1", ["interface.toughness=100"], "interface.toughness = 0.1, if 100 is in J/m2"),
        ("dcb-czm1", ["interface.strength=0.004"], "interface.strength = 4, if 0.004 is in GPa"),
        ("alfano-crisfield-weak", ["interface.strength=1.7e6"], "interface.strength = 1.7, if 1.7e+06 is in Pa"),
        *[(name, PER_M2, "interface.toughness = 0.969, if 969 is in J/m2") for name in AS_IN],
        *[(name, IN_GPA, "material.E1 = 122700, if 122.7 is in GPa") for name in AS_IN],
    ],
)  # fmt: skip
def test_the_unit_is_named(name, overrides, likely):
    (said,) = remarks(load_scene(name, overrides))
    assert said.endswith(f"; they do with {likely}")


def test_it_is_said_before_anything_is_run(tmp_path, capsys):
    """And no solver is blamed for it."""
    fast = ["--set", "discretization.dofs=200", "--set", "discretization.steps=10"]
    main(["solve", "dcb-czm1", "--set", "material.young=120", *fast, "--out", str(tmp_path / "run")])
    said = capsys.readouterr().err
    assert (
        said.startswith("debond: modulus, strength and toughness seem to be in different units") and "fault" not in said
    )
