"""Installed packages, working methods, and how to get the others."""

from __future__ import annotations

import os
import re
import shutil
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

from verify.methods.dolfinx import DOLFINX_WAYS, NEWEST, OLDEST, dolfinx_installed, supported
from verify.methods.plugins import Plugin, plugins
from verify.runs.environment import package_version
from verify.support.refusal import NotRun


@dataclass(frozen=True)
class Package:
    """A package, its purpose, and the extra of debond that installs it; without an extra it is required."""

    module: str
    distribution: str
    purpose: str
    extra: str = ""


PACKAGES = (
    Package("numpy", "numpy", "everything"),
    Package("scipy", "scipy", "everything"),
    Package("pydantic", "pydantic", "scenes"),
    Package("tqdm", "tqdm", "progress bars", "report"),
    Package("jinja2", "jinja2", "the report", "report"),
    Package("matplotlib", "matplotlib", "the figures of the report", "report"),
    Package("distributed", "distributed", "--scheduler, runs on a dask cluster", "distributed"),
    Package("pyvista", "pyvista", "pictures of fields from scripts", "fields"),
    Package("pytest", "pytest", "debond test", "dev"),
    Package("hypothesis", "hypothesis", "debond test", "dev"),
)


def examine() -> tuple[list[str], bool]:
    """Lines for the user, and whether all required packages are installed."""
    needed = all(_present(package.module) for package in PACKAGES if not package.extra)
    report = all(map(_present, ("jinja2", "matplotlib")))
    lines = [*_machine(), "", *map(_package, PACKAGES), *_dolfinx(), "", *map(_state, plugins().values())]
    lines += [
        f"tspline, nurbs, lagrange, beam, lefm: {'work' if needed else 'do not work'}",
        f"dolfinx: {'works' if dolfinx_installed() else 'does not work'}",
        f"report: {'works' if report else 'does not work'}",
    ]
    extras = sorted({package.extra for package in PACKAGES if package.extra and not _present(package.module)})
    if extras or not needed:
        lines.append(f"\nThe missing packages: pip install 'debond[{','.join(extras)}]'".replace("[]", ""))
    if not dolfinx_installed():
        lines += ["\nDOLFINx is not on PyPI. Three ways to it:", *(f"  {way}" for way in DOLFINX_WAYS)]
    return lines, needed


def _machine() -> Iterator[str]:
    threads = os.environ.get("OMP_NUM_THREADS", "as many as cores")
    yield _row("python", sys.version.split()[0], sys.executable)
    yield _row("cores", str(os.cpu_count()), "one run each; --jobs N for fewer at a time")
    yield _row("memory", *_memory())
    yield _row("threads", threads, "of the linear algebra in a run (OMP_NUM_THREADS)")
    yield _row("cache", *_cache())


def _memory() -> tuple[str, str]:
    """Total and free memory."""
    found = Path("/proc/meminfo")
    sizes = dict(re.findall(r"(\w+): +(\d+) kB", found.read_text())) if found.exists() else {}
    total, free = (int(sizes.get(key, 0)) / 1024**2 for key in ("MemTotal", "MemAvailable"))
    return (f"{total:.1f} GB", f"{free:.1f} GB free; a run of 100,000 unknowns takes 1.2") if total else ("unknown", "")


def _cache() -> tuple[str, str]:
    """Whether the folder for the environments of ./debond is writable, and its path."""
    home = Path(os.environ.get("XDG_CACHE_HOME") or "~/.cache")
    folder = Path(os.environ.get("DEBOND_CACHE") or home / "debond").expanduser().absolute()
    there = next(path for path in (folder, *folder.parents) if path.exists())
    if there.is_dir() and os.access(there, os.W_OK):
        return f"{shutil.disk_usage(there).free / 1e9:.0f} GB free", str(folder)
    return "read-only", f"{folder}; DEBOND_CACHE=FOLDER is another one"


def _package(package: Package) -> str:
    if _present(package.module):
        return _row(package.module, package_version(package.distribution) or "present", package.purpose)
    way = f"debond[{package.extra}]" if package.extra else package.distribution
    return _row(package.module, "missing", f"{package.purpose}; pip install '{way}'")


def _dolfinx() -> Iterator[str]:
    window = f"{OLDEST[0]}.{OLDEST[1]} to {NEWEST[0]}.{NEWEST[1]}"
    if dolfinx_installed():
        found = package_version("fenics-dolfinx") or "present"
        known = found == "present" or supported(found)
        yield _row(
            "dolfinx", found, f"method dolfinx{'' if known else f': not tried with this one, but with {window}'}"
        )
    else:
        yield _row("dolfinx", "missing", f"method dolfinx, {window}")
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
