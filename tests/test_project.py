"""What the project says about itself: types, citation, and the hooks that run before a commit."""

import ast
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

import verify
from verify.command_line import doctor
from verify.command_line.parsing import parsed

PROJECT = Path(__file__).resolve().parent.parent

#: Packages whose modules have another name, come with another package, or are not on PyPI.
DISTRIBUTIONS = {"netCDF4": "netcdf4", "pydantic_core": "pydantic"}
DOLFINX = {"dolfinx", "ufl", "basix", "petsc4py", "mpi4py"}


def declared() -> dict[str, list[str]]:
    """Names of the distributions in pyproject.toml by extra; without one, those that are always needed."""
    project = tomllib.loads((PROJECT / "pyproject.toml").read_text())["project"]
    wishes = {"": project["dependencies"], **project["optional-dependencies"]}
    return {extra: [re.split(r"[^\w-]", wish)[0] for wish in words] for extra, words in wishes.items()}


def imported(source: str) -> set[str]:
    """Top-level names of the modules that are imported anywhere in ``source``."""
    nodes = list(ast.walk(ast.parse(source)))
    plain = {alias.name for node in nodes if isinstance(node, ast.Import) for alias in node.names}
    return {name.partition(".")[0] for name in plain | {n.module for n in nodes if isinstance(n, ast.ImportFrom)}}


def test_the_map_names_what_is_there_on_two_screens():
    """Paths with a folder or an ending, from the project or from the room before them in the line."""
    lines = (PROJECT / "CONTRIBUTING.md").read_text().splitlines()
    assert len(lines) <= 120
    paths = re.findall(r"`((?:verify|iga|fem_reference|tests|docs|examples)/[\w/.]*)`", "\n".join(lines))
    assert len(paths) > 30 and [one for one in paths if not ("NAME" in one or (PROJECT / one).exists())] == []


def test_every_library_that_is_imported_is_declared():
    """One that comes with another library today may stay away tomorrow."""
    names: set[str] = set()
    for folder in ("iga", "verify", "fem_reference"):
        names = names.union(*(imported(file.read_text()) for file in (PROJECT / folder).rglob("*.py")))
    others = names - sys.stdlib_module_names - {"iga", "verify", "fem_reference", "debond", *DOLFINX}
    wishes = declared()
    known = {
        name
        for extra in ("", "report", "sheets", "distributed", "fields", "meshes", "docs", "dev")
        for name in wishes[extra]
    }
    assert {DISTRIBUTIONS.get(name, name) for name in others} - known == set() and {"numpy", "matplotlib"} <= others


def test_doctor_and_conda_know_what_is_declared():
    wishes = declared()
    for package, (_, extra) in doctor.PACKAGES.items():
        assert package in wishes[""] + wishes[extra], package
    lines = re.findall(r"^ {2,6}- ([\w-]+)>=(.*)$", (PROJECT / "environment.yml").read_text(), re.MULTILINE)
    text = (PROJECT / "pyproject.toml").read_text()
    for name in wishes[""] + wishes["report"]:
        assert f'"{name}>={dict(lines)[name]}"' in text


def test_no_merge_is_unfinished():
    """A formatter indents the marks of a conflict in a docstring, where neither it nor git finds them any more."""
    folders = ("iga", "verify", "fem_reference", "tests", "launcher", "examples", "docs")
    texts = [
        file
        for folder in folders
        for end in ("py", "md", "j2", "toml")
        for file in (PROJECT / folder).rglob(f"*.{end}")
    ]
    marks = re.compile(r"^ *(<{7}|>{7}) ", re.MULTILINE)
    assert [file for file in texts if marks.search(file.read_text())] == []


@pytest.mark.slow
def test_types_are_right():
    pytest.importorskip("mypy")
    ran = subprocess.run([sys.executable, "-m", "mypy"], cwd=PROJECT, capture_output=True, text=True)
    assert ran.returncode == 0, ran.stdout + ran.stderr


def test_citation_is_of_this_version():
    text = (PROJECT / "CITATION.cff").read_text()
    assert re.findall(r"^version: (.+)$", text, re.MULTILINE) == [verify.__version__]
    assert f"## [{verify.__version__}]" in (PROJECT / "CHANGELOG.md").read_text()


def test_citation_can_be_read():
    yaml = pytest.importorskip("yaml")
    said = yaml.safe_load((PROJECT / "CITATION.cff").read_text())
    assert {"cff-version", "message", "title", "authors", "version", "license", "type"} <= said.keys()
    assert all({"name"} <= who.keys() or {"family-names", "given-names"} <= who.keys() for who in said["authors"])
    (paper,) = said["references"]
    assert {"type", "title", "authors", "year"} <= paper.keys() and len(paper["authors"]) == 3


def test_hooks_run_what_is_here():
    yaml = pytest.importorskip("yaml")
    (local,) = yaml.safe_load((PROJECT / ".pre-commit-config.yaml").read_text())["repos"]
    assert local["repo"] == "local"
    assert [hook["entry"] for hook in local["hooks"]] == [
        "ruff check --force-exclude",
        "ruff format --force-exclude",
        "mypy",
    ]


def test_type_checkers_of_users_are_told_that_there_are_types():
    wheel = tomllib.loads((PROJECT / "pyproject.toml").read_text())["tool"]["hatch"]["build"]["targets"]["wheel"]
    assert all((PROJECT / name / "py.typed").is_file() for name in (*wheel["only-include"], "verify/front/debond"))


@pytest.mark.parametrize(("folder", "name"), [("regression_test", "curves"), ("peer_test", "peer")])
def test_the_workflow_for_users_has_options_that_exist(folder, name):
    """It cannot be run here; what it says to debond can be read."""
    yaml = pytest.importorskip("yaml")
    file = PROJECT / "examples" / folder / ".github" / "workflows" / f"{name}.yml"
    (job,) = yaml.safe_load(file.read_text())["jobs"].values()
    steps = job["steps"]
    *before, command = [step["run"].split() for step in steps if step.get("run", "").startswith("debond ")]
    options = parsed(command[1:])
    assert all(parsed(words[1:]).words == ["install", options.peers] for words in before)
    assert options.require == ["dolfinx"] and str(options.junit) in str(steps[-1]) and options.format == "md"
