"""The arrows of the design: a package imports from the floors below its own alone."""

import ast
import sys
from collections import Counter
from collections.abc import Mapping
from graphlib import CycleError, TopologicalSorter
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


#: Packages, and files that stand outside of one, floor by floor from the top. An import leads to a lower floor or stays
#: within its package. The public names of `iga` and `verify` stand above all that they are imported from.
FLOORS = (
    ("verify",),
    ("verify.face",),
    ("verify.cli", "verify.testing"),
    ("verify.command_line",),
    ("verify.verification",),
    ("verify.report",),
    ("verify.report.studies",),
    ("verify.report.figures",),
    ("verify.studies", "verify.export"),
    ("verify.studies.accuracy", "verify.studies.certified"),
    (
        "verify.studies.cost", "verify.studies.effects", "verify.studies.hard", "verify.studies.law",
        "verify.studies.reduce", "verify.studies.validation", "verify.studies.vary",
    ),
    ("verify.studies.pairs_page", "verify.studies.uncertainty_page"),
    ("verify.studies.page",),
    ("verify.studies.pairs", "verify.studies.uncertainty"),
    ("verify.studies.frame",),
    ("verify.runs",),
    ("verify.checks",),
    ("verify.diagnosis",),
    ("verify.runs.estimate", "verify.runs.fingerprint", "verify.runs.store"),
    ("verify.runs.environment",),
    ("verify.pages",),
    ("verify.fields",),
    ("verify.methods.built_in",),
    ("verify.methods",),
    ("verify.reduction",),
    ("verify.curves",),
    ("verify.verdict",),
    ("verify.meshes",),
    ("verify.scene",),
    ("verify.result",),
    ("verify.theory.arms",),
    ("verify.theory",),
    ("verify.support",),
    ("verify.version",),
    ("fem_reference.solve",),
    ("fem_reference.output",),
    ("fem_reference.path",),
    ("fem_reference.model",),
    ("fem_reference.dolfinx_api",),
    ("fem_reference.problem",),
    ("iga",),
    ("iga.dcb", "iga.peel"),
    ("iga.delamination",),
    ("iga.run",),
    ("iga.output",),
    ("iga.specimen",),
    ("iga.path",),
    ("iga.system",),
    ("iga.interface", "iga.elements", "iga.files", "iga.tsplines"),
    ("iga.bases", "iga.laws"),
    ("iga.mesh", "iga.algebra"),
    ("iga.notebook",),
)  # fmt: skip
FLOOR = {room: floor for floor, rooms in enumerate(FLOORS) for room in rooms}

#: Modules of a package at most, its ``__init__`` included.
MOST_MODULES = 14


def modules(project: Path) -> dict[str, Path]:
    """Dotted name -> file, for the product code."""
    files = [file for name in ("iga", "verify", "fem_reference") for file in sorted((project / name).rglob("*.py"))]
    return {".".join(f.relative_to(project).with_suffix("").parts).removesuffix(".__init__"): f for f in files}


def room(module: str) -> str:
    """The package, or the file outside of one, that a module belongs to."""
    while module not in FLOOR:
        module = module.rpartition(".")[0]
    return module


def targets(source: str, known: Mapping[str, Path]) -> set[str]:
    """Modules of the project that ``source`` imports, wherever the import stands."""
    found = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            inner = {f"{node.module}.{alias.name}" for alias in node.names}
            found |= (inner & set(known)) or {node.module}
    return found & set(known)


def arrows_up(project: Path) -> list[str]:
    """Imports that lead to the same floor or a higher one, or to a package that stands on no floor."""
    known = modules(project)
    arrows = [(module, to) for module, file in known.items() for to in targets(file.read_text(), known) if to != module]
    return [f"{a} -> {b}" for a, b in arrows if room(a) != room(b) and FLOOR[room(a)] >= FLOOR[room(b)]]


def circles(project: Path) -> tuple[str, ...]:
    """Modules that import each other in a circle; a package's face may import what is in it."""
    known = modules(project)
    graph = {module: targets(file.read_text(), known) for module, file in known.items() if file.stem != "__init__"}
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        return tuple(error.args[1])
    return ()


def test_imports_lead_down_and_never_in_a_circle():
    assert arrows_up(PROJECT) == [] and circles(PROJECT) == ()


def test_an_arrow_up_and_a_circle_are_found(tmp_path):
    for name in ("iga/mesh/bezier", "iga/mesh/rank", "iga/path/step"):
        file = tmp_path / f"{name}.py"
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text("import numpy\n")
    (tmp_path / "iga/mesh/bezier.py").write_text(
        "def f():\n    from iga.path.step import g\n\n\nfrom iga.mesh import rank\n"
    )
    (tmp_path / "iga/mesh/rank.py").write_text("from iga.mesh.bezier import f\n")
    assert arrows_up(tmp_path) == ["iga.mesh.bezier -> iga.path.step"]
    assert set(circles(tmp_path)) == {"iga.mesh.bezier", "iga.mesh.rank"}


def test_a_package_has_few_modules():
    sizes = Counter(file.parent.relative_to(PROJECT) for file in modules(PROJECT).values())
    assert {str(folder): size for folder, size in sizes.items() if size > MOST_MODULES} == {}


def test_iga_needs_numpy_and_scipy_only():
    assert broken("iga", only=STANDARD | {"iga", "numpy", "scipy"}) == {}


def test_fem_reference_knows_neither_iga_nor_verify():
    assert broken("fem_reference", forbidden=frozenset({"iga", "verify"})) == {}


def test_verify_never_imports_dolfinx():
    assert broken("verify", forbidden=DOLFINX) == {}


def test_problems_of_fem_reference_need_no_dolfinx():
    assert broken("fem_reference/problem", forbidden=DOLFINX) == {}


def test_launcher_runs_before_anything_is_installed():
    own = frozenset(file.stem for file in (PROJECT / "launcher").glob("*.py"))
    assert broken("launcher", only=STANDARD | own) == {}


@pytest.mark.parametrize(
    "source",
    [
        "import dolfinx.fem",
        "from dolfinx.fem import form",
        "def f():\n    import numpy, dolfinx as d",
        "import importlib\nimportlib.import_module('dolfinx.mesh')",
    ],
)
def test_every_kind_of_import_is_seen(source):
    assert "dolfinx" in imported(source)


def test_an_import_of_the_own_package_is_no_arrow():
    assert imported("from . import result\nfrom .report import page") == set()


@pytest.mark.parametrize("folder", ["iga", "verify", "fem_reference"])
def test_values_are_frozen(folder):
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


#: Where the public names of a package live: every package with such names has its own table.
OF_EVERY_PACKAGE = {"_HOMES"}


def constants(project: Path) -> dict[str, set[str]]:
    """Name -> values, as source text, of every constant that a module of the product sets."""
    found: dict[str, set[str]] = {}
    for file in modules(project).values():
        for node in ast.parse(file.read_text()).body:
            if isinstance(node, ast.Assign | ast.AnnAssign) and node.value is not None:
                for target in node.targets if isinstance(node, ast.Assign) else [node.target]:
                    for name in ast.walk(target):
                        if isinstance(name, ast.Name) and name.id.isupper():
                            found.setdefault(name.id, set()).add(ast.unparse(node.value))
    return found


def test_a_name_of_a_constant_has_one_value():
    """Readers and searches of the tree find one thing by one name."""
    assert {name for name, values in constants(PROJECT).items() if len(values) > 1} <= OF_EVERY_PACKAGE


def test_a_second_value_of_a_constant_is_found(tmp_path):
    for name, text in (("iga/a", "STEPS = 1\nSAME = 2\n"), ("verify/b", "STEPS, MOST = 1, 2\nSAME: int = 2\n")):
        (tmp_path / name).parent.mkdir()
        (tmp_path / f"{name}.py").write_text(text)
    assert {name for name, values in constants(tmp_path).items() if len(values) > 1} == {"STEPS"}


def test_no_module_gives_a_constant_a_second_value():
    """The later value would hold for the functions above it, too."""
    twice = []
    for module, file in modules(PROJECT).items():
        names = [
            target.id
            for node in ast.parse(file.read_text()).body
            for target in getattr(node, "targets", [])
            if isinstance(target, ast.Name) and target.id.isupper()
        ]
        twice += [f"{module}.{name}" for name, times in Counter(names).items() if times > 1]
    assert twice == []
