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

from verify.cli import main
from verify.command_line.commands import COMMANDS
from verify.command_line.parsing import parsed
from verify.methods import dolfinx, names
from verify.theory import lefm

PROJECT = Path(__file__).resolve().parents[2]
PROGRAM = [sys.executable, "-P", "-m", "verify"]
ENVIRONMENT = os.environ | {"PYTHONPATH": str(PROJECT)}
CURVE = "opening,load\n0,0\n1,2\n3,1\n"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "curve.csv").write_text(CURVE)
    return tmp_path


def exit_code(arguments: list[str]) -> int:
    try:
        return main(arguments)
    except SystemExit as end:  # argparse
        return int(end.code or 0)


def as_process(*arguments: str, **environment: str) -> subprocess.CompletedProcess:
    command = [*PROGRAM, *arguments]
    return subprocess.run(command, capture_output=True, text=True, timeout=300, env=ENVIRONMENT | environment)


def test_the_smallest_mesh_is_the_one_that_the_solver_takes():
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
@pytest.mark.parametrize("name", ["", *(command.name for command in COMMANDS)])
def test_help_ends_with_an_example_that_can_be_typed(name, columns, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", str(columns))
    assert exit_code([*[name] * bool(name), "--help"]) == 0
    said = capsys.readouterr().out
    example, leaves = said.splitlines()[-2:]
    assert example.startswith("example: debond ") and leaves.startswith("         # ") and "\x1b" not in said
    assert name or [said.count(f"\n  {one.name} ") for one in COMMANDS] == [1] * len(COMMANDS), "in one group each"
    words = shlex.split(example.removeprefix("example: debond ").partition(" > ")[0])
    assert name in ("", words[0])
    if words[0] != "test":  # pytest reads those
        assert parsed(words).command.name == words[0]


def test_solve_writes_a_folder(folder, capsys):
    assert main(["solve", "dcb-czm1-linear", "--method", "lefm", "--set", "load.opening=1.5"]) == 0
    out = folder / "debond-out" / "dcb-czm1-linear-lefm"
    about = json.loads((out / "result.json").read_text())
    assert about["method"] == "lefm" and about["scene"]["load"]["opening"] == [1.5]
    assert np.loadtxt(out / "curve.csv", delimiter=",", skiprows=1)[-1, 0] == 1.5
    assert capsys.readouterr().out.splitlines()[-1] == "complete: debond-out/dcb-czm1-linear-lefm"


def test_a_run_that_stops_early_exits_with_one(folder, monkeypatch, capsys):
    def stops(*args: object) -> lefm.Solution:
        return lefm.Solution(whole(*args).rows[:20], "stopped: for no reason")

    whole = lefm.solve
    monkeypatch.setattr(lefm, "solve", stops)
    assert main(["solve", "dcb-czm1-linear", "--method", "lefm", "--out", "here"]) == 1
    assert json.loads((folder / "here" / "result.json").read_text())["status"] == "stopped: for no reason"
    assert "stopped: for no reason" in capsys.readouterr().err


def test_a_scene_of_ones_own_whose_specimen_separates_is_complete(folder, capsys):
    text = (PROJECT / "verify" / "scene" / "scenes" / "dcb-czm1-linear.toml").read_text()
    (folder / "own.toml").write_text(text.replace("dcb-czm1-linear", "dcb-own"))
    assert main(["solve", "own.toml", "--method", "lefm", "--set", "load.opening=20", "--out", "here"]) == 0
    about = json.loads((folder / "here" / "result.json").read_text())
    assert about["status"] == "complete" and about["ending"].startswith("separated at opening ")
    assert about["scene"]["name"] == "dcb-own"
    assert capsys.readouterr().out.splitlines()[-1].startswith("complete, separated at opening ")


def test_without_dolfinx_there_is_a_sentence_and_three_ways(folder, monkeypatch, capsys):
    monkeypatch.setattr(dolfinx, "find_spec", lambda name: None)
    assert main(["solve", "dcb-czm1", "--method", "dolfinx"]) == 1
    said = capsys.readouterr().err
    assert "not run: DOLFINx is not installed" in said
    assert all(word in said for word in ("conda", "Docker", "Debian"))
    assert not (folder / "debond-out").exists()


def test_compare_judges_by_the_tolerance(folder, capsys):
    (folder / "more.csv").write_text("# my code\nforce;load;opening\n9;0;0\n9;2.02;1\n9;1.01;3\n")
    (folder / "bare.txt").write_text("0 0\n1 2\n3 1\n")
    assert main(["compare", "more.csv", "curve.csv"]) == 0
    said = capsys.readouterr().out.splitlines()
    assert said[1].split() == ["curve", "error", "1", "%"] and said[2].split()[2:] == ["2.02", "2", "+1", "%"]
    assert main(["compare", "more.csv", "curve.csv", "--tolerance", "0.011"]) == 0
    assert main(["compare", "more.csv", "curve.csv", "--tolerance", "0.009"]) == 1
    assert main(["compare", "bare.txt", "curve.csv", "--tolerance", "0"]) == 0
    main(["solve", "dcb-czm1", "--method", "lefm", "--out", "run"])
    assert main(["compare", "run", "run/curve.csv", "--tolerance", "0"]) == 0


def test_scenes_and_doctor_tell_what_there_is(capsys):
    assert main(["scenes"]) == 0
    assert capsys.readouterr().out.count("\ndcb-czm") == 4
    assert main(["doctor"]) == 0
    said = capsys.readouterr().out
    assert "numpy" in said and "dolfinx" in said


def test_an_interrupt_leaves_a_sentence_and_valid_files(tmp_path):
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


def test_under_mpi_only_the_first_rank_writes(tmp_path):
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


def test_a_reader_that_leaves_is_no_error():
    line = f"{shlex.join(PROGRAM)} scenes | true"
    ended = subprocess.run(["bash", "-c", line], capture_output=True, text=True, env=ENVIRONMENT)
    assert ended.stderr == ""


STUDY = "overrides=[] scheduler=None dry_run=False"
CURVE_OPTIONS = "curves=[] opening=None load=None opening_scale=1.0 load_scale=1.0"
SIDES = "opening_a=None load_a=None opening_b=None load_b=None opening_scale_a=1.0 load_scale_a=1.0 load_scale_b=1.0"
#: command line -> what its options are where they are not told
UNSAID = {
    "verify": f"{STUDY} {CURVE_OPTIONS} scenes=[] out=debond-report full=False format=html include=[] budget=5",
    "solve S": "method=None dofs=None accuracy=None overrides=[] out=None fields=False frames=30",
    "cost S": "overrides=[] out=debond-cost dry_run=False",
    "effects S": f"{STUDY} method=nurbs out=debond-effects",
    "validate S": f"{STUDY} {CURVE_OPTIONS} method=nurbs out=debond-validation at=[]",
    "certify S": f"{STUDY} at=[] out=debond-certified keep=False",
    "vary S": f"{STUDY} method=nurbs out=debond-vary ranks=[1]",
    "hard": "names=[] out=debond-hard scheduler=None dry_run=False",
    "law S": "write=None given=None columns=None scales=None tolerance=None out=None",
    "compare A B": f"{SIDES} a=A b=B end=None begin=None at=() curve_tol=None peak_tol=None energy_tol=None out=None",
    "export S --format vtu": "format=vtu elements=None layers=None overrides=[] out=None",
    "mesh F": "file=F out=None json=False control=False",
    "scenes": "scenes=[]",
    "test": "rest=[]",
}


@pytest.mark.parametrize("words", UNSAID)
def test_what_is_not_told_is_as_the_help_says(words):
    found = vars(parsed(words.split()))
    assert set(UNSAID[words].split()) <= {f"{name}={value}" for name, value in found.items()}
    assert found["command"].name == words.split()[0]
    assert found.get("jobs", os.cpu_count()) == os.cpu_count(), "as many runs at a time as there are cores"
