"""``solve --accuracy``: how the table is read, when a study counts instead, and that scenes meet it."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from verify.cli import main
from verify.curves.of_run import distance
from verify.methods.solve import prepare, solve
from verify.methods.zone_resolution import expected
from verify.runs.environment import machine
from verify.runs.fingerprint import source
from verify.runs.run import run
from verify.scene.by_seed.random_scenes import random_scene
from verify.scene.load import load_scene
from verify.scene.parse import parse_scene
from verify.studies.accuracy import choice
from verify.studies.accuracy.choice import CHOSEN, choose, elements_for, with_elements
from verify.studies.accuracy.levels import growth
from verify.studies.accuracy.verified import verified
from verify.support.refusal import Refusal

NOWHERE = Path("no-such-study.json")


def test_the_table_is_read_on_the_safe_side(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Errors 0.1 e^-2 and, on another scene, 0.4 e^-2 but for one mesh that is good by chance."""
    table = tmp_path / "known.csv"
    lines = ["# made up", "scene,elements,curve_error"]
    lines += [f"a,{e},{0.1 / e**2}" for e in (1, 2, 4, 8)]
    lines += [f"b,{e},{0.4 / e**2 if e != 2 else 1e-5}" for e in (1, 2, 4, 8)]
    table.write_text("\n".join(lines) + "\n")
    monkeypatch.setattr(choice, "KNOWN", table)
    assert elements_for(0.4 / 5.0**2) == pytest.approx(5.0, rel=1e-6)
    assert elements_for(0.4 / 3.0**2) == pytest.approx(3.0, rel=1e-6), "the lucky mesh does not count"
    monkeypatch.setattr(choice, "KNOWN", tmp_path / "a.csv")
    (tmp_path / "a.csv").write_text("\n".join(lines[1:6]) + "\n")
    assert elements_for(0.1 / 20.0**2) == pytest.approx(20.0, rel=1e-6), "beyond the table on with its slope"


def test_more_accuracy_takes_more_elements() -> None:
    assert np.all(np.diff([elements_for(a) for a in (0.05, 0.01, 0.003, 0.001, 0.0005)]) > 0.0)


@pytest.mark.parametrize("name", ["dcb-czm2", "peel-80"])
def test_the_mesh_has_the_elements_that_are_asked_for(name: str) -> None:
    scene = load_scene(name)
    chosen = parse_scene(scene.model_dump(), with_elements(scene, CHOSEN, 2, 3.0))
    assert 3.0 <= expected(chosen, CHOSEN).elements < 4.0
    assert chosen.effects == scene.effects and chosen.discretization.interface_points == 4


@pytest.mark.parametrize("degree", [3, 4])
def test_the_mesh_has_its_degree_through_the_arms(degree: int) -> None:
    """The coarsest mesh of `random-114` with so many elements in its zone is quadratic there, and 0.6 % off."""
    scene = random_scene(114)
    chosen = parse_scene(scene.model_dump(), with_elements(scene, CHOSEN, degree, 3.0))
    solver, problem = prepare(chosen, CHOSEN).problem
    degrees = [block.degrees for mesh in solver.build(problem).meshes for block in mesh.blocks]
    assert set(degrees) == {(degree, degree)}


def test_a_quadratic_element_is_chosen_where_the_arms_are_slender(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(choice, "predicted_seconds", lambda scene, method, iterations: 1.0)
    for seed, asked, degree in ((118, 0.003, 2), (118, 0.0005, 3), (113, 0.01, 3), (102, 0.05, 2)):
        found = choose(random_scene(seed), asked, NOWHERE)
        assert f"discretization.degree={degree}" in found.overrides, seed


def test_the_steps_are_those_of_the_scene_and_enough(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(choice, "predicted_seconds", lambda scene, method, iterations: 1.0)
    for asked, words in (("20", "steps=150"), ("400", "steps=400"), ("auto", "bend=0.003")):
        found = choose(load_scene("dcb-czm1", [f"discretization.steps={asked}"]), 0.003, NOWHERE)
        assert f"discretization.{words}" in found.overrides
        assert not any(one.startswith("effects.") for one in found.overrides)


def a_study(folder: Path, scene, **changes) -> Path:
    front = [
        {"method": "beam", "solver": "beam", "degree": 0, "dofs": 0, "curve_error": 1e-4,
         "seconds": 0.5, "overrides": []},
        {"method": "nurbs", "solver": "nurbs", "degree": 3, "dofs": 350, "curve_error": 0.008, "seconds": 1.0,
         "overrides": ["discretization.dofs=350"]},
        {"method": "tspline-adaptive", "solver": "tspline", "degree": 3, "dofs": 480, "curve_error": 0.002,
         "seconds": 2.0,
         "overrides": ["discretization.dofs=500", "effects.search=auto", "discretization.adaptive=true"]},
    ]  # fmt: skip
    known = {"scene": scene.model_dump(), "machine": machine(), "source": source(("iga", "fem_reference"))}
    path = folder / "cost.json"
    path.write_text(json.dumps({**known, "pareto": front, **changes}))
    return path


def test_a_study_of_the_same_problem_decides(tmp_path: Path) -> None:
    scene = load_scene("dcb-czm1")
    path = a_study(tmp_path, scene)
    assert choose(scene, 0.01, path).overrides == ("discretization.dofs=350",)
    found = choose(load_scene("dcb-czm1", ["discretization.dofs=3000"]), 0.003, path)
    assert (found.method, found.seconds) == ("tspline", 2.0) and "tspline-adaptive of degree 3" in found.why
    assert found.overrides == ("discretization.dofs=500", "discretization.adaptive=true"), "the effects stay"


@pytest.mark.parametrize("what", ["scene", "machine", "source", "file", "error"])
def test_another_study_does_not(what: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(choice, "predicted_seconds", lambda scene, method, iterations: 0.01 * iterations)
    scene = load_scene("dcb-czm1")
    path = a_study(tmp_path, scene, **({what: {}} if what in ("machine", "source") else {}))
    if what == "scene":
        scene = load_scene("dcb-czm1", ["interface.strength=4.1"])
    if what == "file":
        path.write_text("half a fi")
    found = choose(scene, 0.001 if what == "error" else 0.01, path)
    assert "NURBS of degree " in found.why and found.method == "nurbs"


def test_what_cannot_be_asked_for_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    for accuracy_asked in (1e-5, 0.2):
        with pytest.raises(Refusal, match=r"--accuracy: must be >= 0.05% and <= 5%"):
            choose(load_scene("dcb-czm1"), accuracy_asked, NOWHERE)
    command = ["solve", "dcb-czm1", "--accuracy", "0.3%", "--out", str(tmp_path / "out")]
    assert main([*command, "--dofs", "500"]) == main([*command, "--method", "nurbs"]) == 2
    assert "--dofs: must be left out with --accuracy" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
@pytest.mark.parametrize("name", ["dcb-czm2", "dcb-czm1-linear", "peel-80"])
def test_scenes_that_are_not_in_the_table_meet_their_accuracy_in_about_the_time(name: str, tmp_path: Path) -> None:
    scene = load_scene(name)
    first = choose(scene, 0.003, NOWHERE)
    found = verified(scene, first, 0.003, tmp_path, lambda one, method, folder, _: run(prepare(one, method), folder))
    exact = parse_scene(scene.model_dump(), (*with_elements(scene, "nurbs", 4, 12.0), "discretization.steps=300"))
    result = found.delivered.result
    assert found.holds and distance((result.opening, result.load), solve(exact, "nurbs")) <= found.reached[1]
    guess, second = (level.scene for level in found.levels[:2])
    predicted = first.seconds * (1.0 + growth(guess, second, "nurbs"))
    took = sum(level.result.seconds["total"] for level in found.levels[:2])  # without imports and checks
    assert 0.5 < took / predicted < 2.0


def test_the_time_of_a_run_is_that_of_its_beginning_and_of_its_iterations(monkeypatch: pytest.MonkeyPatch) -> None:
    """4 s for what is done once and the first step, then 0.5 s an iteration, once slower; 1 s for what comes after."""
    now, asked = [100.0], []

    def solve(scene, method, note) -> None:
        asked.append((scene.load.opening, scene.discretization.steps, scene.published, method))
        for seconds, iterations in ((4.0, 0), (1.0, 2), (1.5, 3), (9.0, 3), (2.0, 4)):
            now[0] += seconds
            note({"newton_iterations": float(iterations)})
        now[0] += 1.0

    monkeypatch.setattr(choice, "solve", solve)
    monkeypatch.setattr(choice, "perf_counter", lambda: now[0])
    scene = load_scene("dcb-czm1", ["load.opening=[1.0, 2.0, 1.5]"])
    assert choice.predicted_seconds(scene, "nurbs", 100.0) == pytest.approx(18.5 + 0.5 * (100.0 - 13.0))
    assert asked == [((0.04,), 10, (), "nurbs")], "a fiftieth of the way in ten steps"


def test_what_cannot_be_solved_here_is_passed_over(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A mesh that the scene does not take, a method that is missing or unknown; then comes the next, however slow."""
    monkeypatch.setattr("verify.methods.dolfinx.dolfinx_installed", lambda: False)

    def one(solver: str, seconds: float, *overrides: str) -> dict:
        about = {"method": solver, "degree": 3, "dofs": 500, "curve_error": 0.001}
        return {**about, "solver": solver, "seconds": seconds, "overrides": list(overrides)}

    scene, slow = load_scene("dcb-czm1"), one("nurbs", 9.0, "discretization.dofs=500")
    others = [one("nurbs", 1.0, "discretization.degree=9"), one("dolfinx", 2.0), one("bem", 3.0), one("beam", 4.0)]
    found = choose(scene, 0.01, a_study(tmp_path, scene, pareto=[slow, *others]))
    assert (found.method, found.overrides, found.seconds) == ("nurbs", ("discretization.dofs=500",), 9.0)


def test_where_no_mesh_is_fine_enough_it_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    """More unknowns than are allowed, and more elements than there may be on the way of the crack."""
    scene = load_scene("dcb-czm1", ["discretization.dofs=500"])
    chosen = parse_scene(scene.model_dump(), with_elements(scene, CHOSEN, 2, 10.0))
    made = prepare(chosen, CHOSEN)
    assert made.zone.elements >= 10.0 and made.mesh is not None and made.mesh.degree == 2
    with monkeypatch.context() as few:
        few.setattr(choice, "GUESS", replace(choice.GUESS, largest=500))
        with pytest.raises(Refusal, match="no mesh is known with 10.0 elements in the process zone of dcb-czm1"):
            with_elements(scene, CHOSEN, 2, 10.0)
    with pytest.raises(Refusal, match="no mesh is known with 10.0 elements"):
        with_elements(load_scene("dcb-czm1", ["interface.strength=1e6", "interface.penalty=1e12"]), CHOSEN, 2, 10.0)
