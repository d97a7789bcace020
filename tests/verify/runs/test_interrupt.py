"""An interrupt in the middle: what is there is valid, one sentence says how to go on, and going on works."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from verify.runs.store import STORE_FOLDER

PROJECT = Path(__file__).resolve().parents[3]
PIPES = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
SMALL = ["--set", "discretization.dofs=200", "--set", "discretization.steps=6", "--set", "load.opening=0.5"]
STUDIES = {
    "effects": ["effects", "dcb-czm1", *SMALL, "--jobs", "1"],
    "hard": ["hard", "coarse-czm2", "--jobs", "1"],
}


def start(command: list[str], out: Path) -> subprocess.Popen:
    words = [sys.executable, "-P", "-m", "verify", *command, "--out", str(out)]
    environment = os.environ | {"PYTHONPATH": str(PROJECT)}
    return subprocess.Popen(words, text=True, env=environment, start_new_session=True, **PIPES)


def whole(out: Path) -> list[Path]:
    """Folders of runs that are done."""
    return [path for path in (out / STORE_FOLDER).glob("[!.]*") if path.is_dir() and path.suffix != ".failed"]


def interrupted(command: list[str], out: Path) -> str:
    """Start a study, interrupt it as a terminal does when the first of its runs is done; what it said."""
    process = start(command, out)
    deadline = time.monotonic() + 120
    while time.monotonic() < deadline and process.poll() is None and not whole(out):
        time.sleep(0.02)
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does: to the runs as well
    _, said = process.communicate(timeout=60)
    assert process.returncode == 130
    return said


def test_a_study_keeps_its_runs_and_says_that_it_goes_on(tmp_path):
    said = interrupted(STUDIES["effects"], tmp_path)
    last = (
        f"debond: interrupted; the runs that are done are kept in {tmp_path}, and the same command again does the rest"
    )
    assert said.splitlines()[-1] == last
    assert "Traceback" not in said
    assert whole(tmp_path)
    for run in whole(tmp_path):
        assert json.loads((run / "result.json").read_text())["status"] == "complete"
    listed = start([*STUDIES["effects"], "--dry-run"], tmp_path).communicate(timeout=60)[0]
    assert listed.count("at hand") >= len(whole(tmp_path))


@pytest.mark.slow
@pytest.mark.parametrize("study", STUDIES)
def test_the_same_command_again_does_the_rest(study, tmp_path):
    assert "Traceback" not in interrupted(STUDIES[study], tmp_path)
    kept = {path.name: path.stat().st_mtime_ns for path in whole(tmp_path)}
    again = start(STUDIES[study], tmp_path)
    _, said = again.communicate(timeout=600)
    assert again.returncode in (0, 1) and "are at hand" in said
    assert {path.name: path.stat().st_mtime_ns for path in whole(tmp_path) if path.name in kept} == kept
    assert (tmp_path / "report.html").exists() or "no report" in said


def test_work_without_a_folder_starts_over(capsys, monkeypatch):
    from verify import cli

    def stops(*_: object) -> int:
        raise KeyboardInterrupt

    monkeypatch.setattr("verify.command_line.tools.listed", stops)
    assert cli.main(["scenes", "dcb-czm1"]) == 130
    assert capsys.readouterr().err == "debond: interrupted; the same command again starts over\n"


@pytest.mark.parametrize("seconds", [0.0, 0.15, 0.6])
def test_an_interrupt_while_modules_are_imported_is_one_line(seconds, tmp_path):
    words = [sys.executable, "-P", "-m", "verify", "solve", "dcb-czm1", "--out", str(tmp_path)]
    words += ["--set", "discretization.steps=5000"]  # it must not have ended before the last of them
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})  # as the launcher holds it
    try:
        process = subprocess.Popen(
            words, text=True, cwd=PROJECT, env=os.environ | {"PYTHONPATH": str(PROJECT)}, **PIPES
        )
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
    time.sleep(seconds)
    process.send_signal(signal.SIGINT)
    printed, said = process.communicate(timeout=60)
    assert process.returncode == 130
    assert "Traceback" not in printed + said and said.count("interrupted;") == 1
    assert said.splitlines()[-1].startswith("debond: interrupted; ")


LOST = """
import signal, time
class Ends:
    def __del__(self):
        signal.raise_signal(signal.SIGINT)
def in_a_finalizer():
    Ends()
def as_another_error():
    try:
        signal.raise_signal(signal.SIGINT)
    except KeyboardInterrupt:
        raise ImportError("a compiled module") from None
from verify import cli
from verify.command_line import tools
from verify.support import interrupts
def listed(lines):
    {0}()
    time.sleep(0.5)
    return 0
tools.listed = listed
interrupts.running(lambda: cli.main(["scenes", "dcb-czm1"]))
"""


@pytest.mark.parametrize("where", ["in_a_finalizer", "as_another_error"])
def test_an_interrupt_that_another_library_swallows_still_ends_the_command(where):
    words = [sys.executable, "-P", "-c", LOST.format(where)]
    done = subprocess.run(words, text=True, cwd=PROJECT, env=os.environ | {"PYTHONPATH": str(PROJECT)}, **PIPES)
    assert (done.returncode, done.stderr) == (130, "debond: interrupted; the same command again starts over\n")
