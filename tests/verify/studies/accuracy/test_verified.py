"""``solve --accuracy``, verified: when levels end, what is delivered and stated, and faults that must not pass."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import replace
from math import inf
from pathlib import Path

import numpy as np
import pytest

from verify.cli import main
from verify.command_line.answers import FAILED
from verify.methods.solve import prepare, solve
from verify.result import CURVE_COLUMNS, Result, steps_from_rows
from verify.runs import run as run_module
from verify.runs.run import run
from verify.scene.by_seed.random_scenes import random_scene
from verify.scene.load import load_scene
from verify.scene.parse import parse_scene
from verify.scene.schema import counted_steps
from verify.studies.accuracy import choice
from verify.studies.accuracy.choice import Choice
from verify.studies.accuracy.levels import REFINEMENT, apart, bound, finer
from verify.studies.accuracy.verified import verified
from verify.support.interrupts import INTERRUPTED
from verify.verdict import Check

FIRST = Choice("nurbs", ("discretization.dofs=300", "discretization.degree=2"), 1.0, "a guess")


def a_curve(error: float, scene, method: str, on_step=None, stop: bool = False) -> Result:
    """A parabola of which all loads are off by ``error``; half of it where the run stops."""
    x = np.linspace(0.0, 0.5 if stop else 1.0, 2 * counted_steps(scene) + 1)
    rows = []
    for t in x:
        row = dict.fromkeys(CURVE_COLUMNS, 0.0) | {"opening": t, "load": (1.0 + error) * t * (1.5 - t)}
        rows.append(row | {"load_slope": (1.0 + error) * (1.5 - 2.0 * t), "heading": 1.0})
        on_step(rows[-1])
    return Result(method, steps_from_rows(rows), status="stopped: at a wall" if stop else "complete")


@pytest.fixture
def solving(monkeypatch: pytest.MonkeyPatch) -> Callable[[Sequence[float]], None]:
    """``debond solve`` whose runs have these errors, level after level; NaN: it stops halfway, infinite: by Ctrl-C."""
    true = run_module.run
    monkeypatch.setattr(choice, "choose", lambda *_: FIRST)

    def by(errors: Sequence[float]) -> None:
        left = iter(errors)

        def made_up(scene, method: str, on_step=None) -> Result:
            error = next(left)
            if error == inf:
                raise KeyboardInterrupt
            return a_curve(np.nan_to_num(error), scene, method, on_step, stop=error != error)

        def fake(prepared, folder, keep, on_step):
            return true(prepared, folder, keep, on_step, solver=made_up)[0], ()

        monkeypatch.setattr(run_module, "run", fake)

    return by


def solved(out: Path, asked: str = "0.3%") -> tuple[int, dict]:
    code = main(["solve", "dcb-czm1", "--set", "load.opening=1.0", "--accuracy", asked, "--out", str(out)])
    return code, json.loads((out / "result.json").read_text())


def test_two_levels_that_agree_are_enough(solving, tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    solving([0.002, 0.0004])
    code, found = solved(tmp_path)
    about = found["accuracy"]
    assert code == 0 and about["holds"] and about["against"] == "level-0" and about["asked"] == 0.003
    assert about["reached"] == pytest.approx([0.0016 / 61.0, 0.0024], rel=0.02)
    assert [level["folder"] for level in about["levels"]] == ["level-0", "."]
    assert about["levels"][0]["distance"] is None and about["levels"][1]["distance"] == pytest.approx(0.0016, rel=0.02)
    assert "curve and peak load within 0.24 % (between 0.0026 % and 0.24 %), asked 0.3 %" in capsys.readouterr().out
    assert sorted(path.name for path in tmp_path.iterdir()) == ["curve.csv", "evidence.csv", "level-0", "result.json"]
    assert (tmp_path / "level-0" / "curve.csv").exists()
    assert found["scene"]["discretization"]["degree"] == 3, "the finer one is delivered"


def test_levels_go_on_until_two_agree(solving, tmp_path: Path) -> None:
    solving([0.05, 0.01, 0.004])  # the last two 0.6 % apart
    code, found = solved(tmp_path, "1%")
    assert code == 0 and found["accuracy"]["against"] == "level-1" and len(found["accuracy"]["levels"]) == 3
    (tmp_path / "mine.txt").write_text("stays")
    solving([0.0, 0.0])
    assert solved(tmp_path)[0] == 0
    names = sorted(path.name for path in tmp_path.iterdir())
    assert names == ["curve.csv", "evidence.csv", "level-0", "mine.txt", "result.json"], "earlier levels are gone"


def test_an_error_that_does_not_fall_is_not_accepted(solving, tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    solving([0.01, -0.01] * REFINEMENT.levels)
    code, found = solved(tmp_path)
    about = found["accuracy"]
    assert code == FAILED and not about["holds"] and found["status"] == "complete"
    assert len(about["levels"]) == REFINEMENT.levels and 0.02 < about["reached"][1] < 0.11
    said = capsys.readouterr().err
    assert "--accuracy: 0.3 % has not been reached: 4 levels are the most; curve and peak load within " in said


def test_an_error_that_falls_slowly_is_bounded_by_what_is_still_to_come(solving, tmp_path: Path) -> None:
    """1.2 % after distances of 0.4, 0.3 and 0.2 %: 1.5 times the last one is not enough."""
    solving([0.021, 0.017, 0.014, 0.012])
    code, found = solved(tmp_path)
    assert code == FAILED and found["accuracy"]["reached"][1] == pytest.approx(0.004, rel=0.15)
    assert [bound(0.001), bound(0.001, 0.01), bound(0.001, 0.001)] == pytest.approx([0.0015, 0.0015, 0.005])
    assert [bound(0.001, 0.00125), bound(0.0, 0.0), bound(inf)] == pytest.approx([0.004, 0.0, inf])


@pytest.mark.parametrize(("errors", "load"), [([np.nan], 0.5), ([0.02, 0.01, np.nan], 1.01 * 0.5625)])
def test_a_level_that_stops_ends_the_search(
    errors: list[float], load: float, solving, tmp_path: Path, capsys: pytest.CaptureFixture
) -> None:
    """What is delivered is the finest level that came to its end."""
    solving(errors)
    code, found = solved(tmp_path)
    assert code == FAILED and found["peak_load"] == pytest.approx(load, rel=1e-4)
    assert f"level-{len(errors) - 1} stopped: at a wall" in capsys.readouterr().err
    assert found["accuracy"]["reached"] is None if len(errors) == 1 else found["accuracy"]["against"] == "level-0"


@pytest.mark.parametrize("errors", [[inf], [0.02, inf]])
def test_an_interrupt_leaves_what_is_done(errors: list[float], solving, tmp_path: Path) -> None:
    solving(errors)
    code, found = solved(tmp_path)
    assert code == INTERRUPTED and found["status"] == "stopped: interrupted"
    assert (tmp_path / "level-0" / "curve.csv").exists() == (len(errors) == 2)


def test_a_level_with_a_broken_identity_is_refined(tmp_path: Path) -> None:
    """Its curve may be right; the mesh is too coarse for the check, or the solver is at fault on every one."""

    def by(broken: Sequence[bool]):
        left = iter(broken)

        def solve(scene, method: str, folder: Path, keep_fields: bool):
            value = 1.0 if next(left) else 0.0
            return a_curve(0.0, scene, method, lambda _: None), (Check("j", method, value, 0.5, "exact", "It holds."),)

        return solve

    scene = load_scene("dcb-czm1", ["load.opening=1.0"])
    found = verified(scene, FIRST, 0.003, tmp_path, by([True, True, False]))
    assert found.holds and len(found.levels) == 3
    found = verified(scene, FIRST, 0.003, tmp_path, by([True] * REFINEMENT.levels))
    assert not found.holds and found.reached is None and len(found.levels) == REFINEMENT.levels
    assert found.sentence == "error of the curve unknown, level-3 broken: j 1 of 0.5, asked 0.3 %"


def test_where_there_is_no_finer_mesh_it_says_so(solving, tmp_path: Path, monkeypatch, capsys) -> None:
    solving([0.02, 0.01])
    real = choice.with_elements
    tries = iter([real, real])  # one to plan, one for level 1

    def few(*what):
        return next(tries, lambda *_: real(load_scene("dcb-czm1"), "nurbs", 3, 1e5))(*what)

    monkeypatch.setattr("verify.studies.accuracy.levels.with_elements", few)
    code, found = solved(tmp_path)
    assert code == FAILED and found["accuracy"]["reached"][1] == pytest.approx(0.015, rel=0.05)
    assert "no mesh is finer than that of level-1" in capsys.readouterr().err


#: Steps so short that they leave next to no error.
PACE = "discretization.steps=150"


def test_a_wrong_thickness_is_not_shared_by_two_levels(tmp_path: Path) -> None:
    """One quadratic element through the arms of `random-114` is 0.57 % off, however many there are along."""
    scene = random_scene(114)
    first = Choice("nurbs", ("discretization.dofs=430", "discretization.degree=2", PACE), 1.0, "a guess")
    found = verified(scene, first, 0.003, tmp_path, lambda one, method, folder, _: run(prepare(one, method), folder))
    exact = solve(parse_scene(scene.model_dump(), (PACE, *choice.with_elements(scene, "nurbs", 4, 9.0))), "nurbs")
    off = [apart(level.result, exact, scene.load.opening) for level in found.levels]
    assert off[0] > 0.005 and len(off) == 3 and found.levels[1].distance > 0.005, "seen, and not accepted"
    assert found.holds and off[2] < 3e-4 and found.reached[1] < 3e-4


def test_every_level_is_finer_and_keeps_the_effects() -> None:
    scene = load_scene("dcb-czm1", ["effects.search=true", "discretization.steps=150"])
    overrides, degrees = FIRST.overrides, []
    for _ in range(5):
        now = parse_scene(scene.model_dump(), overrides)
        overrides = finer(now, "nurbs", overrides)
        then = parse_scene(scene.model_dump(), overrides)
        assert then.effects == scene.effects and then.discretization.steps > now.discretization.steps
        assert choice.expected(then, "nurbs").elements >= 1.5 * choice.expected(now, "nurbs").elements
        degrees.append(then.discretization.degree)
    assert degrees == [3, 4, 5, 5, 5]
    other = parse_scene(scene.model_dump(), finer(scene, "dolfinx", ()))
    assert (other.dolfinx.degree, other.dolfinx.elements, other.dolfinx.layers) == (3, 168, 1)
    other = parse_scene(scene.model_dump(), finer(scene, "dolfinx", ("dolfinx.degree=4",)))
    last = parse_scene(other.model_dump(), finer(parse_scene(scene.model_dump(), ["dolfinx.degree=4"]), "dolfinx", ()))
    assert (last.dolfinx.degree, last.dolfinx.layers) == (4, 2), "what cannot have a higher degree has more layers"
    chosen = load_scene("dcb-czm1", ['discretization.steps="auto"'])
    for method in ("tspline", "dolfinx"):
        assert finer(chosen, method, ())[0] == f"discretization.bend={0.005 / 1.1**2!r}"


def test_curves_of_programmes_are_apart_by_their_worst_leg() -> None:
    """An unloading that is stiffer by 5 % shows in no envelope."""
    d = np.concatenate([np.linspace(0.0, 1.0, 50), np.linspace(1.0, 0.2, 50)[1:], np.linspace(0.2, 2.0, 50)[1:]])
    P = np.minimum(d, 1.0)
    P[50:99] *= 1.05

    def result(load: np.ndarray) -> Result:
        rows = [dict.fromkeys(CURVE_COLUMNS, 0.0) | {"opening": x, "load": y} for x, y in zip(d, load, strict=True)]
        return Result("nurbs", steps_from_rows(rows))

    programme = (1.0, 0.2, 2.0)
    assert apart(result(P), result(np.minimum(d, 1.0)), programme) == pytest.approx(0.05, rel=0.1)
    assert apart(result(P), result(P), programme) == 0.0
    half = replace(result(P), steps={key: value[:60] for key, value in result(P).steps.items()})
    assert apart(half, result(P), programme) == apart(result(P), half, programme) == inf
    assert apart(replace(half, steps={key: value[:1] for key, value in half.steps.items()}), result(P), (1.0,)) == inf


def test_peaks_are_apart_in_parts_of_the_peak_whatever_pressed_faces_bear() -> None:
    d = np.concatenate([np.linspace(0.0, -0.01, 9), np.linspace(-0.01, 0.0, 9)[1:], np.linspace(0.0, 2.0, 99)[1:]])
    P, top = np.where(d < 0.0, 1e4 * d, np.minimum(d, 1.0)), np.where(np.arange(d.size) == 100, 1.05, 1.0)
    one, other = (Result("", {"opening": d, "load": load}) for load in (top * P, P))
    assert apart(one, other, (-0.01, 2.0)) == pytest.approx(0.05)


def test_a_closing_programme_is_drawn_without_swinging_beyond_its_turn() -> None:
    """Contact makes the slope a thousand times as steep within a step, and its cubic leaves the programme by 0.2."""
    opening = ["load.opening=[1.0, -0.004, 1.5]", "discretization.dofs=400", "discretization.steps=150"]
    runs = [solve(load_scene("dcb-czm1-linear", [*opening, f"discretization.degree={p}"]), "nurbs") for p in (2, 3)]
    assert apart(runs[1], runs[0], (1.0, -0.004, 1.5)) < 0.02
