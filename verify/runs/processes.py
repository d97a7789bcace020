"""The processes of runs, and who begins them: threads of this process, or the workers of a dask cluster.

Processes are forked by the server of `multiprocessing`, which has imported `verify.runs.preloaded`; where there is
none, they import it themselves. They have the environment of the first run.
"""

from __future__ import annotations

import atexit
import multiprocessing
import os
import runpy
import signal
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, field
from multiprocessing.connection import wait
from multiprocessing.process import BaseProcess
from pathlib import Path
from threading import Lock, Thread
from time import sleep
from types import ModuleType
from typing import Any

from verify.support.refusal import Refusal

#: Seconds within which a scheduler has to answer.
ANSWER_SECONDS = 10

#: Starting a process also asks all others for their exit codes, which only one thread may read.
_LOCK = Lock()


def call(words: list[str], log: Path, cwd: Path, timeout: float, running: set[BaseProcess]) -> int:
    """Run a module with arguments in a process of its own, which ``running`` contains meanwhile.

    Returns the exit code, or -n after signal n.

    Raises
    ------
    TimeoutError : it took longer than ``timeout`` seconds, and was killed.
    """
    forked = "forkserver" in multiprocessing.get_all_start_methods()
    context: Any = multiprocessing.get_context("forkserver" if forked else "spawn")
    if forked:
        context.set_forkserver_preload(["verify.runs.preloaded"])
    process = context.Process(target=_run, args=(words, log, cwd), daemon=True)
    main = sys.modules["__main__"]
    with _LOCK:
        multiprocessing.current_process().daemon = False  # a worker of dask is one, which could not begin others
        sys.modules["__main__"] = ModuleType("__main__")  # else the process would first run the script of a user again
        try:
            process.start()
        finally:
            sys.modules["__main__"] = main
        running.add(process)
    in_time = bool(wait([process.sentinel], timeout))
    if not in_time:
        process.kill()
        wait([process.sentinel])
    with _LOCK:
        process.join()
        running.discard(process)
    if not in_time:
        raise TimeoutError
    return process.exitcode or 0


def _run(words: list[str], log: Path, cwd: Path) -> None:
    """Run a module with arguments as the main program, with its output in the log."""
    Thread(target=_end_with_parent, daemon=True).start()
    nothing, said = os.open(os.devnull, os.O_RDONLY), os.open(log, os.O_WRONLY | os.O_APPEND | os.O_CREAT)
    for target, source in ((0, nothing), (1, said), (2, said)):
        os.dup2(source, target)
    os.chdir(cwd)
    sys.argv[:] = words
    atexit.register(_end_mpi)  # the first to be registered is the last to be called
    runpy.run_module(words[0], run_name="__main__", alter_sys=True)


def _end_mpi() -> None:
    """End MPI, if it runs: a process that was forked ends without the part of the interpreter's end that does so."""
    if mpi := sys.modules.get("mpi4py.MPI"):
        mpi.Finalize()


def _end_with_parent() -> None:
    """End this process when the one that asked for it has ended, in whatever way: else it would slow down others."""
    parent = multiprocessing.parent_process()
    assert parent is not None
    parent.join()
    os.kill(os.getpid(), signal.SIGTERM)


@dataclass(frozen=True)
class Local:
    """An executor of threads, each of which waits for a process."""

    jobs: int
    executor: Executor
    running: set[BaseProcess] = field(default_factory=set)
    begun: list[Future] = field(default_factory=list)

    def slots(self) -> int:
        """Number of simultaneous runs."""
        return self.jobs

    def submit(self, work: Callable[..., str], *arguments: object) -> Future:
        """Begin a run."""
        self.begun.append(self.executor.submit(work, *arguments, self.running))
        return self.begun[-1]

    def stop(self) -> None:
        """Drop the runs that have not begun, and end the others."""
        self.executor.shutdown(wait=False, cancel_futures=True)
        while not all(future.done() for future in self.begun):
            for process in list(self.running):
                process.kill()
            sleep(0.02)


@dataclass(frozen=True)
class Cluster:
    """An executor of dask workers with access to the same files; the runs of one that dies are done by another."""

    client: Any
    executor: Executor

    def slots(self) -> int:
        return max(sum(self.client.nthreads().values()), 1)

    def submit(self, work: Callable[..., str], *arguments: object) -> Future:
        return self.executor.submit(work, *arguments)

    def stop(self) -> None:
        self.executor.shutdown(wait=False)


Pool = Local | Cluster


@contextmanager
def pool(jobs: int, scheduler: str | None = None) -> Iterator[Pool]:
    """Runs on this machine, or through the dask scheduler at an address.

    Raises
    ------
    Refusal : dask is not installed, or no scheduler answers.
    """
    if scheduler is None:
        here = Local(jobs, ThreadPoolExecutor(jobs, initializer=_hold_interrupts))
        try:
            yield here
        finally:
            here.stop()
        return
    try:
        from distributed import Client
    except ImportError:
        raise Refusal("--scheduler: needs dask.distributed; pip install 'debond[distributed]'") from None
    try:
        client = Client(scheduler, timeout=ANSWER_SECONDS, set_as_default=False)
    except (OSError, ValueError) as error:
        raise Refusal(f"--scheduler: must be the address of a dask scheduler, got {scheduler!r}: {error}") from None
    try:
        yield Cluster(client, client.get_executor(pure=False))
    finally:
        client.close(timeout=ANSWER_SECONDS)


def _hold_interrupts() -> None:
    """Keep interrupts from the server, which a thread begins: it would print where in its imports one came."""
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
