"""One budget of uncertainty: runs that differ by one thing, the parts that follow from their values, and their sum.

`debond certify` and `debond validate` vary a scene, one thing at a time: meshes, steps, layers, inputs, place of the
load. The runs are kept by what is varied (`Runs`), and a budget is made of the values of one quantity in all of them.
`solve --accuracy` has no quantity but the whole curve, and bounds its error by the distances of successive levels.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from math import hypot, inf, nan
from pathlib import Path
from typing import Any, ClassVar, TypeAlias, TypeVar

from verify.curves.convergence import mesh_error
from verify.methods.mesh_choice import Size
from verify.result import Result
from verify.runs.jobs import Job, Outcome, left_out
from verify.scene.parse import SceneError
from verify.scene.schema import Scene
from verify.studies import frame
from verify.support.refusal import Refusal

One = TypeVar("One")
Other = TypeVar("Other")
Judged = TypeVar("Judged", bound=frame.Study)

#: Places of the load on the end face (`verify.scene.schema.Load`).
LOAD_PLACES = ("face", "node", "hinge")

#: What is varied -> its runs, or what was found in them; "mesh" has the meshes, finest first.
Runs: TypeAlias = Mapping[str, Sequence[One]]


@dataclass(frozen=True)
class Bounds:
    """Bounds of the error of the finer one of two levels over their distance.

    caution : the least: the error of the coarser level is then at least 5/3 of that of the finer one, as with elements
        1.5 times as long for orders above 1.3. On random scenes the error was up to 1.33 times the distance, where the
        ripple of the integration points on the peak dominates, and 0.3 times in the median
    slowest : the largest, for distances that hardly fall
    gain : largest factor by which the error falls from one level to the next; up to 57 on random scenes
    """

    caution: float = 1.5
    slowest: float = 5.0
    gain: float = 60.0


LEVEL_BOUNDS = Bounds()


@dataclass(frozen=True)
class Part:
    """One line of a budget.

    name : of what is varied, dotted for an input or the data
    kind : "num", "input", "introduction" or "data"
    u : uncertainty of the quantity [its unit], with the sign of the sensitivity
    stated : relative standard uncertainty that the scene states, 0 where it states none
    sensitivity : relative change of the quantity over that of the input
    second : second-order term of the contribution [unit of the quantity]
    remark : finding on the meshes, or the values at the places of the load
    doubtful : whether meshes are not in the asymptotic range
    """

    name: str
    kind: str
    u: float
    stated: float = 0.0
    sensitivity: float = nan
    second: float = 0.0
    remark: str = ""
    doubtful: bool = False


@dataclass(frozen=True)
class Budget:
    """The parts of the uncertainty of a quantity, which are independent of each other."""

    parts: tuple[Part, ...]

    def of(self, *kinds: str) -> float:
        """Uncertainty by all parts of some kinds, or by all: the root of the sum of squares."""
        return hypot(*(part.u for part in self.parts if not kinds or part.kind in kinds))


def of_meshes(sizes: Sequence[float], values: Sequence[float], expansion: float = 1.0) -> Part:
    """Part of the mesh: the index of the finest of three or more (`verify.curves.convergence`) over ``expansion``."""
    found = mesh_error(sizes, values)
    return Part("mesh", "num", found.index / expansion, remark=found.verdict, doubtful=found.doubtful)


def bound(distance: float, before: float = inf) -> float:
    """Bound of the error of a level from its ``distance`` to the level before, and that of the two levels ``before``.

    Where the distances have fallen slowly, by the factor f, the following ones add up to f / (1 - f) of the last one,
    as a geometric series.
    """
    f = distance / before if before > 0.0 else 0.0
    return distance * min(max(LEVEL_BOUNDS.caution, f / (1.0 - f) if f < 1.0 else inf), LEVEL_BOUNDS.slowest)


@dataclass(frozen=True)
class Plan:
    """Every run once.

    codes : runs of each code by what is varied: "mesh", the finest one first, which all others vary; a group is empty
        where that cannot be run, or changes nothing
    at : openings at which the load is a quantity
    left_out : a sentence for everything that is in no budget
    """

    codes: Mapping[str, Runs[Job]]
    at: Sequence[float]
    left_out: Sequence[str]

    @property
    def scene(self) -> Scene:
        return next(iter(self.codes.values()))["mesh"][0].scene

    @property
    def jobs(self) -> list[Job]:
        return list(dict.fromkeys(job for runs in self.codes.values() for group in runs.values() for job in group))


def varied(job: Job, name: str, *overrides: str, what: str = "") -> list[Job]:
    """The job with more overrides, of which the last one of a key counts; empty where it cannot be run.

    Raises
    ------
    Refusal : it cannot be run and says ``what`` it is.
    """
    found = replace(job, variant=f"{job.variant}-{name}", overrides=(*job.overrides, *overrides))
    try:
        why = left_out(found)
    except SceneError as error:
        why = "; ".join(error.sentences)
    if why and what:
        raise Refusal(f"{what}: {' '.join(why.split())}")
    return [] if why else [found]


def meshes(job: Job, finest: Size, scales: Iterable[float], name: str) -> list[Job]:
    """The job with so many times the elements of a mesh."""
    what, sizes = f"{finest.key}: of the coarsest or finest mesh", map(finest.times, scales)
    return [run for one in sizes for run in varied(job, f"{name}-{one.value:.6g}", one.override, what=what)]


def places(job: Job) -> dict[str, list[Job]]:
    """The job with the load at every place of the end face where it can act, first that of the scene; none where there
    is no other one."""
    here = job.scene.load.at
    others = {place: varied(job, f"at-{place}", f'load.at="{place}"') for place in LOAD_PLACES if place != here}
    found = {f"load.at={place}": jobs for place, jobs in {here: [job], **others}.items() if jobs}
    return found if len(found) > 1 else {}


def values(runs: Runs[One], of: Callable[[One], Other]) -> dict[str, tuple[Other, ...]]:
    """What is found in every run."""
    return {name: tuple(map(of, group)) for name, group in runs.items()}


@dataclass(frozen=True)
class Study(frame.Study):
    """Budgets of the quantities of a scene, each with its ``sentence`` and its ``doubt``: why it does not count.

    ``left_out`` has a sentence for everything that is in no budget, ``failures`` one for every failed run; one failure
    leaves no quantity.
    """

    PAGE: ClassVar[str] = "verify.studies.uncertainty_page"
    PACKAGES: ClassVar[tuple[str, ...]] = ("iga", "fem_reference")
    #: The entry of the JSON file that has the quantities.
    FOUND: ClassVar[str]
    #: What the page draws of each quantity, its ``interval`` and the ``errors`` of codes, and over what.
    INTERVALS: ClassVar[str]
    AXIS: ClassVar[str]

    found: tuple[Any, ...]
    failures: tuple[str, ...]

    @property
    def complete(self) -> bool:
        """Whether every run is complete and every quantity counts."""
        return bool(self.found) and not self.failures and not any(one.doubt for one in self.found)

    def about(self) -> dict[str, object]:
        pairs = zip(self.rows, self.found, strict=True)
        found = [{**asdict(row), **asdict(one), "sentence": one.sentence} for row, one in pairs]
        return {self.FOUND: found, "failures": list(self.failures)}

    def lines(self) -> list[str]:
        return [*self.left_out, *self.failures, *(one.sentence for one in self.found)]


def results(plan: Plan, outcomes: Mapping[Job, Outcome]) -> tuple[dict[str, Runs[Result]], tuple[str, ...]]:
    """The results of the runs of each code, and a sentence for each run that gives no number: then there are none."""
    failures = frame.failures(outcomes[job] for job in plan.jobs)
    found = {job: outcome.result for job, outcome in outcomes.items() if outcome.result is not None}
    return {} if failures else {code: values(runs, found.__getitem__) for code, runs in plan.codes.items()}, failures


def run_study(
    plan: Plan, judged: Callable[[Mapping[Job, Outcome]], Judged], out: Path, jobs: int, scheduler: str | None
) -> Judged:
    """Run a study into ``out``: its table, its JSON file, and report.html.

    Parameters
    ----------
    judged : the study that is made of the runs
    jobs : runs at a time, or with a dask ``scheduler`` its workers
    """
    frame.one_thread()
    study = judged(frame.run(plan.jobs, out, jobs, scheduler))
    study.write(out)
    return study


def percent(part: float, digits: int = 2, sign: str = "") -> str:
    """A percentage such as 0.31 % or, with the ``sign`` +, −3.10 %."""
    return f"{100.0 * part:{sign}.{digits}f}\u00a0%".replace("-", "−") if part == part else "–"
