"""Progress where there is no terminal: a line now and then, with the time left."""

from __future__ import annotations

import threading
import time
from pathlib import Path

import pytest

from verify import progress, sweep
from verify.pools import pool
from verify.progress import Progress, telling


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """Seconds that a test sets."""
    now = [0.0]
    monkeypatch.setattr(progress, "monotonic", lambda: now[0])
    return now


def test_long_work_is_told_of_before_any_of_it_is_done(clock: list[float], capsys: pytest.CaptureFixture) -> None:
    with Progress("runs", total=100.0, pace=2.0) as shown:
        clock[0] = 5.0
        shown.alive("a")
        assert capsys.readouterr().err == ""
        clock[0] = 11.0
        shown.alive("a")
        assert capsys.readouterr().err == "runs: a, about 39 s left\n"
        shown.advance(25.0)
        clock[0] = 22.0
        shown.alive("b")
        assert capsys.readouterr().err == "runs: b, 66 s left\n"
        clock[0] = 25.0
        shown.alive("b")
        assert capsys.readouterr().err == ""


def test_longer_than_expected_is_no_time_left(clock: list[float], capsys: pytest.CaptureFixture) -> None:
    with Progress("runs", total=10.0, pace=1.0) as shown:
        clock[0] = 15.0
        shown.alive("a")
    assert capsys.readouterr().err == "runs: a\n"
    with Progress("runs", total=10.0, quiet=True) as shown:
        clock[0] = 40.0
        shown.alive("a")
    assert capsys.readouterr().err == ""


def test_a_sweep_tells_what_is_running(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    monkeypatch.setattr(progress, "LINES_EVERY_SECONDS", 0.0)
    monkeypatch.setattr(sweep, "ALIVE_EVERY_SECONDS", 0.05)
    go = threading.Event()

    def execute(task: sweep.Task, root: Path, cwd: Path, running: set) -> str:
        go.wait(30)
        (root / task.key).mkdir()
        return ""

    monkeypatch.setattr(sweep, "execute", execute)
    threading.Timer(0.4, go.set).start()
    tasks = [sweep.Task(name, name, (), "proof", seconds=60.0) for name in ("a", "b")]
    with pool(2) as workers:
        assert len(list(sweep.sweep(tasks, tmp_path, workers, "runs", lambda done: "done"))) == 2
    said = capsys.readouterr().err.splitlines()
    assert said[0].startswith("runs: a and 1 more, about ") and said[-1].endswith(": done (2 of 2)")


def test_work_that_does_not_say_how_far_it_is(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture) -> None:
    monkeypatch.setattr(progress, "LINES_EVERY_SECONDS", 0.0)
    with telling("report", 60.0):
        time.sleep(1.1)
    assert capsys.readouterr().err.startswith("report: at work, about 59 s left\n")
    with pytest.raises(ValueError, match="it"), telling("report", 60.0):
        raise ValueError("it")
    assert not [one for one in threading.enumerate() if one.daemon and "tick" in one.name]
