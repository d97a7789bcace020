"""Wheel and sdist, as pip would install them for a user: in an environment where nothing else is."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

PROJECT = Path(__file__).resolve().parents[1]

#: What a user may write; mypy knows every type in it.
PROGRAM = """
import debond

scene: debond.Scene = debond.load_scene("dcb-czm1-linear", ["interface.strength=6"])
result: debond.Result = debond.solve(scene, "beam")
peak: float = float(result.load.max())
checks = debond.run_checks(scene, result)
names: list[str] = [check.name for check in checks if not check.passed]
beam = debond.iga.Moduli(E1=120e3, nu12=0.2)
debond.assert_curves_close(result, (result.opening, result.load), curve=0.01)
print(debond.__version__, result, peak, names, beam)
"""

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("package")


@pytest.fixture(scope="module")
def python(folder):
    """The Python of a new environment with what the wheel asks for, pytest and mypy; the wheel is made of the sdist."""
    ran(sys.executable, "-m", "venv", str(folder / "venv"))
    pip = [str(folder / "venv" / "bin" / "python"), "-m", "pip", "--disable-pip-version-check", "-q"]
    reached = subprocess.run([*pip, "install", "build"], env=clean(), capture_output=True, text=True)
    if reached.returncode != 0 and "No matching distribution" in reached.stderr:
        pytest.skip("PyPI is not at hand")
    assert reached.returncode == 0, reached.stderr
    ran(pip[0], "-m", "build", "--outdir", str(folder), str(PROJECT))  # the wheel of what the sdist holds
    (wheel,) = folder.glob("*.whl")
    ran(*pip, "install", f"{wheel}", "pytest>=8.2", "mypy>=1.11")
    return Path(pip[0])


def clean() -> dict[str, str]:
    """The environment of a user, who has no copy of the project at hand."""
    return {name: text for name, text in os.environ.items() if name not in ("PYTHONPATH", "MYPYPATH", "VIRTUAL_ENV")}


def ran(*command: str, cwd: Path | None = None) -> str:
    """The output of a command that must succeed."""
    done = subprocess.run(command, cwd=cwd, env=clean(), capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_the_commands_of_the_wheel_work(python, folder):
    debond = str(python.with_name("debond"))
    assert ran(debond, "--version", cwd=folder) == "debond 0.1.0\n"
    out = folder / "run"
    assert str(out) in ran(debond, "solve", "dcb-czm1-linear", "--method", "beam", "--out", str(out), cwd=folder)
    assert (out / "result.json").exists()


def test_a_program_of_a_user_runs_and_its_types_are_known(python, folder):
    (folder / "mine.py").write_text(PROGRAM)
    assert "0.1.0 <Result: beam" in ran(str(python), "mine.py", cwd=folder)
    assert "Success" in ran(str(python), "-m", "mypy", "--strict", "mine.py", cwd=folder)
    wrong = PROGRAM.replace("peak: float = float(", "peak: str = float(")
    (folder / "wrong.py").write_text(wrong)
    done = subprocess.run([python, "-m", "mypy", "wrong.py"], cwd=folder, env=clean(), capture_output=True, text=True)
    assert done.returncode == 1 and "wrong.py:6" in done.stdout


def test_pytest_has_the_fixture(python, folder):
    (folder / "test_mine.py").write_text(
        "def test_a(curve_regression):\n    curve_regression(([0, 1, 2], [0, 2, 1]))\n"
    )
    ran(str(python), "-m", "pytest", "-q", "--update-curves", "test_mine.py", cwd=folder)
    ran(str(python), "-m", "pytest", "-q", "test_mine.py", cwd=folder)


def test_the_metadata_are_whole(python, folder):
    program = (
        "from importlib.metadata import metadata as m; d = m('debond'); print(d['License-Expression'], d['Version'])"
    )
    assert ran(str(python), "-c", program, cwd=folder) == "MIT 0.1.0\n"
