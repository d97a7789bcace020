"""The sweep engine: whole or absent, whoever is killed; what is there is not done again."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from concurrent.futures import CancelledError, Future
from dataclasses import replace
from pathlib import Path

import pytest

from verify.runs.estimate import steps
from verify.runs.fingerprint import digest, fingerprint, source
from verify.runs.jobs import Job
from verify.runs.pools import pool
from verify.runs.store import STORE_FOLDER, Store, link, opened
from verify.runs.sweep import OUTPUT_FOLDER, Done, Task, _at_once, _damage, _next, _submitted, _why, listed, sweep
from verify.scene.load import load_scene
from verify.support.checked_files import Damaged
from verify.support.progress import duration

PROJECT = Path(__file__).resolve().parents[3]

#: Leaves its process id at once, waits until it is let go where it is asked to, and says in its folder that it ran.
PROGRAM = """
import os, sys, time
from pathlib import Path
folder, name, marks, ending = Path(sys.argv[1]), sys.argv[2], Path(sys.argv[3]), sys.argv[4]
with (marks / f"{name}.runs").open("a") as runs:
    print(os.getpid(), file=runs)
if ending == "waits":
    while not (marks / "go").exists():
        time.sleep(0.02)
if ending == "dies":
    sys.exit("the last words")
(folder / "proof").write_text(name)
sys.exit(1 if ending == "fails" else 0)
"""
#: Says why it has nothing to show, and ends as if all were well.
SILENT = "import sys; print('nothing to do'); sys.exit(0)"

#: An engine in a process of its own, which can be killed: python -c ENGINE OUT MARKS SCHEDULER NAME:ENDING ...
ENGINE = """
import sys
from pathlib import Path
sys.path.insert(0, {here!r})
from tests.verify.runs.test_sweep import runs, task
out, marks, scheduler, *words = sys.argv[1:]
tasks = [task(*word.split(":"), Path(marks)) for word in words]
for done in runs(tasks, Path(out), 1, scheduler or None):
    print(done.task.place, done.why, flush=True)
"""


@pytest.fixture
def marks(tmp_path: Path) -> Path:
    folder = tmp_path / "marks"
    folder.mkdir()
    return folder


def task(name: str, ending: str, marks: Path, lane: str = "") -> Task:
    """A run that needs no solver."""
    program = marks / "stand_in.py"
    if not program.exists():
        beside = marks / f"stand_in.{os.getpid()}"
        beside.write_text(PROGRAM)
        beside.rename(program)
    return Task(f"scene/{name}", digest(name), ("stand_in", OUTPUT_FOLDER, name, str(marks), ending), "proof", lane)


def runs(tasks: list[Task], out: Path, jobs: int, scheduler: str | None = None) -> list[Done]:
    with pool(jobs, scheduler) as workers:
        return list(sweep(tasks, out, workers, "test", lambda done: done.why or "done"))


@pytest.fixture(autouse=True)
def _stand_in(marks: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONPATH", str(marks))


def started(marks: Path, name: str) -> list[int]:
    """Process ids of all runs of a name so far."""
    file = marks / f"{name}.runs"
    return [int(line) for line in file.read_text().split()] if file.exists() else []


def until(found, seconds: float = 60.0) -> None:
    deadline = time.monotonic() + seconds
    while not found():
        assert time.monotonic() < deadline, "nothing happens"
        time.sleep(0.02)


def alive(pid: int) -> bool:
    """Whether a process runs; one that has ended and that nobody has asked for counts as ended."""
    status = Path(f"/proc/{pid}/status")
    return status.exists() and "State:\tZ" not in status.read_text()


def test_what_is_there_is_not_done_again(tmp_path: Path, marks: Path, capsys: pytest.CaptureFixture) -> None:
    out, first = tmp_path / "out", [task("a", "ends", marks)]
    assert [(done.why, done.at_hand) for done in runs(first, out, 1)] == [("", False)]
    both = [*first, task("b", "fails", marks)]
    assert {done.task.place: (done.why, done.at_hand) for done in runs(both, out, 2)} == {
        "scene/a": ("", True),
        "scene/b": ("", False),
    }
    assert len(started(marks, "a")) == len(started(marks, "b")) == 1
    assert (out / "scene" / "a" / "proof").read_text() == "a"
    assert os.readlink(out / "scene" / "a") == f"../{STORE_FOLDER}/{first[0].key}"
    assert "1 of 2 runs are at hand" in capsys.readouterr().err


def test_a_run_that_dies_is_kept_for_reading_and_done_again(tmp_path: Path, marks: Path) -> None:
    (done,) = runs([task("a", "dies", marks)], tmp_path, 1)
    assert done.why == "failed: the last words" and not done.at_hand
    assert "the last words" in (tmp_path / "scene" / "a" / "log.txt").read_text()
    (done,) = runs([task("a", "ends", marks)], tmp_path, 1)
    assert not done.why and len(started(marks, "a")) == 2
    assert [path.name for path in (tmp_path / STORE_FOLDER).iterdir() if path.is_dir()] == [
        task("a", "ends", marks).key
    ]


def test_a_killed_worker_costs_its_run(tmp_path: Path, marks: Path) -> None:
    """SIGKILL in the middle: the others are whole, the second call does the one that is missing."""
    tasks = [task("a", "waits", marks), task("b", "ends", marks), task("c", "ends", marks)]
    engine = subprocess.Popen(engine_command(tmp_path, marks, "", *tasks), stdout=subprocess.PIPE, text=True)
    until(lambda: started(marks, "a"))
    os.kill(started(marks, "a")[0], signal.SIGKILL)
    said, _ = engine.communicate(timeout=60)
    assert said.splitlines() == ["scene/a failed: signal 9", "scene/b ", "scene/c "]
    (marks / "go").touch()
    found = {done.task.place: done.at_hand for done in runs(tasks, tmp_path, 1)}
    assert found == {"scene/a": False, "scene/b": True, "scene/c": True}
    assert [len(started(marks, name)) for name in "abc"] == [2, 1, 1]


def test_a_killed_engine_leaves_whole_folders_and_no_process(tmp_path: Path, marks: Path) -> None:
    tasks = [task("a", "ends", marks), task("b", "waits", marks), task("c", "ends", marks)]
    engine = subprocess.Popen(engine_command(tmp_path, marks, "", *tasks), stdout=subprocess.DEVNULL)
    until(lambda: started(marks, "b"))
    (child,) = started(marks, "b")
    engine.kill()
    engine.wait()
    until(lambda: not alive(child))
    store = Store(tmp_path / STORE_FOLDER)
    assert [store.whole(one.key) for one in tasks] == [True, False, False]
    (marks / "go").touch()
    found = {done.task.place: (done.why, done.at_hand) for done in runs(tasks, tmp_path, 1)}
    assert found == {"scene/a": ("", True), "scene/b": ("", False), "scene/c": ("", False)}
    assert [len(started(marks, name)) for name in "abc"] == [1, 2, 1]
    assert sorted(path.name for path in store.root.iterdir() if path.is_dir()) == sorted(one.key for one in tasks)


def engine_command(out: Path, marks: Path, scheduler: str, *tasks: Task) -> list[str]:
    words = [f"{one.program[2]}:{one.program[4]}" for one in tasks]
    code = ENGINE.format(here=str(Path(__file__).parent))
    return [sys.executable, "-c", code, str(out), str(marks), scheduler, *words]


@pytest.fixture
def cluster(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """A scheduler and a worker in processes of their own, and a client that gives up soon."""
    pytest.importorskip("distributed", reason="dask.distributed is not installed; it is an optional extra")
    monkeypatch.setenv("DASK_DISTRIBUTED__COMM__TIMEOUTS__CONNECT", "3s")
    file, quiet = tmp_path / "scheduler.json", {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    paths = os.pathsep.join([str(PROJECT), os.environ["PYTHONPATH"]])
    environment = os.environ | {"PYTHONPATH": paths}
    scheduler = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--port", "0", "--no-dashboard"]
    worker = [sys.executable, "-m", "distributed.cli.dask_worker", "--nthreads", "1", "--no-dashboard"]
    place = ["--scheduler-file", str(file), "--local-directory", str(tmp_path)]
    processes = [subprocess.Popen([*scheduler, "--scheduler-file", str(file)], env=environment, **quiet)]
    until(file.exists)
    processes.append(subprocess.Popen([*worker, *place], env=environment, **quiet))
    try:
        yield lambda: json.loads(file.read_text())["address"], processes
    finally:
        for process in reversed(processes):
            process.terminate()
        for process in processes:
            process.wait(30)


def parent(pid: int) -> int:
    return int(Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[1])


@pytest.mark.slow
def test_runs_through_dask_whose_worker_is_killed(tmp_path: Path, marks: Path, cluster) -> None:
    """The worker's keeper starts another, which does the run again; nothing is left for a second call."""
    address, out = cluster[0](), tmp_path / "out"
    tasks = [task("a", "waits", marks), task("b", "ends", marks)]
    engine = subprocess.Popen(engine_command(out, marks, address, *tasks), stdout=subprocess.PIPE, text=True)
    until(lambda: started(marks, "a"))
    (child,) = started(marks, "a")
    os.kill(parent(parent(child)), signal.SIGKILL)  # the run is forked by a server, which the worker has begun
    until(lambda: not alive(child))
    (marks / "go").touch()
    said, _ = engine.communicate(timeout=120)
    assert sorted(said.splitlines()) == ["scene/a ", "scene/b "]
    assert all(done.at_hand for done in runs(tasks, out, 1))


@pytest.mark.slow
def test_a_killed_scheduler_costs_what_was_not_whole(tmp_path: Path, marks: Path, cluster) -> None:
    find, (scheduler, _) = cluster
    tasks, out = [task("a", "ends", marks), task("b", "waits", marks), task("c", "ends", marks)], tmp_path / "out"
    engine = subprocess.Popen(engine_command(out, marks, find(), *tasks), stdout=subprocess.PIPE, text=True)
    until(lambda: started(marks, "b"))
    scheduler.kill()
    said, _ = engine.communicate(timeout=120)
    ends = [tuple(line.split(" ")[:2]) for line in said.splitlines()]
    assert ends == [("scene/a", ""), ("scene/b", "failed:"), ("scene/c", "failed:")]
    (marks / "go").touch()
    assert {done.task.place: done.at_hand for done in runs(tasks, out, 1)}["scene/a"]
    assert all(Store(out / STORE_FOLDER).whole(one.key) for one in tasks)


def test_a_scheduler_that_does_not_answer_is_refused(capsys: pytest.CaptureFixture, tmp_path: Path) -> None:
    from verify.cli import main

    assert main(["hard", "units", "--scheduler", "nowhere", "--out", str(tmp_path)]) == 2
    assert "debond: --scheduler: " in capsys.readouterr().err


class Fading:
    """A pool that does a task at once, and no longer answers after so many questions."""

    def __init__(self, answers: int, broken: Exception | None = None) -> None:
        self.answers, self.broken, self.stopped = answers, broken, False

    def slots(self) -> int:
        self.answers -= 1
        if self.answers < 0:
            raise OSError("nobody answers")
        return 1

    def submit(self, function, *given) -> Future:
        future: Future = Future()
        future.set_exception(self.broken) if self.broken else future.set_result(function(*given))
        return future

    def stop(self) -> None:
        self.stopped = True


def test_tasks_that_a_scheduler_never_got_are_lost_with_it_and_no_others(tmp_path: Path, marks: Path, capsys) -> None:
    tasks = [task(name, "ends", marks) for name in "abc"]
    pool = Fading(answers=2)  # how many go at once, and the first
    found = [(done.task.place, done.why) for done in sweep([*tasks, tasks[2]], tmp_path, pool, "test", lambda d: d.why)]
    lost = "failed: nobody answers"
    assert found == [("scene/a", ""), ("scene/b", lost), ("scene/c", lost), ("scene/c", lost)]
    assert [len(started(marks, name)) for name in "abc"] == [1, 0, 0] and not pool.stopped
    assert capsys.readouterr().err.splitlines()[-1] == f"scene/c: {lost} (4 of 4)"


@pytest.mark.parametrize(
    ("error", "why"),
    [(KeyError("x"), "failed: KeyError: 'x'"), (CancelledError(), "failed: the run was cancelled with its scheduler")],
)
def test_a_worker_that_is_gone_costs_its_task(error: Exception, why: str, tmp_path: Path, marks: Path) -> None:
    (done,) = sweep([task("a", "ends", marks)], tmp_path, Fading(9, error), "test", lambda done: done.why)
    assert done.why == why and not done.at_hand and not started(marks, "a")


def test_equal_tasks_run_once_and_each_is_told(tmp_path: Path, marks: Path) -> None:
    one = task("a", "ends", marks)
    found = list(sweep([one, replace(one, place="scene/again")], tmp_path, Fading(9), "test", lambda done: done.why))
    assert [done.task.place for done in found] == ["scene/a", "scene/again"] and len(started(marks, "a")) == 1
    assert all((tmp_path / place / "proof").read_text() == "a" for place in ("scene/a", "scene/again"))


def test_who_wants_no_more_stops_the_pool(tmp_path: Path, marks: Path) -> None:
    pool = Fading(9)
    half = sweep([task(name, "ends", marks) for name in "ab"], tmp_path, pool, "test", lambda done: done.why)
    next(half)
    half.close()
    assert pool.stopped and not started(marks, "b")


def test_a_run_that_takes_too_long_is_given_up(tmp_path: Path, marks: Path) -> None:
    (done,) = sweep([replace(task("a", "waits", marks), timeout=0.5)], tmp_path, Fading(9), "test", lambda d: d.why)
    assert done.why == "failed: signal 9"


def test_a_lane_takes_its_tasks_one_after_the_other(tmp_path: Path) -> None:
    """Two of 100 s that cannot go side by side, and three of 10 s beside them."""
    lane = [Task(name, name, (), "proof", "lane", seconds=100.0) for name in "xy"]
    free = [Task(name, name, (), "proof", seconds=10.0) for name in "abc"]
    for jobs, whole in ((1, "3 min 50 s"), (2, "3 min 20 s"), (8, "3 min 20 s")):
        assert listed([*lane, *free, lane[0]], tmp_path, jobs)[-1].endswith(f"about {whole}")
    assert listed(free, tmp_path, 3)[-1] == "3 of 3 runs to do, 3 at a time: about 10 s"
    assert listed(free, tmp_path, 1)[-1] == "3 of 3 runs to do: about 30 s"


def test_a_lane_goes_one_by_one_and_first_and_long_runs_before_short_ones() -> None:
    free = [Task(name, name, (), "proof") for name in "abc"]
    lane = [Task(name, name, (), "proof", "lane") for name in "xyz"]
    assert _next([*free, *lane], [], 2) == [lane[0], free[0]]
    assert _next([*free, *lane[1:]], [lane[0]], 2) == free[:2]
    assert _next(lane[1:], [lane[0]], 1) == []
    long = Task("d", "d", (), "proof", seconds=9.0)
    assert _next([*free, long, *lane], [], 3) == [lane[0], long, free[0]]


def test_an_output_folder_belongs_to_one_engine(tmp_path: Path, marks: Path) -> None:
    from verify.support.refusal import Refusal

    with opened(tmp_path), pytest.raises(Refusal, match="no other debond is at work"):
        runs([task("a", "ends", marks)], tmp_path, 1)
    assert not started(marks, "a")


def test_a_folder_of_an_earlier_version_is_moved_aside(tmp_path: Path, marks: Path) -> None:
    (tmp_path / "scene" / "a").mkdir(parents=True)
    (tmp_path / "scene" / "a" / "mine").touch()
    runs([task("a", "ends", marks)], tmp_path, 1)
    assert (tmp_path / "scene" / "a.earlier" / "mine").exists() and (tmp_path / "scene" / "a" / "proof").exists()


def test_an_output_folder_can_be_moved(tmp_path: Path, marks: Path) -> None:
    runs([task("a", "ends", marks)], tmp_path / "old", 1)
    (tmp_path / "old").rename(tmp_path / "new")
    assert (tmp_path / "new" / "scene" / "a" / "proof").exists()


def test_a_copy_where_there_are_no_links(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(*how, **options):
        raise OSError("no links here")

    (tmp_path / "whole").mkdir()
    (tmp_path / "whole" / "proof").touch()
    monkeypatch.setattr(Path, "symlink_to", refused)
    link(tmp_path, "scene/a", tmp_path / "whole")
    assert (tmp_path / "scene" / "a" / "proof").exists() and not (tmp_path / "scene" / "a").is_symlink()


def test_a_dry_run_lists_what_is_missing(tmp_path: Path, marks: Path) -> None:
    tasks = [task(name, "ends", marks) for name in "abc"]
    runs(tasks[:1], tmp_path, 1)
    lines = listed(tasks, tmp_path, 2)
    assert "at hand" in lines[0] and "about 1 s" in lines[1]
    assert lines[-1] == "2 of 3 runs to do, 2 at a time: about 1 s"
    assert not started(marks, "b")


def test_commands_list_their_runs_and_leave_nothing(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    from verify.cli import main

    out = tmp_path / "out"
    assert main(["verify", "dcb-czm1-linear", "--dry-run", "--out", str(out)]) == 0
    said = capsys.readouterr().out.splitlines()
    assert any(line.startswith("dcb-czm1-linear/nurbs ") and "about" in line for line in said)
    assert "runs to do" in said[-1]
    assert main(["hard", "coarse-czm2", "--dry-run", "--out", str(out)]) == 0
    assert capsys.readouterr().out.splitlines()[0].startswith("coarse-czm2/tspline ") and not out.exists()


def test_a_path_takes_more_steps_where_its_front_asks_for_them() -> None:
    """Counted on the paths of both codes: 86 steps on dcb-czm1 where 40 are asked for, 200 on peel-120."""
    asked = ["discretization.steps=40"]
    assert steps(load_scene("dcb-czm1", asked), "nurbs") == pytest.approx(86, rel=0.1)
    assert steps(load_scene("peel-120", asked), "nurbs") == pytest.approx(200, rel=0.2)
    enough = ["discretization.steps=150"]
    for more in ((), ("load.opening=0.1",)):
        assert steps(load_scene("dcb-czm1", [*enough, *more]), "nurbs") == 150
    chosen = load_scene("dcb-czm1", ["discretization.steps=auto"])
    assert steps(chosen, "nurbs") == steps(chosen, "dolfinx") < 86 and steps(chosen, "beam") == 150


def test_the_hash_tells_what_a_result_rests_on(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = load_scene("dcb-czm1")
    same = fingerprint(scene, "nurbs")
    assert same == fingerprint(load_scene("dcb-czm1"), "nurbs")
    others = [
        fingerprint(load_scene("dcb-czm1", ["interface.strength=4.001"]), "nurbs"),
        fingerprint(scene, "tspline"),
        fingerprint(scene, "nurbs", "repeat 1"),
    ]
    job = Job("dcb-czm1", scene, "nurbs", "a", ("discretization.dofs=500",))
    others += [job.task().key, Job("dcb-czm1", scene, "nurbs", "a", ("discretization.dofs=501",)).task().key]
    for name, value in (("machine", {"processor": "another"}), ("versions", {"numpy": "1"})):
        monkeypatch.setattr(f"verify.runs.fingerprint.{name}", lambda value=value: value)
        others.append(fingerprint(scene, "nurbs"))
        monkeypatch.undo()
    monkeypatch.setenv("OMP_NUM_THREADS", "7")
    others.append(fingerprint(scene, "nurbs"))
    assert len({same, *others}) == 1 + len(others)
    assert source(("iga",)) != source(("fem_reference",)) != source()


def test_durations_read_well() -> None:
    words = [duration(s) for s in (0.25, 8.24, 42.0, 200.0, 7500.0)]
    assert words == ["0.25 s", "8.2 s", "42 s", "3 min 20 s", "2 h 5 min"]


def test_what_reads_a_run_names_the_file_that_is_damaged(tmp_path: Path, marks: Path) -> None:
    """Where its reader takes it, it is whole as far as its proof goes, and is not done again."""

    def reader(folder: Path) -> None:
        raise Damaged(folder / "curve.csv", "no numbers")

    done = [task("a", "ends", marks)]
    list(sweep(done, tmp_path, Fading(9), "test", lambda done: done.why))
    (again,) = sweep([replace(done[0], read=lambda folder: None)], tmp_path, Fading(9), "test", lambda done: "")
    assert again.at_hand and len(started(marks, "a")) == 1
    assert _damage(done[0], Store(tmp_path / STORE_FOLDER)) == ""
    assert _damage(replace(done[0], read=reader), Store(tmp_path / STORE_FOLDER)) == "curve.csv"


def test_of_a_pool_that_does_not_answer_nothing_runs_at_once() -> None:
    assert _at_once(Fading(0)) == 0 and _at_once(Fading(3)) > 0


def test_a_pool_that_takes_no_task_has_lost_it(tmp_path: Path) -> None:
    class Gone:
        def submit(self, *given: object) -> Future:
            raise ConnectionError("the cluster is gone")

    lost = _submitted(Task("a", "a", (), "proof"), Store(tmp_path), Gone())
    assert _why(lost) == "failed: ConnectionError: the cluster is gone"


def test_a_run_without_its_proof_has_failed_however_it_ends(tmp_path: Path, marks: Path) -> None:
    (marks / "silent.py").write_text(SILENT)
    (done,) = runs([Task("scene/a", digest("a"), ("silent", OUTPUT_FOLDER), "proof")], tmp_path, 1)
    assert done.why == "failed: nothing to do" and not (tmp_path / "scene" / "a" / "proof").exists()
