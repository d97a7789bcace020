"""Scenes for other codes: the written mesh alone, read from tables, gives the stiffness of the specimen."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from exported import DCB, PEEL, check_areas, exported
from scipy.sparse import bmat, coo_matrix, csr_matrix
from scipy.sparse.linalg import spsolve

from verify.cli import main
from verify.methods.solve import solve
from verify.scene.load import load_scene

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


def stiffness_of(X_aI: np.ndarray, D: np.ndarray) -> np.ndarray:
    """Of an element with 4 or 8 nodes, by nine Gauss points."""
    corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    points, weights = np.polynomial.legendre.leggauss(3)
    K = np.zeros((2 * len(X_aI),) * 2)
    for i, s in enumerate(points):
        for j, t in enumerate(points):
            dN = np.array([[a * (1 + b * t), b * (1 + a * s)] for a, b in corners]) / 4
            if len(X_aI) == 8:
                ends = np.array(
                    [[a * (1 + b * t) * (2 * a * s + b * t), b * (1 + a * s) * (a * s + 2 * b * t)] for a, b in corners]
                )
                flat = [[-s * (1 + b * t), b * (1 - s * s) / 2] for b in (-1, 1)]
                steep = [[a * (1 - t * t) / 2, -t * (1 + a * s)] for a in (1, -1)]
                dN = np.array([*(ends / 4), flat[0], steep[0], flat[1], steep[1]])
            J = dN.T @ X_aI
            dX = np.linalg.solve(J, dN.T)
            B = np.zeros((3, 2 * len(X_aI)))
            B[0, ::2], B[1, 1::2], B[2, ::2], B[2, 1::2] = dX[0], dX[1], dX[1], dX[0]
            K += weights[i] * weights[j] * np.linalg.det(J) * B.T @ D @ B
    return K


def slope(found: dict, about: dict) -> float:
    """Load over opening of the intact specimen, from the files alone: plane stress, isotropic bodies."""
    X_nI, conn_ea = positions(found), connectivity(found)
    width, law, degree = about["specimen"]["width"], about["law"], about["mesh"]["degree"]
    assert about["specimen"]["plane"] == "stress"
    blocks = []
    for row, nodes in zip(found["elements"], conn_ea, strict=True):
        body = about["bodies"][row["body"]]
        E, nu = body["E1"], body["nu12"]
        D = E / (1 - nu**2) * np.array([[1, nu, 0], [nu, 1, 0], [0, 0, (1 - nu) / 2]])
        blocks.append((np.stack([2 * nodes, 2 * nodes + 1], 1).ravel(), width * stiffness_of(X_nI[nodes], D)))
    pairs = np.array([[int(row["lower"]), int(row["upper"])] for row in found["pairs"]]) - 1
    mass = {1: np.array([[2, 1], [1, 2]]) / 6, 2: np.array([[4, 2, -1], [2, 16, 2], [-1, 2, 4]]) / 30}[degree]
    for start in range(0, len(pairs) - 1, degree):
        side = pairs[start : start + degree + 1]
        K = width * law["stiffness"] * (X_nI[side[-1, 0], 0] - X_nI[side[0, 0], 0]) * mass
        blocks.append((2 * np.concatenate([side[:, 1], side[:, 0]]) + 1, np.block([[K, -K], [-K, K]])))
    n = 2 * len(X_nI)
    K = sum_of(blocks, n)
    rows, right = [], []
    for name, face in about["loaded"].items():
        nodes, weights = members(found, name)
        rows.append({2 * a + 1: w for a, w in zip(nodes, weights, strict=True)})
        right.append(face["part_of_the_opening"])
    for part in about["held"].values():
        rows += [{2 * (a - 1) + i - 1: 1.0} for a in part["nodes"] for i in part["components"]]
        right += [0.0] * (len(rows) - len(right))
    C = np.zeros((len(rows), n))
    for r, row in enumerate(rows):
        C[r, list(row)] = list(row.values())
    C = csr_matrix(C)
    whole = bmat([[K, C.T], [C, None]]).tocsc()
    found_u = spsolve(whole, np.concatenate([np.zeros(n), right]))
    return abs(float(found_u[n]))  # the multiplier of the first loaded face is its load


def sum_of(blocks: list, n: int) -> csr_matrix:
    rows, columns, values = zip(
        *((np.repeat(d, d.size), np.tile(d, d.size), K.ravel()) for d, K in blocks), strict=True
    )
    return coo_matrix((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), shape=(n, n)).tocsr()


@pytest.mark.parametrize(("degree", "layers"), [(2, "1"), (1, "4")])
@pytest.mark.parametrize("scene", [DCB, PEEL])
def test_the_written_mesh_is_as_stiff_as_the_specimen(scene, degree, layers, tmp_path):
    """A dozen lines of finite elements on the CSV files against debond's own slope at the start."""
    small = {DCB: "load.opening=0.02", PEEL: "load.opening=0.05"}[scene]
    elements = {1: 400, 2: 112}[degree]  # bilinear ones lock where they are longer than thick
    words = ["--set", f"dolfinx.degree={degree}", "--set", f"dolfinx.elements={elements}", "--layers", layers]
    assert main(["export", scene, "--format", "csv", "--out", str(tmp_path), *words]) == 0
    like = ["effects.kinematics=linear", "effects.contact=false", "discretization.steps=2", small]
    own = solve(load_scene(scene, like), "nurbs")
    assert own.complete and own.steps["dissipated_energy"][-1] == 0.0
    expected, got = own.load[-1] / own.opening[-1], slope(*tables(tmp_path))
    print(f"{scene}, degree {degree}: {got:.5g} against {expected:.5g}, {got / expected - 1:+.2%}")
    assert got == pytest.approx(expected, rel={1: 0.02, 2: 0.003}[degree])


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
