"""Many independent runs, each in its own process; the result is a folder named by its hash, complete or absent.

A crash loses one run, and a second call does the missing runs only. Who does them: `verify.runs.processes`.
"""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, CancelledError, Future, wait
from dataclasses import dataclass
from multiprocessing.process import BaseProcess
from pathlib import Path

from verify.runs.folder import damage
from verify.runs.processes import Pool, call
from verify.runs.store import STORE_FOLDER, Store, link, opened
from verify.support.checked_files import Damaged
from verify.support.progress import Progress, duration

#: Placeholder for the output folder in the arguments of a program.
OUTPUT_FOLDER = "{folder}"

ALIVE_EVERY_SECONDS = 1.0

#: Exit codes of a program that ended normally: success, or a failed check.
ENDED = (0, 1)


@dataclass(frozen=True)
class Task:
    """One run to do.

    Parameters
    ----------
    place : path of the result in the output folder, and the name of the run in messages
    key : hash of everything that affects the result (`verify.runs.fingerprint`)
    program : module and arguments; ``OUTPUT_FOLDER`` stands for the output folder
    proof : the file that the program writes last
    lane : tasks of one lane, unless it is empty, run one after the other
    seconds : expected time
    timeout : seconds after which the run is killed
    read : reads the result in a folder; a damaged result is computed again
    """

    place: str
    key: str
    program: tuple[str, ...]
    proof: str
    lane: str = ""
    seconds: float = 1.0
    timeout: float = 3600.0
    read: Callable[[Path], object] | None = None


@dataclass(frozen=True)
class Done:
    """The outcome of a task: its folder, and why it failed, or empty.

    The folder of a failed task has the files that it left.
    """

    task: Task
    folder: Path
    why: str = ""
    at_hand: bool = False  # from an earlier call


def sweep(tasks: Sequence[Task], out: Path, pool: Pool, title: str, say: Callable[[Done], str]) -> Iterator[Done]:
    """Yield all tasks: first those whose results are in ``out``, then the others as they end.

    Parameters
    ----------
    say : returns a short message about a task that ended
    """
    with opened(out) as store:
        damaged = {task.key: name for task in tasks if store.whole(task.key) and (name := _damage(task, store))}
        for key in damaged:
            store.set_aside(key)
        missing = [task for task in tasks if not store.whole(task.key)]
        at_hand = [task for task in tasks if store.whole(task.key)]
        with Progress(title, sum(task.seconds for task in missing), pace=_at_once(pool)) as progress:
            if damaged:
                names = ", ".join(sorted(set(damaged.values())))
                progress.line(f"{title}: {len(damaged)} runs in {out} are damaged ({names}) and are done again")
            if at_hand:
                progress.line(f"{title}: {len(at_hand)} of {len(tasks)} runs are at hand in {out}")
            for task in at_hand:
                link(out, task.place, store.folder(task.key))
                yield Done(task, out / task.place, at_hand=True)
            spent = 0.0

            def alive(running: Sequence[Task]) -> None:
                more = f" and {len(running) - 1} more" if len(running) > 1 else ""
                progress.alive(running[0].place + more)

            for count, (task, why) in enumerate(_done(missing, store, pool, alive), len(at_hand) + 1):
                kept = store.failed(task.key) if why else store.folder(task.key)
                if kept.is_dir():
                    link(out, task.place, kept)
                done = Done(task, out / task.place, why)
                spent += task.seconds
                progress.advance(spent, f"{count} of {len(tasks)} runs")
                progress.line(f"{task.place}: {say(done)} ({count} of {len(tasks)}{progress.left})")
                yield done


def _damage(task: Task, store: Store) -> str:
    folder = store.folder(task.key)
    try:
        if task.read is not None:
            task.read(folder)
    except Damaged as error:
        return error.path.name
    return damage(folder, task.proof)


def listed(tasks: Sequence[Task], out: Path, jobs: int) -> list[str]:
    """One line per run of a sweep, and the expected total time; nothing is run."""
    missing = _missing(tasks, out)
    lines = [
        f"{task.place:60} {'about ' + duration(task.seconds) if task.key in missing else 'at hand'}" for task in tasks
    ]
    at_once = f", {jobs} at a time" if jobs > 1 else ""
    whole = duration(expected_seconds(tasks, out, jobs))
    return [*lines, f"{len(missing)} of {len(tasks)} runs to do{at_once}: about {whole}"]


def expected_seconds(tasks: Sequence[Task], out: Path, jobs: int) -> float:
    """Time that the tasks take which are not at hand, ``jobs`` at a time, those of a lane one after the other."""
    lanes: dict[str, float] = {}
    for task in _missing(tasks, out).values():
        lanes[task.lane] = lanes.get(task.lane, 0.0) + task.seconds
    longest = max((seconds for lane, seconds in lanes.items() if lane), default=0.0)
    return max(sum(lanes.values()) / jobs, longest)


def _missing(tasks: Sequence[Task], out: Path) -> dict[str, Task]:
    """The tasks that are not at hand, by their keys."""
    store = Store(out / STORE_FOLDER)
    return {task.key: task for task in tasks if not store.whole(task.key)}


def _at_once(pool: Pool) -> int:
    """Number of simultaneous runs; 0 where the scheduler does not answer."""
    try:
        return pool.slots()
    except OSError:
        return 0


def _done(
    tasks: Sequence[Task], store: Store, pool: Pool, alive: Callable[[Sequence[Task]], None]
) -> Iterator[tuple[Task, str]]:
    """Yield tasks as they end, with the reason if they failed; of tasks with the same key only one runs.

    ``alive`` is called every second with the running tasks. Only as many tasks are submitted as the pool can run at
    once, so that the next task of a lane does not wait behind all others.
    """
    waiting = list({task.key: task for task in tasks}.values())
    running: dict[Future, Task] = {}
    try:
        while waiting or running:
            try:
                room = pool.slots() - len(running)
            except OSError as error:  # the scheduler does not answer; the runs that it began end by themselves
                room, lost = 0, {task.key for task in waiting}
                waiting.clear()
                yield from ((task, f"failed: {error}") for task in tasks if task.key in lost)
            for task in _next(waiting, list(running.values()), room):
                waiting.remove(task)
                running[_submitted(task, store, pool)] = task
            ended = wait(running, ALIVE_EVERY_SECONDS, return_when=FIRST_COMPLETED).done
            if running and not ended:
                alive(list(running.values()))
            for future in ended:
                task = running.pop(future)
                why = _why(future)
                yield from ((twin, why) for twin in tasks if twin.key == task.key)
    except BaseException:  # an interrupt, or the caller closes the generator
        pool.stop()
        raise


def _next(waiting: Sequence[Task], running: Sequence[Task], room: int) -> list[Task]:
    """Tasks to begin: those of lanes first, which cannot run side by side at the end, and long before short ones."""
    busy = {task.lane for task in running}
    chosen: list[Task] = []
    for task in sorted(waiting, key=lambda task: (not task.lane, -task.seconds)):
        if len(chosen) < room and not (task.lane and task.lane in busy):
            chosen.append(task)
            busy.add(task.lane)
    return chosen


def _submitted(task: Task, store: Store, pool: Pool) -> Future:
    try:
        return pool.submit(execute, task, store.root.absolute(), Path.cwd())
    except Exception as error:  # the cluster does not answer
        lost: Future = Future()
        lost.set_exception(error)
        return lost


def _why(future: Future) -> str:
    try:
        return future.result()
    except CancelledError:
        return "failed: the run was cancelled with its scheduler"
    except Exception as error:
        return f"failed: {type(error).__name__}: {error}"


def execute(task: Task, root: Path, cwd: Path, running: set[BaseProcess] | None = None) -> str:
    """Do one task; returns why it failed, or empty. ``running`` contains its process meanwhile."""
    store = Store(root)
    work = store.begin(task.key)
    words = [str(work) if word == OUTPUT_FOLDER else word for word in task.program]
    log = work / "log.txt"
    log.touch()
    try:
        code = call(words, log, cwd, task.timeout, set() if running is None else running)
    except TimeoutError:
        why = f"it took longer than {duration(task.timeout)}"
    else:
        if code in ENDED and (work / task.proof).exists() and not next(work.rglob("error.log"), None):
            store.keep(work, task.key)
            return ""
        said = log.read_text(errors="replace").strip().splitlines()
        why = said[-1] if said else f"exit {code}"
        if code < 0:
            killed = ", by somebody or by the system, which ran out of memory" if code == -signal.SIGKILL else ""
            why = f"signal {-code} ({signal.strsignal(-code)}{killed})"
    store.give_up(work, task.key)
    return f"failed: {why}"
