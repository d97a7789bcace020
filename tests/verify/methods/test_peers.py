"""Codes of others in environments of their own: what is listed, what is missing, runs that end early."""

import sys
import time

import pytest

from verify.cli import main
from verify.methods import peers
from verify.methods.solve import solve
from verify.scene.load import load_scene
from verify.support.refusal import NotRun


@pytest.fixture
def nowhere(tmp_path, monkeypatch):
    """A cache folder without any environment."""
    monkeypatch.setenv("DEBOND_CACHE", str(tmp_path))
    return tmp_path


def test_peers_are_listed_with_what_they_can(nowhere, capsys):
    assert main(["peers"]) == 0
    said = capsys.readouterr().out
    assert all(f"{name}: " in said for name in peers.known()) and "not installed" in said
    assert {"moose", "oofem", "akantu", "pyfem", "scikit-fem", "kratos", "fedoo", "ogs"} <= peers.known().keys()


def test_one_that_is_not_installed_is_told_with_the_way(nowhere, capsys):
    for words in (["verify", "dcb-czm1-linear", "--peers", "moose"], ["verify", "dcb-czm1", "--peers", "abacus"]):
        assert main(words) == 2
    said = capsys.readouterr().err
    assert "moose is not installed: debond peers install moose" in said and "must be one of" in said
    with pytest.raises(NotRun, match="debond peers install moose"):
        solve(load_scene("dcb-czm1-linear"), "moose")
    assert main(["peers", "remove", "moose"]) == 2


def test_what_cannot_be_installed_leaves_nothing(nowhere, capsys, monkeypatch):
    monkeypatch.setenv("PIP_NO_INDEX", "1")
    assert main(["peers", "install", "pyfem"]) == 2
    assert "has ended with 1: " in capsys.readouterr().err
    assert not list(nowhere.glob("peers/*"))


@pytest.mark.parametrize(
    ("program", "why"),
    [
        ("import time; time.sleep(60)", "has not ended within 1 s"),
        ("print('no mesh'); raise SystemExit(3)", "has ended with 3: no mesh"),
        ("import os, signal; os.kill(os.getpid(), signal.SIGSEGV)", "has ended with -11: without a word"),
    ],
)
def test_a_run_that_ends_otherwise_is_a_sentence(program, why, nowhere, monkeypatch):
    monkeypatch.setenv("DEBOND_PEER_SECONDS", "1")
    began = time.monotonic()
    with pytest.raises(RuntimeError, match=why):
        peers.run("moose", [sys.executable, "-c", program], nowhere)
    assert time.monotonic() - began < 20.0


def test_lines_are_told_as_they_come(nowhere):
    lines = []
    peers.run("moose", [sys.executable, "-c", "print('a'); print('b')"], nowhere, lines.append)
    assert [line.strip() for line in lines] == ["a", "b"]


def test_the_start_of_a_program_ends_with_its_word_or_its_first_line(nowhere):
    """Another line before the word is one of the start; the word is none that a failure ends with."""
    waits = "import time; print('banner', flush=True); time.sleep(0.3); print({!r}, flush=True)"
    for word in ("ready", "row 1"):
        program, times, begin = waits.format(word), [], time.monotonic()
        words = [sys.executable, "-c", program]
        begun = peers.run("moose", words, nowhere, lambda _, t=times, b=begin: t.append(time.monotonic() - b))
        assert (begun > times[0]) is (word == "ready") and 0.0 < begun <= times[1]
    with pytest.raises(RuntimeError, match="has ended with 1: banner"):
        peers.run("moose", [sys.executable, "-c", f"{waits.format('ready')}; raise SystemExit(1)"], nowhere)


def test_cost_names_a_peer_that_is_not_installed(nowhere, capsys):
    assert main(["cost", "dcb-czm1-linear", "--peers", "moose", "--out", str(nowhere / "out")]) == 2
    assert "moose is not installed: debond peers install moose" in capsys.readouterr().err
