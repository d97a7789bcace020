"""What the project says about itself: types, citation, and the hooks that run before a commit."""

import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

import verify

PROJECT = Path(__file__).resolve().parent.parent


@pytest.mark.slow
def test_types_are_right() -> None:
    pytest.importorskip("mypy")
    ran = subprocess.run([sys.executable, "-m", "mypy"], cwd=PROJECT, capture_output=True, text=True)
    assert ran.returncode == 0, ran.stdout + ran.stderr


def test_modules_whose_bodies_are_not_checked_exist() -> None:
    """A name that is misspelt or gone would silently excuse nothing, or the next module of that name."""
    overrides = tomllib.loads((PROJECT / "pyproject.toml").read_text())["tool"]["mypy"]["overrides"]
    own = [name for entry in overrides for name in entry["module"] if name.split(".")[0] in ("iga", "verify")]
    gone = [name for name in own if not any((PROJECT / path).is_file() for path in places(name))]
    assert own and gone == []


def places(module: str) -> tuple[str, str]:
    """Where the source of a module may be."""
    path = module.replace(".", "/")
    return f"{path}.py", f"{path}/__init__.py"


def test_citation_is_of_this_version() -> None:
    text = (PROJECT / "CITATION.cff").read_text()
    assert re.findall(r"^version: (.+)$", text, re.MULTILINE) == [verify.__version__]
    assert f"## [{verify.__version__}]" in (PROJECT / "CHANGELOG.md").read_text()


def test_citation_can_be_read() -> None:
    yaml = pytest.importorskip("yaml")
    said = yaml.safe_load((PROJECT / "CITATION.cff").read_text())
    assert {"cff-version", "message", "title", "authors", "version", "license", "type"} <= said.keys()
    assert all({"name"} <= who.keys() or {"family-names", "given-names"} <= who.keys() for who in said["authors"])
    (paper,) = said["references"]
    assert {"type", "title", "authors", "year"} <= paper.keys() and len(paper["authors"]) == 3


def test_hooks_run_what_is_here() -> None:
    yaml = pytest.importorskip("yaml")
    (local,) = yaml.safe_load((PROJECT / ".pre-commit-config.yaml").read_text())["repos"]
    assert local["repo"] == "local"
    assert [hook["entry"] for hook in local["hooks"]] == [
        "ruff check --force-exclude",
        "ruff format --force-exclude",
        "mypy",
    ]
