"""Progress where there is no terminal: a line now and then, with the time left."""

from __future__ import annotations

import sys
import threading
from pathlib import Path
from types import SimpleNamespace
from unittest.mock import Mock

import pytest

from verify.command_line.solving import with_progress
from verify.methods.solve import prepare
from verify.runs import sweep
from verify.runs.processes import pool
from verify.runs.run import NO_FIELDS
from verify.scene.load import load_scene
from verify.support import progress
from verify.support.progress import Progress, telling


@pytest.fixture
def clock(monkeypatch):
    """Seconds that a test sets."""
    now = [0.0]
    monkeypatch.setattr(progress, "monotonic", lambda: now[0])
    return now


def test_long_work_is_told_of_before_any_of_it_is_done(clock, capsys):
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
        assert capsys.readouterr().err == "runs: b, 22 s left\n", "a quarter took 11 s, and 11 s of the rest are over"
        clock[0] = 25.0
        shown.alive("b")
        assert capsys.readouterr().err == ""
        clock[0] = 50.0
        shown.alive("b")
        assert capsys.readouterr().err == "runs: b\n", "a long one makes the rest no longer"


def test_after_the_last_run_no_time_is_left(clock):
    """Ten times 0.1, added up one after the other, are less than 1 by rounding."""
    done = 0.0
    with Progress("runs", total=1.0) as shown:
        for seconds in range(1, 11):
            clock[0], done = float(seconds), done + 0.1
            shown.advance(done)
            assert (shown.left == "") == (seconds == 10), shown.left
    assert done < 1.0


def test_a_sweep_tells_what_is_running(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(progress, "LINES_EVERY_SECONDS", 0.0)
    monkeypatch.setattr(sweep, "ALIVE_EVERY_SECONDS", 0.05)
    go, alive = threading.Event(), Progress.alive

    def heard(self: Progress, news: str) -> None:
        alive(self, news)
        go.set()

    def execute(task: sweep.Task, root: Path, cwd: Path, running: set) -> str:
        go.wait(30)
        (root / task.key).mkdir()
        return ""

    monkeypatch.setattr(sweep, "execute", execute)
    monkeypatch.setattr(Progress, "alive", heard)
    tasks = [sweep.Task(name, name, (), "proof", seconds=60.0) for name in ("a", "b")]
    with pool(2) as workers:
        assert len(list(sweep.sweep(tasks, tmp_path, workers, "runs", lambda done: "done"))) == 2
    said = capsys.readouterr().err.splitlines()
    assert said[0].startswith("runs: a and 1 more, about ") and said[-1].endswith(": done (2 of 2)")


def test_work_that_does_not_say_how_far_it_is(monkeypatch, capsys):
    monkeypatch.setattr(progress, "LINES_EVERY_SECONDS", 0.0)
    said, line = threading.Event(), Progress.line
    monkeypatch.setattr(Progress, "line", lambda self, text: (line(self, text), said.set()))
    with telling("report", 60.0):
        assert said.wait(30)
    assert capsys.readouterr().err.startswith("report: at work, about 5")
    with pytest.raises(ValueError, match="it"), telling("report", 60.0):
        raise ValueError("it")
    assert not [one for one in threading.enumerate() if one.daemon and "tick" in one.name]


def test_on_a_terminal_a_bar_goes_as_far_as_the_work(clock, monkeypatch, capsys):
    bar = Mock(n=0.0, total=4.0)
    bar.update.side_effect = lambda step: setattr(bar, "n", bar.n + step)
    monkeypatch.setattr(progress, "_bar", lambda title, total: bar)
    with Progress("runs", total=4.0) as shown:
        clock[0] = 20.0
        shown.advance(1.0, "first")
        shown.alive("at work")
        shown.line("whole")
        shown.advance(5.0, "beyond")
    said = [call.args[0] for call in (*bar.set_postfix_str.mock_calls, *bar.write.mock_calls)]
    assert said == ["first", "at work, 60 s left", "beyond", "whole"] and bar.close.called
    assert bar.n == 4.0, "never beyond its end"
    assert capsys.readouterr().err == ""


def test_a_bar_needs_a_terminal_and_its_package(monkeypatch):
    made: list[dict] = []
    fake = SimpleNamespace(tqdm=lambda **how: made.append(how) or "bar")
    monkeypatch.setitem(sys.modules, "tqdm", fake)
    assert progress._bar("runs", 3.0) is None
    monkeypatch.setattr(sys, "stderr", SimpleNamespace(isatty=lambda: True))
    assert progress._bar("runs", 3.0) == "bar"
    assert (made[0]["total"], made[0]["desc"], made[0]["leave"]) == (3.0, "runs", False)
    monkeypatch.setitem(sys.modules, "tqdm", None)
    assert progress._bar("runs", 3.0) is None


def test_durations_change_their_units_where_they_round():
    told = [progress.duration(s) for s in (0.0123, 9.94, 9.96, 99.4, 99.6, 119.6, 3599.0, 5939.0, 5941.0, 36000.0)]
    assert told == [
        "0.012 s", "9.9 s", "10 s", "99 s", "1 min 40 s", "2 min 0 s", "59 min 59 s", "98 min 59 s", "1 h 39 min",
        "10 h 0 min",
    ]  # fmt: skip


def test_a_path_that_snaps_back_counts_the_farthest_opening(tmp_path, monkeypatch):
    told: list[float] = []
    monkeypatch.setattr(Progress, "advance", lambda self, done, news: told.append(done / self._total))
    openings = [0.0, 1.0, 0.6, 0.9, 2.0, 1.5, 1.8, 0.5, 1.0, 3.0]
    monkeypatch.setattr("verify.runs.run.run", lambda *a: [a[3]({"opening": d, "load": 0.0}) for d in openings])
    with_progress(prepare(load_scene("dcb-czm1", ["load.opening=[2.0, 0.5, 3.0]"]), "nurbs"), tmp_path, NO_FIELDS, True)
    assert told == pytest.approx([d / 6.0 for d in (0.0, 1.0, 1.0, 1.0, 2.0, 2.5, 2.5, 3.5, 4.0, 6.0)])
