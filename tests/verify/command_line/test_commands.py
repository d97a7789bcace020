"""Commands and their exit codes: how studies end, where they are not begun, what is said when they cannot go on."""

from __future__ import annotations

import errno
import json
import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from iga.delamination import solution
from iga.delamination.problem import Problem
from verify.cli import NOT_WRITTEN, REFUSED, main
from verify.command_line import compare, one_run
from verify.command_line.answers import FAILED
from verify.command_line.compare import Source
from verify.command_line.tools import test as test_command
from verify.curves.read import Reading
from verify.methods.dolfinx import DOLFINX_MISSING
from verify.methods.names import Unsuitable
from verify.methods.solve import prepare
from verify.result import Result
from verify.runs.run import NO_FIELDS
from verify.scene.load import load_scene
from verify.studies import pairs
from verify.studies.accuracy import choice
from verify.studies.cost import study as cost_study
from verify.studies.effects import planned
from verify.studies.hard import suite
from verify.support.interrupts import INTERRUPTED
from verify.support.refusal import Refusal

#: The least that each study takes.
WORDS = {
    "cost": ["dcb-czm1"],
    "effects": ["dcb-czm1"],
    "hard": ["slender"],
    "vary": ["dcb-czm1", "--set", "discretization.dofs=900,600"],
}
COMMANDS = tuple(WORDS)


@pytest.fixture
def studied(monkeypatch: pytest.MonkeyPatch):
    """Studies that end at once, well or not; what they were asked for."""
    asked: list[tuple] = []

    def end(well: bool) -> list[tuple]:
        def study(found: object):
            return lambda *what: asked.append(what) or found

        monkeypatch.setattr(cost_study, "cost", study(SimpleNamespace(complete=well)))
        monkeypatch.setattr(pairs, "compared", study(SimpleNamespace(complete=well)))
        monkeypatch.setattr(suite, "hard", study(well))
        return asked

    return end


@pytest.mark.parametrize("well", [True, False])
@pytest.mark.parametrize("name", COMMANDS)
def test_a_study_ends_with_what_it_found(name: str, well: bool, studied, tmp_path: Path) -> None:
    asked, out = studied(well), tmp_path / "there" / "out"
    assert main([name, *WORDS[name], "--out", str(out)]) == (0 if well else FAILED)
    assert len(asked) == 1 and out in asked[0] and out.is_dir()


@pytest.mark.parametrize("name", ["cost", "effects"])
def test_overrides_reach_the_study_and_its_scene(name: str, studied, tmp_path: Path) -> None:
    asked = studied(True)
    assert main([name, "dcb-czm1", "--set", "interface.strength=5.0", "--out", str(tmp_path)]) == 0
    if name == "effects":
        base = asked[0][1].base
        source, scene, rest = base.source, base.scene, [list(base.overrides)]
    else:
        source, scene, *rest = asked[0]
    assert source == "dcb-czm1" and scene.interface.strength == 5.0 and ["interface.strength=5.0"] in rest


@pytest.mark.parametrize("name", COMMANDS)
def test_a_dry_run_does_nothing(name: str, studied, tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    asked, out = studied(True), tmp_path / "out"
    assert main([name, *WORDS[name], "--dry-run", "--out", str(out)]) == 0
    assert asked == [] and not out.exists() and "about " in capsys.readouterr().out


@pytest.mark.parametrize("dry", [[], ["--dry-run"]])
def test_effects_of_what_cannot_be_solved_are_not_begun(
    dry: list[str], studied, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    asked, out = studied(True), tmp_path / "out"
    turning = ["effects", "dcb-czm1", "--method", "lefm", "--set", "load.opening=[1.0, 0.5]", "--out", str(out), *dry]
    assert main(turning) == REFUSED and "must only increase" in capsys.readouterr().err
    monkeypatch.setattr("verify.methods.dolfinx.dolfinx_installed", lambda: False)
    assert main(["effects", "dcb-czm1", "--method", "dolfinx", "--out", str(out), *dry]) == FAILED
    assert DOLFINX_MISSING.split(": ")[1] in capsys.readouterr().err
    assert asked == [] and not out.exists()


def test_an_unsuitable_scene_is_a_refusal() -> None:
    with pytest.raises(Unsuitable, match="must only increase"):
        planned("dcb-czm1", load_scene("dcb-czm1", ["load.opening=[1.0, 0.5]"]), "lefm")


@pytest.mark.parametrize("name", ["cost", "effects", "vary"])
def test_a_study_is_begun_by_one_process(
    name: str, studied, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    asked = studied(True)
    monkeypatch.setattr("verify.runs.environment.mpi_size", lambda: 2)
    assert main([name, "dcb-czm1", "--out", str(tmp_path)]) == REFUSED
    assert asked == [] and "mpirun" in capsys.readouterr().err


def test_an_accuracy_becomes_a_method_and_a_mesh(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    """300 unknowns are 9 % off, 4 times as many on the next level 1 %, and so on."""
    overrides = ("discretization.dofs=300", "discretization.steps=40")
    chosen = choice.Choice("lagrange", overrides, 1.0, "Lagrange, 300 unknowns")
    asked: list[tuple] = []
    monkeypatch.setattr(choice, "choose", lambda *what: asked.append(what) or chosen)
    words = ["solve", "dcb-czm1", "--accuracy", "4%", "--set", "load.opening=0.6"]
    assert main([*words, "--fields", "--frames", "2", "--out", str(tmp_path / "out")]) == 0
    said = capsys.readouterr()
    drawn = {"fields.npz", "fields.pvd", "frames"}
    of_level_0, of_the_delivered = (
        {path.name for path in (tmp_path / "out" / name).iterdir()} for name in ("level-0", "")
    )
    assert drawn <= of_the_delivered and not drawn & of_level_0
    assert "Lagrange, 300 unknowns; with a second run on a finer mesh, to verify it, about " in said.err
    assert "level-0 took " in said.err and "level-1: degree 4 with " in said.err
    assert "peak load" in said.out and ", asked 4 %" in said.out
    scene, wanted, where = asked[0]
    assert scene.load.opening == (0.6,) and wanted == pytest.approx(0.04) and where.name == "cost.json"
    found = json.loads((tmp_path / "out" / "result.json").read_text())
    assert found["method"] == "lagrange" and found["accuracy"]["holds"] and found["accuracy"]["asked"] == 0.04
    assert found["accuracy"]["levels"][-1]["folder"] == "."
    monkeypatch.setattr("verify.runs.environment.mpi_size", lambda: 4)
    assert main([*words, "--out", str(tmp_path / "other")]) == REFUSED
    assert "--accuracy: must be asked for in 1 process, without mpirun, got 4" in capsys.readouterr().err
    assert len(asked) == 1


@pytest.mark.parametrize("name", ["solve", "cost"])
@pytest.mark.parametrize(
    ("number", "code"),
    [(errno.ENOSPC, NOT_WRITTEN), (errno.EACCES, NOT_WRITTEN), (errno.EDQUOT, NOT_WRITTEN), (errno.EBADF, None)],
)
def test_a_disk_that_takes_no_more_is_a_sentence_and_anything_else_an_error(
    name: str, number: int, code: int | None, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    def full(options) -> int:
        raise OSError(number, "it is so", "curve.csv")

    full.__module__ = name
    monkeypatch.setattr(f"verify.command_line.studies.{name}.run", full)
    if code is None:
        with pytest.raises(OSError, match="it is so"):
            main([name, "dcb-czm1"])
        return
    assert main([name, "dcb-czm1", "--out", "there"]) == code
    said = capsys.readouterr().err
    assert "curve.csv: cannot be written: it is so; " in said and "the same command again" in said


def test_the_guide_has_every_exit_code() -> None:
    page = Path(__file__).parents[3] / "docs" / "pages" / "guide" / "running.md"
    table = page.read_text().partition("## Exit codes")[2].partition("\n## ")[0]
    codes = [int(code) for code in re.findall(r"^\| (\d+) \|", table, re.MULTILINE)]
    assert codes == [0, FAILED, REFUSED, 3, NOT_WRITTEN, INTERRUPTED]


@pytest.mark.parametrize(
    ("words", "end"),
    [
        (["solve", "dcb-czm1", "--out", "there"], "in there, and the same command again starts over"),
        (["solve", "dcb-czm1"], "interrupted; the same command again starts over"),
        (["doctor"], "interrupted; the same command again starts over"),
        (["cost", "dcb-czm1", "--dry-run"], "interrupted; the same command again starts over"),
    ],
)
def test_an_interrupt_tells_how_to_go_on(
    words: list[str], end: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    def interrupted(options) -> int:
        raise KeyboardInterrupt

    interrupted.__module__ = words[0]
    folder = "tools" if words == ["doctor"] else "studies"
    monkeypatch.setattr(f"verify.command_line.{folder}.{words[0]}.run", interrupted)
    assert main(words) == INTERRUPTED
    assert capsys.readouterr().err.rstrip().endswith(end)


def test_a_result_in_words(capsys: pytest.CaptureFixture) -> None:
    steps = {"opening": np.array([0.0, 0.5, 1.0]), "load": np.array([0.0, 2.5, 1.25])}
    result = Result("nurbs", steps, status="stopped: here", ending="", seconds={"mesh": 0.5, "total": 1.25})
    one_run.print_result(result, (), Path("there"))
    said = capsys.readouterr()
    assert "peak load 2.5 at opening 0.5, 2 steps" in said.out and "seconds: mesh 0.50, total 1.25" in said.out
    assert said.out.rstrip().endswith("stopped: here: there") and "nurbs stopped: here" in said.err
    one_run.print_result(Result("nurbs", {"opening": np.zeros(0), "load": np.zeros(0)}), (), Path("there"))
    assert "peak" not in capsys.readouterr().out


def test_the_way_of_a_programme_adds_up_back_and_forth(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def made_up(prepared, folder, keep, on_step) -> None:
        for opening in (0.0, 1.0, 0.5, -0.5, 2.0):
            on_step({"opening": opening, "load": 0.0})

    gone: list[float] = []
    monkeypatch.setattr("verify.runs.run.run", made_up)
    monkeypatch.setattr("verify.support.progress.Progress.advance", lambda self, done, news: gone.append(done))
    one_run.with_progress(prepare(load_scene("dcb-czm1"), "lefm"), tmp_path, NO_FIELDS, True)
    assert gone == [0.0, 1.0, 1.5, 2.5, 5.0]


@pytest.mark.parametrize(
    ("path", "label"),
    [("a/b/curve.csv", "b/curve.csv"), ("curve.csv", "curve.csv"), ("/curve.csv", "//curve.csv"), (".", ".")],
)
def test_a_curve_is_called_by_its_name_and_that_of_its_folder(path: str, label: str) -> None:
    assert Source(Path(path), Reading()).label == label


def test_numbers_of_a_comparison_name_both_sides(tmp_path: Path) -> None:
    for name, factor in (("a", 1.01), ("b", 1.0)):
        rows = "\n".join(f"{d},{factor * d * (2 - d)}" for d in np.linspace(0, 1.5, 40))
        (tmp_path / f"{name}.csv").write_text(f"opening,load\n{rows}\n")
    sources = tuple(Source(tmp_path / f"{name}.csv", Reading()) for name in "ab")
    comparison, loads = compare.held_against(*sources, None, [0.75])
    found = compare.numbers(sources, comparison, loads, [])
    assert found["a"]["file"].endswith("a.csv") and found["b"]["file"].endswith("b.csv") and found["passed"]
    assert found["a"]["peak_load"] == pytest.approx(1.01, rel=1e-3) and found["b"]["peak_load"] == pytest.approx(
        1.0, rel=1e-3
    )
    assert found["curve_error"] == pytest.approx(0.01) and found["peak_difference"] == pytest.approx(0.01)
    assert found["loads"][0]["load_a"] == pytest.approx(1.01 * found["loads"][0]["load_b"])
    assert (found["begin"], found["end"], found["asked_end"]) == (0.0, 1.5, 1.5) and found["a"]["points"] == 40


def test_tests_are_those_of_the_copy_that_is_run(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys) -> None:
    asked: list[tuple] = []
    monkeypatch.setattr(test_command.subprocess, "call", lambda words, cwd: asked.append((words, cwd)) or 7)
    assert test_command.run(SimpleNamespace(rest=["-q", "tests/iga"])) == 7
    ((words, cwd),) = asked
    assert words[1:] == ["-m", "pytest", "-q", "tests/iga"] and (cwd / "tests" / "verify").is_dir()
    monkeypatch.setattr(test_command, "__file__", str(tmp_path / "verify" / "command_line" / "tools" / "test.py"))
    with pytest.raises(Refusal, match="the tests are not installed"):
        test_command.run(SimpleNamespace(rest=[]))
    assert len(asked) == 1


@pytest.mark.parametrize("name", COMMANDS)
def test_a_study_has_a_folder_of_its_own(name: str, studied, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked = studied(True)
    monkeypatch.chdir(tmp_path)
    assert main([name, *WORDS[name]]) == 0
    assert Path(f"debond-{name}") in asked[0] and [path.name for path in tmp_path.iterdir()] == [f"debond-{name}"]


def test_what_is_written_has_a_place_where_none_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of runs and exports one for every scene and method, or format."""
    exported: list[Path] = []
    monkeypatch.setattr("verify.export.command.export", lambda scene, kind, folder, *how: exported.append(folder) or [])
    monkeypatch.chdir(tmp_path)
    for words in ([], ["--out", "there"]):
        assert main(["export", "dcb-czm1", "--format", "csv", *words]) == 0
        assert main(["solve", "dcb-czm1", "--method", "lefm", *words]) == 0
    assert exported == [Path("debond-export/dcb-czm1-csv"), Path("there")]
    found = {path.parent.relative_to(tmp_path).as_posix() for path in tmp_path.rglob("curve.csv")}
    assert found == {"debond-out/dcb-czm1-lefm", "there"}


@pytest.mark.parametrize("name", ["dcb-czm1", "peel-60"])
def test_a_run_makes_its_problem_once(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Warnings, solver, checks and summary share it. Its mesh is looked at once, and made in the solver's time."""
    made, built, build = [], [], solution.build

    class Counted(Problem):
        def __init__(self, **keys) -> None:
            made.append(keys)
            super().__init__(**keys)

    monkeypatch.setattr("iga.delamination.problem.Problem", Counted)
    monkeypatch.setattr(solution, "build", lambda *given: built.append(given) or build(*given))
    few = ["--set", "load.opening=0.05", "--set", "discretization.steps=3"]
    main(["solve", name, "--method", "nurbs", *few, "--out", str(tmp_path)])
    assert json.loads((tmp_path / "result.json").read_text())["status"] == "complete"
    assert len(made) == 1 and len(built) == 2 and built[0][0] is built[1][0]
