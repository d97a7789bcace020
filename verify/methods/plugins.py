"""Solvers of other packages: entry points of the group ``debond.methods``, each a method by its own name.

A solver is called with a scene and with a function to call after every converged step, and returns a result:

    def solve(scene: verify.scene.load.Scene, on_step: Callable[[Mapping[str, float]], None]) -> verify.result.Result

Its rows and the ``steps`` of its result hold ``opening`` and ``load``, and whatever else it knows of
``verify.result``: each column brings its checks. Where it has a function ``unsuitable`` as an attribute, that says of a
scene why the solver is not made for it, or nothing. Its attribute ``laws`` names the traction laws that it has
(``interface.law`` of a scene); left out: the bilinear one alone.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from importlib.metadata import EntryPoint, entry_points
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from verify.methods.names import METHODS, NotRun, OnStep, Unsuitable
from verify.result import Result
from verify.scene.laws import PLAIN, refusal
from verify.scene.schema import Scene
from verify.support.timing import Stopwatch, peak_memory_mb

GROUP = "debond.methods"

Solver = Callable[[Scene, OnStep], Result]

_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]*")


class PluginFault(Exception):
    """What a solver of another package did wrong."""

    whose = "the plug-in: see error.log"


@dataclass(frozen=True)
class Plugin:
    """One entry point; ``package`` is the distribution that it comes from, with its version."""

    name: str
    package: str
    entries: tuple[EntryPoint, ...]

    def load(self) -> Solver:
        """The solver. Raises NotRun where there is none: a package that does not import, a name that is taken."""
        if self.name in METHODS or not _NAME.fullmatch(self.name):
            raise NotRun(f"{self._not_run} its name must be a word of its own, no method's, got {self.name!r}")
        if len(self.entries) > 1:
            raise NotRun(f"{self._not_run} the name is there {len(self.entries)} times")
        try:
            solver = self.entries[0].load()
        except Exception as error:
            why = f"{type(error).__name__}: {_one_line(error)}"
            raise NotRun(f"{self._not_run} {self.entries[0].value} cannot be imported, {why}") from None
        if not callable(solver):
            raise NotRun(f"{self._not_run} {self.entries[0].value} must be callable, got {type(solver).__name__}")
        return solver

    @property
    def _not_run(self) -> str:
        return f"not run: plug-in {self.name} of {self.package}:"


def plugins() -> dict[str, Plugin]:
    """Those of all installed packages, by name; nothing is imported."""
    found: dict[str, list[EntryPoint]] = {}
    for entry in entry_points(group=GROUP):
        found.setdefault(entry.name, []).append(entry)
    return {
        name: Plugin(name, " and ".join(dict.fromkeys(_package(entry) for entry in entries)), tuple(entries))
        for name, entries in sorted(found.items())
    }


def require(scene: Scene, method: str) -> None:
    """Raise ``NotRun`` where the plug-in of that name is broken, ``Unsuitable`` where it says so of the scene."""
    plugin = plugins()[method]
    solver = plugin.load()
    unsuitable = getattr(solver, "unsuitable", None)
    try:
        other_law = refusal(scene.interface.law, method, getattr(solver, "laws", (PLAIN,)), METHODS)
        why = unsuitable(scene) if unsuitable is not None else ""
    except Exception as error:
        raise NotRun(f"not run: plug-in {method} of {plugin.package}: {type(error).__name__}: {error}") from None
    if other_law:
        raise Unsuitable(other_law)
    if why:
        raise Unsuitable(f"{method}: {why}")


def solve(scene: Scene, method: str, on_step: OnStep) -> Result:
    """The result of a plug-in, timed and in the shape of every other.

    Raises
    ------
    NotRun : it cannot be loaded.
    PluginFault : it fails, or returns what is no result.
    """
    plugin = plugins()[method]
    solver, watch, told = plugin.load(), Stopwatch(), _Told(on_step)
    try:
        with watch.phase("solve"):
            found = solver(scene, told)
        steps = _from_zero(_steps(found))
        if not told.any:
            for row in zip(*steps.values(), strict=True):
                on_step(dict(zip(steps, map(float, row), strict=True)))
    except Exception as error:
        raise PluginFault(f"plug-in {method} of {plugin.package}: {type(error).__name__}: {error}") from error
    memory = found.peak_memory_mb or peak_memory_mb()
    return replace(found, method=method, steps=steps, seconds=found.seconds or watch.seconds(), peak_memory_mb=memory)


def content(method: str) -> list[str]:
    """What the result of a plug-in rests on: its package, and a hash of the source next to its entry point."""
    plugin = plugins()[method]
    found = hashlib.sha256()
    for entry in plugin.entries:
        for path in _files(entry.module.partition(".")[0]):
            found.update(path.name.encode() + b"\0" + path.read_bytes() + b"\0")
    return [plugin.package, found.hexdigest()]


class _Told:
    """Passes rows on, with one of zeros before a first that is none."""

    def __init__(self, on_step: OnStep) -> None:
        self._on_step, self.any = on_step, False

    def __call__(self, row: Mapping[str, float]) -> None:
        row = {name: float(value) for name, value in row.items()}
        missing = {"opening", "load"} - set(row)
        if missing:
            raise ValueError(f"a row must have {' and '.join(sorted(missing))}, got {', '.join(row) or 'none'}")
        if not self.any and row["opening"] != 0.0:
            self._on_step(dict.fromkeys(row, 0.0))
        self.any = True
        self._on_step(row)


def _steps(found: Any) -> dict[str, np.ndarray]:
    """The columns of a result, all of one length."""
    if not isinstance(found, Result):
        raise TypeError(f"must return a verify.result.Result, got {type(found).__name__}")
    steps = {name: np.asarray(values, dtype=float) for name, values in found.steps.items()}
    missing = {"opening", "load"} - set(steps)
    if missing:
        raise ValueError(f"the steps must have {' and '.join(sorted(missing))}, got {', '.join(steps) or 'none'}")
    shapes = {name: values.shape for name, values in steps.items()}
    if len(set(shapes.values())) > 1 or steps["load"].ndim != 1:
        raise ValueError(f"the steps must be columns of one length, got {shapes}")
    if not (np.isfinite(steps["opening"]).all() and np.isfinite(steps["load"]).all()):
        raise ValueError("opening and load must be finite")
    return steps


def _from_zero(steps: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """With a first row of zeros, which is where every path begins."""
    if steps["opening"].size and steps["opening"][0] == 0.0:
        return steps
    return {name: np.append(0.0, values) for name, values in steps.items()}


def _package(entry: EntryPoint) -> str:
    dist = entry.dist
    return f"{dist.name} {dist.version}" if dist is not None else "an unknown package"


def _files(module: str) -> list[Path]:
    """The source of a top-level module or package, without importing it; none where there is none."""
    try:
        spec = find_spec(module)
    except (ImportError, ValueError):
        spec = None
    if spec is None:
        return []
    folders = [Path(place) for place in spec.submodule_search_locations or ()]
    inside = [path for folder in folders for path in sorted(folder.rglob("*")) if path.suffix in (".py", ".so", ".pyd")]
    return inside or [path for path in [Path(spec.origin or "")] if path.is_file()]


def _one_line(error: Exception) -> str:
    return " ".join(str(error).split())


def known_methods() -> dict[str, str]:
    """``METHODS``, and those of other packages (`verify.methods.plugins`)."""

    others = {name: f"plug-in of {plugin.package}" for name, plugin in plugins().items() if name not in METHODS}
    return {**METHODS, **others}
