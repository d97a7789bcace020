"""Disks that are full, folders that are read-only, files that are damaged, runs in each other's way: a sentence, and
nothing that passes for what it is not."""

from __future__ import annotations

import json
import os
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from verify.cli import main
from verify.methods.names import METHODS
from verify.methods.solve import prepare
from verify.result import CURVE_COLUMNS, Result
from verify.runs.folder import damage, read_columns, read_result, write_json
from verify.runs.run import run
from verify.scene.load import load_scene
from verify.support.refusal import Refusal
from verify.verdict import Check

PROJECT = Path(__file__).resolve().parents[3]
PROGRAM = [sys.executable, "-P", "-m", "verify"]
ENVIRONMENT = os.environ | {"PYTHONPATH": str(PROJECT)}
SOLVE = ["solve", "dcb-czm1-linear", "--method", "lefm"]


def row(opening: float) -> dict[str, float]:
    return dict.fromkeys(CURVE_COLUMNS, 1.0 / 3.0) | {"opening": opening}


def program(*words: str, most: int | None = None, **keys: object) -> subprocess.CompletedProcess:
    """``debond`` in a process of its own, whose files may have so many bytes: what a full disk is, without a disk."""

    def limited() -> None:
        if most is not None:
            resource.setrlimit(resource.RLIMIT_FSIZE, (most, most))

    streams = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **keys}
    return subprocess.run(
        [*PROGRAM, *words], text=True, env=ENVIRONMENT, preexec_fn=limited, timeout=120, check=False, **streams
    )


def test_a_full_disk_leaves_whole_rows_and_a_sentence(tmp_path):
    ended = program(*SOLVE, "--out", str(tmp_path), most=2000)
    assert ended.returncode == 4 and "Traceback" not in ended.stderr
    assert "cannot be written: File too large" in ended.stderr and str(tmp_path) in ended.stderr
    assert not (tmp_path / "result.json").exists() and not (tmp_path / "error.log").exists()
    text = (tmp_path / "curve.csv").read_text()
    assert text.endswith("\n") and all(line.count(",") == 6 for line in text.splitlines())
    assert program(*SOLVE, "--out", str(tmp_path)).returncode == 0
    whole = (tmp_path / "curve.csv").read_text()
    assert whole.startswith(text) and len(whole) > len(text)


def test_an_output_that_takes_nothing():
    with open("/dev/full", "w") as full:
        ended = program("scenes", stdout=full)
    assert ended.returncode == 4 and "Traceback" not in ended.stderr and "Exception ignored" not in ended.stderr
    assert "cannot be written: No space left on device" in ended.stderr


def test_json_on_a_full_disk_leaves_the_old_one(tmp_path, monkeypatch):
    write_json(tmp_path / "a.json", {"a": 1})

    def full(self: Path, text: str) -> None:
        self.touch()
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_text", full)
    with pytest.raises(OSError, match="a.json"):
        write_json(tmp_path / "a.json", {"a": 2})
    assert [path.name for path in tmp_path.iterdir()] == ["a.json"]
    assert json.loads((tmp_path / "a.json").read_text()) == {"a": 1}


def test_a_killed_run_is_shorter_and_a_second_call_is_whole(tmp_path):
    words = ["solve", "dcb-czm1-linear", "--method", "nurbs", "--dofs", "112", "--set", "discretization.steps=20"]
    endless = [*words[:-1], "discretization.steps=20000", "--out", str(tmp_path)]
    streams = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    with subprocess.Popen([*PROGRAM, *endless], env=ENVIRONMENT, **streams) as process:
        curve, deadline = tmp_path / "curve.csv", time.monotonic() + 60
        while not (curve.exists() and curve.read_text().count("\n") > 5):
            assert time.monotonic() < deadline and process.poll() is None
            time.sleep(0.01)
        process.send_signal(signal.SIGKILL)
    assert read_result(tmp_path).status == "stopped: the run was killed"
    columns = read_columns(curve)
    assert len(columns["opening"]) >= 5 and np.all(np.diff(columns["opening"]) > 0)
    assert not (tmp_path / "result.json").exists()
    assert program(*words, "--out", str(tmp_path)).returncode in (0, 1)  # whatever so coarse a mesh is worth
    assert json.loads((tmp_path / "result.json").read_text())["status"] == "complete"
    assert damage(tmp_path, "result.json") == ""


def test_two_runs_into_one_folder(tmp_path):
    scene = load_scene("dcb-czm1-linear")

    def second(*_: object) -> Result:
        with pytest.raises(Refusal, match="--out: must be a folder that no other debond is at work in, got"):
            run(prepare(scene, "lefm"), tmp_path)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run(prepare(scene, "lefm"), tmp_path, solver=second)
    assert json.loads((tmp_path / "result.json").read_text())["status"] == "stopped: interrupted"
    assert run(prepare(scene, "lefm"), tmp_path)[0].complete  # the lock goes with the run


def test_an_identity_that_does_not_hold_fails_a_run(tmp_path, monkeypatch, capsys):
    import verify.runs.run

    def judged(unresolved: str = ""):
        check = Check("energy-ledger", "lefm", 0.1, 0.01, "exact", "The energies add up.", unresolved=unresolved)
        return lambda *_: (check,)

    monkeypatch.setattr(verify.runs.run, "checks_of", judged())
    assert main([*SOLVE, "--out", str(tmp_path)]) == 1
    assert "lefm: broken: energy-ledger" in capsys.readouterr().err
    monkeypatch.setattr(verify.runs.run, "checks_of", judged("2 elements in the process zone"))
    assert main([*SOLVE, "--out", str(tmp_path)]) == 0
    assert ": 2 elements in the process zone" in capsys.readouterr().out


@pytest.mark.parametrize("number", ["0.8.0", "0.12.0"])
def test_another_dolfinx_ends_in_words(number, tmp_path):
    """A module that calls itself so and has nothing of what is needed."""
    assert "dolfinx" in METHODS
    (tmp_path / "dolfinx").mkdir()
    (tmp_path / "dolfinx" / "__init__.py").write_text(f"__version__ = {number!r}\n")
    (tmp_path / "mpi4py.py").write_text("import dolfinx\n")
    command = [*PROGRAM, "solve", "dcb-czm1", "--method", "dolfinx", "--out", str(tmp_path / "out")]
    paths = os.pathsep.join([str(tmp_path), str(PROJECT)])
    ended = subprocess.run(command, capture_output=True, text=True, env=ENVIRONMENT | {"PYTHONPATH": paths})
    assert ended.returncode == 1 and "Traceback" not in ended.stderr
    assert number in ended.stderr and "0.9 to 0.11" in ended.stderr
