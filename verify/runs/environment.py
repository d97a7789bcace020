"""Machine, versions, threads and MPI ranks of a run."""

from __future__ import annotations

import ctypes
import os
import re
import sys
from functools import cache
from pathlib import Path
from typing import Any

from verify.version import __version__

#: mallopt(3) parameters of glibc and their values: keep up to 256 MB, and serve blocks up to 32 MB from the heap.
M_TRIM_THRESHOLD, M_MMAP_THRESHOLD = (-1, 256 << 20), (-3, 32 << 20)


def mpi_rank() -> int:
    """Rank of this process, from the environment variables of mpirun, as `verify` does not import mpi4py."""
    return _number("OMPI_COMM_WORLD_RANK", "PMI_RANK", "PMIX_RANK", default=0)


def mpi_size() -> int:
    """Number of processes of this run."""
    return _number("OMPI_COMM_WORLD_SIZE", "PMI_SIZE", default=1)


def versions() -> dict[str, str]:
    """Versions of debond, Python and the installed packages."""
    names = ("numpy", "scipy", "pydantic", "fenics-dolfinx", "petsc4py", "mpi4py")
    found = {name: number for name in names if (number := package_version(name))}
    return {"debond": __version__, "python": sys.version.split()[0], **found}


@cache
def package_version(name: str) -> str:
    """Version of a package, empty if not installed; cached, as every fingerprint needs it and it takes milliseconds."""
    from importlib.metadata import PackageNotFoundError, distribution  # here, as it takes as long as the command line

    try:
        package = distribution(name)
    except PackageNotFoundError:
        return ""
    about = package.read_text("METADATA") or package.read_text("PKG-INFO") or ""
    found = re.search(r"^Version: *(\S+)", about, re.MULTILINE)  # its own reader takes all of it for an e-mail
    return found[1] if found else ""


def machine() -> dict[str, Any]:
    """System, processor and cores."""
    import platform

    cpuinfo = Path("/proc/cpuinfo")
    lines = cpuinfo.read_text().splitlines() if cpuinfo.exists() else []
    models = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    processor = models[0] if models else platform.processor() or platform.machine()
    return {"system": platform.platform(), "processor": processor, "cores": os.cpu_count()}


def threads() -> int:
    """Largest number of threads of numerical libraries."""
    return _number("OMP_NUM_THREADS", default=os.cpu_count() or 1)


def environment() -> dict[str, str]:
    """Versions, machine and threads in words, for the foot of a page."""
    about = machine()
    return {
        **versions(),
        "machine": f"{about['processor']}, {about['cores']} cores, {about['system']}",
        "threads a run": os.environ.get("OMP_NUM_THREADS", "as many as cores"),
    }


def keep_freed_memory() -> None:
    """Let the allocator reuse freed blocks instead of returning them to the system.

    By default glibc returns every large array when it is freed, and the next Newton iteration fetches and clears the
    same pages again, which was measured to cost five times the assembly. Without glibc this does nothing.
    """
    try:
        mallopt = ctypes.CDLL(None).mallopt
    except (OSError, AttributeError, TypeError):
        return
    for parameter, value in (M_TRIM_THRESHOLD, M_MMAP_THRESHOLD):
        mallopt(parameter, value)


def _number(*names: str, default: int) -> int:
    values = [os.environ[name] for name in names if os.environ.get(name, "").isdigit()]
    return int(values[0]) if values else default


#: Packages whose source affects the times of all methods.
ALL_PACKAGES = ("iga", "fem_reference")

#: Environment variables for the number of threads of numerical libraries.
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
