"""Scenes for other codes: tables of the mesh, and what is refused or said."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from exported import DCB, PEEL, check_areas, exported

from verify.checks.mechanics.columns import law_of
from verify.cli import main
from verify.scene.load import load_scene
from verify.scene.materials import elastic_constants

Tables = tuple[dict[str, list[dict[str, str]]], dict]


def tables(folder: Path) -> Tables:
    """The CSV files as anybody would read them."""
    found = {}
    for name in ("nodes", "elements", "pairs", "sets"):
        with (folder / f"{name}.csv").open(newline="") as stream:
            found[name] = list(csv.DictReader(stream))
    return found, json.loads((folder / "scene.json").read_text())


def positions(found: dict) -> np.ndarray:
    return np.array([(float(row["x"]), float(row["y"])) for row in found["nodes"]])


def connectivity(found: dict) -> np.ndarray:
    names = [name for name in found["elements"][0] if name.startswith("n")]
    return np.array([[int(row[name]) for name in names] for row in found["elements"]]) - 1


def members(found: dict, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Nodes of a set, and their weights where they have any."""
    rows = [row for row in found["sets"] if row["set"] == name]
    return np.array([int(r["node"]) - 1 for r in rows]), np.array([float(r["weight"] or "nan") for r in rows])


@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize("scene", [DCB, PEEL])
def test_tables_hold_the_specimen(scene, degree, tmp_path):
    found, about = tables(exported(scene, "csv", tmp_path, "--set", f"dolfinx.degree={degree}", "--layers", "2"))
    X_nI, conn_ea, s = positions(found), connectivity(found), load_scene(scene).specimen
    names = list(about["bodies"])
    check_areas(scene, names, X_nI, conn_ea, [row["body"] for row in found["elements"]])
    assert conn_ea.shape[1] == 4 * degree and set(conn_ea.ravel()) == set(range(len(X_nI)))
    if degree == 2:  # middles where they belong
        ends = X_nI[conn_ea[:, :4]]
        assert np.allclose(X_nI[conn_ea[:, 4:]], (ends + np.roll(ends, -1, axis=1)) / 2, rtol=1e-13)

    upper, lower = (np.array([int(row[name]) - 1 for row in found["pairs"]]) for name in ("upper", "lower"))
    assert np.array_equal(X_nI[upper], X_nI[lower]) and np.all(X_nI[upper, 1] == 0) and not set(upper) & set(lower)
    ends = (0.0, s.bond_length) if scene == PEEL else (s.precrack, s.length)
    assert (X_nI[upper[0], 0], X_nI[upper[-1], 0]) == ends and np.all(np.diff(X_nI[upper, 0]) > 0)
    assert sum(float(row["length"]) for row in found["pairs"]) == pytest.approx(ends[1] - ends[0], rel=1e-12)
    for name, nodes in zip(names, (upper, lower), strict=True):
        assert np.array_equal(members(found, f"{name}_bond")[0], nodes)

    model = load_scene(scene)
    for name in names:
        moduli = elastic_constants(getattr(model, name, None) or model.material)
        assert {key: about["bodies"][name][key] for key in moduli} == pytest.approx(moduli)
    assert about["law"]["stiffness"] == pytest.approx(law_of(model).stiffness)
    for name, part in about["held"].items():
        assert np.array_equal(members(found, name)[0] + 1, part["nodes"])
        assert part["components"] == ["xy".index(axis) + 1 for axis in name.rpartition("_")[2]]

    loaded_at = s.strip_length if scene == PEEL else 0.0
    assert list(about["loaded"]) == ([f"{names[0]}_loaded"] if scene == PEEL else [f"{n}_loaded" for n in names])
    for name, face in about["loaded"].items():
        nodes, weights = members(found, name)
        assert np.all(X_nI[nodes, 0] == loaded_at) and len(nodes) == 2 * degree + 1
        assert weights.sum() == pytest.approx(1.0) and np.allclose(weights, face["weights"])
        middle = X_nI[nodes, 1].mean()
        assert weights @ X_nI[nodes, 1] == pytest.approx(middle) and np.sign(middle) == np.sign(
            face["part_of_the_opening"]
        )
    assert sum(abs(face["part_of_the_opening"]) for face in about["loaded"].values()) == 1.0
    if scene == PEEL:
        base, _ = members(found, "substrate_held_xy")
        on_base = np.flatnonzero(X_nI[:, 1] == X_nI[:, 1].min())
        assert set(base) == set(on_base)
    else:
        assert [X_nI[members(found, f"{n}_held_{c}")[0]].tolist() for n, c in (("upper", "x"), ("lower", "xy"))] == [
            [[s.length, 0.0]]
        ] * 2


REFUSED = {
    "--format nastran": '--format: must be "abaqus", "gmsh", "med", "exodus", "vtu", "moose" or "csv", got \'nastran\'',
    "--format csv --set dolfinx.degree=3": "must be 1 or 2 for export, got 3; --set dolfinx.degree=2 exports it",
    "--format csv --elements 1": "dolfinx.elements: must be an integer >= 2",
    "--format csv --layers 0": "argument --layers: must be an integer >= 1, got '0'",
    "--format csv --out {file}": "--out: must be a folder that can be written to",
}


@pytest.mark.parametrize("words", REFUSED)
def test_what_cannot_be_written_is_refused(words, tmp_path, capsys):
    (tmp_path / "file").write_text("")
    try:
        code = main(["export", DCB, *words.format(file=tmp_path / "file").split()])
    except SystemExit as end:
        code = end.code
    assert code == 2 and REFUSED[words] in capsys.readouterr().err


def test_the_scene_file_beside_an_export_keeps_the_mesh_of_the_reference(tmp_path):
    """DOLFINx, which judges the other code, does not take over the mesh that was made for it."""
    words = ["--set", "dolfinx.degree=1", "--layers", "2", "--set", "interface.strength=5"]
    exported(DCB, "csv", tmp_path, *words)
    assert load_scene(tmp_path / f"{DCB}.toml") == load_scene(DCB, ["interface.strength=5"])
    text = (tmp_path / "scene.json").read_text()
    assert json.loads(text)["mesh"]["degree"] == 1 and len(text.splitlines()) < 150, "lists are a line each"


def test_what_is_left_out_is_said(tmp_path, capsys):
    exported(DCB, "csv", tmp_path, "--set", "pose.angle=30")
    said = capsys.readouterr().out
    assert "the pose of the scene is left out" in said and "linear kinematics" in said
    assert "the pose of the scene is left out" in str(json.loads((tmp_path / "scene.json").read_text())["notes"])


def test_the_scene_that_is_exported_is_not_overwritten(tmp_path, capsys):
    assert main(["new", "--from", DCB]) == 0
    own = tmp_path / f"{load_scene(DCB).name}.toml"
    own.write_text(text := capsys.readouterr().out)
    assert main(["export", str(own), "--format", "csv", "--out", str(tmp_path)]) == 2
    assert own.read_text() == text and "must be another folder" in capsys.readouterr().err
