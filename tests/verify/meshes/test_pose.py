"""Meshes as people have them: clockwise, moved, mirrored; decks that include and generate; endings nobody reads."""

import os
from pathlib import Path

import meshes_made
import meshio
import numpy as np
import pytest
from meshes_made import LENGTH, arms, breaks, changed, write

from verify.cli import main
from verify.meshes.arms import given_arms
from verify.meshes.pose import OTHER_SENSE
from verify.meshes.read import read_mesh
from verify.runs.fingerprint import fingerprint
from verify.scene.load import load_scene
from verify.scene.toml import keep_scene

SCENE = load_scene("dcb-czm1-linear")
X = breaks(fine=20, coarse=4)


def given(mesh, tmp_path: Path, ending: str = ".inp"):
    file = write(mesh, tmp_path / f"arms{ending}")
    return given_arms(load_scene("dcb-czm1-linear", [f"specimen.mesh='{file}'"]))


def clockwise(mesh, bodies: tuple[int, ...]):
    cells = [
        (block.type, block.data[:, OTHER_SENSE[block.data.shape[1]]] if b in bodies else block.data)
        for b, block in enumerate(mesh.cells)
    ]
    return changed(mesh, cells=cells)


@pytest.mark.parametrize("kind", ["triangle", "quad", "triangle6", "quad8"])
def test_a_mesh_is_brought_where_its_specimen_is(kind, tmp_path, capsys):
    """One body or both clockwise, another origin, the mirror image: the same arms, with a remark for each."""
    mesh = arms(kind, X)
    expected = given(mesh, tmp_path)
    assert capsys.readouterr().err == ""
    mirrored = changed(mesh, points=np.array([LENGTH, 0.0, 0.0]) + mesh.points * np.array([-1.0, 1.0, 1.0]))
    for one, said in (
        (clockwise(mesh, (1,)), "the elements of the lower body run clockwise"),
        (clockwise(mesh, (0, 1)), "the elements of the upper and the lower body run clockwise"),
        (changed(mesh, points=mesh.points + [3.0, 0.2, 0.0]), "is moved by (-3, -0.2)"),
        (clockwise(mirrored, (0, 1)), "is mirrored"),
        (mirrored, "is mirrored"),
        (changed(mirrored, points=mirrored.points + [3.0, 0.2, 0.0]), "is mirrored"),
    ):
        folder = tmp_path / str(len(list(tmp_path.iterdir())))
        folder.mkdir()
        if "mirrored" in said:  # the loaded end is the other one as well
            one = meshes_made.changed(one, cell_data={name: list(tags) for name, tags in one.cell_data.items()})
        found = given(one, folder)
        assert said in capsys.readouterr().err
        for body, other in zip(found, expected, strict=True):
            places = {tuple(np.round(X_I, 9)) for X_I in body.X_nI}
            assert places == {tuple(np.round(X_I, 9)) for X_I in other.X_nI}
            assert sum(map(len, body.conn_kea.values())) == sum(map(len, other.conn_kea.values()))


def test_elements_of_both_senses_in_one_body_stay_refused(tmp_path):
    mesh = arms("quad", X)
    conn = mesh.cells[0].data.copy()
    conn[5] = conn[5, OTHER_SENSE[4]]
    with pytest.raises(ValueError, match="counter-clockwise"):
        given(changed(mesh, cells=[("quad", conn), *mesh.cells[1:]]), tmp_path)


DECK = """*NODE, NSET=all
1, 0.0, 0.0
5, 4.0, 0.0
*NODE
11, 0.0, 1.0
15, 4.0, 1.0
*NGEN, NSET=all
1, 5, 1
11, 15
*ELEMENT, TYPE={kind}, ELSET=one
1, 1, 2, 12, 11
*ELGEN, ELSET=body
1, 4, 1, 1
"""


@pytest.mark.parametrize("kind", ["CPE4", "CPS4R", "CPEG4", "S4R", "S4", "CAX4P", "M2D4", "CPE4RH"])
def test_generated_nodes_and_elements_of_any_kind_with_these_nodes(kind, tmp_path):
    (tmp_path / "a.inp").write_text(DECK.format(kind=kind))
    mesh = read_mesh(tmp_path / "a.inp")
    assert mesh.X_nI.shape == (10, 2) and sorted(mesh.X_nI[:, 0]) == [0, 0, 1, 1, 2, 2, 3, 3, 4, 4]
    corners = mesh.X_nI[mesh.conn_kea[4]]
    assert np.array_equal(corners.mean(1)[:, 0], [0.5, 1.5, 2.5, 3.5]) and len(mesh.elements["body"]) == 4


GENERATED = """*PARAMETER
# sizes
L = 4.0
n = 2**2
last = n + 1  # from 1 on
top = 10*n + last
high = -(-L / 2)
*NODE, NSET=low
1, 0.0, 0.0
<last>, <L>, 0.0
*NODE, INPUT=far.txt
* NGEN, NSET=Low,
  NSET=low
1, <last>
*NGEN, NSET=high
41, <top>, 1
*NFILL, NSET=all
LOW, high, 4, 10
*ELEMENT, TYPE=CPE4
1, 1, 2, 12, 11
*ELGEN, ELSET=body
1, <n>, 1, 1, <n>, 10, 100
*ASSEMBLY, NAME=whole
*NODE
1, 0.0, 99.0
*END ASSEMBLY
"""


def test_parameters_and_filled_nodes(tmp_path):
    """A grid of 4 by 4 elements, 4 wide and 2 high; rows of a file, a keyword over two lines, sets in any capitals.

    What an assembly numbers is not the mesh.
    """
    (tmp_path / "far.txt").write_text("41, 0.0, 2.0\n45, 4.0, 2.0\n")
    (tmp_path / "a.inp").write_text(GENERATED)
    mesh = read_mesh(tmp_path / "a.inp")
    number_n = [10 * row + column for row in range(5) for column in range(1, 6)]
    order = np.argsort(mesh.number_n)
    assert mesh.number_n[order].tolist() == number_n and mesh.number_e.tolist() == [
        100 * row + column for row in range(4) for column in range(1, 5)
    ]
    assert np.allclose(mesh.X_nI[order], [[column, 0.5 * row] for row in range(5) for column in range(5)])


def test_arms_apart_and_half_models_are_named(tmp_path):
    """And not arms that are too thick."""
    mesh = arms("quad", X, layers=4)
    upper = np.unique(mesh.cells[0].data)
    apart, thick = mesh.points.copy(), mesh.points * [1.0, 1.3, 1.0]
    apart[upper] += [0.0, 0.02, 0.0]
    for points, cells, said in (
        (apart, mesh.cells, "must hold arms that meet, got 0.02 between them; move them together"),
        (mesh.points, mesh.cells[:1], "must hold both arms, got one: a half model. Mirror it"),
        (mesh.points, mesh.cells[1:2], "must hold both arms, got one"),
        (thick, mesh.cells, r"Y must run from 0 to 0.2 \(specimen.arm_thickness\), got 0 to 0.26"),
    ):
        with pytest.raises(ValueError, match=said):
            file = tmp_path / "arms.vtu"
            meshio.Mesh(points, [(one.type, one.data) for one in cells if one.type == "quad"]).write(file)
            given_arms(load_scene("dcb-czm1-linear", [f"specimen.mesh='{file}'"]))


def test_included_files_lie_beside_the_deck(tmp_path, monkeypatch):
    """Read from anywhere, by the same rules; never a device or a pipe, which may not end, nor each other for ever."""
    nodes, elements = DECK.format(kind="CPE4").split("*ELEMENT")
    (tmp_path / "deck").mkdir()
    (tmp_path / "deck" / "mesh").mkdir()
    (tmp_path / "deck" / "mesh" / "nodes.inp").write_text(nodes)
    job = tmp_path / "deck" / "job.inp"
    job.write_text(f"*HEADING\n a job\n*INCLUDE, INPUT=mesh/nodes.inp\n*ELEMENT{elements}")
    monkeypatch.chdir(tmp_path)
    assert len(read_mesh(job).X_nI) == 10
    scene = load_scene("dcb-czm1", [f"specimen.mesh='{job}'"])
    keep_scene(scene, tmp_path / "kept" / "own.toml")
    assert len(read_mesh(tmp_path / "kept" / "job.inp").X_nI) == 10
    before = fingerprint(scene, "lagrange")
    (tmp_path / "deck" / "mesh" / "nodes.inp").write_text(nodes.replace("4.0", "5.0"))
    assert fingerprint(scene, "lagrange") != before
    os.mkfifo(tmp_path / "deck" / "pipe")
    for name, said in (
        ("gone.inp", "line 1: .INCLUDE: there is no file gone.inp"),
        ("pipe", "there is no file pipe"),
        ("../other.inp", "beside the deck or below"),
        (str(tmp_path / "deck" / "mesh" / "nodes.inp"), "beside the deck or below"),
        ("job.inp", "at most 5 deep"),
    ):
        job.write_text(f"*INCLUDE, INPUT={name}\n")
        with pytest.raises(ValueError, match=said):
            read_mesh(job)
    for depth in range(4):  # a row of a few files in files stands for any number of them
        (tmp_path / "deck" / f"{depth}.inp").write_text(f"*INCLUDE, INPUT={depth + 1}.inp\n" * 100)
    (tmp_path / "deck" / "4.inp").write_text("")
    job.write_text("*INCLUDE, INPUT=0.inp\n")
    with pytest.raises(ValueError, match="what a deck includes must have at most 100 MB"):
        read_mesh(job)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("TYPE=CPE4", "TYPE=C3D8", "line 10: elements must be plane ones"),
        ("TYPE=CPE4, ELSET=one", "ELSET=one", "line 10: elements must be plane ones"),
        ("1, 5, 1", "1, 6, 1", "line 8: .NGEN: nodes 1 and 6 must be defined"),
        ("1, 5, 1", "1, 5, 3", "line 8: .NGEN: must have first, last and a step"),
        ("1, 4, 1, 1", "7, 4, 1, 1", "line 13: .ELGEN: element 7 must be defined"),
        ("1, 4, 1, 1", "1, 9, 1, 1", "line 13: elements must have nodes of the file, got node 6"),
        ("1, 4, 1, 1", "1, 4000, 1, 1, 4000, 1, 1, 4000", "line 13: .ELGEN: must make 1 to 10000000 elements"),
        ("4.0, 0.0", "4.0, zero", "line 3: must have numbers, got 'zero'"),
        (
            "4.0, 0.0",
            "<L>, 0.0",
            "line 3: .PARAMETER must be numbers and parameters that are defined before, .* got 'L'",
        ),
        ("*NODE, NSET=all", "*PARAMETER\n L = 9**9**9**9\n*NODE", "line 2: .PARAMETER must be numbers"),
        ("*NGEN, NSET=all", "*NGEN, NSET=all, LINE=C", "line 7: .NGEN: LINE is not read"),
        ("*ELGEN", "*NFILL\n all, far, 2, 10\n*ELGEN", "line 13: set far must be defined before it"),
        (
            "*ELGEN",
            "*ELEMENT, TYPE=CPE4\n 1, 2, 3, 13, 12\n*ELGEN",
            "element 1 must be defined once, got it at line 10",
        ),
        (
            "*ELEMENT, TYPE=CPE4, ELSET=one\n1, 1, 2, 12, 11\n*ELGEN",
            "*HEADING",
            "must have rows below the keywords .NODE and .ELEMENT of Abaqus, got the keywords",
        ),
        ("1, 1, 2, 12, 11", "1, 1, 2, 12", "must have 4 nodes each"),
    ],
)
def test_what_a_whole_deck_has_too_much_is_named_and_not_called_broken(old, new, said, tmp_path):
    (tmp_path / "a.inp").write_text(DECK.format(kind="CPE4").replace(old, new))
    with pytest.raises(ValueError, match=said) as raised:
        read_mesh(tmp_path / "a.inp")
    assert "broken" not in str(raised.value)


@pytest.mark.parametrize("method", ["lagrange", "dolfinx", "nurbs"])
@pytest.mark.parametrize("name", ["arms.vtk", "arms.bdf", "arms"])
def test_an_ending_that_nobody_reads_is_refused(name, method, tmp_path, capsys):
    (tmp_path / name).write_text("a mesh of some kind")
    words = ["solve", "dcb-czm1-linear", "--method", method, "--set", f"specimen.mesh='{tmp_path / name}'"]
    assert main([*words, "--out", str(tmp_path / "out")]) == 2
    said = capsys.readouterr().err
    assert "must end with" in said and ".msh" in said and not (tmp_path / "out").exists()
