"""A code of others that does not do what it should: one sentence each, and everything else is judged."""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path

import numpy as np
import pytest

from verify import verification
from verify.cli import main
from verify.methods import peers
from verify.methods.solve import solve
from verify.scene.load import load_scene
from verify.studies.one_scene import planned

SCENE = "dcb-czm1-linear"

#: What the program does that stands in the place of MOOSE's; it has the curve of a right run in ``curve``, and writes
#: its lines to ``scene.csv`` by ``write``.
PROGRAM = """#!{python}
import os, signal, sys, time
curve = open({curve!r}).read().splitlines()
def write(lines):
    open("scene.csv", "w").write("\\n".join(lines) + "\\n")
def cells(change):
    return curve[:1] + [",".join(map(str, change(*map(float, line.split(","))))) for line in curve[1:]]
{fault}
"""
FAULTS = {
    "hangs": ("time.sleep(60)", "has not ended within 2 s"),
    "hangs after half": ("write(curve[:40]); print('step', flush=True); time.sleep(60)", "has not ended within 2 s"),
    "is killed": ("os.kill(os.getpid(), signal.SIGKILL)", "has ended with -9: without a word"),
    "segfaults": ("os.kill(os.getpid(), signal.SIGSEGV)", "has ended with -11: without a word"),
    "segfaults after half": ("write(curve[:40]); os.kill(os.getpid(), signal.SIGSEGV)", "has ended with -11"),
    "fails": ("print('no such block'); sys.exit(3)", "has ended with 3: no such block"),
    "fails in bytes": ("sys.stdout.buffer.write(b'\\xff\\xfe bad\\n'); sys.exit(1)", "has ended with 1: "),
    "runs out of memory": ("print('out of memory', file=sys.stderr); os.abort()", "has ended with -6: out of memory"),
    "writes nothing": ("pass", "wrote no curve"),
    "writes an empty file": ("open('scene.csv', 'w')", "wrote no curve"),
    "writes a header alone": ("write(curve[:1])", "wrote no curve"),
    "writes one row": ("write(curve[:2])", "wrote no curve"),
    "has no load": ("write([line.rpartition(',')[0] for line in curve])", "no column load"),
    "has other names": ("write(['time,P', *curve[1:]])", "no column opening"),
    "writes half a line": ("write(curve[:40] + ['0.9'])", "in row 40 of its table"),
    "writes words": ("write(curve[:40] + ['0.9,failed'])", "in row 40 of its table"),
    "writes nan": ("write(cells(lambda d, P: (d, P if d < 1 else float('nan'))))", "must be finite"),
    "writes infinity": ("write(cells(lambda d, P: (d, P if d < 1 else float('inf'))))", "must be finite"),
    "writes bytes": ("open('scene.csv', 'wb').write(bytes(range(128, 256)))", "wrote no curve"),
    "is no program": (None, "Exec format error|cannot execute"),
    "is not there": ("", "No such file"),
    "may not be run": ("NOT EXECUTABLE", "Permission denied"),
}


@pytest.fixture(scope="module")
def right(tmp_path_factory):
    """The curve of the beam, which everybody else has."""
    found, path = solve(load_scene(SCENE), "beam"), tmp_path_factory.mktemp("right") / "curve.csv"
    np.savetxt(path, np.transpose([found.opening, found.load]), delimiter=",", header="opening,load", comments="")
    return path


@pytest.fixture(scope="module")
def cache(tmp_path_factory):
    """One for all faults, as the process that runs a job keeps the environment that it was begun with."""
    return tmp_path_factory.mktemp("cache")


def verified(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> tuple[int, dict]:
    """The exit code of a verification by beam and MOOSE, and its verdict."""
    monkeypatch.setattr(verification, "write_page", lambda *a: None)
    two = ("beam", "moose")
    monkeypatch.setattr(verification, "planned", lambda *a: [job for job in planned(*a) if job.variant in two])
    words = ["verify", SCENE, "--peers", "moose", "--no-ladder", "--jobs", "1", "--out", str(tmp_path / "out")]
    return main(words), json.loads((tmp_path / "out/verdict.json").read_text())


@pytest.mark.slow
@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_of_a_peer_is_a_sentence(name, right, cache, tmp_path, monkeypatch, capfd):
    fault, why = FAULTS[name]
    monkeypatch.setenv("DEBOND_CACHE", str(cache))
    monkeypatch.setenv("DEBOND_PEER_SECONDS", "2")
    program = peers.named("moose").site / "rabbit/bin/rabbit"
    program.parent.mkdir(parents=True, exist_ok=True)
    program.unlink(missing_ok=True)
    if fault != "":
        text = "\0" if fault is None else PROGRAM.format(python=sys.executable, curve=str(right), fault=fault)
        program.write_text(text)
        program.chmod(0o644 if fault == "NOT EXECUTABLE" else 0o755)
    code, verdict = verified(tmp_path, monkeypatch)
    said = capfd.readouterr()
    told = [line for line in said.out.splitlines() if "moose" in line]
    assert code == 1 and any(re.search(why, line) for line in told), said.out
    assert "Traceback" not in said.out + said.err
    told = [line for line in told if line.startswith("moose:")]
    assert len(told) == 1, told
    of_beam = [check for check in verdict["checks"] if check["subject"] == "beam"]
    assert of_beam and all(check["state"] != "broken" for check in of_beam)
