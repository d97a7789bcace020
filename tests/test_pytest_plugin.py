"""The fixture `curve_regression`, in test files of a user of it."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import debond
import pytest

FRONT = Path(debond.__file__).parents[1]
TEST = """
import numpy as np

D = np.linspace(0.0, 3.0, 301)
P = D / (0.1 + D**2)

def test_a(curve_regression):
    curve_regression((D, FACTOR * P))
    curve_regression({"u": D, "f": 2 * P}, "other [1]", rel=0.01, reading=READING)
"""
READING = """
from verify.testing import Reading
READING = Reading(opening="u", load="f", load_scale=0.5)
"""


def ran(folder: Path, factor: float, *words: str) -> tuple[int, str]:
    """Exit code and output of pytest on a test of curves that are ``factor`` times too large."""
    (folder / "test_mine.py").write_text(f"FACTOR = {factor}\n{READING}{TEST}")
    return pytest_in(folder, *words)


def pytest_in(folder: Path, *words: str) -> tuple[int, str]:
    """Exit code and output of pytest with no plug-in but this one, in a process of its own."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(map(str, (FRONT, FRONT.parents[1])))}
    plugin = ["-p", "debond.pytest_plugin", "-p", "no:cacheprovider", "-c", os.devnull, "--rootdir", "."]
    command = [sys.executable, "-P", "-m", "pytest", "-q", *plugin, *words]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)
    return done.returncode, done.stdout + done.stderr


def test_a_curve_is_held_to_its_file(tmp_path):
    code, said = ran(tmp_path, 1.0)
    assert code == 1 and f"{tmp_path / 'test_mine' / 'test_a.csv'}: is missing; run pytest --update-curves" in said
    assert ran(tmp_path, 1.0, "--update-curves")[0] == 0
    assert sorted(file.name for file in (tmp_path / "test_mine").iterdir()) == ["other_1_.csv", "test_a.csv"]
    kept = (tmp_path / "test_mine" / "test_a.csv").read_text()
    assert ran(tmp_path, 1.0005)[0] == 0
    code, said = ran(tmp_path, 1.002)
    assert code == 1 and "actual is not close to expected: curve error 0.2 %" in said
    assert (tmp_path / "test_mine" / "test_a.csv").read_text() == kept
    assert ran(tmp_path, 1.002, "--update-curves")[0] == 0
    assert (tmp_path / "test_mine" / "test_a.csv").read_text() != kept


def test_two_curves_of_a_test_need_two_names(tmp_path):
    """Without them the second one would take the place of the first, which then never passes."""
    test = "def test_c(curve_regression):\n    for P in ([0, 1], [0, 2]):\n        curve_regression(([0, 1], P))\n"
    (tmp_path / "test_c.py").write_text(test)
    code, said = pytest_in(tmp_path, "test_c.py", "--update-curves")
    assert code == 1 and "name: must be another one for each curve of a test, got 'test_c' again" in said


def test_the_example_passes_as_it_is():
    folder = FRONT.parents[1] / "examples" / "regression_test"
    code, said = pytest_in(folder)
    assert code == 0 and "2 passed" in said


def test_who_does_not_use_it_imports_nothing(tmp_path):
    test = "import sys\ndef test_b(): assert {'numpy', 'verify', 'iga', 'pydantic'}.isdisjoint(sys.modules)\n"
    (tmp_path / "test_b.py").write_text(test)
    assert ran(tmp_path, 1.0, "test_b.py")[0] == 0


def test_pytest_finds_it_where_debond_is_installed():
    tomllib = pytest.importorskip("tomllib")
    project = tomllib.loads((FRONT.parents[1] / "pyproject.toml").read_text())["project"]
    assert project["entry-points"]["pytest11"] == {"debond": "debond.pytest_plugin"}
