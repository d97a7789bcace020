"""Scenes with a mesh of the user, exported: cohesive elements between its arms, and its own numbers."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import meshio
import numpy as np
import pytest
from meshes_made import arms, breaks

from verify.cli import main
from verify.export.command import ENDINGS
from verify.meshes.read import read_mesh
from verify.methods.solve import solve
from verify.scene.load import load_scene

NAMES = {"quad": "CPE4", "quad8": "CPS8R", "triangle": "CPS3", "triangle6": "CPE6"}
SHORT = ["load.opening=0.8", "discretization.steps=40"]
DCB = "dcb-czm1-linear"


def deck(kind: str, path: Path, shared: bool) -> dict[int, np.ndarray]:
    """A deck whose numbers have gaps and fall, the lower arm first; with nodes of the bond that both arms share, or
    not. Returns the position of each node."""
    mesh = arms(kind, breaks(40, 8))
    X_nI, number_n = mesh.points[:, :2], 90_000 - 7 * np.arange(len(mesh.points))
    upper, lower = (block.data for block in mesh.cells[:2])
    if shared:
        at = {tuple(np.round(X_nI[n], 9)): number_n[n] for n in np.unique(lower)}
        for n in np.unique(upper):
            if X_nI[n, 1] == 0.0 and X_nI[n, 0] >= 4.0:
                number_n[n] = at[tuple(np.round(X_nI[n], 9))]
    place = dict(zip(number_n.tolist(), X_nI, strict=True))
    lines = ["*NODE", *(f"{n}, {float(x)!r}, {float(y)!r}" for n, (x, y) in place.items())]
    for first, conn in ((501, lower), (5, upper)):
        lines.append(f"*ELEMENT, TYPE={NAMES[kind]}, ELSET=from{first}")
        lines += [f"{first + 3 * e}, {', '.join(map(str, row))}" for e, row in enumerate(number_n[conn].tolist())]
    path.write_text("\n".join(lines) + "\n")
    return place


def exported(tmp_path: Path, kind: str, mesh: str, *words: str) -> Path:
    words = ("--set", f"specimen.mesh={json.dumps(mesh)}", "--out", str(tmp_path / kind), *words)
    assert main(["export", DCB, "--format", kind, *words]) == 0
    return tmp_path / kind / f"{DCB}.{ENDINGS.get(kind, '')}"


def oriented(X_eaI: np.ndarray) -> None:
    """Cells from the end of the precrack to that of the specimen: the lower side along X, the upper one back."""
    X_eaI = X_eaI[np.argsort(X_eaI[:, 0, 0])]
    assert np.all(X_eaI[..., 1] == 0.0) and np.array_equal(X_eaI[:, [0, 1]], X_eaI[:, [3, 2]])
    assert np.all(X_eaI[:, 1, 0] > X_eaI[:, 0, 0]) and np.array_equal(X_eaI[1:, 0], X_eaI[:-1, 1])
    assert (X_eaI[0, 0, 0], X_eaI[-1, 1, 0]) == (4.0, 14.0)


@pytest.mark.parametrize(("kind", "shared"), zip(NAMES, (False, True, True, False), strict=True))
def test_a_deck_keeps_its_numbers_and_its_curve(kind, shared, tmp_path):
    place = deck(kind, tmp_path / "arms.inp", shared)
    file = exported(tmp_path, "abaqus", str(tmp_path / "arms.inp"))
    blocks = [block.split("\n") for block in file.read_text().split("\n*")]
    nodes = next(block for block in blocks if block[0].startswith("NODE, NSET"))[1:]
    X = {int(n): (float(x), float(y)) for n, x, y in (row.split(",") for row in nodes)}
    assert all(np.allclose(X[n], x_I) for n, x_I in place.items()) and min(set(X) - set(place)) > max(place)
    conn = {
        block[0]: np.array([row.split(",") for row in block[1:]], dtype=int)
        for block in blocks
        if block[0].startswith("ELEMENT, TYPE=C")
    }
    given, found = read_mesh(tmp_path / "arms.inp"), read_mesh(file)
    (*solids, bond) = conn.values()
    rows = np.concatenate(solids)
    assert set(rows[:, 0]) == set(given.number_e.tolist()) and bond[:, 0].min() > rows[:, 0].max()
    own = dict(zip(given.number_e.tolist(), given.X_nI[next(iter(given.conn_kea.values()))], strict=True))
    assert all(np.allclose([X[n] for n in row[1:]], own[row[0]]) for row in rows.tolist()), (
        "elements are where they were"
    )
    oriented(np.array([[X[n] for n in row] for row in bond[:, 1:].tolist()]))
    assert len(bond) == 40 * (2 if kind in ("quad8", "triangle6") else 1)
    below, above = (
        set(np.concatenate([part[:, 1:].ravel() for name, part in conn.items() if f"={body}" in name]))
        for body in ("lower", "upper")
    )
    assert set(bond[:, 1:3].ravel()) <= below and set(bond[:, 3:].ravel()) <= above and not below & above

    before, after = (
        solve(load_scene(DCB, [f"specimen.mesh='{path}'", *SHORT]), "lagrange")
        for path in (tmp_path / "arms.inp", file)
    )
    assert len(found.number_n) >= len(given.number_n)
    assert np.abs(np.interp(before.opening, after.opening, after.load) - before.load).max() < 1e-6 * before.load.max()


def cells(file: Path) -> np.ndarray:
    """Corners (n, 4, 2) of the cells without thickness of a file, by meshio."""
    mesh = meshio.read(file)
    X_eaI = mesh.points[np.concatenate([block.data for block in mesh.cells if block.type == "quad"]), :2]
    return X_eaI[np.all(X_eaI[..., 1] == 0.0, axis=1)]


@pytest.mark.parametrize("kind", ["quad", "triangle6", "quad9"])
def test_every_format_has_cohesive_elements_and_is_read_again(kind, tmp_path):
    from meshes_made import write

    source = write(arms(kind, breaks(20, 4)), tmp_path / "arms.msh")
    own = solve(
        load_scene(DCB, [f"specimen.mesh='{source}'", "load.opening=0.1", "discretization.steps=4"]), "lagrange"
    )
    for name in ("gmsh", "exodus", "vtu", *["med"] * (kind != "quad9")):
        file = exported(tmp_path, name, source)
        found = cells(file)
        oriented(found)
        assert len(found) == (20 if kind == "quad" else 40)
        read, given = read_mesh(file), read_mesh(Path(source))
        assert np.array_equal(read.X_nI, given.X_nI) and [*read.conn_kea] == [*given.conn_kea]
        assert all(np.array_equal(conn, given.conn_kea[size]) for size, conn in read.conn_kea.items())
        again = solve(
            load_scene(DCB, [f"specimen.mesh='{file}'", "load.opening=0.1", "discretization.steps=4"]), "lagrange"
        )
        assert again.load == pytest.approx(own.load, rel=1e-6)
    exported(tmp_path, "csv", source)
    with (tmp_path / "csv" / "pairs.csv").open() as stream:
        pairs = list(csv.DictReader(stream))
    assert len(pairs) == (21 if kind == "quad" else 41)
    assert np.sum([float(row["length"]) for row in pairs]) == pytest.approx(10.0)


def test_what_an_export_does_not_take_is_refused(tmp_path, capsys):
    from meshes_made import write

    source = write(arms("quad9", breaks(20, 4)), tmp_path / "arms.msh")
    words = ["export", DCB, "--set", f"specimen.mesh='{source}'", "--out", str(tmp_path / "out")]
    assert main([*words, "--format", "abaqus"]) == 2
    assert (
        'must be "gmsh", "exodus", "vtu", "moose" or "csv" for a mesh with elements of 9 nodes'
        in capsys.readouterr().err
    )
    assert main([*words, "--format", "gmsh", "--elements", "20"]) == 2
    assert "must be left out with the mesh of a file" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
