"""Meshes of other programs: what is read, what is refused, and the curve of the built-in meshes on them."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import cache
from pathlib import Path

import meshio
import numpy as np
import pytest
from meshes_made import LENGTH, TAGS, arms, breaks, changed, write

from iga.files.nodal_body import NODAL
from verify.cli import REFUSED, main
from verify.meshes.arms import given_arms
from verify.meshes.joined import joined
from verify.meshes.read import read_mesh
from verify.methods.dolfinx import dolfinx_installed
from verify.methods.method import Unsuitable
from verify.methods.solve import prepare, require, solve
from verify.result import Result
from verify.scene.load import load_scene
from verify.scene.schema import Scene
from verify.support.refusal import Refusal

GROUPS = 'specimen.groups={upper="upper", lower="lower", bond="bond", load="load"}'
SMALL = breaks(12, 6)


def scene_on(file: str, *overrides: str) -> Scene:
    return load_scene("dcb-czm1", [f"specimen.mesh={json.dumps(file)}", *overrides])


@pytest.mark.parametrize("size", NODAL)
def test_functions_of_an_element_are_nodal_and_complete(size):
    nodal = NODAL[size]
    assert np.allclose(nodal.functions(nodal.nodes_aI), np.eye(size), atol=1e-13)
    x_qI = np.array([[0.2, 0.3], [0.5, 0.1]])
    for power in range(nodal.degree + 1):
        field = (nodal.nodes_aI @ [0.7, -0.4] + 0.1) ** power
        assert np.allclose(nodal.functions(x_qI) @ field, (x_qI @ [0.7, -0.4] + 0.1) ** power)


@pytest.mark.parametrize(
    ("kind", "ending", "groups"),
    [(kind, ".msh", True) for kind in ("quad", "quad8", "quad9", "triangle", "triangle6")]
    + [("quad8", ".inp", True), ("triangle6", ".inp", True), ("quad8", ".vtu", False), ("triangle", ".vtu", False)],
)
def test_arms_are_read_with_their_groups(kind, ending, groups, tmp_path):
    made = arms(kind, SMALL)
    file = write(made, tmp_path / f"arms{ending}")
    named = GROUPS if groups else 'specimen.groups={bond="bond", load="load"}'
    upper, lower = given_arms(scene_on(file, named))
    for arm, block in zip((upper, lower), made.cells, strict=False):
        (conn,) = arm.conn_kea.values()
        assert np.allclose(arm.X_nI[conn], made.points[block.data, :2], atol=1e-12)
    points, conn = joined((upper, lower))
    assert np.allclose(np.ptp(points, axis=0), [LENGTH, 0.4]) and len(conn) == sum(len(b.data) for b in made.cells[:2])
    assert len(np.unique(np.round(points, 9), axis=0)) == len(points), "the arms share the nodes of the interface"


@pytest.mark.parametrize("ending", [".e", ".med", None])
def test_exodus_and_med_and_meshes_in_memory_are_read(ending, tmp_path):
    made = arms("quad8", SMALL)
    if ending is None:
        found = given_arms(scene_on("arms.msh", GROUPS), made)
        with pytest.raises(Refusal, match="the mesh: group upper: must hold the 36 elements"):
            given_arms(scene_on("arms.msh", GROUPS), renamed(made, upper=(2, 2), lower=(1, 2)))
    else:
        solid = np.concatenate([block.data for block in made.cells[:2]])
        file = tmp_path / f"arms{ending}"
        meshio.Mesh(made.points[:, : 2 if ending == ".med" else 3], [("quad8", solid)]).write(file)
        found = given_arms(scene_on(str(file)))
    assert [len(arm.conn_kea[8]) for arm in found] == [len(block.data) for block in made.cells[:2]]


ABAQUS = """\
*Node
1, 0., 0.
2, 1., 0.
** between
3, 1., 1.,
4, 0., 1.
*Element, type=CPE4H, elset=all
7, 1, 2, 3,
 4
*NODE, nset=far
5, 2., 0.5, 0.
*Element, type=CPS3, elset=all
9, 2, 5, 3
*ELEMENT, TYPE=T2D2
11, 2, 5
*Element, type=MASS, elset=heavy
12, 5
*Elset, elset=side
11
*Elset, elset=some
all, heavy
*Nset, nset=low, generate
1, 5, 2
*Nset, nset=both
low, far, 2
*Boundary
low, 1
"""


def test_an_abaqus_file_is_read_by_its_keywords(tmp_path):
    """Nodes in two blocks, one without z; an element over two lines; one set over two blocks; sets of sets."""
    (tmp_path / "a.inp").write_text(ABAQUS)
    mesh = read_mesh(tmp_path / "a.inp")
    assert mesh.X_nI.tolist() == [[0, 0], [1, 0], [1, 1], [0, 1], [2, 0.5]]
    assert {size: conn.tolist() for size, conn in mesh.conn_kea.items()} == {3: [[1, 4, 2]], 4: [[0, 1, 2, 3]]}
    assert {name: found.tolist() for name, found in mesh.elements.items()} == {"all": [0, 1], "some": [0, 1]}
    nodes = {"far": [4], "low": [0, 2, 4], "both": [0, 2, 4, 4, 1], "side": [1, 4], "heavy": [4]}
    assert {name: found.tolist() for name, found in mesh.nodes.items()} == nodes
    part = f"*Part, name=a\n{ABAQUS}*End Part\n"
    (tmp_path / "a.inp").write_text(part)
    assert len(read_mesh(tmp_path / "a.inp").X_nI) == 5
    (tmp_path / "a.inp").write_text(part + part)
    with pytest.raises(ValueError, match="must be written without parts and assemblies, or with both arms in one part"):
        read_mesh(tmp_path / "a.inp")


@cache
def on_its_own_mesh(method: str) -> Result:
    return solve(load_scene("dcb-czm1", ["load.opening=1.0"]), method)


@pytest.mark.parametrize(
    ("kind", "ending", "method"),
    [
        ("triangle6", ".inp", "dolfinx"),
        ("quad9", ".vtu", "lagrange"),
        pytest.param("quad8", ".msh", "dolfinx", marks=pytest.mark.slow),
        pytest.param("quad8", ".msh", "lagrange", marks=pytest.mark.slow),
        pytest.param("triangle6", ".inp", "lagrange", marks=pytest.mark.slow),
        pytest.param("quad9", ".vtu", "dolfinx", marks=pytest.mark.slow),
    ],
)
def test_the_curve_is_that_of_the_meshes_that_are_made(method, kind, ending, tmp_path):
    """To 0.5 % of the largest load, graded meshes and triangles included."""
    if method == "dolfinx" and not dolfinx_installed():
        pytest.skip("DOLFINx is not installed")
    given = solve(scene_on(write(arms(kind), tmp_path / f"arms{ending}"), "load.opening=1.0"), method)
    made = on_its_own_mesh(method)
    opening = np.linspace(0.0, 1.0, 200)[1:]
    load, other = (np.interp(opening, run.opening, run.load) for run in (given, made))
    assert given.complete and np.abs(load - other).max() < 0.005 * other.max()


def shifted(mesh: meshio.Mesh, which: Callable, by: tuple[float, float, float]) -> meshio.Mesh:
    moved = mesh.points + np.where(which(mesh.points)[:, None], by, 0.0)
    return changed(mesh, points=moved)


def with_solids(mesh: meshio.Mesh, change: Callable) -> meshio.Mesh:
    upper, *others = ((block.type, block.data) for block in mesh.cells)
    new = change(upper[1])
    tags = [np.full(len(new), 1), *mesh.cell_data["gmsh:physical"][1:]]
    data = {"gmsh:physical": tags, "gmsh:geometrical": tags}
    return changed(mesh, cells=[(upper[0], new), *others], cell_data=data)


def renamed(mesh: meshio.Mesh, **tags: tuple[int, int]) -> meshio.Mesh:
    return changed(mesh, field_data={name: np.array(tag) for name, tag in (TAGS | tags).items() if tag})


def with_block(mesh: meshio.Mesh, kind: str, conn: np.ndarray) -> meshio.Mesh:
    tags = [*mesh.cell_data["gmsh:physical"], np.full(len(conn), 1)]
    data = {"gmsh:physical": tags, "gmsh:geometrical": tags}
    return changed(mesh, cells=[*((b.type, b.data) for b in mesh.cells), (kind, conn)], cell_data=data)


def third_body(mesh: meshio.Mesh) -> meshio.Mesh:
    """A copy of one element, beside the others in the same place."""
    first, n = mesh.cells[0].data[:1], len(mesh.points)
    more = changed(mesh, points=np.concatenate([mesh.points, mesh.points[first[0]]]))
    return with_block(more, mesh.cells[0].type, n + np.arange(first.size)[None])


def swapped(conn: np.ndarray, one: int, other: int) -> np.ndarray:
    new = conn.copy()
    new[0, [one, other]] = new[0, [other, one]]
    return new


#: A fault -> the mesh with it, and what the refusal says.
FAULTS: dict[str, tuple[Callable, str]] = {
    "no group": (lambda m: renamed(m, bond=()), "group bond (specimen.groups.bond) is missing, the file has"),
    "bond of elements": (lambda m: renamed(m, bond=(2, 2), lower=(3, 1)), "group lower: must hold elements of a body"),
    "loaded body": (lambda m: renamed(m, load=(1, 2), upper=(4, 1)), "group upper: must hold elements of a body"),
    "bodies exchanged": (lambda m: renamed(m, upper=(2, 2), lower=(1, 2)), "group upper: must hold the 36 elements"),
    "faces exchanged": (
        lambda m: renamed(m, bond=(4, 1), load=(3, 1)),
        "group bond: must lie on Y = 0 from X = 4 to 14",
    ),
    "order of nodes": (lambda m: with_solids(m, lambda c: swapped(c, 1, 2)), "body upper: nodes of elements"),
    "middles": (lambda m: with_solids(m, lambda c: swapped(c, 4, 5)), "body upper: sides inside it"),
    "hole": (lambda m: with_solids(m, lambda c: np.delete(c, 8, 0)), "body upper: sides inside it"),
    "twice": (lambda m: with_solids(m, lambda c: np.concatenate([c, c[:1]])), "body upper: sides inside it"),
    "third body": (third_body, "must hold 2 bodies, one above and one below Y = 0, got 2 above and 1 below"),
    "metres": (lambda m: changed(m, points=m.points / 1000), "the mesh is 1000 times smaller: in other units?"),
    "long": (
        lambda m: changed(m, points=m.points * [1.5, 1, 1]),
        "X must run from 0 to 14 (specimen.length), got 0 to 21",
    ),
    "thick": (
        lambda m: changed(m, points=m.points * [1, 2, 1]),
        "body upper: Y must run from 0 to 0.2 (specimen.arm_thickness), got 0 to 0.4",
    ),
    "gap": (
        lambda m: changed(m, points=m.points - 0.01 * np.outer((m.points[:, 1] == 0) & _lower(m), [0, 1, 0])),
        "body lower: Y must run from -0.2 to 0 (specimen.arm_thickness), got -0.2 to -0.01",
    ),
    "part of a gap": (
        lambda m: changed(
            m, points=m.points - 0.01 * np.outer((m.points[:, 1] == 0) & _lower(m) & (m.points[:, 0] > 9), [0, 1, 0])
        ),
        "body lower: sides inside it",
    ),
    "other precrack": (lambda m: arms("quad8", np.linspace(0.0, LENGTH, 12)), "X = 4 (specimen.precrack), got 3.8"),
    "out of the plane": (lambda m: shifted(m, lambda p: p[:, 0] > 13, (0, 0, 1.0)), "plane z = 0, got z = 1 at node"),
    "two degrees": (lambda m: with_block(m, "quad", m.cells[0].data[:1, :4]), "one degree, got quad and quad8"),
    "solid": (lambda m: with_block(m, "tetra", np.array([[0, 1, 2, 3]])), "got 1 of type tetra"),
}


def _lower(mesh: meshio.Mesh) -> np.ndarray:
    return np.isin(np.arange(len(mesh.points)), mesh.cells[1].data)


def refused(file: str, words: str, capsys: pytest.CaptureFixture, tmp_path: Path) -> None:
    out = tmp_path / "out"
    options = ["--set", f"specimen.mesh={json.dumps(file)}", "--set", GROUPS, "--out", str(out)]
    assert main(["solve", "dcb-czm1", "--method", "lagrange", *options]) == REFUSED
    said = capsys.readouterr().err
    assert "specimen.mesh: " in said and Path(file).name in said and words in said, said
    assert not out.exists()


@pytest.mark.parametrize("fault", FAULTS)
def test_a_broken_mesh_is_refused(fault, tmp_path, capsys):
    change, words = FAULTS[fault]
    refused(write(change(arms("quad8", SMALL)), tmp_path / "arms.msh"), words, capsys, tmp_path)


@pytest.mark.parametrize(
    ("ending", "change", "words"),
    [
        (".msh", lambda text: "", "is empty"),
        (
            ".inp",
            lambda text: text.replace("CPS8R", "C3D8", 1),
            "elements must be plane ones (CPS, CPE, CPEG), shells (S) or CAX with 3, 4, 6 or 8 nodes",
        ),
        (
            ".msh",
            lambda text: text[: len(text) // 2],
            "must be a whole file of gmsh, of a version that meshio reads, got",
        ),
        (".inp", lambda text: text[: text.index("ELSET=lower") - 300], "must have 8 nodes each, got 262 numbers"),
        (".vtu", lambda text: text[: len(text) // 2], "must be a whole file of vtu"),
        (".msh", lambda text: "4 2 4\n0 0 1\n", "got 2 lines from '4 2 4' on"),
    ],
)
def test_a_broken_file_is_refused(ending, change, words, tmp_path, capsys):
    file = Path(write(arms("quad8", SMALL), tmp_path / f"arms{ending}"))
    file.write_text(change(file.read_text()))
    refused(str(file), words, capsys, tmp_path)


def test_faces_that_do_not_match_are_for_lagrange_alone(tmp_path):
    fine, coarse = arms("quad8", breaks()), arms("quad8", breaks(100, 20))
    points = np.concatenate([fine.points, coarse.points])
    both = meshio.Mesh(points, [("quad8", fine.cells[0].data), ("quad8", coarse.cells[1].data + len(fine.points))])
    both.write(tmp_path / "arms.vtu")
    scene = scene_on(str(tmp_path / "arms.vtu"))
    require(prepare(scene, "lagrange"))
    with pytest.raises(Unsuitable, match="must match on Y = 0 for dolfinx, got 145 and 121"):
        require(prepare(scene, "dolfinx"))
