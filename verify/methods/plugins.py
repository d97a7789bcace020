"""Solvers of other packages: entry points of the group ``debond.methods``, each a method by its own name.

A solver is called with a scene and with a function to call after every converged step, and returns a result:

    def solve(scene: verify.scene.Scene, on_step: Callable[[Mapping[str, float]], None]) -> verify.result.Result

Its rows and the ``steps`` of its result hold ``opening`` and ``load``. They may hold any other column of
``verify.result``; each enables the checks that use it. The rows that it reports are its steps from the first one on:
all of them, or those up to some step, or none.

The solver may have two attributes. ``unsuitable``, a function of the scene, returns why the solver does not apply to
the scene, or an empty text. ``laws`` names the traction laws that it has (``interface.law`` of a scene); without it the
solver has the bilinear law only.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from importlib.metadata import EntryPoint, entry_points
from importlib.util import find_spec
from math import isfinite, nan
from pathlib import Path
from typing import Any

import numpy as np

from verify.methods import peers
from verify.methods.method import Failure, Method, OnFrame, OnStep, Prepared, Unsuitable
from verify.methods.names import METHODS
from verify.result import Result
from verify.scene.laws import PLAIN
from verify.scene.schema import Scene
from verify.support.refusal import NotRun, suggestion
from verify.support.timing import Stopwatch, peak_memory_mb

GROUP = "debond.methods"

#: Difference of a reported and a returned value, over the largest value, that is rounding in single precision.
SAME = 1e-6

Solver = Callable[[Scene, OnStep], Result]

_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]*")


@dataclass(frozen=True)
class Plugin:
    """One entry point; ``package`` is the distribution that it comes from, with its version, ``lacks`` why it cannot be
    used, or nothing."""

    name: str
    package: str
    entries: tuple[EntryPoint, ...]
    lacks: str = ""

    def load(self) -> Solver:
        """The solver. Raises NotRun where there is none: a package that does not import, a name that is taken."""
        if self.lacks:
            raise NotRun(f"not run: {self.lacks}")
        if self.name in METHODS or not _NAME.fullmatch(self.name):
            raise NotRun(f"not run: {self.who} its name must be a word of its own, no method's, got {self.name!r}")
        if len(self.entries) > 1:
            raise NotRun(f"not run: {self.who} the name is there {len(self.entries)} times")
        try:
            solver = self.entries[0].load()
        except Exception as error:
            why = f"{type(error).__name__}: {' '.join(str(error).split())}"
            raise NotRun(f"not run: {self.who} {self.entries[0].value} cannot be imported, {why}") from None
        if not callable(solver):
            raise NotRun(f"not run: {self.who} {self.entries[0].value} must be callable, got {type(solver).__name__}")
        return solver

    @property
    def who(self) -> str:
        """The beginning of sentences on it."""
        return f"plug-in {self.name} of {self.package}:"


def plugins() -> dict[str, Plugin]:
    """Plug-ins of all installed packages, by name; nothing is imported."""
    found: dict[str, list[EntryPoint]] = {}
    for entry in entry_points(group=GROUP):
        found.setdefault(entry.name, []).append(entry)
    packages = {
        name: [f"{one.dist.name} {one.dist.version}" if one.dist is not None else "an unknown package" for one in of]
        for name, of in found.items()
    }
    return {
        name: Plugin(name, " and ".join(dict.fromkeys(packages[name])), tuple(entries))
        for name, entries in sorted(found.items())
    }


def loaded(others: Sequence[str] = ()) -> Iterator[tuple[str, Solver]]:
    """Names and solvers of the plug-ins that can be imported: those of packages, and of the peers that are named."""
    for name in dict.fromkeys([*plugins(), *others]):
        plugin = _plugin(name)
        with suppress(NotRun):
            if plugin is not None:
                yield name, plugin.load()


def known_methods() -> dict[str, str]:
    """Name and description of every method: the built-in ones, then those of other packages."""
    others = {name: f"plug-in of {plugin.package}" for name, plugin in plugins().items() if name not in METHODS}
    return {name: method.what for name, method in METHODS.items()} | others


def find(name: str) -> Method:
    """The method of a name. An unknown name gives a method that cannot run, for judging curves of other codes."""
    if name in METHODS:
        return METHODS[name]
    if (plugin := _plugin(name)) is not None:
        return _method(name, plugin)

    def missing(prepared: Prepared, *_: object) -> Any:
        raise NotRun(f"not run: there is no method {name}; {suggestion(name, known_methods(), 'the methods')}")

    return Method(name=name, label=name, what="another code", solve=missing, require=missing, code=name)


def _plugin(name: str) -> Plugin | None:
    """The plug-in of an installed package, or else the one in the folder of a peer."""
    peer = peers.known().get(name)
    from_folder = None if peer is None else Plugin(name, peer.version, (peer.entry(GROUP),), peer.missing())
    return plugins().get(name) or from_folder


def _method(name: str, plugin: Plugin) -> Method:
    """The plug-in as a method like the built-in ones; nothing is imported before it is used."""

    def laws() -> tuple[str, ...]:
        try:
            return tuple(getattr(plugin.load(), "laws", (PLAIN,)))
        except TypeError as error:
            raise NotRun(f"not run: {_fault(plugin, error)}") from None

    def require(prepared: Prepared) -> None:
        unsuitable = getattr(plugin.load(), "unsuitable", None)
        try:
            why = unsuitable(prepared.scene) if unsuitable is not None else ""
        except Exception as error:
            raise NotRun(f"not run: {_fault(plugin, error)}") from None
        if why:
            raise Unsuitable(f"{name}: {why}")

    def solve(prepared: Prepared, on_step: OnStep, on_frame: OnFrame | None) -> Result:
        solver = plugin.load()
        try:
            return replace(_solved(solver, prepared.scene, on_step), method=name)
        except Exception as error:
            raise Failure(_fault(plugin, error), "the plug-in: see error.log") from error

    kinds: dict[str, Any] = {"takes_files": ("iga", "nodal"), "code": name, "label": name}
    kinds["packages"] = ("verify/export",)  # from which most write their input
    what = f"plug-in of {plugin.package}"
    return Method(name=name, what=what, solve=solve, require=require, laws=laws, **kinds)


def _fault(plugin: Plugin, error: Exception) -> str:
    return f"{plugin.who} {type(error).__name__}: {error}"


def _solved(solver: Solver, scene: Scene, on_step: OnStep) -> Result:
    """The result of a solver, timed, from a row of zeros on. Steps that it has not reported are reported here."""
    watch, reported = Stopwatch(), _Reported(on_step)
    with watch.phase("solve"):
        found = solver(scene, reported)
    steps = _steps(found)
    reported.finish(steps)
    memory = found.peak_memory_mb or peak_memory_mb()
    return replace(found, steps=steps, seconds=found.seconds or watch.seconds(), peak_memory_mb=memory)


def content(method: str) -> list[str]:
    """What the result of a plug-in depends on: its package, and a hash of the source of its entry point."""
    plugin = _plugin(method)
    assert plugin is not None  # it has run
    found = hashlib.sha256()
    for entry in plugin.entries:
        for path in _files(entry.module.partition(".")[0]):
            found.update(path.name.encode() + b"\0" + path.read_bytes() + b"\0")
    return [plugin.package, found.hexdigest()]


class _Reported:
    """Passes rows to ``on_step``, after a row of zeros where the first opening is not zero, and keeps them."""

    def __init__(self, on_step: OnStep) -> None:
        self._on_step = on_step
        self._rows: list[Mapping[str, float]] = []

    def __call__(self, row: Mapping[str, float]) -> None:
        row = {name: float(value) for name, value in row.items()}
        _require_curve("a row", row)
        if not (isfinite(row["opening"]) and isfinite(row["load"])):
            raise ValueError(f"opening and load of a row must be finite, got {row['opening']:g} and {row['load']:g}")
        if not self._rows and row["opening"] != 0.0:
            self._pass(dict.fromkeys(row, 0.0))
        self._pass(row)

    def finish(self, steps: Mapping[str, np.ndarray]) -> None:
        """Pass on the steps that were not reported. Raises ValueError where the rows are not the first of the steps, up
        to rounding in single precision."""
        count = len(self._rows)
        if count > steps["opening"].size:
            raise ValueError(f"{count} rows were reported, but {steps['opening'].size} steps returned")
        for name in [name for name in steps if count and name in self._rows[0]]:
            reported, first = np.array([row[name] for row in self._rows]), steps[name][:count]
            size = np.max(np.abs(steps[name][np.isfinite(steps[name])]), initial=0.0)
            for row in np.flatnonzero(~np.isclose(reported, first, rtol=0.0, atol=SAME * size, equal_nan=True)):
                raise ValueError(
                    f"the rows reported by on_step must be those of the steps, one for each, "
                    f"but {name} in row {row} was reported as {reported[row]:g} and returned as {first[row]:g}"
                )
        unknown = dict.fromkeys(self._rows[0] if count else (), nan)
        for values in list(zip(*steps.values(), strict=True))[count:]:
            self._pass(unknown | dict(zip(steps, map(float, values), strict=True)))

    def _pass(self, row: Mapping[str, float]) -> None:
        self._rows.append(row)
        self._on_step(row)


def _require_curve(who: str, columns: Mapping[str, Any]) -> None:
    missing = {"opening", "load"} - set(columns)
    if missing:
        raise ValueError(f"{who} must have {' and '.join(sorted(missing))}, got {', '.join(columns) or 'none'}")


def _steps(found: Any) -> dict[str, np.ndarray]:
    """The columns of a result, all of one length and from a row of zeros on, where every path begins."""
    if not isinstance(found, Result):
        raise TypeError(f"must return a verify.result.Result, got {type(found).__name__}")
    steps = {name: np.asarray(values, dtype=float) for name, values in found.steps.items()}
    _require_curve("the steps", steps)
    shapes = {name: values.shape for name, values in steps.items()}
    if len(set(shapes.values())) > 1 or steps["load"].ndim != 1:
        raise ValueError(f"the steps must be columns of one length, got {shapes}")
    if not (np.isfinite(steps["opening"]).all() and np.isfinite(steps["load"]).all()):
        raise ValueError("opening and load must be finite")
    if steps["opening"].size and steps["opening"][0] == 0.0:
        return steps
    return {name: np.append(0.0, values) for name, values in steps.items()}


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
