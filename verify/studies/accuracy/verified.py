"""Solutions on ever finer meshes until two successive ones agree.

Level 0 is the first choice (`choice`). Every further level has ``ratio`` times the elements along the specimen, a
higher degree, which also refines the thickness of the arms, and another number of steps. The error of the finer one of
two levels is bounded by `bound`.
"""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from math import inf, isfinite
from pathlib import Path
from time import perf_counter
from typing import Any

from verify.fields.frames import cleared
from verify.methods.names import WITH_DOFS
from verify.methods.reference_mesh import reference_mesh
from verify.result import Result
from verify.runs import estimate
from verify.runs.folder import FILES, write_json
from verify.runs.store import alone_in
from verify.scene.parse import parse_scene
from verify.scene.schema import Scene
from verify.studies.accuracy.choice import Choice
from verify.studies.accuracy.levels import REFINEMENT, apart, bound, finer, growth, more_steps
from verify.support.checked_files import read_json
from verify.support.progress import duration
from verify.support.refusal import Refusal
from verify.support.say import say
from verify.verdict import Check, Checks

#: Solves a scene by a method into a folder; the last argument says whether fields are stored.
Solve = Callable[[Scene, str, Path, bool], tuple[Result, tuple[Check, ...]]]


@dataclass(frozen=True, eq=False)
class Level:
    """A run: ``distance`` to the previous level, and ``bound`` of its error; both infinite for the first level."""

    folder: str
    scene: Scene
    method: str
    overrides: tuple[str, ...]
    result: Result
    checks: tuple[Check, ...]
    seconds: float
    distance: float = inf
    bound: float = inf

    @property
    def fault(self) -> str:
        """Why the run gives no number: it stopped, or checks of its own are broken; empty where it gives one."""
        return Checks(self.checks).fault if self.result.complete else self.result.status

    def summary(self) -> dict[str, Any]:
        keys = ("folder", "method", "overrides", "seconds", "distance", "fault")
        return {key: getattr(self, key) for key in keys} | {"status": self.result.status}


@dataclass(frozen=True, eq=False)
class Verified:
    """The levels of a solution, coarse to fine; ``why``: the reason if the accuracy ``asked`` was not reached."""

    asked: float
    levels: tuple[Level, ...]
    why: str = ""

    @property
    def delivered(self) -> Level:
        """The finest complete level; the last one where no level is complete."""
        return next((one for one in reversed(self.levels) if one.result.complete), self.levels[-1])

    @property
    def reached(self) -> tuple[float, float] | None:
        """Interval of the error of the delivered level; None where no other level was compared with it.

        Lower end: the distance of two levels is at most ``gain + 1`` times the error of the finer one, which holds for
        errors of opposite signs that fall by the factor ``gain``. None as well where the level gives no number; checks
        that are broken on the coarser one alone are those that its mesh explains.
        """
        last = self.delivered
        known = isfinite(last.bound) and not last.fault
        return (last.distance / (REFINEMENT.gain + 1.0), last.bound) if known else None

    @property
    def holds(self) -> bool:
        """Whether the error bound is within the accuracy asked for; of a level whose identities are broken there is
        none, and they may hold on a finer mesh."""
        return self.reached is not None and self.delivered.bound <= self.asked

    @property
    def sentence(self) -> str:
        """The accuracy reached and the accuracy asked for."""
        asked = f"asked {percent(self.asked)}"
        if self.reached is None:
            fault = f", {self.delivered.folder} {self.delivered.fault}" if self.delivered.fault else ""
            return f"error of the curve unknown{fault}, {asked}"
        low, high = self.reached
        return f"curve and peak load within {percent(high)} (between {percent(low)} and {percent(high)}), {asked}"

    def summary(self) -> dict[str, Any]:
        """The entry ``accuracy`` of result.json."""
        number = self.levels.index(self.delivered)
        return {
            "asked": self.asked,
            "holds": self.holds,
            "reached": self.reached,
            "against": self.levels[number - 1].folder if self.reached else None,
            "why": self.why,
            "levels": [one.summary() | ({"folder": "."} if one is self.delivered else {}) for one in self.levels],
        }


def verified(scene: Scene, first: Choice, accuracy: float, out: Path, solve: Solve) -> Verified:
    """Solve on finer and finer meshes, each in a folder in ``out``, until two bound the error by ``accuracy``.

    The files of the delivered run are moved to ``out``, also those of an interrupted run.

    Raises
    ------
    Refusal : another run is at work in ``out``.
    """
    with alone_in(out):
        _clear(out)
        with _kept_if_interrupted(out):
            found = _refined(scene, first, accuracy, out, solve)
        _deliver(out, found)
    return found


def _refined(scene: Scene, first: Choice, accuracy: float, out: Path, solve: Solve) -> Verified:
    overrides = first.overrides
    levels: list[Level] = []
    for number in range(REFINEMENT.levels):
        folder = f"level-{number}"
        chosen = parse_scene(scene.model_dump(), overrides)
        begun = perf_counter()
        result, checks = solve(chosen, first.method, out / folder, number > 0)
        seconds = perf_counter() - begun
        level = Level(folder, chosen, first.method, overrides, result, checks, seconds)
        if levels and result.complete:
            off = apart(result, levels[-1].result, scene.load.opening)
            level = replace(level, distance=off, bound=bound(off, levels[-1].distance))
        levels.append(level)
        found = Verified(accuracy, tuple(levels))
        if not result.complete:
            return replace(found, why=f"{folder} {result.status}")
        if found.holds:
            return found
        if number + 1 == REFINEMENT.levels:
            break
        try:
            overrides = finer(chosen, first.method, overrides, more_steps(result, scene.load.opening, accuracy))
            _announce(level, parse_scene(scene.model_dump(), overrides), number + 1)
        except Refusal as error:
            return replace(found, why=f"no mesh is finer than that of {folder}: {error}")
    return replace(found, why=f"{REFINEMENT.levels} levels are the most")


def planned(scene: Scene, first: Choice) -> str:
    """The message before the first run: the first choice, and the expected time of the first two levels.

    Raises
    ------
    Refusal : no finer mesh is possible for the verification.
    """
    guess = parse_scene(scene.model_dump(), first.overrides)
    following = parse_scene(scene.model_dump(), finer(guess, first.method, first.overrides))
    total = duration(first.seconds * (1.0 + growth(guess, following, first.method)))
    return f"{first.why}; with a second run on a finer mesh, to verify it, about {total} in all"


def _announce(level: Level, following: Scene, number: int) -> None:
    took = f"{level.folder} took {duration(level.seconds)}"
    if isfinite(level.distance):
        took += f" and is {percent(level.distance)} from the level before"
    degree = following.discretization.degree if level.method in WITH_DOFS else reference_mesh(following).degree
    unknowns = estimate.unknowns(following, level.method)
    about = duration(level.seconds * growth(level.scene, following, level.method))
    say(f"{took}; level-{number}: degree {degree} with {unknowns} unknowns, about {about}")


@contextmanager
def _kept_if_interrupted(out: Path) -> Iterator[None]:
    """Move the files of a run to ``out`` that is interrupted or has no disk space left."""
    try:
        yield
    except (KeyboardInterrupt, OSError):
        last = max(out.glob("level-[0-9]"), default=None)
        if last is not None:
            _move(last, out)
        raise


def _deliver(out: Path, found: Verified) -> None:
    _move(out / found.delivered.folder, out)
    file = out / "result.json"
    if file.exists():
        write_json(file, {**read_json(file, {}), "accuracy": found.summary()})


def _move(folder: Path, out: Path) -> None:
    for item in folder.glob("*"):
        if (out / item.name).is_dir():
            shutil.rmtree(out / item.name)
        item.replace(out / item.name)
    if folder.is_dir():
        folder.rmdir()


def _clear(out: Path) -> None:
    """Remove earlier runs."""
    for folder in out.glob("level-[0-9]"):
        if (folder / "curve.csv").exists():
            shutil.rmtree(folder)
    cleared(out)
    for name in FILES:
        (out / name).unlink(missing_ok=True)


def percent(part: float) -> str:
    return f"{100.0 * part:.2g} %"
