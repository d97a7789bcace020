"""The environments the launcher knows, in the order it tries them."""

from __future__ import annotations

import importlib.util
import os
import re
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import debian_root
from bubblewrap import mounts
from building import Trouble, digest, need_space, only_one, remove_tree, run_logged, say

LAUNCHER = Path(__file__).resolve().parent
PROJECT = LAUNCHER.parent
#: Set inside an environment, so that a launcher started there does not set up another.
MARK = "DEBOND_INSIDE"
PATH_IN_ROOT = "/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin"
#: One thread a process, and Open MPI as root, with more ranks than cores and none of them tied to one; without TCP, and
#: without libfabric, which looks for networks at every start: MPI_Init takes 0.25 s in place of 1.3 s.
DEFAULTS = {
    "OMPI_MCA_btl": "^tcp,ofi",
    "OMP_NUM_THREADS": "1",
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "OMPI_MCA_rmaps_base_oversubscribe": "1",
    "OMPI_MCA_hwloc_base_binding_policy": "none",
}
OPEN_MPI_5 = {
    "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe",
    "PRTE_MCA_hwloc_default_binding_policy": "none",
}
OPEN_MPI_6 = {"PRTE_MCA_mapby": ":oversubscribe", "PRTE_MCA_bindto": "none"}
MISLEADING = ("PYTHONHOME", "VIRTUAL_ENV", "PYTHONSTARTUP", "__PYVENV_LAUNCHER__", "PYENV_VERSION")
MISLEADING_IN_ROOT = ("LD_LIBRARY_PATH", "LD_PRELOAD", "PYTHONPATH", "LANG", "LANGUAGE", "CONDA_PREFIX")
FIND_DOLFINX = "import sys, importlib.util as u; sys.exit(sys.version_info < (3, 11) or u.find_spec('dolfinx') is None)"
IMPORT_DOLFINX = "import dolfinx; print(dolfinx.__version__)"


@dataclass(frozen=True)
class Place:
    """A virtual environment, and the private root it lives in or None."""

    cache: Path
    venv: Path
    root: Path | None = None
    sees_host: bool = False  # built on a Python of the host that has DOLFINx: its search paths stay


def cache_folder() -> Path:
    """Where everything that is built is kept."""
    home = Path(os.environ.get("XDG_CACHE_HOME") or "~/.cache")
    return Path(os.environ.get("DEBOND_CACHE") or home / "debond").expanduser().absolute()


def inside() -> Place | None:
    """The environment this process already runs in, or None."""
    venv = os.environ.get(MARK)
    return Place(cache_folder(), Path(venv), sees_host=True) if venv else None


def find(tests: bool = False) -> Place:
    """The first environment that works, with what only tests need or without. Raises Trouble when there is none."""
    cache = cache_folder()
    if os.environ.get("DEBOND_NO_DOLFINX", "0") not in ("", "0"):
        return plain(cache, tests)
    if os.environ.get("DEBOND_SUITE"):
        return private_root(cache, tests)
    for way in (own_dolfinx, private_root):
        try:
            found = way(cache, tests)
        except Trouble as trouble:
            say(str(trouble))
            continue
        if found is not None:
            return found
    say("going on without DOLFINx; conda users: conda env create -f environment.yml")
    return plain(cache, tests)


def own_dolfinx(cache: Path, tests: bool = False) -> Place | None:
    """A virtual environment on a Python of this machine that has DOLFINx, or None."""
    base = python_with_dolfinx()
    if base is None:
        return None
    venv = cache / f"venv-dolfinx-{digest(*recipe(), base)}"
    if not is_whole(venv):
        done = subprocess.run([base, "-c", IMPORT_DOLFINX], check=False, capture_output=True, text=True)
        version = done.stdout.strip().rpartition("\n")[2]
        if done.returncode != 0:
            raise Trouble(f"{base} has a DOLFINx that cannot be imported: {done.stderr.strip().rpartition(chr(10))[2]}")
        if tuple(int(word) for word in version.split(".")[:2]) < (0, 9):
            raise Trouble(f"{base} has DOLFINx {version}, and 0.9 or newer is needed")
        say(f"{base} has DOLFINx {version}")
    return filled(Place(cache, venv, sees_host=True), base, ["--system-site-packages"], tests)


def python_with_dolfinx() -> str | None:
    """The Python that runs the launcher, or else the system's, if DOLFINx can be found in it."""
    if sys.version_info >= (3, 11) and importlib.util.find_spec("dolfinx") is not None:
        return sys.executable
    system = "/usr/bin/python3"
    if not os.path.exists(system) or os.path.realpath(system) == os.path.realpath(sys.executable):
        return None
    # an interrupt of the terminal reaches this process too, and its traceback would be shown
    found = subprocess.run([system, "-c", FIND_DOLFINX], check=False, stderr=subprocess.DEVNULL)
    return system if found.returncode == 0 else None


def private_root(cache: Path, tests: bool = False) -> Place:
    """The virtual environment of the private Debian root."""
    root = debian_root.provide(cache, tests)
    place = Place(cache, cache / f"venv-{debian_root.suite()}-{digest(*recipe(), root.name)}", root)
    return filled(place, "/usr/bin/python3", ["--system-site-packages"], tests)


def plain(cache: Path, tests: bool = False) -> Place:
    """A virtual environment from PyPI alone."""
    base = sys.executable
    if sys.version_info < (3, 11):  # noqa: UP036
        names = ("python3.14", "python3.13", "python3.12", "python3.11")
        base = next(filter(None, map(shutil.which, names)), None)
        if base is None:
            raise Trouble(f"Python 3.11 or newer is needed and this is {sys.version.split()[0]}; install a newer one")
    return filled(Place(cache, plain_venv(cache, base)), base, [], tests)


def plain_venv(cache: Path, base: str) -> Path:
    """Where the virtual environment without DOLFINx is or will be."""
    return cache / f"venv-plain-{digest(*recipe(), base)}"


def recipe() -> tuple[str, ...]:
    """What the packages of a virtual environment depend on: the requirements of the project and the pins."""
    wanted = re.findall(r'"[a-z][\w-]* *[<>=~!]=?[^"]*"', (PROJECT / "pyproject.toml").read_text())
    return (*wanted, (LAUNCHER / "pins.txt").read_text())


def is_whole(venv: Path, tests: bool = False) -> bool:
    """Whether the building of a virtual environment came to its end, and that of what only tests need."""
    return (venv / "whole").exists() and (not tests or (venv / "whole-for-tests").exists())


def filled(place: Place, base: str, options: list[str], tests: bool = False) -> Place:
    """The place, whose virtual environment is made and filled first where it is not whole."""
    if is_whole(place.venv, tests):
        return place
    with only_one(place.cache):
        if not is_whole(place.venv):
            make_venv(place, base, options)
        if not is_whole(place.venv, tests):
            add_packages(place, "the Python packages of the tests", 1.5, "tests")
            (place.venv / "whole-for-tests").touch()
    return place


def make_venv(place: Place, base: str, options: list[str]) -> None:
    """Make and fill a virtual environment where it will stay; the file ``whole`` is written last."""
    remove_tree(place.venv)
    log_of(place).unlink(missing_ok=True)
    make = [*entered(place), base, "-m", "venv", *options, str(place.venv)]
    need_space(place.cache, 1.0)
    run_logged(make, log_of(place), "making the virtual environment", variables(place))
    if place.sees_host:
        follow_parent(base, place.venv)
    add_packages(place, "the Python packages", 1.0)
    program = place.venv / "bin" / "debond"
    program.write_text(f'#!/bin/sh\nexec "{place.venv / "bin" / "python"}" -P -m verify "$@"\n')
    program.chmod(0o755)
    (place.venv / "whole").touch()


def add_packages(place: Place, what: str, gigabytes: float, *words: str) -> None:
    """Run ``fill_venv.py`` with these words in a virtual environment."""
    need_space(place.cache, gigabytes)
    say(f"installing {what} in {place.venv}: once, about half a minute")
    fill = [*entered(place), str(place.venv / "bin" / "python"), str(LAUNCHER / "fill_venv.py"), *words]
    run_logged(fill, log_of(place), f"installing {what}", variables(place))


def entered(place: Place) -> list[str]:
    """Words that let a command run in the root of the place, if it has one."""
    return ["bwrap", "--die-with-parent", *mounts(place.root, PROJECT, (PROJECT, place.cache))] if place.root else []


def log_of(place: Place) -> Path:
    """What the builders of a virtual environment print."""
    return place.venv.with_name(place.venv.name + ".log")


def follow_parent(base: str, venv: Path) -> None:
    """Let ``venv`` see the packages of ``base`` where that is a virtual environment too, as in the DOLFINx images."""
    code = "import sys, site; print('\\n'.join(site.getsitepackages() if sys.prefix != sys.base_prefix else []))"
    folders = subprocess.run([base, "-c", code], check=True, capture_output=True, text=True).stdout
    for site in venv.glob("lib/python3*/site-packages"):
        (site / "parent.pth").write_text(folders)


def variables(place: Place) -> dict[str, str]:
    """The environment variables of a program that runs in ``place``; what the user has set stays."""
    drop = {*MISLEADING, *(MISLEADING_IN_ROOT if place.root else ())}
    newer = place.root is not None and not any(place.root.glob("usr/lib/*/libprrte.so.3"))
    defaults = {**DEFAULTS, **(OPEN_MPI_6 if newer else OPEN_MPI_5)}
    env = {**defaults, **{name: text for name, text in os.environ.items() if name not in drop}}
    threads = env["OMP_NUM_THREADS"]
    env = {"OPENBLAS_NUM_THREADS": threads, "MKL_NUM_THREADS": threads, **env}
    paths = [
        str(PROJECT),
        str(PROJECT / "verify" / "front"),
        *(env["PYTHONPATH"].split(os.pathsep) if env.get("PYTHONPATH") else []),
    ]
    env["PYTHONPATH"] = os.pathsep.join(dict.fromkeys(paths))
    programs = PATH_IN_ROOT if place.root else env.get("PATH", os.defpath)
    env["PATH"] = os.pathsep.join(dict.fromkeys([str(place.venv / "bin"), *programs.split(os.pathsep)]))
    if place.root:
        env = {name: text for name, text in env.items() if not name.startswith("LC_")} | {"LC_ALL": "C.UTF-8"}
    if not place.sees_host:
        env["PYTHONNOUSERSITE"] = "1"
    if env.pop(
        "PYTHONDONTWRITEBYTECODE", ""
    ):  # a checkout without them: they are kept elsewhere, as a start takes a third less
        env.setdefault("PYTHONPYCACHEPREFIX", str(place.cache / "compiled" / "python"))
    env |= {MARK: str(place.venv), "DEBOND_CACHE": str(place.cache)}
    return {**env, "XDG_CACHE_HOME": str(place.cache / "compiled")}  # where DOLFINx keeps compiled forms
