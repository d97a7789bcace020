"""The command line: exit codes, words for what is wrong, files for what is right."""

from __future__ import annotations

import json
import os
import shlex
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from verify.cli import main, parser
from verify.command_line.completion import Command, commands
from verify.command_line.spelling import parsed
from verify.methods import dolfinx, names
from verify.methods.plugins import plugins
from verify.support.refusal import one_of
from verify.theory import lefm

PROJECT = Path(__file__).resolve().parents[2]
PROGRAM = [sys.executable, "-P", "-m", "verify"]
ENVIRONMENT = os.environ | {"PYTHONPATH": str(PROJECT)}
CURVE = "opening,load\n0,0\n1,2\n3,1\n"

BUILT_IN = "tspline nurbs lagrange dolfinx beam lefm".split()

#: command line -> what its message must say
REFUSED = {
    "": "COMMAND",
    "nosuch": "nosuch: is no command; the commands are verify,",
    "sovle dcb-czm1": 'sovle: is no command; did you mean "solve"?',
    "solve dcb-czm1 --metod nurbs": '--metod: is no option of solve; did you mean "--method"',
    "solve dcb-czm1 nurbs": "nurbs: is more than solve takes",
    "solve dcb-czm1 --set strength=4": 'strength: is not a key of a scene, got 4; did you mean "interface.strength"?',
    "solve dcb-czm1 --set load.strength=4": 'did you mean "interface.strength"?',
    "solve dcb-czm1 --set interfce.strength=4": 'did you mean "interface"?',
    "solve dcb-czm1 --set specimen.mesh=5": "specimen.mesh: must be a file name, or a list of two, got 5",
    "effects dcb-czm1 --method nubrs": 'did you mean "nurbs"?',
    "hard coarse-cmz2": 'coarse-cmz2: is no hard case; did you mean "coarse-czm2"?',
    "solve": "SCENE",
    "solve dcb-czm3": 'did you mean "dcb-czm2"',
    "solve /dev/null": "specimen: is missing",
    "solve missing.toml": "is neither a packaged scene nor a file",
    "solve broken.toml": "broken.toml:1",
    "solve dcb-czm1 --method fem": f"--method: must be {one_of([*BUILT_IN, *plugins()])}, got 'fem'",
    "solve dcb-czm1 --method nubrs": 'did you mean "nurbs"?',
    "solve dcb-czm1 --method tsplines": 'did you mean "tspline"?',
    "solve dcb-czm1 --method tspline --set discretization.degree=2": "degree: must be 3 for tspline, got 2",
    "solve dcb-czm1 --dofs 0": "argument --dofs: must be an integer >= 1, got '0'",
    "solve dcb-czm1 --dofs many": "argument --dofs: must be an integer >= 1, got 'many'",
    "solve dcb-czm1 --dofs 30": 'discretization.dofs: must be an integer >= 40 and <= 1000000, or "auto", got 30',
    "solve dcb-czm1 --dofs 79": "discretization.dofs: must be >= 80 for nurbs of degree 3, got 79",
    "solve dcb-czm1 --method lagrange --dofs 111": "discretization.dofs: must be >= 112 for lagrange of degree 3, got",
    "solve dcb-czm1 --dofs 80 --set load.opening=0.3": (
        "discretization.dofs: a mesh of this basis and degree needs at least 96 unknowns, got 80"
    ),
    "solve dcb-czm1 --method beam --dofs 500": (
        '--dofs: is only for --method "tspline", "nurbs" or "lagrange", got 500 for beam'
    ),
    "solve dcb-czm1 --set interface.strength=-4": "interface.strength: must be > 0, got -4",
    "solve dcb-czm1 --set interface.strength": "--set interface.strength: must be KEY=VALUE",
    "solve dcb-czm1 --method lefm --set load.opening=[1.0,0.5]": (
        "load.opening: must only increase for the method lefm, got [1.0, 0.5]"
    ),
    "solve dcb-czm1 --set discretization.interface_rule='lumped' --set discretization.mismatch=2": (
        'discretization.interface_rule: must be "gauss" or "lobatto" on meshes that do not match along the interface'
    ),
    "solve dcb-czm1 --method lefm --out a-file": "--out: must be a folder that can be written to, got 'a-file'",
    "solve dcb-czm1 --colour red": "--colour",
    "solve peel-60 --method dolfinx --set dolfinx.elements=2": (
        "dolfinx.elements: must be >= 3, one on each part of the specimen, got 2"
    ),
    "verify dcb-czm1 dcb-czm3": "dcb-czm3:",
    "verify dcb-czm1 dcb-czm1": "SCENE: must have different names, got 'dcb-czm1' more than once",
    "verify --jobs 0": "argument --jobs: must be an integer >= 1, got '0'",
    "verify dcb-czm1 --out a-file/below": "--out: must be a folder",
    "compare curve.csv": "B",
    "compare /dev/null /dev/null": "must hold a curve of at least 2 points",
    "compare curve.csv missing.csv": "missing.csv: must be a file with a curve",
    "compare curve.csv other.csv": "other.csv:1: the header must name load, got opening, weight",
    "compare curve.csv holes.csv": "holes.csv:3: column 'load' must be a finite number, got ''",
    "compare curve.csv point.csv": "point.csv: must hold at least 2 points of different opening",
    "compare curve.csv curve.csv --tolerance -1": "argument --curve-tol/--tolerance: must be a number >= 0, got '-1'",
    "scenes all": "is neither a packaged scene nor a file",
    "doctor all": "all: is more than doctor takes",
}


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "broken.toml").write_text("[specimen\n")
    (tmp_path / "a-file").write_text("")
    (tmp_path / "curve.csv").write_text(CURVE)
    (tmp_path / "other.csv").write_text("opening,weight\n0,0\n1,2\n")
    (tmp_path / "holes.csv").write_text("opening,load\n0,0\n1\n")
    (tmp_path / "point.csv").write_text("opening,load\n1,1\n1,2\n")
    return tmp_path


def exit_code(arguments: list[str]) -> int:
    try:
        return main(arguments)
    except SystemExit as end:  # argparse
        return int(end.code or 0)


def as_process(*arguments: str, **environment: str) -> subprocess.CompletedProcess:
    command = [*PROGRAM, *arguments]
    return subprocess.run(command, capture_output=True, text=True, timeout=300, env=ENVIRONMENT | environment)


@pytest.mark.parametrize("line", REFUSED)
def test_bad_input_is_refused_before_any_work(line: str, folder: Path, capsys: pytest.CaptureFixture) -> None:
    before = sorted(folder.rglob("*"))
    assert exit_code(line.split()) == 2
    said = capsys.readouterr()
    assert REFUSED[line] in said.err
    assert "Traceback" not in said.err and said.out == ""
    assert sorted(folder.rglob("*")) == before


def test_the_smallest_mesh_is_the_one_that_the_solver_takes() -> None:
    from iga.bases.names import BASES
    from iga.delamination.meshes import drawn
    from verify.methods.solve import prepare
    from verify.scene.load import load_scene

    for method in names.WITH_DOFS:
        for degree in BASES[method].degrees:
            _, problem = prepare(load_scene("dcb-czm1"), method).problem
            least = BASES[method].least_dofs(degree)
            drawn(replace(problem, degree=degree, dofs=least))
            with pytest.raises(ValueError, match="unknowns"):
                drawn(replace(problem, degree=degree, dofs=least - 1))


@pytest.mark.parametrize("columns", [40, 200])
@pytest.mark.parametrize("command", [None, *commands(parser())], ids=lambda command: command.name if command else "")
def test_help_ends_with_an_example_that_can_be_typed(
    command: Command | None, columns: int, capsys: pytest.CaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", str(columns))
    assert exit_code([*([command.name] if command else []), "--help"]) == 0
    said = capsys.readouterr().out
    example, leaves = said.splitlines()[-2:]
    assert example.startswith("example: debond ") and leaves.startswith("         # ")
    words = shlex.split(example.removeprefix("example: debond ").partition(" > ")[0])
    assert command is None or words[0] == command.name
    if words[0] != "test":  # pytest reads those
        assert parsed(parser(), words).command.__module__.endswith(f".{words[0]}")
    assert "\x1b" not in said


def test_solve_writes_a_folder(folder: Path, capsys: pytest.CaptureFixture) -> None:
    assert main(["solve", "dcb-czm1-linear", "--method", "lefm", "--set", "load.opening=1.5"]) == 0
    out = folder / "debond-out" / "dcb-czm1-linear-lefm"
    about = json.loads((out / "result.json").read_text())
    assert about["method"] == "lefm" and about["scene"]["load"]["opening"] == [1.5]
    assert np.loadtxt(out / "curve.csv", delimiter=",", skiprows=1)[-1, 0] == 1.5
    assert capsys.readouterr().out.splitlines()[-1] == "complete: debond-out/dcb-czm1-linear-lefm"


def test_a_scene_of_ones_own_is_a_path(folder: Path) -> None:
    text = (PROJECT / "verify" / "scene" / "scenes" / "dcb-czm1.toml").read_text()
    (folder / "own.toml").write_text(text.replace("dcb-czm1", "dcb-own"))
    assert main(["solve", "own.toml", "--method", "lefm", "--out", "here"]) == 0
    assert json.loads((folder / "here" / "result.json").read_text())["scene"]["name"] == "dcb-own"


def test_a_mesh_is_no_scene(folder: Path, capsys: pytest.CaptureFixture) -> None:
    assert main(["verify", "a plate.iga", "dcb-czm1"]) == 2
    said = capsys.readouterr().err
    assert "debond mesh 'a plate.iga' examines it" in said and "specimen.mesh" in said


def test_a_run_that_stops_early_exits_with_one(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    def stops(*args: object) -> lefm.Solution:
        return lefm.Solution(whole(*args).rows[:20], "stopped: for no reason")

    whole = lefm.solve
    monkeypatch.setattr(lefm, "solve", stops)
    assert main(["solve", "dcb-czm1-linear", "--method", "lefm", "--out", "here"]) == 1
    assert json.loads((folder / "here" / "result.json").read_text())["status"] == "stopped: for no reason"
    assert "stopped: for no reason" in capsys.readouterr().err


def test_a_specimen_that_separates_is_complete(folder: Path, capsys: pytest.CaptureFixture) -> None:
    assert main(["solve", "dcb-czm1-linear", "--method", "lefm", "--set", "load.opening=20", "--out", "here"]) == 0
    about = json.loads((folder / "here" / "result.json").read_text())
    assert about["status"] == "complete" and about["ending"].startswith("separated at opening ")
    assert capsys.readouterr().out.splitlines()[-1].startswith("complete, separated at opening ")


def test_without_dolfinx_there_is_a_sentence_and_three_ways(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    monkeypatch.setattr(dolfinx, "find_spec", lambda name: None)
    assert main(["solve", "dcb-czm1", "--method", "dolfinx"]) == 1
    said = capsys.readouterr().err
    assert "not run: DOLFINx is not installed" in said
    assert all(word in said for word in ("conda", "Docker", "Debian"))
    assert not (folder / "debond-out").exists()


def test_compare_judges_by_the_tolerance(folder: Path, capsys: pytest.CaptureFixture) -> None:
    (folder / "more.csv").write_text("# my code\nforce;load;opening\n9;0;0\n9;2.02;1\n9;1.01;3\n")
    (folder / "bare.txt").write_text("0 0\n1 2\n3 1\n")
    assert main(["compare", "more.csv", "curve.csv"]) == 0
    said = capsys.readouterr().out.splitlines()
    assert said[1].split() == ["curve", "error", "1", "%"] and said[2].split()[2:] == ["2.02", "2", "+1", "%"]
    assert main(["compare", "more.csv", "curve.csv", "--tolerance", "0.011"]) == 0
    assert main(["compare", "more.csv", "curve.csv", "--tolerance", "0.009"]) == 1
    assert main(["compare", "bare.txt", "curve.csv", "--tolerance", "0"]) == 0


def test_compare_takes_the_folder_of_a_run(folder: Path) -> None:
    main(["solve", "dcb-czm1", "--method", "lefm", "--out", "run"])
    assert main(["compare", "run", "run/curve.csv", "--tolerance", "0"]) == 0


def test_scenes_and_doctor_tell_what_there_is(capsys: pytest.CaptureFixture) -> None:
    assert main(["scenes"]) == 0
    assert capsys.readouterr().out.count("\ndcb-czm") == 4
    assert main(["doctor"]) == 0
    said = capsys.readouterr().out
    assert "numpy" in said and "dolfinx" in said


def test_an_interrupt_leaves_a_sentence_and_valid_files(tmp_path: Path) -> None:
    command = [*PROGRAM, "solve", "dcb-czm1", "--method", "beam", "--out", str(tmp_path)]
    command += ["--set", "discretization.steps=2000"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=ENVIRONMENT)
    curve, deadline = tmp_path / "curve.csv", time.monotonic() + 120
    while time.monotonic() < deadline and not (curve.exists() and curve.read_text().count("\n") > 5):
        time.sleep(0.02)
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=60)
    assert process.returncode == 130
    assert "interrupted" in said and "Traceback" not in said
    assert json.loads((tmp_path / "result.json").read_text())["status"] == "stopped: interrupted"
    assert np.loadtxt(curve, delimiter=",", skiprows=1).shape[1] == 7


def test_no_traceback_in_a_process_of_its_own(tmp_path: Path) -> None:
    bad = as_process("solve", "dcb-czm1", "--set", "interface.strength=-4", "--out", str(tmp_path / "o"))
    assert bad.returncode == 2 and "Traceback" not in bad.stderr
    assert as_process("solve", "dcb-czm1", "--method", "lefm", "--out", str(tmp_path / "o")).returncode == 0


def test_under_mpi_only_the_first_rank_writes(tmp_path: Path) -> None:
    many = {"OMPI_COMM_WORLD_SIZE": "2", "OMPI_COMM_WORLD_RANK": "1"}
    refused = as_process("solve", "dcb-czm1", "--method", "nurbs", "--out", str(tmp_path), **many)
    assert refused.returncode == 2 and "--method: must be dolfinx under mpirun" in refused.stderr
    assert as_process("verify", **many).returncode == 2
    one = (
        "from pathlib import Path; from verify.runs.run import run; from verify.scene.load import load_scene\n"
        "from verify.methods.solve import prepare\n"
        f"run(prepare(load_scene('dcb-czm1'), 'lefm'), Path({str(tmp_path / 'rank1')!r}))"
    )
    assert subprocess.run([sys.executable, "-c", one], env=ENVIRONMENT | many).returncode == 0
    assert not (tmp_path / "rank1").exists()


def test_a_reader_that_leaves_is_no_error() -> None:
    line = f"{shlex.join(PROGRAM)} scenes | true"
    ended = subprocess.run(["bash", "-c", line], capture_output=True, text=True, env=ENVIRONMENT)
    assert ended.stderr == ""


#: command line -> what its options are where they are not told
UNSAID = {
    "verify": {
        "scenes": [], "out": Path("debond-report"), "full": False, "curves": [], "opening": None, "load": None,
        "opening_scale": 1.0, "load_scale": 1.0, "format": "html", "include": [], "scheduler": None, "dry_run": False,
    },
    "solve S": {
        "method": None, "dofs": None, "accuracy": None, "overrides": [], "out": None, "fields": False, "frames": 30,
    },
    "cost S": {"overrides": [], "out": Path("debond-cost"), "dry_run": False},
    "effects S": {"method": "nurbs", "overrides": [], "out": Path("debond-effects"), "scheduler": None},
    "validate S": {
        "method": "nurbs", "overrides": [], "out": Path("debond-validation"), "scheduler": None, "curves": [], "at": [],
        "opening": None, "load": None, "opening_scale": 1.0, "load_scale": 1.0, "dry_run": False,
    },
    "certify S": {
        "at": [], "overrides": [], "out": Path("debond-certified"), "keep": False, "scheduler": None, "dry_run": False,
    },
    "vary S": {"method": "nurbs", "overrides": [], "out": Path("debond-vary"), "ranks": [1], "dry_run": False},
    "hard": {"names": [], "out": Path("debond-hard"), "scheduler": None, "dry_run": False},
    "compare A B": {
        "a": Path("A"), "b": Path("B"), "opening_a": None, "load_a": None, "opening_scale_a": 1.0, "load_scale_b": 1.0,
        "load_scale_a": 1.0, "opening_scale_b": 1.0, "end": None, "begin": None, "at": [], "curve_tol": None,
        "peak_tol": None, "energy_tol": None, "out": None,
    },
    "export S --format vtu": {"format": "vtu", "elements": None, "layers": None, "overrides": [], "out": None},
    "mesh F": {"file": Path("F"), "out": None, "json": False, "control": False},
    "scenes": {"scenes": []},
    "test": {"rest": []},
}  # fmt: skip


@pytest.mark.parametrize("words", UNSAID)
def test_what_is_not_told_is_as_the_help_says(words: str) -> None:
    found = vars(parsed(parser(), words.split()))
    assert {name: found[name] for name in UNSAID[words]} == UNSAID[words]
    assert found["command"].__module__.endswith(f".{words.split()[0]}")
    assert found.get("jobs", os.cpu_count()) == os.cpu_count(), "as many runs at a time as there are cores"


@pytest.mark.parametrize("words", ["solve dcb-czm1 --meth nurbs", "verify --sched here", "doctor --hel"])
def test_options_are_told_in_full(words: str, capsys: pytest.CaptureFixture) -> None:
    assert exit_code(words.split()) == 2 and "is no option" in capsys.readouterr().err
