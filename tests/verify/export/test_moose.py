"""The input of MOOSE: what it says of a scene, and the mesh beside it, which has the format that MOOSE reads."""

import re

import meshio
import netCDF4
import numpy as np
import pytest

from verify.cli import main
from verify.scene.load import load_scene
from verify.scene.materials import plane_compliance


def blocks(text):
    """Name -> keys of the innermost blocks, the first of each name."""
    found = re.findall(r"\[(\w+)\]\n((?:\s+\w+ = .*\n)+)\s*\[\]", text)
    return {name: dict(re.findall(r"(\w+) = (.*)", keys)) for name, keys in reversed(found)}


def exported(tmp_path, scene, *words):
    assert main(["export", scene, "--format", "moose", "--out", str(tmp_path), *words]) == 0
    return (tmp_path / f"{scene}.i").read_text(), tmp_path / f"{scene}.e"


@pytest.mark.parametrize("plane", ["stress", "strain"])
def test_the_stiffness_of_the_plane_is_that_of_the_scene(tmp_path, plane):
    text, _ = exported(tmp_path, "enf-as4peek", "--set", f"specimen.plane={plane}")
    c = [float(word) for word in blocks(text)["upper"]["C_ijkl"].strip("'").split()]
    told = np.array([[c[0], c[1], 0.0], [c[1], c[3], 0.0], [0.0, 0.0, c[8]]])
    material = load_scene("enf-as4peek").materials[0]
    assert told @ plane_compliance(material, plane) == pytest.approx(np.eye(3), abs=1e-9)


def test_a_load_on_rollers_moves_one_node_against_its_share(tmp_path):
    text, mesh = exported(tmp_path, "enf-as4peek")
    found, sets = blocks(text), meshio.read(mesh).point_sets
    assert found["upper_load_1"]["scale_factor"] == "-1.0" and found["load"]["scaling_factor"] == "-25.4"
    assert [len(sets[name]) for name in ("upper_load_1", "lower_support_1", "lower_support_2")] == [1, 1, 1]


def test_the_mesh_is_netcdf_3_with_numbers_of_32_bits(tmp_path):
    _, path = exported(tmp_path, "dcb-czm1-linear")
    with netCDF4.Dataset(path) as file:
        assert file.data_model == "NETCDF3_64BIT_OFFSET"
        assert {one.dtype.kind + str(one.dtype.itemsize) for one in file.variables.values()} <= {"i4", "f4", "f8", "S1"}
        assert file.variables["eb_prop1"][:].tolist() == [1, 2]
    read = meshio.read(path)
    assert sum(len(cells.data) for cells in read.cells) == 224


def test_a_lever_is_refused(tmp_path, capsys):
    assert main(["export", "mmb50-as4peek", "--format", "moose", "--out", str(tmp_path)]) == 2
    assert "must have one load for MOOSE" in capsys.readouterr().err
