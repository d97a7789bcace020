"""`debond mesh`: facts of mesh files, pictures, other formats, and refusals without a traceback."""

import json
import sys
import time
import xml.etree.ElementTree as ElementTree
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from doctored_meshes import SMOOTH, arch, function_halved
from hypothesis import given, settings
from iga_files import REAL, SMALL, assert_same, from_mesh, real, small
from unstructured import polygon_mesh

from iga.bases.bspline import open_knots
from iga.bases.nurbs import nurbs_rectangle
from iga.files.iga_format import mesh, write_iga
from iga.files.iga_reader import read_iga
from iga.mesh import rank
from iga.tsplines.lines import tensor_grid, with_line
from iga.tsplines.tspline import tspline_rectangle
from tests.iga.files.test_iga_format import MALFORMED, mutated
from verify.cli import main
from verify.command_line.mesh import examine as mesh_command
from verify.command_line.mesh import facts as mesh_facts
from verify.command_line.mesh.examine import _unity, examine
from verify.command_line.mesh.facts import MeshFacts
from verify.support import progress
from verify.support.refusal import Refusal

#: control points, elements, T-junctions, valences, inner edges that are C0, C1, C2, area
FACTS = {
    "arch_nurbs": (49, 16, 0, [], (0, 0, 24), 0.75 * np.pi),
    "arch_tsplines": (119, 80, 8, [], (0, 0, 146), 0.75 * np.pi),
    "plate_with_hole": (275, 176, 8, [], (12, 0, 320), 16.0 - np.pi / 4),
    "square_structured": (25, 4, 0, [], (0, 0, 4), 1.0),
    "square_unstructured": (187, 112, 0, [3, 5], (0, 24, 178), 1.0),
}


@pytest.fixture(autouse=True)
def in_a_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def test_the_sample_among_the_examples_is_written_by_our_own_writer(capsys):
    """A T-spline whose control points lie on a quarter of a ring; two lines of it end inside."""
    grid = tensor_grid(np.linspace(0.0, 1.0, 13), np.linspace(0.0, 1.0, 4))
    body = tspline_rectangle(with_line(grid, "horizontal", 1 / 6, between=(4 / 12, 8 / 12)))
    s, t = body.P_AI.T
    phi = 0.5 * np.pi * (1.0 - s)
    body = replace(body, P_AI=np.stack([(1.0 + t) * np.cos(phi), (1.0 + t) * np.sin(phi)], -1))
    write_iga(from_mesh(body), Path("made.iga"))
    sample = Path(__file__).parents[3] / "examples" / "quarter_ring.iga"
    made, kept = ([line.split() for line in path.read_text().splitlines()] for path in (Path("made.iga"), sample))
    assert [len(line) for line in made] == [len(line) for line in kept]
    numbers = [np.array([line[1:] for line in rows if line[0] == "node"], float) for rows in (made, kept)]
    np.testing.assert_allclose(*numbers, atol=1e-15)
    assert main(["mesh", str(sample)]) == 0
    assert "T-junctions: 2 (" in capsys.readouterr().out


@pytest.mark.parametrize("name", REAL)
def test_facts_of_real_files(name, capsys, tmp_path):
    """As numbers, in words and drawn; a surface in space has those of the plane body that it was."""
    points, elements, junctions, valences, edges, area = FACTS[name]
    assert main(["mesh", str(real(name)), "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert report["type"] == "plane" and report["unsound"] == []
    assert (report["control_points"], report["elements"], report["rank"]) == (points, elements, points)
    assert sum(kind["elements"] for kind in report["kinds"]) == elements
    assert report["area"] == pytest.approx(area, rel=1e-12) and report["smallest_jacobian"] > 0
    assert len(report["t_junctions"]) == junctions and report["boundary_loops"] == 1
    assert sorted(point["valence"] for point in report["extraordinary_points"]) == valences
    assert report["continuity"] == {"broken": 0, **dict(zip(("C0", "C1", "C2"), edges, strict=True))}
    if name != "square_unstructured":
        assert report["sum_of_functions_misses_one_by"] < 1e-14
    else:
        places = {point["valence"]: point["at"] for point in report["extraordinary_points"]}
        assert places[3] == pytest.approx([0.28027, 0.73564], abs=1e-5)
    assert main(["mesh", str(real(name))]) == 0
    said = capsys.readouterr()
    assert f"written: debond-mesh/{name}.svg" in said.out and said.err == ""
    assert f"independent functions: {points} of {points}, all" in said.out
    assert f"T-junctions: {junctions or 'none'} (" in said.out
    texts = [text.text for text in ElementTree.parse(tmp_path / "debond-mesh" / f"{name}.svg").iter() if text.text]
    assert any(f"{junctions} T-junctions" in text for text in texts) == bool(junctions)
    assert all(str(valence) in map(str.strip, texts) for valence in valences)
    file = read_iga(real(name))
    x, y, _ = file.P_AI.T
    write_iga(replace(file, kind="surface", P_AI=np.stack([0.6 * x, y, 0.8 * x], -1)), Path("surface.iga"))
    assert main(["mesh", "surface.iga", "--json", "--out", "again.iga"]) == 0
    said = capsys.readouterr()
    turned = json.loads(said.out)
    assert turned["type"] == "surface" and turned["area"] == pytest.approx(area, rel=1e-6)
    assert all(turned[key] == report[key] for key in ("control_points", "elements", "kinds"))
    assert "the solvers take plane bodies alone" in said.err and Path("again.iga").exists()
    assert main(["mesh", "surface.iga"]) == 0 and "area: " in capsys.readouterr().out


def test_t_junction_of_the_small_file(tmp_path, capsys):
    assert main(["mesh", str(small(tmp_path)), "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert report["t_junctions"] == [[1.0, 0.5]] and report["extraordinary_points"] == []
    assert report["continuity"] == {"broken": 0, "C0": 3, "C1": 0, "C2": 0}
    assert report["chains"] == {"Right_side": 2} and report["written"] == "debond-mesh/small.svg"


@pytest.mark.parametrize("corners", [3, 5, 6])
def test_valence_of_a_polygon(corners):
    """A polygon cut from its middle into as many quadrilaterals as it has corners."""
    facts = MeshFacts(polygon_mesh(corners, 2))
    ((valence, x),) = facts.extraordinary
    assert valence == corners and np.abs(x).max() < 1e-12
    assert len(facts.junctions) == 0 and facts.loops == 1 and facts.unsound == []


def test_other_formats(tmp_path, capsys):
    source = small(tmp_path)
    for name in ("again.iga", "mesh.vtu", "mesh.png", "mesh.pdf", "mesh.SVG"):
        assert main(["mesh", str(source), "--out", name, "--control"]) == 0
        assert f"written: {name}" in capsys.readouterr().out
    assert_same(read_iga(source), read_iga("again.iga"))
    again = (tmp_path / "mesh.SVG").read_bytes()
    assert main(["mesh", str(source), "--out", "mesh.SVG", "--control"]) == 0
    assert (tmp_path / "mesh.SVG").read_bytes() == again, "the picture is the same every time"
    assert (tmp_path / "mesh.png").read_bytes().startswith(b"\x89PNG")
    assert 'HigherOrderDegrees="HigherOrderDegrees"' in (tmp_path / "mesh.vtu").read_text()
    assert not (tmp_path / "debond-mesh").exists()


@pytest.mark.parametrize(
    "what", ["empty", "NaN", "short block", "node out of range", "truncated", "binary", "huge count"]
)
def test_malformed_files_are_bad_input(what, tmp_path, capsys):
    text, line, _ = MALFORMED[what]
    path = tmp_path / "wrong.iga"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    assert main(["mesh", str(path)]) == 2
    said = capsys.readouterr()
    assert said.out == "" and said.err.startswith(f"debond: {path}: line {line}: expected ")
    assert said.err.count("\n") == 1 and "this command" not in said.err
    assert not (tmp_path / "debond-mesh").exists()


def test_a_folded_element_is_no_mesh_to_solve_on(tmp_path, capsys):
    path = small(tmp_path, SMALL.replace("node 0 1 0 1", "node 0.9 0.1 0 1"))
    assert main(["mesh", str(path)]) == 1
    said = capsys.readouterr()
    assert "Jacobians are not positive on 1 of 3 elements" in said.err
    assert "continuity: not computed" in said.out and (tmp_path / "debond-mesh" / "small.svg").exists()


@pytest.mark.parametrize("kind", SMOOTH)
def test_what_is_wrong_is_named(kind, tmp_path, capsys):
    doctor, words = SMOOTH[kind]
    write_iga(from_mesh(doctor(replace(arch(), chains={}))), tmp_path / "wrong.iga")
    assert main(["mesh", "wrong.iga", "--out", "wrong.vtu"]) == 1
    said = capsys.readouterr()
    assert words in said.err and "debond: wrong.iga: " in said.err and "elements" in said.out


@pytest.mark.parametrize("many", [0, 2000])
def test_dependent_functions_are_found(many, monkeypatch):
    """By singular values and, as for large meshes, by the smallest eigenvalue."""
    monkeypatch.setattr(rank, "RANK", replace(rank.RANK, dense=many))
    kv = open_knots(np.linspace(0.0, 1.0, 4), 3)
    body = nurbs_rectangle(kv, kv)
    lost = replace(body, P_AI=np.concatenate([body.P_AI, [[0.0, 0.0]]]), w_A=np.ones(37))  # without elements
    assert [MeshFacts(one).rank for one in (body, function_halved(body), lost)] == [36, 36, 36]
    assert MeshFacts(function_halved(body)).unsound == ["the functions are dependent: rank 36 of 37"]


def test_semi_standard_functions(tmp_path, capsys):
    """Functions that add up to one only with their weights: said so, and the same body."""
    body = nurbs_rectangle(*[open_knots(np.linspace(0.0, 1.0, 4), 3)] * 2)
    (block,) = body.blocks
    w_A = 0.5 + np.random.default_rng(1).random(36)
    scaled = replace(block, C_eab=block.C_eab / w_A[block.conn_ea][..., None])
    write_iga(from_mesh(replace(body, blocks=(scaled,), w_A=w_A)), tmp_path / "semi.iga")
    assert main(["mesh", "semi.iga"]) == 0
    said = capsys.readouterr().out
    assert "with the weights (semi-standard)" in said and "area: 1\n" in said


def test_without_matplotlib(tmp_path, monkeypatch, capsys):
    """The facts all the same; a picture that was asked for is refused."""
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    monkeypatch.delitem(sys.modules, "verify.command_line.mesh.drawing", raising=False)
    path = str(small(tmp_path))
    assert main(["mesh", path]) == 0
    said = capsys.readouterr()
    assert "3 elements" in said.out and "no picture without matplotlib" in said.err and "written" not in said.out
    assert main(["mesh", path, "--out", "x.vtu"]) == 0
    assert main(["mesh", path, "--out", "x.svg"]) == 2
    monkeypatch.setitem(sys.modules, "verify.command_line.mesh.drawing", None)  # which is not optional
    with pytest.raises(ModuleNotFoundError, match="verify.command_line.mesh.drawing"):
        main(["mesh", path])


@settings(max_examples=30)
@given(data=mutated())
def test_any_file_is_refused_or_examined(data, tmp_path_factory):
    path = tmp_path_factory.getbasetemp() / "mutated.iga"
    path.write_bytes(data)
    try:
        sound = examine(path, path.with_suffix(".vtu"), False, False)
    except Refusal as refusal:
        assert str(path) in str(refusal) and "\n" not in str(refusal)
        return
    assert sound in (True, False) and mesh(read_iga(path)).elements >= 1


def test_a_file_that_takes_long_says_that_it_is_at_work(tmp_path, capsys, monkeypatch):
    def slow(*given):
        time.sleep(1.3)
        return whole(*given)

    whole = mesh_command.facts_of_mesh
    monkeypatch.setattr(mesh_command, "facts_of_mesh", slow)
    monkeypatch.setattr(progress, "LINES_EVERY_SECONDS", 0.5)
    assert main(["mesh", str(small(tmp_path)), "--out", "small.vtu"]) == 0
    said = capsys.readouterr()
    assert said.err.startswith("mesh small.iga: at work") and "at work" not in said.out


@pytest.mark.parametrize(
    ("plain", "weighted", "words"),
    [
        (0.9e-10, 5.0, "1 to 9.0e-11"),
        (1.1e-10, 0.9e-10, "1 to 9.0e-11 with the weights (semi-standard), 1.1e-10 without"),
        (0.25, 1.1e-10, "misses 1 by up to 2.50e-01 (the rational functions, divided by it, add up to 1)"),
    ],
)
def test_what_functions_add_up_to_is_one_but_for_rounding(plain, weighted, words):
    assert _unity(plain, weighted) == words


def test_of_a_mesh_that_is_flat_somewhere_continuity_is_not_told(monkeypatch):
    def flat(*given):
        raise np.linalg.LinAlgError("singular")

    facts = MeshFacts(nurbs_rectangle(*[open_knots(np.array([0.0, 1.0]), 2)] * 2))
    assert facts.continuity == {"broken": 0, "C0": 0, "C1": 0, "C2": 0}
    monkeypatch.setattr(mesh_facts, "jumps", flat)
    assert MeshFacts(facts.mesh).continuity is None
