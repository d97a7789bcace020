"""Scenes for other codes: every format is read back, and the written mesh alone gives the stiffness of the specimen."""

from __future__ import annotations

import csv
import json
import re
from pathlib import Path

import numpy as np
import pytest
from scipy.sparse import bmat, coo_matrix, csr_matrix
from scipy.sparse.linalg import spsolve
from vtu_files import arrays

from verify.cli import main
from verify.export.mesh import scene_mesh
from verify.methods import solve
from verify.scene import load_scene

DCB, PEEL = "dcb-czm1-linear", "peel-60"
Tables = tuple[dict[str, list[dict[str, str]]], dict]


def exported(scene: str, kind: str, folder: Path, *words: str) -> Path:
    assert main(["export", scene, "--format", kind, "--elements", "24", "--out", str(folder), *words]) == 0
    return folder


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


def area(X_vI: np.ndarray) -> float:
    """Of a polygon, by Gauss; positive counter-clockwise."""
    (x, y), (x_next, y_next) = X_vI.T, np.roll(X_vI, -1, axis=0).T
    return 0.5 * float(np.sum(x * y_next - x_next * y))


def check_areas(scene: str, names: list[str], X_nI: np.ndarray, conn_ea: np.ndarray, body_e: list[str]) -> None:
    """Elements counter-clockwise, and as large together as the bodies."""
    s = load_scene(scene).specimen
    strips = ((s.strip_length, s.strip_thickness), (s.substrate_length, s.substrate_thickness)) if scene == PEEL else ()
    areas = np.array([area(X_nI[nodes[:4]]) for nodes in conn_ea])
    assert np.all(areas > 0)
    for name, (length, thickness) in zip(names, strips or ((s.length, s.arm_thickness),) * 2, strict=True):
        assert np.sum(areas[np.array(body_e) == name]) == pytest.approx(length * thickness, rel=1e-12)


@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize("scene", [DCB, PEEL])
def test_tables_hold_the_specimen(scene: str, degree: int, tmp_path: Path) -> None:
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
def test_the_written_mesh_is_as_stiff_as_the_specimen(scene: str, degree: int, layers: str, tmp_path: Path) -> None:
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


def abaqus_blocks(text: str) -> list[tuple[str, dict[str, str], list[list[str]]]]:
    """Keyword, parameters and data lines of an input file."""
    blocks: list[tuple[str, dict[str, str], list[list[str]]]] = []
    for line in text.splitlines():
        if line.startswith("**"):
            continue
        cells = [cell.strip() for cell in line.split(",")]
        if line.startswith("*"):
            blocks.append((cells[0], dict(cell.partition("=")[::2] for cell in cells[1:]), []))
        else:
            blocks[-1][2].append([cell for cell in cells if cell])
    return blocks


@pytest.mark.parametrize(("degree", "plane", "solid"), [(1, "strain", "CPE4I"), (2, "stress", "CPS8")])
@pytest.mark.parametrize("scene", [DCB, PEEL])
def test_abaqus_holds_mesh_law_and_steps(scene: str, degree: int, plane: str, solid: str, tmp_path: Path) -> None:
    words = [
        "--set",
        f"dolfinx.degree={degree}",
        "--set",
        f"specimen.plane={plane}",
        "--set",
        "load.opening=[2.0, 0.5]",
    ]
    model = load_scene(scene)
    text = (exported(scene, "abaqus", tmp_path, *words) / f"{scene}.inp").read_text()
    assert max(map(len, text.splitlines())) <= 256
    blocks = abaqus_blocks(text)
    nodes = [row for keyword, _, rows in blocks if keyword == "*NODE" for row in rows]
    X_nI = np.array([[float(x) for x in row[1:]] for row in nodes])
    assert [int(row[0]) for row in nodes] == list(range(1, len(nodes) + 1))
    elements = {known["ELSET"]: (known["TYPE"], rows) for keyword, known, rows in blocks if keyword == "*ELEMENT"}
    *bodies, bond = elements
    assert bond == "bond" and {elements[name][0] for name in bodies} == {solid} and elements[bond][0] == "COH2D4"
    conn_ea = np.array([[int(a) for a in row[1:]] for name in bodies for row in elements[name][1]]) - 1
    check_areas(scene, bodies, X_nI, conn_ea, [name for name in bodies for _ in elements[name][1]])
    cohesive = np.array([[int(a) for a in row[1:]] for row in elements[bond][1]]) - 1
    assert np.array_equal(X_nI[cohesive[:, 0]], X_nI[cohesive[:, 3]])  # of no thickness
    assert np.array_equal(X_nI[cohesive[:, 1]], X_nI[cohesive[:, 2]])
    assert np.all(X_nI[cohesive[:, 1], 0] > X_nI[cohesive[:, 0], 0]), "lower side first and along X: normal upwards"
    numbers = [int(row[0]) for _, rows in elements.values() for row in rows]
    assert numbers == list(range(1, len(numbers) + 1))

    law = model.interface
    of_bond = [
        block for block in blocks if block[0] in ("*DAMAGE INITIATION", "*DAMAGE EVOLUTION", "*COHESIVE SECTION")
    ]
    assert [block[1] for block in of_bond] == [
        {"ELSET": "bond", "MATERIAL": "bond", "RESPONSE": "TRACTION SEPARATION", "THICKNESS": "SPECIFIED"},
        {"CRITERION": "MAXS"},
        {"TYPE": "ENERGY", "SOFTENING": "LINEAR"},
    ]
    strength, toughness = float(of_bond[1][2][0][0]), float(of_bond[2][2][0][0])
    (traction,) = (
        rows[0] for keyword, known, rows in blocks if keyword == "*ELASTIC" and known.get("TYPE") == "TRACTION"
    )
    assert (strength, toughness) == (law.strength, law.toughness)
    assert strength / float(traction[0]) == pytest.approx(2 * toughness / strength / law.ductility)  # g_max

    sets = {
        known["NSET"]: {int(a) for row in rows for a in row} for keyword, known, rows in blocks if keyword == "*NSET"
    }
    equations = [rows for keyword, _, rows in blocks if keyword == "*EQUATION"]
    loaded = [name for name in sets if name.endswith("_loaded")]
    for name, (count, *terms) in zip(loaded, equations, strict=True):
        assert int(count[0]) == len(terms) and {int(a) for a, _, _ in terms[:-1]} == sets[name]
        assert sum(float(w) for _, _, w in terms) == pytest.approx(0.0, abs=1e-11) and float(terms[-1][2]) == -1.0
    steps = [known["NLGEOM"] for keyword, known, _ in blocks if keyword == "*STEP"]
    assert steps == ["YES" if scene == PEEL else "NO"] * 2
    moved = [float(row[3]) for keyword, _, rows in blocks if keyword == "*BOUNDARY" for row in rows if len(row) == 4]
    assert moved == ([2.0, 0.5] if scene == PEEL else [1.0, -1.0, 0.25, -0.25])


def test_abaqus_takes_fibres_along_the_specimen(tmp_path: Path) -> None:
    scene = tmp_path / "fibres.toml"
    scene.write_text(
        'specimen = {kind = "dcb", length = 10, arm_thickness = 0.2, precrack = 3, plane = "strain"}\n'
        "material = {E1 = 130e3, E2 = 9e3, G12 = 5e3, nu12 = 0.3}\n"
        "interface = {strength = 4, toughness = 0.1}\nload = {opening = 1}\n"
    )
    for plane, kind, row in (
        ("stress", "LAMINA", [130e3, 9e3, 0.3, 5e3, 5e3, 5e3]),
        ("strain", "ENGINEERING CONSTANTS", [130e3, 9e3, 9e3, 0.3, 0.3, 0.3, 5e3, 5e3, 5e3]),
    ):
        words = ["--set", f"specimen.plane={plane}"]
        assert main(["export", str(scene), "--format", "abaqus", "--out", str(tmp_path), *words]) == 0
        blocks = abaqus_blocks((tmp_path / "fibres.inp").read_text())
        found = [rows for keyword, known, rows in blocks if keyword == "*ELASTIC" and known.get("TYPE") == kind]
        assert [[float(cell) for line in rows for cell in line] for rows in found] == [row, row]


@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize("scene", [DCB, PEEL])
def test_a_vtu_file_holds_mesh_bond_and_sets(scene: str, degree: int, tmp_path: Path) -> None:
    words = ["--set", f"dolfinx.degree={degree}"]
    model = scene_mesh(load_scene(scene, ["dolfinx.elements=24", f"dolfinx.degree={degree}"]))
    found, _ = arrays(exported(scene, "vtu", tmp_path, *words) / f"{scene}.vtu")
    values = {name: column.ravel() for name, column in found.items() if name != "Points"}
    X_nI = found["Points"][:, :2]
    assert found["Points"].shape == (len(model.X_nI), 3) and np.all(found["Points"][:, 2] == 0.0)
    cells = np.split(values["connectivity"], values["offsets"][:-1])
    body, types = values["body"], values["types"]
    assert values["offsets"][-1] == len(values["connectivity"]) and len(cells) == len(body) == len(types)
    assert set(types[body < 2]) == {9 if degree == 1 else 23} and set(types[body == 2]) == {9}
    solid = np.array([nodes for nodes, b in zip(cells, body, strict=True) if b < 2])
    assert solid.shape[1] == 4 * degree
    check_areas(scene, list(model.names), X_nI, solid, [model.names[b] for b in body if b < 2])

    pair = values["pair"]
    bonded = np.flatnonzero(pair >= 0)
    assert np.array_equal(pair[pair[bonded]], bonded) and np.array_equal(X_nI[pair[bonded]], X_nI[bonded])
    assert len(bonded) == 2 * len(model.pair_kb) and not np.any(pair == np.arange(len(pair)))
    bond = np.array([nodes for nodes, b in zip(cells, body, strict=True) if b == 2])
    assert set(bond.ravel()) == set(bonded) and np.array_equal(pair[bond], bond[:, [3, 2, 1, 0]])
    s = load_scene(scene).specimen
    length = s.bond_length if scene == PEEL else s.length - s.precrack
    assert values["pair_length"].sum() == pytest.approx(2.0 * length) and np.all(values["pair_length"][pair < 0] == 0)
    assert np.array_equal(values["pair_length"][bonded], values["pair_length"][pair[bonded]])
    for face in model.loaded:
        assert values["load_weight"][face.node_n].sum() == pytest.approx(1.0)
    loaded = np.concatenate([face.node_n for face in model.loaded])
    assert set(np.flatnonzero(values["load_weight"])) == set(loaded)
    for name, nodes in model.sets.items():
        assert np.array_equal(np.flatnonzero(values[name] == 1), np.sort(nodes)) and set(values[name]) <= {0, 1}


@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize("scene", [DCB, PEEL])
def test_a_gmsh_file_names_bodies_and_sets(scene: str, degree: int, tmp_path: Path) -> None:
    """Read as the manual of format 2.2 says, by hand."""
    model = scene_mesh(load_scene(scene, ["dolfinx.elements=24", f"dolfinx.degree={degree}"]))
    file = exported(scene, "gmsh", tmp_path, "--set", f"dolfinx.degree={degree}") / f"{scene}.msh"
    parts = re.findall(r"^\$(\w+)\n(.*?)\n\$End\1$", file.read_text(), re.DOTALL | re.MULTILINE)
    block = {name: [line.split() for line in lines.split("\n")] for name, lines in parts}
    assert list(block) == ["MeshFormat", "PhysicalNames", "Nodes", "Elements"] and block["MeshFormat"] == [
        ["2.2", "0", "8"]
    ]
    for name in ("PhysicalNames", "Nodes", "Elements"):
        assert int(block[name][0][0]) == len(block[name]) - 1
        if name != "PhysicalNames":
            assert [int(row[0]) for row in block[name][1:]] == list(range(1, len(block[name])))
    X_nI = np.array([row[1:3] for row in block["Nodes"][1:]], dtype=float)
    names = {int(number): (int(dim), name.strip('"')) for dim, number, name in block["PhysicalNames"][1:]}
    assert {name for _, name in names.values()} == {*model.names, *model.sets}
    kinds = {2: {3: 4, 16: 8}, 1: {1: 2, 8: 3}, 0: {15: 1}}
    groups: dict[str, list[np.ndarray]] = {}
    for _, kind, tags, group, entity, *nodes in (map(int, row) for row in block["Elements"][1:]):
        dim, name = names[group]
        assert tags == 2 and entity == group and kinds[dim][kind] == len(nodes)
        groups.setdefault(name, []).append(np.array(nodes) - 1)
    for name, nodes in model.sets.items():
        assert set(np.concatenate(groups[name])) == set(nodes)
    solid = np.array([nodes for name in model.names for nodes in groups[name]])
    check_areas(scene, list(model.names), X_nI, solid, [name for name in model.names for _ in groups[name]])
    sides = np.array(groups[f"{model.names[0]}_bond"])
    assert np.all(X_nI[sides[:, 1], 0] > X_nI[sides[:, 0], 0]) and sides.shape[1] == degree + 1
    if degree == 2:
        assert np.allclose(X_nI[sides[:, 2]], X_nI[sides[:, :2]].mean(axis=1))


@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize("scene", [DCB, PEEL])
def test_meshio_reads_gmsh_and_vtu(scene: str, degree: int, tmp_path: Path) -> None:
    meshio = pytest.importorskip("meshio")
    words = ["--set", f"dolfinx.degree={degree}"]
    model = scene_mesh(load_scene(scene, ["dolfinx.elements=24", f"dolfinx.degree={degree}"]))
    quad, side = {1: ("quad", "line"), 2: ("quad8", "line3")}[degree]

    mesh = meshio.read(exported(scene, "gmsh", tmp_path, *words) / f"{scene}.msh")
    names = {number: name for name, (number, _) in mesh.field_data.items()}
    groups: dict[str, list[np.ndarray]] = {}
    for cells, tags in zip(mesh.cells, mesh.cell_data["gmsh:physical"], strict=True):
        for tag in np.unique(tags):
            assert cells.type in (quad, side, "vertex")
            groups.setdefault(names[tag], []).append(cells.data[tags == tag])
    assert set(groups) == {*model.names, *model.sets}
    for name, nodes in model.sets.items():
        assert set(np.concatenate([part.ravel() for part in groups[name]])) == set(nodes)
    conn_ea = np.concatenate([part for name in model.names for part in groups[name]])
    body_e = [name for name in model.names for part in groups[name] for _ in part]
    check_areas(scene, list(model.names), mesh.points[:, :2], conn_ea, body_e)
    if degree == 2:
        (bond,) = groups[f"{model.names[0]}_bond"]
        assert np.allclose(mesh.points[bond[:, 2]], mesh.points[bond[:, :2]].mean(axis=1))

    mesh = meshio.read(exported(scene, "vtu", tmp_path, *words) / f"{scene}.vtu")
    body = np.concatenate(mesh.cell_data["body"]).ravel()
    cells = [nodes for block in mesh.cells for nodes in block.data]
    solid = np.array([nodes for nodes, b in zip(cells, body, strict=True) if b < 2])
    of = [model.names[b] for b in body if b < 2]
    check_areas(scene, list(model.names), mesh.points[:, :2], solid, of)
    pair = mesh.point_data["pair"].ravel()
    bonded = np.flatnonzero(pair >= 0)
    assert np.array_equal(pair[pair[bonded]], bonded) and np.array_equal(mesh.points[pair[bonded]], mesh.points[bonded])
    assert len(bonded) == 2 * len(model.pair_kb) and not np.any(pair == np.arange(len(pair)))
    for name, nodes in model.sets.items():
        assert np.array_equal(np.flatnonzero(mesh.point_data[name].ravel()), np.sort(nodes))


def test_meshio_reads_the_solids_of_abaqus(tmp_path: Path) -> None:
    """By names of elements that it knows, of the same nodes; it knows neither plane strain nor cohesive elements."""
    meshio = pytest.importorskip("meshio")
    for degree, known in ((1, ("CPS4I", "CPS4")), (2, ("CPS8", "S8R"))):
        file = exported(DCB, "abaqus", tmp_path, "--set", f"dolfinx.degree={degree}") / f"{DCB}.inp"
        before, _, after = file.read_text().replace(*known).partition("*ELEMENT, TYPE=COH2D4")
        file.write_text(before + after[after.index("*NSET") : after.index("*ORIENTATION")])
        mesh = meshio.read(file)
        assert [block.type for block in mesh.cells] == ["quad" if degree == 1 else "quad8"] * 2
        assert set(mesh.point_sets) >= {"upper_loaded", "lower_bond"}


REFUSED = {
    "--format nastran": '--format: must be "abaqus", "gmsh", "vtu" or "csv", got \'nastran\'',
    "--format csv --set dolfinx.degree=3": "dolfinx.degree: must be 1 or 2 for export, got 3",
    "--format csv --elements 1": "dolfinx.elements: must be >= 2",
    "--format csv --layers 0": "argument --layers: must be an integer >= 1, got '0'",
    "--format csv --out {file}": "--out: must be a folder that can be written to",
}


@pytest.mark.parametrize("words", REFUSED)
def test_what_cannot_be_written_is_refused(words: str, tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    (tmp_path / "file").write_text("")
    try:
        code = main(["export", DCB, *words.format(file=tmp_path / "file").split()])
    except SystemExit as end:
        code = end.code
    assert code == 2 and REFUSED[words] in capsys.readouterr().err


def test_what_is_left_out_is_said(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    exported(DCB, "csv", tmp_path, "--set", "pose.angle=30")
    said = capsys.readouterr().out
    assert "the pose of the scene is left out" in said and "linear kinematics" in said
    assert "the pose of the scene is left out" in str(json.loads((tmp_path / "scene.json").read_text())["notes"])
