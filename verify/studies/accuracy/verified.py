"""Solutions on ever finer meshes until two successive ones agree.

Level 0 is the first choice (`verify.studies.accuracy.choice`), and tells the time of the next one. The error of the
finer one of two levels is bounded by their distance (`verify.studies.uncertainty.bound`).
"""

from __future__ import annotations

import shutil
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import inf, isfinite
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

from verify.curves.curve import peak
from verify.curves.leg_checks import leg_differences
from verify.curves.legs import path
from verify.curves.of_run import cubics, distance
from verify.fields.frames import cleared
from verify.result import Result
from verify.runs.estimate import unknowns
from verify.runs.folder import FILES, write_json
from verify.runs.store import alone_in
from verify.scene.parse import parse_scene
from verify.scene.schema import Scene
from verify.studies.accuracy.choice import GUESS, Choice, finer
from verify.studies.uncertainty import LEVEL_BOUNDS, bound
from verify.support.checked_files import read_json
from verify.support.programme import only_opens, turns
from verify.support.progress import duration
from verify.support.refusal import Refusal
from verify.support.say import say
from verify.verdict import Check, Checks


@dataclass(frozen=True)
class Refinement:
    """Constants of the levels.

    levels : the most of them
    straight, most_steps : allowed error of straight lines between the steps, over the accuracy; where it is exceeded
        the next level has up to ``most_steps`` times the steps
    slower : time of a level over that of the level before: for 0.3 % 0.7 to 3.2 times on dcb-czm1, dcb-czm1-linear,
        dcb-czm2, tijs-dcb, enf-as4peek, mmb80-as4peek, slb, 4enf, peel-80 and peel-120. Finer elements take longer, and
        may need fewer steps, as the load oscillates less
    """

    levels: int = 4
    straight: float = 0.25
    most_steps: float = 3.0
    slower: float = 1.7


REFINEMENT = Refinement()

#: Solves a scene by a method into a folder; the last argument says whether fields are stored.
Solve = Callable[[Scene, str, Path, bool], tuple[Result, tuple[Check, ...]]]


@dataclass(frozen=True, eq=False)
class Level:
    """A run: ``distance`` to the previous level, and ``bound`` of its error; both infinite for the first level."""

    folder: str
    scene: Scene
    overrides: tuple[str, ...]
    result: Result
    checks: tuple[Check, ...]
    seconds: float
    distance: float = inf
    bound: float = inf

    @property
    def fault(self) -> str:
        """Why the run gives no number: it stopped, or checks of its own are broken; empty where it gives one. Checks
        that are broken on a coarser level alone are those that its mesh explains."""
        return Checks(self.checks).fault if self.result.complete else self.result.status

    @property
    def reached(self) -> tuple[float, float] | None:
        """Interval of its error, the lower end for errors of opposite signs; None where it was compared with no other
        level, or gives no number."""
        known = isfinite(self.bound) and not self.fault
        return (self.distance / (LEVEL_BOUNDS.gain + 1.0), self.bound) if known else None


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
    def holds(self) -> bool:
        """Whether the error bound is within the accuracy asked for."""
        return self.delivered.reached is not None and self.delivered.bound <= self.asked

    @property
    def sentence(self) -> str:
        """The accuracy reached and the accuracy asked for."""
        asked, last = f"asked {percent(self.asked)}", self.delivered
        if last.reached is None:
            return f"error of the curve unknown{f', {last.folder} {last.fault}' if last.fault else ''}, {asked}"
        low, high = map(percent, last.reached)
        return f"curve and peak load within {high} (between {low} and {high}), {asked}"

    def summary(self) -> dict[str, Any]:
        """The entry ``accuracy`` of result.json."""
        last, levels = self.delivered, self.levels
        keys = ("overrides", "seconds", "distance", "fault")
        told = [
            {"folder": "." if one is last else one.folder, "method": one.result.method, "status": one.result.status}
            | {key: getattr(one, key) for key in keys}
            for one in levels
        ]
        against = levels[levels.index(last) - 1].folder if last.reached else None
        own = {"asked": self.asked, "holds": self.holds, "reached": last.reached, "against": against, "why": self.why}
        return own | {"levels": told}


def verified(scene: Scene, first: Choice, accuracy: float, out: Path, solve: Solve) -> Verified:
    """Solve on finer and finer meshes, each in a folder in ``out``, until two bound the error by ``accuracy``.

    The files of the delivered run are moved to ``out``, also those of an interrupted run.

    Raises
    ------
    Refusal : another run is at work in ``out``.
    """
    with alone_in(out):
        for folder in out.glob("level-[0-9]"):  # of earlier calls
            if (folder / "curve.csv").exists():
                shutil.rmtree(folder)
        cleared(out)
        for name in FILES:
            (out / name).unlink(missing_ok=True)
        try:
            found = _refined(scene, first, accuracy, out, solve)
        except (KeyboardInterrupt, OSError):  # or no space left
            if last := max(out.glob("level-[0-9]"), default=None):
                _move(last, out)
            raise
        _move(out / found.delivered.folder, out)
        file = out / "result.json"
        if file.exists():
            write_json(file, {**read_json(file, {}), "accuracy": found.summary()})
    return found


def _move(folder: Path, out: Path) -> None:
    for item in folder.glob("*"):
        if (out / item.name).is_dir():
            shutil.rmtree(out / item.name)
        item.replace(out / item.name)
    if folder.is_dir():
        folder.rmdir()


def _refined(scene: Scene, first: Choice, accuracy: float, out: Path, solve: Solve) -> Verified:
    overrides, method, programme = first.overrides, first.method, scene.load.opening
    found = Verified(accuracy, ())
    for number in range(REFINEMENT.levels):
        chosen, folder = parse_scene(scene.model_dump(), overrides), f"level-{number}"
        begun = perf_counter()
        result, checks = solve(chosen, method, out / folder, number > 0)
        level = Level(folder, chosen, overrides, result, checks, perf_counter() - begun)
        took = f"{folder} took {duration(level.seconds)}"
        if found.levels and result.complete:
            off = apart(result, found.levels[-1].result, programme)
            level = replace(level, distance=off, bound=bound(off, found.levels[-1].distance))
            took += f" and is {percent(off)} from the level before"
        found = replace(found, levels=(*found.levels, level))
        if not result.complete:
            return replace(found, why=f"{folder} {result.status}")
        if found.holds or number + 1 == REFINEMENT.levels:
            break
        try:
            overrides = finer(chosen, method, overrides, more_steps(result, programme, accuracy))
        except Refusal as error:
            return replace(found, why=f"no mesh is finer than that of {folder}: {error}")
        following = parse_scene(scene.model_dump(), overrides)
        mesh = f"degree {following.discretization.degree} with {unknowns(following, method)} unknowns"
        total = REFINEMENT.slower * level.seconds + sum(one.seconds for one in found.levels)
        say(f"{took}; level-{number + 1}: {mesh}, about {duration(total)} in all")
    return found if found.holds else replace(found, why=f"{REFINEMENT.levels} levels are the most")


def apart(fine: Result, coarse: Result, programme: Sequence[float]) -> float:
    """Relative distance of the curve of a run, with straight lines between the steps, from the path of another.

    The largest of the L2 distance of the loads, leg by leg for a programme with reversals, and of the difference of the
    peak loads. Infinite where they cannot be compared.
    """
    if min(len(fine.load), len(coarse.load)) < 2:
        return inf
    curve, known = (fine.opening, fine.load), cubics(coarse)
    d, P = (np.asarray(values) for values in known)
    size = float(np.max(np.abs(P[d >= 0.0] if max(programme) > 0.0 else P)))  # pressed faces have no peak
    found = [abs(peak(curve)[1] - peak(known)[1]) / size if size > 0.0 else inf]
    if only_opens(programme):
        found.append(distance(curve, coarse))
    else:
        legs = leg_differences(path(curve, programme), path(known, programme))
        found += [leg.error for leg in legs] if len(legs) == len(turns(programme)) else [inf]
    return max(one if isfinite(one) else inf for one in found)


def more_steps(result: Result, programme: Sequence[float], accuracy: float) -> float:
    """Factor on the number of steps for which straight lines between them are accurate enough."""
    straight = apart(result, result, programme)
    wanted = (straight / (REFINEMENT.straight * accuracy)) ** 0.5 if isfinite(straight) else REFINEMENT.most_steps
    return min(max(wanted, GUESS.more_steps), REFINEMENT.most_steps)


def percent(part: float) -> str:
    return f"{100.0 * part:.2g} %"
