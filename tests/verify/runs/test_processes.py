"""Processes of runs: forked with all imports made, each with an exit code of its own, none left when a pool stops."""

from __future__ import annotations

import ctypes
import json
import os
import subprocess
import sys
from collections.abc import Callable
from concurrent.futures import Future
from multiprocessing.popen_forkserver import Popen
from time import sleep
from types import SimpleNamespace

import pytest

from verify.runs.environment import keep_freed_memory
from verify.runs.processes import ANSWER_SECONDS, Cluster, call, pool
from verify.support.refusal import Refusal

PROGRAM = """
import os, sys, time
print(os.getppid(), "iga" in sys.modules, os.getcwd(), *sys.argv[1:], flush=True)
if "sleeps" in sys.argv:
    time.sleep(60)
sys.exit(int(sys.argv[1]))
"""


@pytest.fixture
def said(tmp_path, monkeypatch):
    """Where the program lies that says who it is."""
    (tmp_path / "said.py").write_text(PROGRAM)
    monkeypatch.syspath_prepend(tmp_path)
    return tmp_path


def test_one_server_forks_every_run_with_an_exit_code_of_its_own(said, monkeypatch):
    """Also where several threads begin runs while others end: only one at a time asks for exit codes."""
    asking: list[int] = []
    at_once: list[int] = []

    def asked(process: Popen, *how: int, ask: Callable = Popen.poll) -> int | None:
        if process.returncode is not None:  # it is known
            return process.returncode
        asking.append(process.pid)
        at_once.append(len(asking))
        sleep(0.01)
        try:
            return ask(process, *how)
        finally:
            asking.pop()

    monkeypatch.setattr(Popen, "poll", asked)

    def one(number: int, running: set) -> str:
        log = said / f"{number}.txt"
        return f"{call(['said', str(number), 'word'], log, said, 60.0, running)} {log.read_text()}"

    with pool(3) as here:
        assert here.slots() == 3
        lines = [done.result(60).split() for done in [here.submit(one, number) for number in range(12)]]
        assert here.running == set()
    servers = {line[1] for line in lines}
    assert lines == [[str(n), *servers, "True", str(said), str(n), "word"] for n in range(12)]
    assert len(servers) == 1 and servers != {str(os.getpid())} and max(at_once) == 1


def test_what_runs_ends_with_its_pool_and_what_waits_is_dropped(said):
    def one(running: set) -> int:
        return call(["said", "0", "sleeps"], said / "log.txt", said, 60.0, running)

    with pool(1) as here:
        first, second = here.submit(one), here.submit(one)
        while not here.running:
            assert not first.done()
    assert first.result(0) == -9 and second.cancelled()


def test_a_script_that_begins_runs_is_not_run_by_them(said):
    """It needs no guard around what it does."""
    script = said / "script.py"
    script.write_text(
        "print('once', flush=True)\nfrom pathlib import Path\nfrom verify.runs.processes import call\n"
        "call(['said', '0'], Path('log.txt'), Path.cwd(), 60.0, set())"
    )
    ended = subprocess.run([sys.executable, script], cwd=said, capture_output=True, text=True, check=True)
    assert (ended.stdout, ended.stderr) == ("once\n", "")


SOLVED = """
import json, sys
import verify.runs.preloaded
before = set(sys.modules)
from verify.cli import main
assert main(["solve", "dcb-czm1-linear", "--method", sys.argv[1], "--out", sys.argv[2]]) == 0
print(json.dumps([sorted(set(sys.modules) - before), "mpi4py" in before]))
"""


@pytest.mark.parametrize("method", ["nurbs", "beam"])
def test_a_run_imports_next_to_nothing_and_its_server_no_mpi(method, tmp_path):
    words = [sys.executable, "-P", "-c", SOLVED, method, str(tmp_path)]
    done = subprocess.run(words, capture_output=True, text=True, check=True, timeout=120)
    imported, mpi = json.loads(done.stdout.splitlines()[-1])
    assert len(imported) < 5 and not mpi, imported


def test_freed_memory_is_kept_where_the_c_library_can(monkeypatch):
    """By the numbers of M_TRIM_THRESHOLD and M_MMAP_THRESHOLD in malloc.h: 256 MB are kept, 32 MB from the heap."""
    asked: list[tuple] = []
    library = SimpleNamespace(mallopt=lambda *values: asked.append(values))
    for found in (library, SimpleNamespace(), None):
        monkeypatch.setattr(ctypes, "CDLL", lambda name, found=found: found)
        keep_freed_memory()
    assert asked == [(-1, 256 * 1024**2), (-3, 32 * 1024**2)]


class Client:
    """Stands in for that of dask."""

    def __init__(self, address: str, timeout: float, set_as_default: bool) -> None:
        if address == "nowhere":
            raise OSError("no answer")
        self.workers, self.ended = {"a": 2, "b": 3}, []

    def nthreads(self) -> dict[str, int]:
        return self.workers

    def get_executor(self, pure: bool) -> SimpleNamespace:
        assert not pure, "equal runs are no single one"
        return SimpleNamespace(submit=lambda work, *given: Future(), shutdown=lambda wait: self.ended.append(wait))

    def close(self, timeout: float) -> None:
        self.ended.append(timeout)


def test_a_cluster_does_as_many_as_its_workers_have_threads(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", SimpleNamespace(Client=Client))
    with pool(9, "tcp://here:1") as there:
        assert isinstance(there, Cluster) and there.slots() == 5 and isinstance(there.submit(print, "a"), Future)
        there.client.workers.clear()
        assert there.slots() == 1, "workers may yet come"
        there.stop()
    assert there.client.ended == [False, ANSWER_SECONDS]
    with pytest.raises(Refusal, match="must be the address of a dask scheduler, got 'nowhere': no answer"):
        pool(1, "nowhere").__enter__()
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(Refusal, match="needs dask.distributed"):
        pool(1, "tcp://here:1").__enter__()
