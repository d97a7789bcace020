"""Hash of everything that affects a result: equal hashes mean equal results, and equal times on one machine."""

from __future__ import annotations

import hashlib
import json
import os
import platform
from functools import cache
from pathlib import Path

from verify.methods import plugins
from verify.methods.names import METHODS
from verify.runs.environment import machine, versions
from verify.scene.schema import Scene
from verify.scene.toml import mesh_files

PROJECT = Path(__file__).resolve().parents[2]

#: Source that affects every run and its checks; pages, commands and studies do not.
RUN_SOURCE = (
    *(
        f"verify/{name}"
        for name in ("scene", "theory", "curves", "meshes", "methods", "fields", "checks", "runs", "support")
    ),
    "verify/result.py",
    "verify/verdict.py",
)


def fingerprint(scene: Scene, method: str, *besides: str) -> str:
    """Hash of the scene as solved, the method with its source, library versions, machine and threads.

    Parameters
    ----------
    besides : further values that distinguish two runs
    """
    plugged = [] if method in METHODS else plugins.content(method)
    return digest(_problem(scene, method), besides, source(plugins.find(method).packages), plugged, _here())


def source(packages: tuple[str, ...] = ()) -> str:
    """Hash of the source files of `RUN_SOURCE` and of whole packages, given by their paths in the project."""
    places = [PROJECT / name for name in (*packages, *RUN_SOURCE)]
    files = [path for place in places for path in (sorted(place.rglob("*.py")) if place.is_dir() else [place])]
    return _content(tuple(files))


def digest(*content: object) -> str:
    """20 hexadecimal digits of anything that JSON can hold."""
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:20]


def _problem(scene: Scene, method: str) -> list[object]:
    meshes = [hashlib.sha256(file.read_bytes()).hexdigest() for file in mesh_files(scene).values()]
    solved = scene.model_dump(mode="json", exclude={"uncertainty"})  # which no run knows
    return [solved, method, meshes]


@cache
def _content(files: tuple[Path, ...]) -> str:
    found = hashlib.sha256()
    for path in files:
        found.update(str(path.relative_to(PROJECT)).encode() + b"\0" + path.read_bytes() + b"\0")
    return found.hexdigest()


def _here() -> list[object]:
    """Versions, machine and threads, as times of another machine are not comparable."""
    return [versions(), machine(), platform.node(), os.environ.get("OMP_NUM_THREADS", "")]
