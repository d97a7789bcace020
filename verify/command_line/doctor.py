"""Installed packages, working methods, and how to get the others."""

from __future__ import annotations

import os
import re
import shutil
import sys
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

from verify.methods.dolfinx import DOLFINX_WAYS, NEWEST, OLDEST, dolfinx_installed, supported
from verify.methods.peers import cache_folder
from verify.methods.plugins import Plugin, plugins
from verify.runs.environment import package_version
from verify.support.refusal import NotRun

#: Packages with their purposes and the extra of debond that installs each; without an extra it is required.
PACKAGES = {
    "numpy": ("everything", ""),
    "scipy": ("everything", ""),
    "pydantic": ("scenes", ""),
    "tqdm": ("progress bars", "report"),
    "jinja2": ("the report", "report"),
    "matplotlib": ("the figures of the report", "report"),
    "openpyxl": ("workbooks of testing machines", "sheets"),
    "distributed": ("--scheduler, runs on a dask cluster", "distributed"),
    "pyvista": ("pictures of fields from scripts", "fields"),
    "pytest": ("debond test", "dev"),
    "hypothesis": ("debond test", "dev"),
}


def examine() -> tuple[list[str], bool]:
    """Lines for the user, and whether all required packages are installed."""
    missing = {name: extra for name, (_, extra) in PACKAGES.items() if not _present(name)}
    needed, report = "" not in missing.values(), not {"jinja2", "matplotlib"} & set(missing)
    lines = [*_machine(), "", *map(_package, PACKAGES), *_dolfinx(), "", *map(_state, plugins().values())]
    lines += [
        f"tspline, nurbs, lagrange, beam, lefm: {'work' if needed else 'do not work'}",
        f"dolfinx: {'works' if dolfinx_installed() else 'does not work'}",
        f"report: {'works' if report else 'does not work'}",
    ]
    if missing:
        extras = ",".join(sorted({*missing.values()} - {""}))
        lines.append(f"\nThe missing packages: pip install 'debond[{extras}]'".replace("[]", ""))
    if not dolfinx_installed():
        lines += ["\nDOLFINx is not on PyPI. Three ways to it:", *(f"  {way}" for way in DOLFINX_WAYS)]
    return lines, needed


def _machine() -> Iterator[str]:
    threads = os.environ.get("OMP_NUM_THREADS", "as many as cores")
    yield _row("python", sys.version.split()[0], sys.executable)
    yield _row("cores", str(os.cpu_count()), "one run each; --jobs N for fewer at a time")
    info = Path("/proc/meminfo")
    sizes = dict(re.findall(r"(\w+): +(\d+) kB", info.read_text())) if info.exists() else {}
    total, free = (int(sizes.get(key, 0)) / 1024**2 for key in ("MemTotal", "MemAvailable"))
    known = f"{total:.1f} GB", f"{free:.1f} GB free; a run of 100,000 unknowns takes 1.2"
    yield _row("memory", *(known if total else ("unknown", "")))
    yield _row("threads", threads, "of the linear algebra in a run (OMP_NUM_THREADS)")
    folder = cache_folder()
    there = next(path for path in (folder, *folder.parents) if path.exists())
    if there.is_dir() and os.access(there, os.W_OK):
        yield _row("cache", f"{shutil.disk_usage(there).free / 1e9:.0f} GB free", str(folder))
    else:
        yield _row("cache", "read-only", f"{folder}; DEBOND_CACHE=FOLDER is another one")


def _package(name: str) -> str:
    purpose, extra = PACKAGES[name]
    if _present(name):
        return _row(name, package_version(name) or "present", purpose)
    return _row(name, "missing", f"{purpose}; pip install '{f'debond[{extra}]' if extra else name}'")


def _dolfinx() -> Iterator[str]:
    window = f"{OLDEST[0]}.{OLDEST[1]} to {NEWEST[0]}.{NEWEST[1]}"
    found, note = "missing", f"method dolfinx, {window}"
    if dolfinx_installed():
        found, note = package_version("fenics-dolfinx") or "present", "method dolfinx"
        if found != "present" and not supported(found):
            note += f": not tried with this one, but with {window}"
    yield _row("dolfinx", found, note)
    mpi = (package_version("mpi4py") or "present") if _present("mpi4py") else "missing"
    yield _row("mpi4py", mpi, "method dolfinx on many ranks")
    yield _row("mpirun", "present" if shutil.which("mpirun") else "missing", shutil.which("mpirun") or "comes with MPI")


def _state(plugin: Plugin) -> str:
    """Whether the method of another package can be loaded, in one line."""
    try:
        plugin.load()
    except NotRun as error:
        return f"{plugin.name}: does not work, {str(error).removeprefix('not run: ')}"
    return f"{plugin.name}: works ({plugin.package})"


def _row(name: str, found: str, note: str) -> str:
    return f"{name:12} {found:12} {note}".rstrip()


def _present(module: str) -> bool:
    return find_spec(module) is not None
