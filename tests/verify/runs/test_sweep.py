"""The sweep engine: whole or absent, whoever is killed; what is there is not done again."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from concurrent.futures import CancelledError, Future
from dataclasses import replace
from pathlib import Path

import pytest

from verify.runs.fingerprint import digest
from verify.runs.processes import pool
from verify.runs.store import STORE_FOLDER, Store, link, opened
from verify.runs.sweep import OUTPUT_FOLDER, Done, Task, _next, listed, sweep
from verify.support.checked_files import Damaged
from verify.support.progress import duration
from verify.support.refusal import Refusal

PROJECT = Path(__file__).resolve().parents[3]

#: Leaves its process id and a row at once, and ends as it is asked to: whole, in time or not, or in one of many ways.
PROGRAM = """
import os, resource, sys, time
from pathlib import Path
folder, name, marks, ending = Path(sys.argv[1]), sys.argv[2], Path(sys.argv[3]), sys.argv[4]
with (marks / f"{name}.runs").open("a") as runs:
    print(os.getpid(), file=runs)
(folder / "row").write_text(name)
while ending == "waits" and not (marks / "go").exists():
    time.sleep(0.02)
if ending == "killed":
    os.kill(os.getpid(), 9)
if ending == "crash":
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    os.abort()
if ending == "memory":
    resource.setrlimit(resource.RLIMIT_AS, (2**34, 2**34))
    bytearray(2**40)
if ending == "error":
    raise RuntimeError("no luck")
if ending == "exit":
    sys.exit("the last words")
if ending == "nothing":
    sys.exit(0)
(folder / "proof").write_text(name)
sys.exit(1 if ending == "fails" else 0)
"""

#: An engine in a process of its own, which can be killed: python -c ENGINE OUT MARKS SCHEDULER NAME:ENDING ...
ENGINE = f"""
import sys
from pathlib import Path
out, marks, scheduler, *words = sys.argv[1:]
sys.path[:0] = [{str(PROJECT)!r}, marks]
from tests.verify.runs.test_sweep import runs, task
tasks = [task(*word.split(":"), Path(marks)) for word in words]
for done in runs(tasks, Path(out), 1, scheduler or None):
    print(done.task.place, done.why, flush=True)
"""


@pytest.fixture
def marks(tmp_path, monkeypatch):
    folder = tmp_path / "marks"
    folder.mkdir()
    (folder / "stand_in.py").write_text(PROGRAM)
    monkeypatch.syspath_prepend(folder)
    return folder


def task(name: str, ending: str, marks: Path, lane: str = "") -> Task:
    """A run that needs no solver."""
    return Task(f"scene/{name}", digest(name), ("stand_in", OUTPUT_FOLDER, name, str(marks), ending), "proof", lane)


def runs(tasks: list[Task], out: Path, jobs: int = 1, scheduler: str | None = None) -> list[Done]:
    with pool(jobs, scheduler) as workers:
        return list(sweep(tasks, out, workers, "test", lambda done: done.why or "done"))


def started(marks: Path, name: str) -> list[int]:
    """Process ids of all runs of a name so far."""
    file = marks / f"{name}.runs"
    return [int(line) for line in file.read_text().split()] if file.exists() else []


def until(found: Callable[[], object], seconds: float = 60.0) -> None:
    deadline = time.monotonic() + seconds
    while not found():
        assert time.monotonic() < deadline, "nothing happens"
        time.sleep(0.02)


def alive(pid: int) -> bool:
    """Whether a process runs; one that has ended and that nobody has asked for counts as ended."""
    status = Path(f"/proc/{pid}/status")
    return status.exists() and "State:\tZ" not in status.read_text()


def test_what_is_there_is_not_done_again(tmp_path, marks, capsys):
    out, first = tmp_path / "out", task("a", "ends", marks)
    again = replace(first, place="scene/again")
    assert [(done.why, done.at_hand) for done in runs([first, again], out)] == [("", False)] * 2
    tasks = [first, task("b", "fails", marks), again]
    assert {done.task.place: (done.why, done.at_hand) for done in runs(tasks, out, 2)} == {
        "scene/a": ("", True),
        "scene/b": ("", False),
        "scene/again": ("", True),
    }
    assert len(started(marks, "a")) == len(started(marks, "b")) == 1
    assert os.readlink(out / "scene" / "a") == f"../{STORE_FOLDER}/{first.key}"
    assert "2 of 3 runs are at hand" in capsys.readouterr().err
    out.rename(tmp_path / "new")
    assert (tmp_path / "new" / "scene" / "again" / "proof").read_text() == "a"
    lines = listed([*tasks, task("c", "ends", marks)], tmp_path / "new", 2)
    assert "at hand" in lines[0] and "about 1 s" in lines[3] and not started(marks, "c")
    assert lines[-1] == "1 of 4 runs to do, 2 at a time: about 0.5 s"


@pytest.mark.parametrize(
    ("ending", "why"),
    [
        ("killed", "signal 9 (Killed, by somebody or by the system, which ran out of memory)"),
        ("crash", "signal 6 (Aborted)"),
        ("memory", "MemoryError"),
        ("error", "RuntimeError: no luck"),
        ("exit", "the last words"),
        ("nothing", "exit 0"),
        ("waits", "it took longer than 0.5 s"),
    ],
)
def test_a_run_that_fails_says_why_and_what_it_left_is_kept(ending, why, tmp_path, marks):
    one = task("a", ending, marks)
    (done,) = runs([replace(one, timeout=0.5) if ending == "waits" else one], tmp_path)
    assert done.why == f"failed: {why}" and not done.at_hand
    assert (tmp_path / "scene" / "a" / "row").read_text() == "a"
    (done,) = runs([task("a", "ends", marks)], tmp_path)
    assert not done.why and len(started(marks, "a")) == 2
    assert [path.name for path in (tmp_path / STORE_FOLDER).iterdir() if path.is_dir()] == [one.key]


def engine(out: Path, marks: Path, scheduler: str, *tasks: Task) -> subprocess.Popen:
    words = [f"{one.program[2]}:{one.program[4]}" for one in tasks]
    command = [sys.executable, "-c", ENGINE, str(out), str(marks), scheduler, *words]
    return subprocess.Popen(command, stdout=subprocess.PIPE, text=True, start_new_session=True)


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
def test_an_engine_that_ends_leaves_whole_folders_and_no_process(number, tmp_path, marks):
    tasks = [task("a", "ends", marks), task("b", "waits", marks), task("c", "ends", marks)]
    process = engine(tmp_path, marks, "", *tasks)
    until(lambda: started(marks, "b"))
    (child,) = started(marks, "b")
    process.send_signal(number)
    process.communicate()
    until(lambda: not alive(child))
    store = Store(tmp_path / STORE_FOLDER)
    assert [store.whole(one.key) for one in tasks] == [True, False, False]
    (marks / "go").touch()
    found = {done.task.place: (done.why, done.at_hand) for done in runs(tasks, tmp_path)}
    assert found == {"scene/a": ("", True), "scene/b": ("", False), "scene/c": ("", False)}
    assert [len(started(marks, name)) for name in "abc"] == [1, 2, 1]
    assert sorted(path.name for path in store.root.iterdir() if path.is_dir()) == sorted(one.key for one in tasks)


@pytest.fixture
def cluster(tmp_path, marks, monkeypatch):
    """The address of a scheduler, and its process and that of a worker; a client that gives up soon."""
    pytest.importorskip("distributed", reason="dask.distributed is not installed; it is an optional extra")
    monkeypatch.setenv("DASK_DISTRIBUTED__COMM__TIMEOUTS__CONNECT", "3s")
    file, quiet = tmp_path / "scheduler.json", {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(PROJECT), str(marks)])}
    place = ["--no-dashboard", "--scheduler-file", str(file)]
    worker = ["--nthreads", "1", *place, "--local-directory", str(tmp_path)]
    processes = []
    for words in (["scheduler", "--port", "0", *place], ["worker", *worker]):
        command = [sys.executable, "-m", f"distributed.cli.dask_{words[0]}", *words[1:]]
        processes.append(subprocess.Popen(command, env=environment, **quiet))
        until(file.exists)
    yield json.loads(file.read_text())["address"], processes[0]
    for process in reversed(processes):
        process.terminate()
        process.wait(30)


def parent(pid: int) -> int:
    return int(Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[1])


@pytest.mark.slow
def test_runs_through_dask_whose_worker_is_killed(tmp_path, marks, cluster):
    """The worker's keeper starts another, which does the run again; nothing is left for a second call."""
    tasks, out = [task("a", "waits", marks), task("b", "ends", marks)], tmp_path / "out"
    process = engine(out, marks, cluster[0], *tasks)
    until(lambda: started(marks, "a"))
    (child,) = started(marks, "a")
    os.kill(parent(parent(child)), signal.SIGKILL)  # the run is forked by a server, which the worker has begun
    until(lambda: not alive(child))
    (marks / "go").touch()
    said, _ = process.communicate(timeout=120)
    assert sorted(said.splitlines()) == ["scene/a ", "scene/b "]
    assert all(done.at_hand for done in runs(tasks, out))


class Fading:
    """A pool that does a task at once, fails in a way of its own, and no longer answers after so many questions."""

    def __init__(self, answers: int, broken: Exception | None = None) -> None:
        self.answers, self.broken, self.stopped = answers, broken, False

    def slots(self) -> int:
        self.answers -= 1
        if self.answers < 0:
            raise OSError("nobody answers")
        return 1

    def submit(self, function: Callable, *given: object) -> Future:
        if isinstance(self.broken, ConnectionError):
            raise self.broken
        future: Future = Future()
        future.set_exception(self.broken) if self.broken else future.set_result(function(*given))
        return future

    def stop(self) -> None:
        self.stopped = True


def test_tasks_that_a_scheduler_never_got_are_lost_with_it_and_no_others(tmp_path, marks, capsys):
    tasks = [task(name, "ends", marks) for name in "abc"]
    pool = Fading(answers=2)  # how many go at once, and the first
    found = [(done.task.place, done.why) for done in sweep([*tasks, tasks[2]], tmp_path, pool, "test", lambda d: d.why)]
    lost = "failed: nobody answers"
    assert found == [("scene/a", ""), ("scene/b", lost), ("scene/c", lost), ("scene/c", lost)]
    assert [len(started(marks, name)) for name in "abc"] == [1, 0, 0] and not pool.stopped
    assert capsys.readouterr().err.splitlines()[-1] == f"scene/c: {lost} (4 of 4)"
    assert [done.why for done in sweep(tasks[1:2], tmp_path, Fading(0), "test", lambda d: d.why)] == [lost]


@pytest.mark.parametrize(
    ("error", "why"),
    [
        (KeyError("x"), "failed: KeyError: 'x'"),
        (CancelledError(), "failed: the run was cancelled with its scheduler"),
        (ConnectionError("the cluster is gone"), "failed: ConnectionError: the cluster is gone"),
    ],
)
def test_a_worker_that_is_gone_costs_its_task(error, why, tmp_path, marks):
    (done,) = sweep([task("a", "ends", marks)], tmp_path, Fading(9, error), "test", lambda done: done.why)
    assert done.why == why and not done.at_hand and not started(marks, "a")


def test_who_wants_no_more_stops_the_pool(tmp_path, marks):
    pool = Fading(9)
    half = sweep([task(name, "ends", marks) for name in "ab"], tmp_path, pool, "test", lambda done: done.why)
    next(half)
    half.close()
    assert pool.stopped and not started(marks, "b")


def test_a_lane_goes_one_by_one_and_first_and_long_runs_before_short_ones(tmp_path):
    """Two of 100 s that cannot go side by side, and three of 10 s beside them."""
    lane = [Task(name, name, (), "proof", "lane", seconds=100.0) for name in "xy"]
    free = [Task(name, name, (), "proof", seconds=10.0) for name in "abc"]
    long = replace(free[0], key="d", seconds=90.0)
    assert _next([*free, *lane], [], 2) == [lane[0], free[0]] and _next(lane[1:], lane[:1], 1) == []
    assert _next([*free, lane[1]], lane[:1], 2) == free[:2] and _next([*free, long], [], 2) == [long, free[0]]
    for jobs, whole in ((1, "3 min 50 s"), (2, "3 min 20 s"), (8, "3 min 20 s")):
        assert listed([*lane, *free, lane[0]], tmp_path, jobs)[-1].endswith(f"about {whole}")
    words = [duration(seconds) for seconds in (0.25, 8.24, 42.0, 7500.0)]
    assert words == ["0.25 s", "8.2 s", "42 s", "2 h 5 min"]


def test_an_output_folder_belongs_to_one_engine_and_keeps_what_was_there(tmp_path, marks):
    with opened(tmp_path), pytest.raises(Refusal, match="no other debond is at work"):
        runs([task("a", "ends", marks)], tmp_path)
    assert not started(marks, "a")
    (tmp_path / "scene" / "a").mkdir(parents=True)
    (tmp_path / "scene" / "a" / "mine").touch()
    runs([task("a", "ends", marks)], tmp_path)
    assert (tmp_path / "scene" / "a.earlier" / "mine").exists() and (tmp_path / "scene" / "a" / "proof").exists()


def test_a_copy_where_there_are_no_links(tmp_path, monkeypatch):
    def refused(*how, **options):
        raise OSError("no links here")

    (tmp_path / "whole").mkdir()
    (tmp_path / "whole" / "proof").touch()
    monkeypatch.setattr(Path, "symlink_to", refused)
    link(tmp_path, "scene/a", tmp_path / "whole")
    assert (tmp_path / "scene" / "a" / "proof").exists() and not (tmp_path / "scene" / "a").is_symlink()


def test_what_reads_a_run_finds_its_damage(tmp_path, marks, capsys):
    """Where its reader takes it, it is whole as far as its proof goes, and is not done again."""

    def reader(folder: Path) -> None:
        raise Damaged(folder / "curve.csv", "no numbers")

    done = task("a", "ends", marks)
    for read, times in ((None, 1), (lambda folder: None, 1), (reader, 2)):
        runs([replace(done, read=read)], tmp_path)
        assert len(started(marks, "a")) == times
    assert f"1 runs in {tmp_path} are damaged (curve.csv) and are done again" in capsys.readouterr().err


def test_commands_list_their_runs_and_leave_nothing(tmp_path, capsys):
    from verify.cli import main

    out = tmp_path / "out"
    assert main(["verify", "dcb-czm1-linear", "--dry-run", "--out", str(out)]) == 0
    said = capsys.readouterr().out.splitlines()
    assert any(line.startswith("dcb-czm1-linear/nurbs ") and "about" in line for line in said)
    assert "runs to do" in said[-1]
    assert main(["hard", "coarse-czm2", "--dry-run", "--out", str(out)]) == 0
    assert capsys.readouterr().out.splitlines()[0].startswith("coarse-czm2/tspline ") and not out.exists()
    assert main(["hard", "units", "--scheduler", "nowhere", "--out", str(out)]) == 2
    assert "debond: --scheduler: " in capsys.readouterr().err
