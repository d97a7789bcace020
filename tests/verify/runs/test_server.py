"""Runs that a process forks which has imported the package."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from verify.runs import server

pytestmark = pytest.mark.skipif(not server.POSSIBLE, reason="processes are copied on Linux alone")

PROGRAM = """
import os, sys, time
imported = "iga" in sys.modules
print(os.getppid(), imported, os.getcwd(), os.environ.get("MARK"), *sys.argv[1:], flush=True)
if "sleeps" in sys.argv:
    time.sleep(60)
if "raises" in sys.argv:
    raise RuntimeError("the last words")
sys.exit(7 if "fails" in sys.argv else 0)
"""


@pytest.fixture
def environment(tmp_path: Path) -> dict[str, str]:
    (tmp_path / "said.py").write_text(PROGRAM)
    paths = [str(tmp_path), str(Path(__file__).resolve().parents[3])]
    return {**os.environ, "PYTHONPATH": os.pathsep.join(paths)}


def test_one_server_does_one_run_after_the_other_each_in_a_process_of_its_own(tmp_path: Path, environment) -> None:
    running: set = set()

    def run(*words: str, seconds: float = 60.0, **more: str) -> tuple[int, list[str]]:
        log = tmp_path / "log.txt"
        log.write_text("")
        code = server.call(["said", *words], log, tmp_path, seconds, environment | more, running)
        return code, log.read_text().splitlines()

    code, (first,) = run("a")
    assert code == 0 and first.split()[1:] == ["True", str(tmp_path), "None", "a"]
    code, (second,) = run("fails")
    assert code == 7 and second.split()[0] == first.split()[0] != str(os.getpid()), "the same server"
    code, said = run("raises")
    assert code == 1 and said[-1] == "RuntimeError: the last words"
    code, said = run("sleeps", seconds=0.5)
    assert code == -9 and len(said) == 1
    code, (other,) = run("a", MARK="x")
    assert code == 0 and other.split()[3] == "x" and other.split()[0] != first.split()[0], "another environment"
    assert not running
