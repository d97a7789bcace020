"""The arrows of the design: verify -> iga, verify -> fem_reference, and nothing else."""

import ast
import sys
from pathlib import Path

import pytest

PROJECT = Path(__file__).resolve().parent.parent
DOLFINX = frozenset({"dolfinx", "ufl", "basix", "ffcx", "petsc4py", "mpi4py"})
STANDARD = frozenset(sys.stdlib_module_names)


def imported(source: str) -> set[str]:
    """Top-level names of all packages that ``source`` imports, wherever the import stands."""
    names = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            names |= {alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            names.add(node.module.partition(".")[0])
        elif isinstance(node, ast.Call) and called(node.func) in ("import_module", "__import__", "importorskip"):
            names |= {str(arg.value).partition(".")[0] for arg in node.args[:1] if isinstance(arg, ast.Constant)}
    return names


def called(function: ast.expr) -> str:
    """Name of a called function without what stands before the last dot."""
    return function.attr if isinstance(function, ast.Attribute) else getattr(function, "id", "")


def imports_of(folder: str) -> dict[str, set[str]]:
    """File -> imported packages, for all Python files under ``folder``."""
    files = sorted((PROJECT / folder).rglob("*.py"))
    assert files, f"no Python files under {folder}"
    return {str(file.relative_to(PROJECT)): imported(file.read_text()) for file in files}


def broken(folder: str, *, forbidden: frozenset[str] = frozenset(), only: frozenset[str] | None = None) -> dict:
    """File -> packages it must not import."""
    found = {
        file: {name for name in names if name in forbidden or (only is not None and name not in only)}
        for file, names in imports_of(folder).items()
    }
    return {file: names for file, names in found.items() if names}


def test_iga_needs_numpy_and_scipy_only() -> None:
    assert broken("iga", only=STANDARD | {"iga", "numpy", "scipy"}) == {}


def test_fem_reference_knows_neither_iga_nor_verify() -> None:
    assert broken("fem_reference", forbidden=frozenset({"iga", "verify"})) == {}


def test_verify_never_imports_dolfinx() -> None:
    assert broken("verify", forbidden=DOLFINX) == {}


def test_launcher_runs_before_anything_is_installed() -> None:
    own = frozenset(file.stem for file in (PROJECT / ".ci" / "launcher").glob("*.py"))
    assert broken(".ci/launcher", only=STANDARD | own) == {}


@pytest.mark.parametrize(
    "source",
    [
        "import dolfinx.fem",
        "from dolfinx.fem import form",
        "def f():\n    import numpy, dolfinx as d",
        "import importlib\nimportlib.import_module('dolfinx.mesh')",
    ],
)
def test_every_kind_of_import_is_seen(source: str) -> None:
    assert "dolfinx" in imported(source)


def test_an_import_of_the_own_package_is_no_arrow() -> None:
    assert imported("from . import result\nfrom .report import page") == set()


@pytest.mark.parametrize("folder", ["iga", "verify", "fem_reference"])
def test_values_are_frozen(folder: str) -> None:
    """No data class of which an object could change after it was made."""
    classes, mutable = 0, []
    for file in sorted((PROJECT / folder).rglob("*.py")):
        for node in ast.walk(ast.parse(file.read_text())):
            for made in node.decorator_list if isinstance(node, ast.ClassDef) else []:
                if called(made.func if isinstance(made, ast.Call) else made) == "dataclass":
                    said = {word.arg: word.value for word in made.keywords} if isinstance(made, ast.Call) else {}
                    frozen = isinstance(said.get("frozen"), ast.Constant) and said["frozen"].value is True
                    classes, mutable = classes + 1, mutable if frozen else [*mutable, f"{file.name}: {node.name}"]
    assert classes > 5 and mutable == []
