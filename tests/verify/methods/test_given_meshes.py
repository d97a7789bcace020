"""Meshes from files: the bodies of the scene, or a sentence that says where they are not."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from iga_files import from_mesh

from iga.delamination.meshes import drawn
from iga.delamination.on_base import tmeshes as peel_tmeshes
from iga.files.iga_format import write_iga
from iga.mesh.extraction import Mesh
from iga.tsplines.tspline import tspline_rectangle
from verify import verification
from verify.cli import REFUSED, main
from verify.methods.given_meshes import OWN, given_meshes, own_mesh
from verify.methods.names import METHODS
from verify.methods.solve import prepare, require, solve
from verify.scene.load import load_scene
from verify.scene.schema import Scene
from verify.studies import one_scene
from verify.support.refusal import Refusal
from verify.verdict import SceneReport

DCB = ("discretization.dofs=400", "load.opening=0.5", "discretization.steps=4")


@pytest.fixture(scope="module")
def arms():
    return drawn(prepare(load_scene("dcb-czm1", DCB), "tspline").problem[1]).meshes


def written(folder: Path, *meshes: Mesh) -> list[str]:
    files = [folder / f"body-{i}.iga" for i in range(len(meshes))]
    for file, mesh in zip(files, meshes, strict=True):
        write_iga(from_mesh(mesh), file)
    return [str(file) for file in files]


def scene_with(files: list[str], name: str = "dcb-czm1", *overrides: str) -> Scene:
    return load_scene(name, [f"specimen.mesh={json.dumps(files)}", *overrides])


def alike(found: Mesh, mesh: Mesh) -> bool:
    """The same control points, in whatever order."""
    points = [np.unique(np.round(one.P_AI, 7) + 0.0, axis=0) for one in (found, mesh)]
    return points[0].shape == points[1].shape and np.allclose(*points, atol=1e-6)


def test_two_files_are_both_arms_and_one_is_mirrored(arms, tmp_path):
    moved = [replace(arm, P_AI=arm.P_AI + [0.0, 0.9e-6 * 14.0]) for arm in arms]  # a millionth is the tolerance
    assert len(given_meshes(scene_with(written(tmp_path, *moved)))) == 2
    upper, lower = given_meshes(scene_with(written(tmp_path, *arms)))
    assert alike(upper, arms[0]) and alike(lower, arms[1])
    assert upper.P_AI[:, 1].min() == pytest.approx(0.0, abs=1e-9) and lower.P_AI[:, 1].max() == pytest.approx(
        0.0, abs=1e-9
    )
    alone, image = given_meshes(scene_with(written(tmp_path, arms[0])))
    assert alike(alone, arms[0])
    assert alike(replace(image, P_AI=image.P_AI * [1.0, -1.0]), arms[0])
    assert given_meshes(load_scene("dcb-czm1")) == ()


def test_the_load_is_that_of_the_mesh_that_was_made(arms, tmp_path):
    """But for the points of its elements, of which a mesh that is given has more."""
    given = solve(scene_with(written(tmp_path, *arms), "dcb-czm1", *DCB), "tspline")
    made = solve(load_scene("dcb-czm1", DCB), "tspline")
    assert given.dofs == made.dofs and given.complete
    assert given.load == pytest.approx(made.load, rel=2e-3)


def test_bodies_of_a_peel(tmp_path):
    problem = prepare(load_scene("peel-60", ["discretization.dofs=1200"]), "tspline").problem[1]
    bodies = tuple(tspline_rectangle(mesh) for mesh in peel_tmeshes(problem))
    found = given_meshes(scene_with(written(tmp_path, *bodies), "peel-60"))
    assert all(alike(one, body) for one, body in zip(found, bodies, strict=True))
    with pytest.raises(Refusal, match=r"its left side must lie on X = 0, got 10$"):
        given_meshes(
            scene_with(written(tmp_path, replace(bodies[0], P_AI=bodies[0].P_AI + [10.0, 0.0]), bodies[1]), "peel-60")
        )


def test_a_mesh_of_another_specimen_is_refused(arms, tmp_path):
    """By a tenth more than the millionth that is allowed; others are in `tests/iga/delamination/test_given.py`."""
    other = replace(arms[0], P_AI=arms[0].P_AI + [0.0, 1.1e-6 * 14.0])
    files = written(tmp_path, other, arms[1])
    for act in (given_meshes, lambda scene: require(prepare(scene, "tspline"))):
        with pytest.raises(Refusal, match="specimen.mesh: .*body-0.iga: its bottom side must lie on Y = 0"):
            act(scene_with(files))


@pytest.mark.parametrize("method", [name for name in METHODS if name != "tspline"])
def test_a_method_that_takes_no_files_refuses_them(method, arms, tmp_path):
    for files in (written(tmp_path, *arms), [str(tmp_path / "none.iga")]):
        with pytest.raises(Refusal, match=rf"specimen.mesh: must be left out .* for {method}, which takes no mesh"):
            require(prepare(scene_with(files), method))
        assert own_mesh(scene_with(files)) == load_scene("dcb-czm1", [OWN]) == load_scene("dcb-czm1")


@pytest.mark.parametrize(
    "command",
    ["solve", "solve --method tspline", "solve --method beam", "solve --accuracy 1%", "effects", "cost"]
    + ["effects --method tspline", "export --format gmsh", "cost --dry-run", "effects --dry-run"],
)
def test_a_missing_file_is_refused_before_any_work(command, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    name, *options = command.split()
    assert main([name, "dcb-czm1", *options, "--set", 'specimen.mesh="none.iga"']) == REFUSED
    assert "specimen.mesh: " in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_what_is_no_mesh_is_refused(tmp_path):
    file = tmp_path / "absent.iga"
    for words in ("cannot read .*absent.iga: No such file", ".*absent.iga"):
        with pytest.raises(Refusal, match=f"specimen.mesh: {words}"):
            given_meshes(scene_with([str(file)]))
        file.write_text("type plane\nnodeN three\n")


def scene_file(folder: Path, mesh: object) -> str:
    """The linear scene on a small mesh of four steps."""
    overrides = (*DCB, "dolfinx.elements=20", "effects.kinematics=linear")
    scene = load_scene("dcb-czm1-linear", overrides).model_dump(exclude={"published", "name"}, exclude_defaults=True)
    scene["specimen"]["mesh"] = mesh
    lines = [f"{key} = {_toml(value)}" for key, value in scene.items()]
    (folder / "mine.toml").write_text("\n".join(lines) + "\n")
    return str(folder / "mine.toml")


def _toml(value: object) -> str:
    if isinstance(value, dict):
        return f"{{ {', '.join(f'{key} = {_toml(one)}' for key, one in value.items())} }}"
    return json.dumps(value)


def test_verify_holds_the_mesh_against_methods_on_meshes_of_their_own(arms, tmp_path, monkeypatch):
    """Both arms from files are solved as two, the others as the scene without files would be."""
    seen: list[SceneReport] = []
    monkeypatch.setattr(verification, "write_page", lambda module, findings, *others: seen.extend(findings.reports))
    every = one_scene.planned
    few = ("tspline", "nurbs", "lefm")
    monkeypatch.setattr(verification, "planned", lambda *what: [job for job in every(*what) if job.variant in few])
    source = scene_file(tmp_path, [Path(file).name for file in written(tmp_path, *arms)])
    scene = load_scene(source)
    verification.verify(verification.Subjects([(source, scene)]), tmp_path / "out", 1)
    (report,) = seen
    runs = {run.method: run for run in report.runs}
    assert set(runs) == set(few) and all(run.result is not None and run.result.complete for run in runs.values())
    assert "specimen.mesh=[]" in runs["nurbs"].command and "specimen.mesh=[]" not in runs["tspline"].command
    assert (runs["tspline"].scene, runs["nurbs"].scene) == (scene, own_mesh(scene))
    assert "specimen.mesh: the mesh of tspline alone; nurbs, lefm ran without it" in report.remarks
