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
        assert {*file.ncattrs()} >= {"title", "api_version", "version", "floating_point_word_size"}, "libMesh asks"
        assert {one.dtype.kind + str(one.dtype.itemsize) for one in file.variables.values()} <= {"i4", "f4", "f8", "S1"}
        assert file.variables["eb_prop1"][:].tolist() == [1, 2]
    read = meshio.read(path)
    assert sum(len(cells.data) for cells in read.cells) == 224


@pytest.mark.parametrize(
    ("scene", "words", "why"),
    [
        ("mmb50-as4peek", (), "must have one force for MOOSE"),
        ("moments", (), "must have one force for MOOSE"),
        ("slb", (), "must have no support on a face of the crack"),
        ("enf-as4peek", ("--set", "interface.friction=0.3"), "interface.friction: must be 0 for MOOSE, got 0.3"),
        ("enf-as4peek", ("--set", "interface.shear_stiffness=5e4"), "must be 100000 for MOOSE"),
    ],
)
def test_what_moose_has_not_is_refused(scene, words, why, tmp_path, capsys):
    assert main(["export", scene, "--format", "moose", "--out", str(tmp_path), *words]) == 2
    assert why in capsys.readouterr().err


def test_arms_that_could_slide_are_pulled_apart_by_the_opening(tmp_path):
    """Their loads are parts of the opening; the keys of sliding are those of the law alone."""
    text, _ = exported(tmp_path, "dcb-as4peek", "--set", "dolfinx.degree=2")
    found = blocks(text)
    assert (found["upper_loaded"]["scale_factor"], found["lower_loaded"]["scale_factor"]) == ("0.5", "-0.5")
    assert found["of_S"]["expression"] != found["of_N"]["expression"]


def test_nodes_of_supports_belong_to_one_body_after_the_split(tmp_path):
    _, path = exported(tmp_path, "enf-as4peek")
    read = meshio.read(path)
    y = read.points[[int(nodes[0]) for nodes in read.point_sets.values() if len(nodes) == 1], 1]
    assert (np.abs(y) > 0.0).all()
