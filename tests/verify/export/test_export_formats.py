"""Scenes in the formats of Abaqus, VTK, Gmsh, MED and Exodus, read back: by hand where debond writes them itself."""

from __future__ import annotations

import json

import meshio
import numpy as np
import pytest
from exported import DCB, PEEL, check_areas, exported
from vtu_files import arrays

from verify.cli import main
from verify.export.groups import GROUP_FILES
from verify.export.mesh import scene_mesh
from verify.export.numbers import SLIDING_LAW
from verify.scene.load import load_scene


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


def test_abaqus_has_the_law_of_a_bond_that_slides(tmp_path):
    """Its own onset and criterion; a remark where those of the scene are others, or are left out."""
    words = ["--set", "dolfinx.degree=1"]
    for more, remarks in (("onset=turon", 1), ("onset=quadratic", 0), ("friction=0.3", 2), ("criterion=power", 0)):
        sets = ["--set", f"interface.{more}", *(["--set", "interface.onset=quadratic"] if "power" in more else [])]
        folder = exported("dcb-as4peek", "abaqus", tmp_path / more, *words, *sets)
        text = (folder / "dcb-as4peek.inp").read_text().partition("*MATERIAL, NAME=bond")[2].partition("*EQUATION")[0]
        assert sum(line.startswith("** ") for line in text.splitlines()) == remarks
        blocks = {keyword: (known, rows) for keyword, known, rows in abaqus_blocks(text.strip())}
        numbers = {keyword: [float(cell) for cell in rows[0]] for keyword, (_, rows) in blocks.items()}
        assert numbers == {
            "*ELASTIC": [1e5, 1e5, 1e5],
            "*DAMAGE INITIATION": [80.0, 100.0, 100.0],
            "*DAMAGE EVOLUTION": [0.969, 1.719, 1.719],
        }
        assert blocks["*DAMAGE INITIATION"][0] == {"CRITERION": "QUADS"}
        mixed = {"MIXED MODE BEHAVIOR": "POWER LAW" if "power" in more else "BK", "POWER": "2.284"}
        assert blocks["*DAMAGE EVOLUTION"][0] == {"TYPE": "ENERGY", "SOFTENING": "LINEAR", **mixed}
        law = json.loads((folder / "scene.json").read_text())["law"]
        assert (law["kind"], law["shear_toughness"], law["exponent"]) == (SLIDING_LAW, 1.719, 2.284)


@pytest.mark.parametrize(("degree", "plane", "solid"), [(1, "strain", "CPE4I"), (2, "stress", "CPS8")])
@pytest.mark.parametrize("scene", [DCB, PEEL])
def test_abaqus_holds_mesh_law_and_steps(scene, degree, plane, solid, tmp_path):
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
    opening, *sliding = map(float, traction)  # costs nothing, is no mechanism, and does no damage
    assert len(sliding) == 2 and all(1e-8 * opening <= K <= 1e-5 * opening for K in sliding)
    assert all(float(p) >= 1e5 * strength for p in of_bond[1][2][0][1:])

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


def test_abaqus_takes_fibres_along_the_specimen(tmp_path):
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
        assert main(["export", str(scene), "--format", "abaqus", "--out", str(tmp_path / "out"), *words]) == 0
        blocks = abaqus_blocks((tmp_path / "out" / "fibres.inp").read_text())
        found = [rows for keyword, known, rows in blocks if keyword == "*ELASTIC" and known.get("TYPE") == kind]
        assert [[float(cell) for line in rows for cell in line] for rows in found] == [row, row]


def written(scene, kind, degree, folder):
    """The mesh of a scene whose tables `test_export.py` looks at, and the file."""
    model = scene_mesh(load_scene(scene, ["dolfinx.elements=24", f"dolfinx.degree={degree}"]))
    ending = GROUP_FILES[kind] if kind in GROUP_FILES else kind
    return model, exported(scene, kind, folder, "--set", f"dolfinx.degree={degree}") / f"{scene}.{ending}"


@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize("scene", [DCB, PEEL])
def test_a_vtu_file_holds_mesh_bond_and_sets(scene, degree, tmp_path):
    model, file = written(scene, "vtu", degree, tmp_path)
    values = {name: column.ravel() for name, column in arrays(file)[0].items()}
    assert np.array_equal(values["Points"].reshape(-1, 3), np.pad(model.X_nI, ((0, 0), (0, 1))))
    cells = np.split(values["connectivity"], values["offsets"][:-1])
    solids = len(model.body_e)
    assert np.array_equal(cells[:solids], model.conn_ea) and np.array_equal(values["body"][:solids], model.body_e)
    assert set(values["types"][:solids]) == {9 if degree == 1 else 23} and set(values["types"][solids:]) == {9}
    (lower, upper), bond = model.pair_kb.T, np.array(cells[solids:])
    assert set(values["body"][solids:]) == {2} and len(bond) == len(lower) - 1
    assert np.array_equal(bond, np.stack([lower[:-1], lower[1:], upper[1:], upper[:-1]], 1))
    pair, length, weight = np.full(len(model.X_nI), -1), np.zeros(len(model.X_nI)), np.zeros(len(model.X_nI))
    pair[lower], pair[upper], length[lower], length[upper] = upper, lower, model.length_k, model.length_k
    for face in model.loaded:
        weight[face.node_n] = face.weight_n
    for name, expected in (("pair", pair), ("pair_length", length), ("load_weight", weight)):
        assert np.array_equal(values[name], expected), name
    for name, nodes in model.sets.items():
        assert np.array_equal(np.flatnonzero(values[name] == 1), np.sort(nodes)) and set(values[name]) <= {0, 1}


@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize("scene", [DCB, PEEL])
def test_a_gmsh_file_names_bodies_and_sets(scene, degree, tmp_path):
    model, file = written(scene, "gmsh", degree, tmp_path)
    mesh = meshio.read(file)
    names = {number: name for name, (number, _) in mesh.field_data.items()}
    groups: dict[str, list[np.ndarray]] = {}
    for cells, tags in zip(mesh.cells, mesh.cell_data["gmsh:physical"], strict=True):
        for tag in np.unique(tags):
            assert cells.type in (("quad", "line"), ("quad8", "line3"))[degree - 1] or cells.type == "vertex"
            groups.setdefault(names[tag], []).append(cells.data[tags == tag])
    assert set(groups) == {*model.names, *model.sets} and np.array_equal(mesh.points[:, :2], model.X_nI)
    for number, name in enumerate(model.names):
        assert np.array_equal(np.concatenate(groups[name]), model.conn_ea[model.body_e == number])
    for name, nodes in model.sets.items():
        assert set(np.concatenate([part.ravel() for part in groups[name]])) == set(nodes)
    if degree == 2:
        (bond,) = groups[f"{model.names[0]}_bond"]
        assert np.allclose(mesh.points[bond[:, 2]], mesh.points[bond[:, :2]].mean(axis=1))


@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize("kind", ["gmsh", "med", "exodus"])
def test_a_merged_mesh_is_one_conforming_mesh_with_the_bond_as_a_group(kind, degree, tmp_path):
    words = ["--set", f"dolfinx.degree={degree}", "--merged"]
    whole = scene_mesh(load_scene(DCB, ["dolfinx.elements=24", f"dolfinx.degree={degree}"]))
    file = exported(DCB, kind, tmp_path, *words) / f"{DCB}.{GROUP_FILES[kind]}"
    mesh = meshio.read(file)
    assert len(mesh.points) == len(whole.X_nI) - len(whole.pair_kb)
    quads = np.concatenate([block.data for block in mesh.cells if block.type.startswith("quad")])
    check_areas(DCB, list(whole.names), mesh.points[:, :2], quads, [whole.names[b] for b in whole.body_e])
    sides = [frozenset(quad[[i, (i + 1) % 4]]) for quad in quads for i in range(4)]
    corners = whole.pair_kb[::degree, 0]
    assert sum(sides.count(side) == 2 for side in set(sides)) > len(corners), "elements share sides across the bond"
    bond = bond_of(mesh, kind)
    assert np.allclose(mesh.points[bond, 1], 0.0)
    assert np.allclose(np.sort(mesh.points[bond, 0]), np.sort(whole.X_nI[whole.pair_kb[:, 0], 0]))
    across = [side for side in set(sides) if side <= set(bond.tolist())]
    assert len(across) == len(corners) - 1 and all(sides.count(side) == 2 for side in across)


@pytest.mark.parametrize(("scene", "merged"), [(DCB, True), (DCB, False), ("enf-as4peek", False)])
@pytest.mark.parametrize("degree", [1, 2])
def test_exodus_has_the_sides_of_its_sets(scene, merged, degree, tmp_path):
    """Loaded faces, rollers, bond and the faces of the precrack, which are contact surfaces; by the numbers of the
    sets of nodes of these names."""
    import netCDF4

    words = ["--set", f"dolfinx.degree={degree}", *["--merged"] * merged]
    with netCDF4.Dataset(exported(scene, "exodus", tmp_path, *words) / f"{scene}.e") as file:
        file.set_auto_mask(False)
        of_nodes, of_sides = (["".join(row.astype(str)) for row in file[f"{one}_names"][:]] for one in ("ns", "ss"))
        numbers = dict(zip(of_nodes, file["ns_prop1"][:], strict=True))
        conn_ea = np.concatenate([file[f"connect{b}"][:, :4] for b in (1, 2)])
        for i, name in enumerate(of_sides):
            nodes = file[f"node_ns{of_nodes.index(name) + 1}"][:]
            e, side = file[f"elem_ss{i + 1}"][:] - 1, file[f"side_ss{i + 1}"][:] - 1
            ends = np.stack([conn_ea[e, side], conn_ea[e, (side + 1) % 4]], axis=1)
            assert len(e) == (len(nodes) - 1) // degree and np.isin(ends, nodes).all(), name
            assert file["ss_prop1"][i] == numbers[name]
    crack = {"upper_crack", "lower_crack"} if scene == "enf-as4peek" else set()
    assert {"bond"} <= {*of_sides} if merged else {"upper_bond", "lower_bond"} | crack <= {*of_sides}


def bond_of(mesh: meshio.Mesh, kind: str) -> np.ndarray:
    """The nodes of the group."""
    if kind == "gmsh":
        number = mesh.field_data["bond"][0]
        tagged = zip(mesh.cells, mesh.cell_data["gmsh:physical"], strict=True)
        return np.unique(np.concatenate([block.data[tags == number].ravel() for block, tags in tagged]))
    if kind == "exodus":
        return np.asarray(mesh.point_sets["bond"])
    tags = [tag for tag, names in mesh.cell_tags.items() if "bond" in names]
    tagged = zip(mesh.cells, mesh.cell_data["cell_tags"], strict=True)
    sides = np.unique(np.concatenate([block.data[np.isin(tag_e, tags)].ravel() for block, tag_e in tagged]))
    shared = [tag for tag, names in mesh.point_tags.items() if "bond" in names]
    assert np.array_equal(sides, np.flatnonzero(np.isin(mesh.point_data["point_tags"], shared)))
    return sides


def test_formats_with_conventions_of_their_own_are_not_merged(tmp_path, capsys):
    assert main(["export", DCB, "--format", "abaqus", "--merged", "--out", str(tmp_path)]) == 2
    assert '--merged: is for --format "gmsh", "med" or "exodus"' in capsys.readouterr().err


OWN_LOADS = """
material = {E1 = 122e3, E2 = 10e3, G12 = 5e3, nu12 = 0.25}
interface = {strength = 30, toughness = 0.9, shear_strength = 40, shear_toughness = 1.7, friction = 0.2}
load = {opening = 0.4}

[specimen]
kind = "delamination"
length = 30
arm_thickness = 1.5
precrack = 10
width = 5
plane = "strain"
loads = [
    {body = "upper", side = "left", share = 2.0, couple = true},
    {body = "both", side = "left", share = -1.0},
]
supports = [{body = "both", side = "right"}, {body = "both", side = "right", couple = true}]
"""


@pytest.mark.parametrize("degree", [1, 2])
def test_abaqus_has_every_load_and_support_by_an_equation(degree, tmp_path):
    """Each holds for a rigid motion: the opening is the work of the loads, a support its mean rise or rotation.

    A support of both arms is one equation. What Abaqus eliminates is held nowhere else.
    """
    (tmp_path / "own.toml").write_text(OWN_LOADS)
    folder = exported(str(tmp_path / "own.toml"), "abaqus", tmp_path / "out", "--set", f"dolfinx.degree={degree}")
    blocks = abaqus_blocks((folder / "own.inp").read_text())
    X_nI = {int(row[0]): np.array(row[1:], dtype=float) for key, _, rows in blocks if key == "*NODE" for row in rows}
    sets = {known["NSET"]: {int(a) for row in rows for a in row} for key, known, rows in blocks if key == "*NSET"}
    equations = [{(int(a), int(i)): float(w) for a, i, w in rows[1:]} for key, _, rows in blocks if key == "*EQUATION"]
    points = [next(iter(sets[name])) for name in ("load_mean", "support_1_mean", "support_2_mean")]
    rise, turn = 0.3, 1e-3
    expected = [2.0 * turn - rise, rise + 30.0 * turn, turn]
    for terms, point, value in zip(equations, points, expected, strict=True):
        assert list(terms.items())[-1] == ((point, 2), -1.0)
        moved = {a: (-turn * X_nI[a][1], rise + turn * X_nI[a][0]) for a, _ in terms if a != point}
        found = sum(w * moved[a][i - 1] for (a, i), w in terms.items() if a != point)
        assert found == pytest.approx(value, rel=1e-9)
    boundaries = [row for key, _, rows in blocks if key == "*BOUNDARY" for row in rows]
    fixed = {
        (a, i) for name, first, last, *_ in boundaries for a in sets[name] for i in range(int(first), int(last) + 1)
    }
    assert {(point, 2) for point in points} <= fixed
    firsts = [next(iter(terms)) for terms in equations]
    assert not fixed & set(firsts)
    assert [sum(one in terms for terms in equations) for one in firsts] == [1, 1, 1]

    on = {known["ELSET"]: [int(a) for row in rows for a in row] for key, known, rows in blocks if key == "*ELSET"}
    conn = {int(row[0]): [int(a) for a in row[1:]] for key, _, rows in blocks if key == "*ELEMENT" for row in rows}
    faces = {known["NAME"]: rows[0] for key, known, rows in blocks if key == "*SURFACE"}
    for name, side, ends in (("upper", "S1", (0, 1)), ("lower", "S3", (2, 3))):
        assert faces[f"{name}_crack_face"] == [f"{name}_at_crack", side]
        corners = np.array([[X_nI[conn[e][a]] for a in ends] for e in on[f"{name}_at_crack"]])
        assert np.all(corners[..., 1] == 0.0)
        assert (corners[..., 0].min(), corners[..., 0].max()) == (0.0, 10.0)
        assert np.sum(np.abs(np.diff(corners[..., 0]))) == pytest.approx(10.0), "each side once"
    (rows,) = (rows for key, _, rows in blocks if key == "*FRICTION")
    assert rows == [["0.2"]]


def test_abaqus_has_a_weak_spring_where_nothing_holds_the_rotation(tmp_path):
    """At the end that no support holds; one that has supports has none."""
    text = (exported("adcb-czmtestkit-a", "abaqus", tmp_path) / "adcb-czmtestkit-a.inp").read_text()
    blocks = abaqus_blocks(text)
    X_nI = {int(row[0]): row[1:] for key, _, rows in blocks if key == "*NODE" for row in rows}
    numbers = [int(row[0]) for key, _, rows in blocks if key == "*ELEMENT" for row in rows]
    assert len(set(numbers)) == len(numbers)
    ((number, node),) = (row for key, known, rows in blocks if known.get("TYPE") == "SPRING1" for row in rows)
    assert X_nI[int(node)] == ["0", "0"] and int(number) == max(numbers)
    (((component,), (stiffness,)),) = (rows for key, _, rows in blocks if key == "*SPRING")
    scene = load_scene("adcb-czmtestkit-a")
    assert component == "2" and 0.0 < float(stiffness) < 1e-9 * scene.material.E1 * scene.specimen.width
    assert "SPRING" not in (exported("slb", "abaqus", tmp_path) / "slb.inp").read_text()
