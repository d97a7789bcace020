"""Executors of the runs: threads of this process, or the workers of a dask cluster."""

from __future__ import annotations

import subprocess
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Protocol

from verify.support.refusal import Refusal

if TYPE_CHECKING:
    from distributed import Client

#: Seconds within which a scheduler has to answer.
ANSWER_SECONDS = 10


class Process(Protocol):
    """A run, as much as is needed to end it."""

    def terminate(self) -> None: ...

    def wait(self, timeout: float | None = None) -> int: ...


class Pool(Protocol):
    """The interface that a sweep needs."""

    def slots(self) -> int:
        """Number of simultaneous runs."""

    def submit(self, work: Callable[..., str], *arguments: object) -> Future:
        """Begin a run."""

    def stop(self) -> None:
        """Drop the runs that have not begun, and end the others."""


@dataclass(frozen=True)
class Local:
    """Threads, each of which waits for a process."""

    jobs: int
    executor: Executor
    running: set[Process]

    def slots(self) -> int:
        return self.jobs

    def submit(self, work: Callable[..., str], *arguments: object) -> Future:
        return self.executor.submit(partial(work, *arguments, running=self.running))

    def stop(self) -> None:
        self.executor.shutdown(wait=False, cancel_futures=True)
        ended = list(self.running)
        for process in ended:
            process.terminate()
        for process in ended:
            with suppress(subprocess.TimeoutExpired):
                process.wait(ANSWER_SECONDS)


@dataclass(frozen=True)
class Cluster:
    """Workers of dask with access to the same files; the runs of a worker that dies are done by another."""

    client: Client
    executor: Executor

    def slots(self) -> int:
        return max(sum(self.client.nthreads().values()), 1)

    def submit(self, work: Callable[..., str], *arguments: object) -> Future:
        return self.executor.submit(work, *arguments)

    def stop(self) -> None:
        self.executor.shutdown(wait=False)


@contextmanager
def pool(jobs: int, scheduler: str | None = None) -> Iterator[Pool]:
    """Runs on this machine, or through the dask scheduler at an address.

    Raises
    ------
    Refusal : dask is not installed, or no scheduler answers.
    """
    if scheduler is None:
        here = Local(jobs, ThreadPoolExecutor(jobs), set())
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
