"""``debond solve --accuracy``: solutions on ever finer meshes until two successive ones agree.

Level 0 is the first choice (`verify.studies.cost.accuracy`). Every further level has ``ratio`` times the elements along
the specimen, a higher degree, which also refines the thickness of the arms, and another number of steps. The error of
the finer one of two levels is bounded by `bound`.
"""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from math import ceil, inf, isfinite
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

from iga.bases.names import BASES
from verify.curves.curve import Curve, peak
from verify.curves.leg_checks import leg_differences
from verify.curves.legs import path
from verify.curves.of_run import POINTS_PER_STEP, cubics, distance
from verify.fields.frames import cleared
from verify.methods.names import WITH_DOFS
from verify.methods.reference_mesh import reference_mesh
from verify.methods.solve import prepare
from verify.methods.zone_resolution import expected
from verify.result import Result
from verify.runs import estimate
from verify.runs.folder import FILES, write_json
from verify.runs.store import alone_in
from verify.scene.parse import parse_scene
from verify.scene.schema import Scene, counted_steps
from verify.studies.cost.accuracy import Choice, with_elements
from verify.support.checked_files import read_json
from verify.support.programme import only_opens, turns
from verify.support.progress import duration
from verify.support.refusal import Refusal
from verify.support.say import say
from verify.verdict import Check

#: Highest degree of a method.
HIGHEST = {**{name: max(basis.degrees) for name, basis in BASES.items()}, "dolfinx": 4}


@dataclass(frozen=True)
class Refinement:
    """Constants of the refinement and of the error bound.

    ratio, levels : ratio of the elements along the specimen of successive levels, and largest number of levels
    straight, more_steps, most_steps : allowed error of straight lines between the steps, over the accuracy; the next
        level has ``more_steps`` times the steps, so that they end elsewhere, and up to ``most_steps`` times where the
        allowed error is exceeded
    caution, slowest : smallest and largest ratio of the error bound of the finer level to the distance of two levels.
        On random scenes the error was up to 1.33 times the distance, where the ripple of the integration points on the
        peak dominates, and 0.3 times in the median
    gain : largest factor by which the error falls from one level to the next; up to 57 on random scenes
    condensed : exponent of the time over the unknowns where a linear bulk is condensed
    """

    ratio: float = 1.5
    levels: int = 4
    straight: float = 0.25
    more_steps: float = 1.1
    most_steps: float = 3.0
    caution: float = 1.5
    slowest: float = 5.0
    gain: float = 60.0
    condensed: float = 0.3


REFINEMENT = Refinement()

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

    def summary(self) -> dict[str, Any]:
        keys = ("folder", "method", "overrides", "seconds", "distance")
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
        errors of opposite signs that fall by the factor ``gain``.
        """
        last = self.delivered
        return (last.distance / (REFINEMENT.gain + 1.0), last.bound) if isfinite(last.bound) else None

    @property
    def close(self) -> bool:
        """Whether the error bound is within the accuracy asked for."""
        return self.delivered.bound <= self.asked

    @property
    def holds(self) -> bool:
        """Whether `close` holds and no identity is broken; a broken one may hold on a finer mesh."""
        return self.close and all(check.state != "broken" for check in self.delivered.checks)

    @property
    def sentence(self) -> str:
        """The accuracy reached and the accuracy asked for."""
        asked = f"asked {percent(self.asked)}"
        if self.reached is None:
            return f"error of the curve unknown, {asked}"
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
            overrides = finer(chosen, first.method, overrides, _more_steps(result, scene.load.opening, accuracy))
            _announce(level, parse_scene(scene.model_dump(), overrides), number + 1)
        except Refusal as error:
            return replace(found, why=f"no mesh is finer than that of {folder}: {error}")
    return replace(found, why=f"{REFINEMENT.levels} levels are the most")


def apart(fine: Result, coarse: Result, programme: Sequence[float]) -> float:
    """Relative distance of the curve of a run, with straight lines between the steps, from the path of another.

    The largest of the L2 distance of the loads, leg by leg for a programme with reversals, and of the difference of the
    peak loads. Infinite where they cannot be compared.
    """
    if min(len(fine.load), len(coarse.load)) < 2:
        return inf
    curve, known = (fine.opening, fine.load), _curved(coarse, programme)
    size = float(np.max(np.abs(known[1])))
    found = [abs(peak(curve)[1] - peak(known)[1]) / size if size > 0.0 else inf]
    if only_opens(programme):
        found.append(distance(curve, coarse))
    else:
        legs = leg_differences(path(curve, programme), path(known, programme))
        found += [leg.error for leg in legs] if len(legs) == len(turns(programme)) else [inf]
    return max(one if isfinite(one) else inf for one in found)


def _curved(result: Result, programme: Sequence[float]) -> Curve:
    """The path of a run, with points between its steps.

    In a programme with reversals, steps at which faces come into contact are straight lines: the slopes at both ends
    are unrelated, and a cubic would overshoot the reversal.
    """
    (d, P), ends = map(np.asarray, cubics(result)), result.opening
    if only_opens(programme) or len(d) == len(ends):
        return d, P
    at = np.linspace(0.0, len(ends) - 1.0, len(d))
    low, high = (np.repeat(of(ends[:-1], ends[1:]), POINTS_PER_STEP) for of in (np.minimum, np.maximum))
    trifle = 1e-9 * float(np.max(np.abs(ends)))
    beyond = np.maximum(low - d[1:], d[1:] - high) > trifle
    straight = np.append(False, np.repeat(beyond.reshape(-1, POINTS_PER_STEP).any(axis=1), POINTS_PER_STEP))
    steps = np.arange(len(ends))
    return np.where(straight, np.interp(at, steps, ends), d), np.where(straight, np.interp(at, steps, result.load), P)


def bound(distance: float, before: float = inf) -> float:
    """Bound of the error of the finer one of two levels, from their distance and from the previous distance.

    ``caution`` times the distance is a bound where the error of the coarser level is at least 5/3 of that of the
    finer one, with ``ratio`` 1.5 for orders above 1.3. Where the distances have fallen more slowly, by the factor f,
    the following ones add up to f / (1 - f) of the last one, as a geometric series; at most ``slowest`` is used.
    """
    f = distance / before if before > 0.0 else 0.0
    return distance * min(max(REFINEMENT.caution, f / (1.0 - f) if f < 1.0 else inf), REFINEMENT.slowest)


def finer(scene: Scene, method: str, overrides: Sequence[str], more: float = REFINEMENT.more_steps) -> tuple[str, ...]:
    """Overrides of the next level.

    Parameters
    ----------
    scene, overrides : the scene of this level, which contains its overrides, and these overrides
    more : ratio of the numbers of steps

    Raises
    ------
    Refusal : no finer mesh is possible.
    """
    asked = scene.discretization
    if method in WITH_DOFS:
        degree = min(asked.degree + 1, HIGHEST[method])
        mesh = with_elements(scene, method, degree, REFINEMENT.ratio * expected(scene, method).elements)
    else:
        own = reference_mesh(scene)
        degree = min(own.degree + 1, HIGHEST[method])
        layers = own.layers + (degree == own.degree)
        finest = {"degree": degree, "elements": ceil(REFINEMENT.ratio * own.elements), "layers": layers}
        mesh = tuple(f"dolfinx.{key}={value}" for key, value in finest.items())
    counted, closer = ceil(more * counted_steps(scene)), max(asked.bend / more**2, 1e-5)
    chooses = prepare(scene, method).by_accuracy
    pace = f"discretization.bend={closer!r}" if chooses else f"discretization.steps={counted}"
    found = {one.partition("=")[0]: one for one in (*overrides, pace, *mesh)}
    return tuple(found.values())


def _more_steps(result: Result, programme: Sequence[float], accuracy: float) -> float:
    """Factor on the number of steps for which straight lines between them are accurate enough."""
    straight = apart(result, result, programme)
    wanted = (straight / (REFINEMENT.straight * accuracy)) ** 0.5 if isfinite(straight) else REFINEMENT.most_steps
    return min(max(wanted, REFINEMENT.more_steps), REFINEMENT.most_steps)


def growth(scene: Scene, following: Scene, method: str) -> float:
    """Ratio of the times of runs on a finer mesh and on this one: proportional to steps and unknowns.

    With a linear bulk, which is condensed onto the interface, the time grows more slowly: 1.1 to 1.6 times for twice
    the unknowns on random scenes.
    """
    unknowns, steps = (of(following, method) / of(scene, method) for of in (estimate.unknowns, estimate.steps))
    if prepare(scene, method).by_accuracy:
        steps *= (scene.discretization.bend / following.discretization.bend) ** 0.5
    condensed = method in WITH_DOFS and prepare(scene, method).effects["kinematics"] == "linear"
    return steps * unknowns ** (REFINEMENT.condensed if condensed else 1.0)


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
