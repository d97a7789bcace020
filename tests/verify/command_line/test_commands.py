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
from verify.command_line import commands, parsing, solving, tools
from verify.command_line.answers import FAILED
from verify.command_line.compare import Source
from verify.curves.read import Reading
from verify.methods.dolfinx import DOLFINX_MISSING
from verify.result import Result
from verify.studies.accuracy import choice
from verify.support.interrupts import INTERRUPTED
from verify.support.refusal import Refusal

#: Command -> what makes its study, for which a made-up one stands in, and the least that it takes.
STUDIES = {
    "cost": ("cost.study.cost", "dcb-czm1"),
    "effects": ("pairs.compared", "dcb-czm1"),
    "hard": ("hard.suite.hard", "slender"),
    "vary": ("pairs.compared", "dcb-czm1", "--set", "discretization.dofs=900,600"),
}


@pytest.mark.parametrize("name", STUDIES)
def test_a_study_ends_with_what_it_found_and_is_not_begun_in_vain(name, tmp_path, monkeypatch, capsys):
    """With what it was asked for, in a folder of its own; not for a dry run, and by one process alone."""
    monkeypatch.chdir(tmp_path)
    asked: list[tuple] = []
    made, *words = STUDIES[name]
    sets = ["--set", "interface.strength=5.0"] if name in ("cost", "effects") else []
    for well in (True, False):
        found = well if name == "hard" else SimpleNamespace(complete=well)
        monkeypatch.setattr(f"verify.studies.{made}", lambda *what, found=found: asked.append(what) or found)
        assert main([name, *words, *sets]) == (0 if well else FAILED)
    assert Path(f"debond-{name}") in asked[0] and [path.name for path in tmp_path.iterdir()] == [f"debond-{name}"]
    if sets:
        scene, overrides = (asked[0][1].base.scene, asked[0][1].base.overrides) if name == "effects" else asked[0][1:3]
        assert scene.interface.strength == 5.0 and list(overrides) == ["interface.strength=5.0"]
    asked.clear()
    capsys.readouterr()
    assert main([name, *words, "--dry-run", "--out", "there"]) == 0 and "about " in capsys.readouterr().out
    if name != "hard":
        monkeypatch.setattr("verify.runs.environment.mpi_size", lambda: 2)
        assert main([name, *words, "--out", "there"]) == REFUSED and "mpirun" in capsys.readouterr().err
    if name == "effects":
        monkeypatch.setattr("verify.runs.environment.mpi_size", lambda: 1)
        monkeypatch.setattr("verify.methods.dolfinx.dolfinx_installed", lambda: False)
        for dry in ([], ["--dry-run"]):
            assert main(["effects", "dcb-czm1", "--method", "dolfinx", "--out", "there", *dry]) == FAILED
            assert DOLFINX_MISSING.split(": ")[1] in capsys.readouterr().err
    assert asked == [] and not Path("there").exists()


def test_an_accuracy_becomes_a_method_and_a_mesh(tmp_path, monkeypatch, capsys):
    """300 unknowns are 9 % off, 4 times as many on the next level 1 %, and so on."""
    overrides = ("discretization.dofs=300", "discretization.steps=40")
    chosen = choice.Choice("lagrange", overrides, "Lagrange, 300 unknowns")
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
    assert "Lagrange, 300 unknowns; then a second run on a finer mesh, to verify it" in said.err
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
def test_a_disk_that_takes_no_more_is_a_sentence_and_anything_else_an_error(name, number, code, monkeypatch, capsys):
    def full(options) -> int:
        raise OSError(number, "it is so", "curve.csv")

    full.__name__ = name
    monkeypatch.setattr(parsing, "COMMANDS", [one._replace(run=full) for one in commands.COMMANDS if one.name == name])
    if code is None:
        with pytest.raises(OSError, match="it is so"):
            main([name, "dcb-czm1"])
        return
    assert main([name, "dcb-czm1", "--out", "there"]) == code
    said = capsys.readouterr().err
    assert "curve.csv: cannot be written: it is so; " in said and "the same command again" in said


def test_the_guide_has_every_exit_code():
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
def test_an_interrupt_tells_how_to_go_on(words, end, monkeypatch, capsys):
    def interrupted(options) -> int:
        raise KeyboardInterrupt

    interrupted.__name__ = words[0]
    command = next(one for one in commands.COMMANDS if one.name == words[0])
    monkeypatch.setattr(parsing, "COMMANDS", [command._replace(run=interrupted)])
    assert main(words) == INTERRUPTED
    assert capsys.readouterr().err.rstrip().endswith(end)


def test_a_result_in_words(capsys):
    steps = {"opening": np.array([0.0, 0.5, 1.0]), "load": np.array([0.0, 2.5, 1.25])}
    result = Result("nurbs", steps, status="stopped: here", ending="", seconds={"mesh": 0.5, "total": 1.25})
    solving.print_result(result, (), Path("there"))
    said = capsys.readouterr()
    assert "peak load 2.5 at opening 0.5, 2 steps" in said.out and "seconds: mesh 0.50, total 1.25" in said.out
    assert said.out.rstrip().endswith("stopped: here: there") and "nurbs stopped: here" in said.err
    solving.print_result(Result("nurbs", {"opening": np.zeros(0), "load": np.zeros(0)}), (), Path("there"))
    assert "peak" not in capsys.readouterr().out


def test_a_curve_is_called_by_its_name_and_that_of_its_folder():
    names = {"a/b/curve.csv": "b/curve.csv", "curve.csv": "curve.csv", "/curve.csv": "//curve.csv", ".": "."}
    assert {path: Source(Path(path), Reading()).label for path in names} == names


def test_tests_are_those_of_the_copy_that_is_run(monkeypatch, tmp_path, capsys):
    asked: list[tuple] = []
    monkeypatch.setattr(tools.subprocess, "call", lambda words, cwd: asked.append((words, cwd)) or 7)
    assert tools.test.run(SimpleNamespace(rest=["-q", "tests/iga"])) == 7
    ((words, cwd),) = asked
    assert words[1:] == ["-m", "pytest", "-q", "tests/iga"] and (cwd / "tests" / "verify").is_dir()
    monkeypatch.setattr(tools, "__file__", str(tmp_path / "verify" / "command_line" / "tools.py"))
    with pytest.raises(Refusal, match="the tests are not installed"):
        tools.test.run(SimpleNamespace(rest=[]))
    assert len(asked) == 1


def test_what_is_written_has_a_place_where_none_is_told(tmp_path, monkeypatch):
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
def test_a_run_makes_its_problem_once(name, tmp_path, monkeypatch):
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
