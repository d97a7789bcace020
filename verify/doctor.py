"""What is installed here, what therefore works, and how to get the rest."""

from __future__ import annotations

import os
import sys
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec

from verify.methods import DOLFINX_WAYS, NotRun, dolfinx_installed
from verify.plugins import Plugin, plugins

#: module -> (distribution, what it is for, whether nothing works without it)
PACKAGES = {
    "numpy": ("numpy", "everything", True),
    "scipy": ("scipy", "everything", True),
    "pydantic": ("pydantic", "scenes", True),
    "jinja2": ("jinja2", "the report", False),
    "matplotlib": ("matplotlib", "the figures of the report", False),
    "tqdm": ("tqdm", "progress bars", False),
    "pytest": ("pytest", "debond test", False),
    "hypothesis": ("hypothesis", "debond test", False),
    "dolfinx": ("fenics-dolfinx", "method dolfinx", False),
    "mpi4py": ("mpi4py", "method dolfinx under mpirun", False),
}


def examine() -> tuple[list[str], bool]:
    """Lines for the user, and whether the main job can run at all."""
    lines = [f"python       {sys.version.split()[0]:12} {sys.executable}", f"cores        {os.cpu_count()}"]
    needed = True
    for module, (distribution, purpose, must) in PACKAGES.items():
        present = find_spec(module) is not None
        needed &= present or not must
        lines.append(f"{module:12} {_version(distribution) if present else 'missing':12} {purpose}")
    lines.append("")
    report = all(find_spec(module) for module in ("jinja2", "matplotlib"))
    lines += [
        *map(_state, plugins().values()),
        f"tspline, nurbs, lagrange, beam, lefm: {'work' if needed else 'do not work'}",
        f"dolfinx: {'works' if dolfinx_installed() else 'does not work'}",
        f"report: {'works' if report else 'does not work'}",
    ]
    if not report or not needed:
        lines.append("\nThe missing packages: pip install 'debond[report]'")
    if not dolfinx_installed():
        lines += ["\nDOLFINx is not on PyPI. Three ways to it:", *(f"  {way}" for way in DOLFINX_WAYS)]
    return lines, needed


def _state(plugin: Plugin) -> str:
    """Whether the method of another package can be loaded, in one line."""
    try:
        plugin.load()
    except NotRun as error:
        return f"{plugin.name}: does not work, {str(error).removeprefix('not run: ')}"
    return f"{plugin.name}: works ({plugin.package})"


def _version(distribution: str) -> str:
    try:
        return version(distribution)
    except PackageNotFoundError:
        return "present"
