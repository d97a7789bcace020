"""Bad input is refused before any work: a sentence with key, range and value, exit code 2, and nothing is written."""

from __future__ import annotations

import argparse
import os
import shlex
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path

import files_with_causes
import pytest
from iga_files import SMALL

from iga.files import iga_reader
from verify.cli import REFUSED, main
from verify.command_line import arguments
from verify.support import limited

PROJECT = Path(__file__).resolve().parents[3]
#: Command -> line -> what must be said.
LINES = tomllib.loads(Path(__file__).with_name("refused.toml").read_text())
CAUSES = tomllib.loads(Path(__file__).with_name("causes.toml").read_text())["cause"]
FILES = {
    "broken.toml": "[specimen\n",
    "a-file": "",
    "curve.csv": "opening,load\n0,0\n1,2\n3,1\n",
    "other.csv": "opening,weight\n0,0\n1,2\n",
    "holes.csv": "opening,load\n0,0\n1\n",
    "point.csv": "opening,load\n1,1\n1,2\n",
    "small.iga": SMALL,
    "raised.iga": SMALL.replace("node 2 0.5 0 1", "node 2 0.5 0.25 1"),
    "volume.iga": "type volume\nnodeN 1\nelemN 1\nnode 0 0 0 1\nbelem 1 1 1 1\n0\n1 1 1 1 1 1 1 1\n",
    "arms.msh": "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n",
}


def exit_code(words: list[str]) -> int:
    try:
        return main(words)
    except SystemExit as end:  # argparse
        return int(end.code or 0)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder to stand in, in which a file of 1 MB is too large."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(limited.read_at_most, "__defaults__", (10**6,))
    monkeypatch.setattr(iga_reader, "FILE_LIMITS", iga_reader.FileLimits(size=10**6))
    for name, text in FILES.items():
        (tmp_path / name).write_text(text)
    for name in ("abaqus.csv", "expected.csv"):
        shutil.copy(PROJECT / "examples" / "regression_test" / name, tmp_path)
    return tmp_path


@pytest.mark.parametrize("line", [line for lines in LINES.values() for line in lines])
def test_bad_input_is_refused_before_any_work(line, folder, capsys):
    before = {path: path.stat().st_size for path in folder.rglob("*")}
    assert exit_code(shlex.split(line)) == REFUSED
    said = capsys.readouterr()
    assert next(lines[line] for lines in LINES.values() if line in lines) in said.err
    assert "Traceback" not in said.err and said.out == ""
    assert {path: path.stat().st_size for path in folder.rglob("*")} == before


@pytest.mark.parametrize("cause", CAUSES, ids=lambda cause: cause["says"])
def test_a_cause_is_named_where_it_is_one_alone(cause, folder, capsys):
    """By lines that have it, and by none of at least three that have another one."""
    files_with_causes.write(folder)
    assert len(cause["not_by"]) >= 3
    for line in [*cause["by"], *cause["not_by"]]:
        exit_code(shlex.split(line))
        said = capsys.readouterr().err
        assert (cause["says"] in said) is (line in cause["by"]), f"{line}: {said}"
        assert "Traceback" not in said


def test_keys_without_end_are_refused(folder, capsys):
    long = ".".join(["a"] * 50_000)
    for text in (f"{long} = 1", f"[{long}]", "x = {" + long[:99] + " = 1}"):
        (folder / "scene.toml").write_text(text)
        assert exit_code(["solve", "scene.toml"]) == REFUSED
        assert "keys of at most 20 parts" in capsys.readouterr().err
    assert exit_code(["solve", "dcb-czm1", "--set", f"{long}=1"]) == REFUSED
    assert "at most 20 parts, got 50000" in capsys.readouterr().err


def test_a_deleted_working_folder_is_named(tmp_path):
    script = f"import os; os.rmdir('{tmp_path}'); os.execv({sys.executable!r}, 'python -P -m verify scenes'.split())"
    environment = os.environ | {"PYTHONPATH": str(PROJECT)}
    done = subprocess.run([sys.executable, "-P", "-c", script], cwd=tmp_path, env=environment, capture_output=True)
    assert done.returncode == REFUSED and b"has been deleted" in done.stderr and b"Traceback" not in done.stderr


#: Type of an option -> texts and their values, and texts that are refused -> with which range.
TAKEN: dict[Callable, dict[str, object]] = {
    arguments.positive: {"1": 1, "12": 12, "123456789": 123456789},
    arguments.count: {"0": 0, "1": 1, "123456789": 123456789},
    arguments.positives: {"1,2,4": [1, 2, 4]},
    arguments.accuracy: {"0.5%": 0.005, "0.5 %": 0.005, "0.005": 0.005, "0": 0.0, "100%": 1.0},
    arguments.fraction: {"0": 0.0, "0.25": 0.25, "3": 3.0},
    arguments.scale: {"-1": -1.0, "1e-3": 1e-3},
    arguments.numbers: {"1,-2.5,0": [1.0, -2.5, 0.0]},
    arguments.column: {"0": 0, "12": 12, "load": "load", "-1": "-1", "²": "²", "1234567890": "1234567890"},
    arguments.columns: {"3,U2": (3, "U2")},
    arguments.seeds: {"3": (0, 2), "40-79": (40, 79)},
    arguments.names_of: {"p=S22,t=S12": {"p": "S22", "t": "S12"}},
    arguments.scales_of: {"g=1e3,t=-1": {"g": 1e3, "t": -1.0}},
}
NOT_TAKEN: dict[Callable, dict[str, str]] = {
    arguments.positive: dict.fromkeys(("0", "-1", "1.5", "", "²"), "an integer >= 1, got"),
    arguments.count: {"-1": "an integer >= 0, got", "1234567890": "an integer >= 0 and < 1000000000, got"},
    arguments.fraction: dict.fromkeys(("-0.1", "inf", "nan", "half", ""), "a number >= 0, got"),
    arguments.accuracy: dict.fromkeys(("-0.1", "inf", "half", ""), "a number >= 0, got"),
    arguments.scale: {"0": "a finite number other than 0, got", "inf": "a finite number, got"},
    arguments.numbers: {"1,": "a finite number, got ''", "one": "a finite number, got"},
    arguments.columns: {"3,": "names or numbers of columns"},
    arguments.seeds: dict.fromkeys(("0", "9-3", "x", "-3"), "a number >= 1, or two like 40-79"),
}


@pytest.mark.parametrize("kind", TAKEN, ids=lambda kind: kind.__name__)
def test_values_of_options(kind):
    assert {text: kind(text) for text in TAKEN[kind]} == TAKEN[kind]
    for text, rule in NOT_TAKEN.get(kind, {}).items():
        with pytest.raises(argparse.ArgumentTypeError) as refused:
            kind(text)
        assert str(refused.value).startswith(f"must be {rule}"), text
