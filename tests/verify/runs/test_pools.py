"""Who does the runs: what is told of a pool, and what is left of it when it is stopped."""

from __future__ import annotations

import subprocess
import sys
from concurrent.futures import Future
from types import SimpleNamespace

import pytest

from verify.runs.pools import ANSWER_SECONDS, Cluster, pool
from verify.support.refusal import Refusal


def test_threads_of_this_process_do_as_many_as_they_are() -> None:
    with pool(3) as here:
        assert here.slots() == 3
        done = here.submit(lambda word, running: f"{word} {sorted(running)}", "a")
        assert done.result(30) == "a []"


def test_what_runs_ends_with_its_pool_and_what_waits_is_dropped() -> None:
    begun: list[subprocess.Popen] = []

    def work(running: set) -> str:
        begun.append(subprocess.Popen([sys.executable, "-c", "import time; time.sleep(60)"]))
        running.add(begun[0])
        begun[0].wait()
        running.discard(begun[0])
        return "ended"

    with pool(1) as here:
        first, second = here.submit(work), here.submit(work)
        while not here.running:
            assert not first.done()
    assert first.result(30) == "ended" and second.cancelled()
    assert begun[0].returncode == -15 and len(begun) == 1


class Client:
    """Stands in for that of dask."""

    made: list[tuple] = []

    def __init__(self, address: str, timeout: float, set_as_default: bool) -> None:
        if address == "nowhere":
            raise OSError("no answer")
        self.closed, self.workers = None, {"a": 2, "b": 3}
        Client.made.append((address, timeout, set_as_default, self))

    def nthreads(self) -> dict[str, int]:
        return self.workers

    def get_executor(self, pure: bool) -> SimpleNamespace:
        assert not pure, "equal runs are no single one"
        self.executor = SimpleNamespace(submit=lambda work, *given: Future(), stopped=[])
        self.executor.shutdown = lambda wait: self.executor.stopped.append(wait)
        return self.executor

    def close(self, timeout: float) -> None:
        self.closed = timeout


def test_a_cluster_does_as_many_as_its_workers_have_threads(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", SimpleNamespace(Client=Client))
    with pool(9, "tcp://here:1") as there:
        ((*how, client),) = Client.made
        assert isinstance(there, Cluster) and how == ["tcp://here:1", ANSWER_SECONDS, False]
        assert there.slots() == 5 and isinstance(there.submit(print, "a"), Future)
        client.workers = {}
        assert there.slots() == 1, "workers may yet come"
        there.stop()
        assert client.executor.stopped == [False] and client.closed is None
    assert client.closed == ANSWER_SECONDS


def test_a_scheduler_that_is_none_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", SimpleNamespace(Client=Client))
    with pytest.raises(Refusal, match="must be the address of a dask scheduler, got 'nowhere': no answer"):
        with pool(1, "nowhere"):
            raise AssertionError("there is nobody")
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(Refusal, match="needs dask.distributed"), pool(1, "tcp://here:1"):
        raise AssertionError("there is nobody")
