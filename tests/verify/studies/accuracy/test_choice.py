"""``solve --accuracy``: the meshes that are chosen, and when a study counts instead."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from verify.cli import main
from verify.methods.solve import prepare
from verify.methods.zone_resolution import expected
from verify.runs.environment import machine
from verify.runs.fingerprint import source
from verify.scene.by_seed.random_scenes import random_scene
from verify.scene.load import load_scene
from verify.scene.parse import parse_scene
from verify.studies.accuracy import choice
from verify.studies.accuracy.choice import CHOSEN, choose, finer, with_elements
from verify.support.refusal import Refusal

NOWHERE = Path("no-such-study.json")


@pytest.mark.parametrize(("scene", "degree"), [("dcb-czm2", 2), ("peel-80", 2), (114, 3), (114, 4)])
def test_the_mesh_has_the_elements_that_are_asked_for_and_its_degree_through_the_arms(scene, degree):
    """The coarsest mesh of `random-114` with so many elements in its zone is quadratic there, and 0.6 % off."""
    scene = random_scene(scene) if isinstance(scene, int) else load_scene(scene)
    chosen = parse_scene(scene.model_dump(), with_elements(scene, CHOSEN, degree, 3.0))
    assert 3.0 <= expected(chosen, CHOSEN).elements < (4.0 if degree == 2 else 30.0) and chosen.effects == scene.effects
    solver, problem = prepare(chosen, CHOSEN).problem
    assert {block.degrees for mesh in solver.build(problem).meshes for block in mesh.blocks} == {(degree, degree)}


@pytest.mark.parametrize(
    ("scene", "asked", "words"),
    [
        *((random_scene(seed), a, f"degree={p}") for seed, a, p in ((118, 5e-4, 3), (118, 3e-3, 2), (113, 1e-2, 3))),
        *((load_scene("dcb-czm1", [f"discretization.steps={n}"]), 0.003, words)
          for n, words in (("20", "steps=150"), ("400", "steps=400"), ("auto", "bend=0.003"))),
    ],
)  # fmt: skip
def test_a_quadratic_element_is_chosen_for_slender_arms_and_steps_are_enough(scene, asked, words):
    found = choose(scene, asked, NOWHERE)
    assert f"discretization.{words}" in found.overrides and "NURBS of degree " in found.why
    assert not any(one.startswith("effects.") for one in found.overrides)


def front(solver: str, seconds: float, *overrides: str, error: float = 0.001) -> dict:
    about = {"method": solver, "degree": 3, "dofs": 500, "curve_error": error}
    return {**about, "solver": solver, "seconds": seconds, "overrides": list(overrides)}


def a_study(folder: Path, scene, **changes) -> Path:
    moving = "discretization.dofs=500", "effects.search=auto", "discretization.adaptive=true"
    pareto = [
        front("nurbs", 9.0, "discretization.dofs=500"),
        front("nurbs", 0.6, "discretization.degree=9"),
        front("dolfinx", 0.7), front("bem", 0.8), front("beam", 0.5),
        front("nurbs", 1.0, "discretization.dofs=350", error=0.008),
        front("tspline", 2.0, *moving),
    ]  # fmt: skip
    known = {"scene": scene.model_dump(), "machine": machine(), "source": source(("iga", "fem_reference"))}
    path = folder / "cost.json"
    path.write_text(json.dumps({**known, "pareto": pareto, **changes}))
    return path


def test_a_study_of_the_same_problem_decides(tmp_path):
    """By the quickest run that the scene and this machine can have: no unknown degree or method, no beam."""
    scene = load_scene("dcb-czm1")
    path = a_study(tmp_path, scene)
    assert choose(scene, 0.01, path).overrides == ("discretization.dofs=350",)
    found = choose(load_scene("dcb-czm1", ["discretization.dofs=3000"]), 0.003, path)
    assert found.method == "tspline" and "tspline of degree 3" in found.why
    assert found.overrides == ("discretization.dofs=500", "discretization.adaptive=true"), "the effects stay"


@pytest.mark.parametrize("what", ["scene", "machine", "source", "file", "error"])
def test_another_study_does_not(what, tmp_path):
    path = a_study(tmp_path, load_scene("dcb-czm1"), **({what: {}} if what in ("machine", "source") else {}))
    if what == "file":
        path.write_text("half a fi")
    scene = load_scene("dcb-czm1", ["interface.strength=4.1"] if what == "scene" else [])
    assert "elements in the process zone" in choose(scene, 0.0008 if what == "error" else 0.01, path).why


def test_what_cannot_be_asked_for_is_refused(tmp_path, monkeypatch, capsys):
    """Among it more unknowns than are allowed, and more elements than there may be on the way of the crack."""
    scene = load_scene("dcb-czm1", ["discretization.dofs=500"])
    for asked in (1e-5, 0.2):
        with pytest.raises(Refusal, match=r"--accuracy: must be >= 0.05% and <= 5%"):
            choose(scene, asked, NOWHERE)
    command = ["solve", "dcb-czm1", "--accuracy", "0.3%", "--out", str(tmp_path / "out")]
    assert main([*command, "--dofs", "500"]) == main([*command, "--method", "nurbs"]) == 2
    assert "--dofs: must be left out with --accuracy" in capsys.readouterr().err and not (tmp_path / "out").exists()
    with_elements(scene, CHOSEN, 2, 10.0)
    stiff = load_scene("dcb-czm1", ["interface.strength=1e6", "interface.penalty=1e12"])
    for one, largest in ((scene, 500), (stiff, choice.GUESS.largest)):
        monkeypatch.setattr(choice, "GUESS", replace(choice.GUESS, largest=largest))
        with pytest.raises(Refusal, match="no mesh is known with 10.0 elements in the process zone of dcb-czm1"):
            with_elements(one, CHOSEN, 2, 10.0)


def test_every_level_is_finer_and_keeps_the_effects():
    scene = load_scene("dcb-czm1", ["effects.search=true", "discretization.steps=150"])
    overrides, degrees = ("discretization.dofs=300", "discretization.degree=2"), []
    for _ in range(5):
        now = parse_scene(scene.model_dump(), overrides)
        overrides = finer(now, "nurbs", overrides)
        then = parse_scene(scene.model_dump(), overrides)
        assert then.effects == scene.effects and then.discretization.steps > now.discretization.steps
        assert expected(then, "nurbs").elements >= 1.5 * expected(now, "nurbs").elements
        degrees.append(then.discretization.degree)
    assert degrees == [3, 4, 5, 5, 5]
    chosen = load_scene("dcb-czm1", ['discretization.steps="auto"'])
    assert finer(chosen, "tspline")[0] == f"discretization.bend={0.005 / 1.1**2!r}"
