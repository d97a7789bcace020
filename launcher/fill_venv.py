"""Installs what the project needs into the virtual environment whose Python runs this file.

With the word ``tests`` also what only tests need. The wishes come from pyproject.toml, the versions from pins.txt.
NumPy and SciPy of the base Python stay where it has them: its DOLFINx was compiled against them.
"""

import importlib.metadata
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

HERE = Path(__file__).resolve().parent
LEFT_TO_THE_BASE = ("numpy", "scipy")
EXTRAS = ("report", "sheets", "dev")
EXTRAS_OF_TESTS = ("distributed", "docs", "fields", "meshes")


def requirements(tests: bool) -> list[str]:
    """What to install: the dependencies and the extras of the report, of development and of tests."""
    project = tomllib.loads((HERE.parent / "pyproject.toml").read_text())["project"]
    extras = project["optional-dependencies"]
    wanted = (*EXTRAS, *(EXTRAS_OF_TESTS if tests else ()))
    return [*project["dependencies"], *(wish for extra in wanted for wish in extras[extra])]


def constraints() -> list[str]:
    """The pins, without those of packages that the base Python supplies."""
    present = {name for name in LEFT_TO_THE_BASE if is_installed(name)}
    lines = (line.strip() for line in (HERE / "pins.txt").read_text().splitlines())
    return [line for line in lines if line and not line.startswith("#") and line.split("==")[0] not in present]


def is_installed(name: str) -> bool:
    """Whether this Python has the distribution ``name``."""
    try:
        importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError:
        return False
    return True


def main() -> int:
    """Run pip; its exit code."""
    with tempfile.NamedTemporaryFile("w", suffix=".txt") as file:
        file.write("\n".join(constraints()) + "\n")
        file.flush()
        pip = [sys.executable, "-m", "pip", "install", "--no-input", "--disable-pip-version-check"]
        return subprocess.call([*pip, "--constraint", file.name, *requirements("tests" in sys.argv[1:])])


if __name__ == "__main__":
    raise SystemExit(main())
