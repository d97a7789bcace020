"""Runs in pairs that differ by one thing: the changes of curve, peak, end and energies by it, and its cost in time.

`debond effects` and `debond vary` are a `Plan` of such pairs each, and a `Study` that names itself.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import inf, isfinite, nan
from pathlib import Path
from typing import Any, ClassVar, TypeVar

import numpy as np

from verify.curves.leg_checks import worst_leg
from verify.curves.of_run import cubics, dissipated, distance, peak_load, work
from verify.result import Result, run_seconds
from verify.runs.estimate import seconds
from verify.runs.jobs import Job, Outcome
from verify.scene.effects import NEGLIGIBLE
from verify.studies import frame
from verify.studies.frame import BUSY, failure, unmeasured
from verify.support.progress import duration

#: Every run is repeated this many times for its wall time, alone on the machine.
TIMES = 3

#: Value, over the work or the peak load, that counts as zero.
ZERO = 1e-9

#: Least condition number that is assumed of the matrices of two runs whose slopes are compared.
SLOPES_CONDITION = 1e7

#: Names of the changes in the table, by column.
CHANGES: Mapping[str, str] = {
    "peak_change": "peak load",
    "end_change": "load at the end",
    "dissipated_change": "dissipated energy",
    "work_change": "work",
}


@dataclass(frozen=True)
class Pair:
    """The run ``one``, which is compared with the ``other``; they differ by ``key``, or are the same run.

    name : of the difference, in tables
    value, against : values of the key in both
    scene_has : whether ``value`` is that of the scene
    of_damage : whether the key changes how damage grows or stays, and nothing before there is any
    within : a pair near whose curves that of ``one`` is: it is run only where they are not negligibly close
    """

    name: str
    key: str
    value: str
    against: str
    one: Job
    other: Job
    scene_has: bool
    of_damage: bool = False
    within: Pair | None = None

    def long(self, times: int) -> str:
        """In words, how long ``one`` and its repetitions are expected to take."""
        return f"about {duration(times * seconds(self.one.solved, self.one.method))}"


@dataclass(frozen=True)
class Plan:
    """The run that the others differ from, pairs of runs, and a sentence for everything that cannot be run."""

    base: Job
    pairs: tuple[Pair, ...]
    left_out: tuple[str, ...]

    @property
    def jobs(self) -> list[Job]:
        """Every run once, but those that depend on others."""
        return list(dict.fromkeys(job for pair in self.pairs if not pair.within for job in (pair.other, pair.one)))

    def decided(self, first: Mapping[Job, Outcome]) -> Plan:
        """With the pairs that its ``first`` runs call for, and a sentence for each that they do not."""
        found, reasons = [], []
        for pair in self.pairs:
            bound = row(pair.within, first, dict.fromkeys(first, ())).curve_change if pair.within else inf
            if bound > NEGLIGIBLE:
                found.append(replace(pair, within=None))
                continue
            assert pair.within is not None
            sides = f"{pair.within.key} {pair.within.against} and {pair.within.value}"
            apart = f"are {signed(bound).lstrip('+')} apart" if isfinite(bound) else "are not compared"
            reasons.append(f"{pair.name}: left out, {pair.long(1)} spared: {sides} {apart}")
        return replace(self, pairs=tuple(found), left_out=(*self.left_out, *reasons))

    def again(self, first: Mapping[Job, Outcome] | None = None) -> dict[Job, Job]:
        """Repetitions for the wall times, each with its job: all in turn, so that other load on the machine affects all
        alike. Those whose ``first`` run gives no number are left out."""
        jobs = [job for job in self.jobs if first is None or not failure(first[job])]
        numbers = range(1, TIMES + 1)
        return {replace(job, repeat=n, variant=f"{job.variant}-again-{n}"): job for n in numbers for job in jobs}


@dataclass(frozen=True)
class Row:
    """A line of the table of a study; unknown values are NaN.

    scene_has : whether ``value`` is that of the scene
    curve_change : relative L2 distance of the loads of both runs, see `apart`
    peak_change, end_change, dissipated_change, work_change : value of the run over that of the other, minus 1, of the
        peak load and, at the end, of load, dissipated energy and external work; NaN where the other is 0
    dofs, steps, newton_iterations, rejected_steps, peak_memory_mb : of the run
    iteration : seconds of a Newton iteration: wall time without mesh, basis and compilation over their number
    seconds, seconds_against : least wall time of ``times`` runs, without imports and compilation
    time_ratio : time of the run over that of the other
    time_spread : largest over least time of equal runs; well above 1 the machine was busy and the ratio is inaccurate
    """

    name: str
    key: str
    value: str
    against: str
    scene_has: bool
    curve_change: float
    peak_change: float
    end_change: float
    dissipated_change: float
    work_change: float
    dofs: int
    steps: int
    newton_iterations: int
    rejected_steps: int
    iteration: float
    peak_memory_mb: float
    seconds: float
    seconds_against: float
    time_ratio: float
    time_spread: float
    times: int
    status: str

    @property
    def complete(self) -> bool:
        return self.status == "complete"

    @property
    def sentence(self) -> str:
        """A line such as: finite kinematics: curve 0.69 %, +0.2 % peak load, +0.7 % load at the end, 3.1 x time"""
        if not self.complete:
            return f"{self.name}: {self.status}"
        changes = [f"curve {signed(self.curve_change).lstrip('+')}"] if isfinite(self.curve_change) else []
        for key, name in CHANGES.items():
            value = getattr(self, key)
            changes.append(f"{signed(value)} {name}" if isfinite(value) else f"no {name} to compare with")
        return f"{self.name}: {', '.join([*changes, self.time])}"

    @property
    def time(self) -> str:
        if not isfinite(self.time_ratio):
            return "no time"
        busy = f" (equal runs differ by up to {self.time_spread:.2g} x)" if self.time_spread > BUSY else ""
        return f"{self.time_ratio:.2g} x time{busy}"


@dataclass(frozen=True)
class Study(frame.Study):
    """Rows of pairs; ``left_out`` has a sentence for each pair that cannot be run. ``planes``: runs by their plane."""

    PAGE: ClassVar[str] = "verify.studies.pairs_page"
    ROW: ClassVar[type] = Row
    PACKAGES: ClassVar[tuple[str, ...]] = ("iga", "fem_reference")

    method: str
    planes: Mapping[str, Result] = field(default_factory=dict, kw_only=True)

    @property
    def title(self) -> str:
        """Of the page, before the name of the scene."""
        raise NotImplementedError

    @property
    def complete(self) -> bool:
        return all(one.complete for one in self.rows)

    @property
    def sentences(self) -> list[str]:
        """What the study found, a line each."""
        return [one.sentence for one in self.rows]

    def lines(self) -> list[str]:
        return [*self.sentences, *self.left_out]


S = TypeVar("S", bound=Study)


def compared(kind: type[S], plan: Plan, out: Path, jobs: int, scheduler: str | None = None) -> S:
    """Do the runs of all pairs in ``out``, then their repetitions, one at a time; write the study.

    Parameters
    ----------
    jobs : runs at a time, or with a dask ``scheduler`` its workers; timed runs are done here, one at a time
    """
    frame.one_thread()
    first = frame.run(plan.jobs, out, jobs, scheduler)
    plan = plan.decided(first)
    first |= frame.run([job for job in plan.jobs if job not in first], out, jobs, scheduler)
    of_job, again = plan.again(first), {job: list[Outcome]() for job in plan.jobs}
    for job, outcome in frame.run(list(of_job), out).items():
        again[of_job[job]].append(outcome)
    rows, doubts = tuple(row(pair, first, again) for pair in plan.pairs), frame.doubts(first.values())
    jobs_of = {
        job.solved.specimen.plane: job for pair in plan.pairs if pair.key == "plane" for job in (pair.one, pair.other)
    }
    planes: dict[str, Result] = {
        plane: run for plane, job in sorted(jobs_of.items()) if (run := first[job].result) is not None
    }
    study = kind(plan.base.solved, rows, plan.left_out, plan.base.method, unresolved=doubts, planes=planes)
    study.write(out)
    return study


def would_run(plan: Plan, out: Path) -> list[str]:
    """The runs with their times, a line each, and what is left out; nothing is run."""
    runs = TIMES + 1
    perhaps = [
        f"{pair.name}: {runs} runs, {pair.long(runs)}, where {pair.within.key} {pair.within.against} and "
        f"{pair.within.value} are more than {NEGLIGIBLE:.1%} apart"
        for pair in plan.pairs
        if pair.within
    ]
    return frame.would_run([*plan.jobs, *plan.again()], (*perhaps, *plan.left_out), out)


def row(pair: Pair, first: Mapping[Job, Outcome], again: Mapping[Job, Sequence[Outcome]]) -> Row:
    """Compare the two runs of a pair; the times are those of the repetitions ``again``."""
    known: dict[str, Any] = {key: getattr(pair, key) for key in ("name", "key", "value", "against", "scene_has")}
    sides = {pair.value: pair.one, pair.against: pair.other}
    wrong = [f"{pair.key} = {value}: {why}" for value, job in sides.items() if (why := failure(first[job]))]
    ours, theirs = first[pair.one].result, first[pair.other].result
    if not wrong and ours is not None and theirs is not None and pair.of_damage:
        wrong = starts_otherwise(ours, theirs)
    if wrong or ours is None or theirs is None:
        return unmeasured(Row, known | {"status": "; ".join(wrong)})
    mine, other = (
        sorted((o.result for o in again[job] if o.result and o.result.seconds), key=run_seconds)
        for job in (pair.one, pair.other)
    )
    (least, most), (against, longest) = (
        (run_seconds(runs[0]), run_seconds(runs[-1])) if runs else (nan, nan) for runs in (mine, other)
    )
    return Row(
        **known,
        **changes(ours, theirs, pair.one.solved.load.opening),
        **counts(mine[0] if mine else ours),
        seconds=least,
        seconds_against=against,
        time_ratio=least / against,
        time_spread=max(most / least, longest / against),
        times=min(len(mine), len(other)),
        status="complete",
    )


def counts(result: Result) -> dict[str, Any]:
    """Unknowns, steps, iterations, memory, and seconds of an iteration."""
    iterations, parts = int(np.sum(result.steps["newton_iterations"])), result.seconds or {}
    moving = parts.get("total", nan) - sum(parts.get(name, 0.0) for name in ("mesh", "basis"))
    return {
        "dofs": result.dofs,
        "steps": result.opening.size - 1,
        "newton_iterations": iterations,
        "rejected_steps": result.rejected_steps,
        "iteration": moving / max(iterations, 1),
        "peak_memory_mb": result.peak_memory_mb,
    }


def starts_otherwise(with_it: Result, without: Result) -> list[str]:
    """A sentence where two runs that differ in damage alone have other slopes at rest, where there is none.

    Both are slopes of one matrix: they differ by rounding, which its condition number enlarges.
    """
    first, other = (float(run.steps.get("load_slope", np.full(1, nan))[0]) for run in (with_it, without))
    rounding = np.finfo(float).eps * max(with_it.condition, without.condition, SLOPES_CONDITION)
    off = first / other - 1.0 if other else 0.0
    if not abs(off) > rounding:
        return []
    return [f"one of both runs is wrong: at rest, without any damage, the stiffness with it is {signed(off)} off"]


def changes(one: Result, other: Result, programme: Sequence[float]) -> dict[str, Any]:
    """Changes of curve, peak, end and energies: value of one run over that of the other, minus 1."""
    top = max(abs(peak_load(one)), abs(peak_load(other)))
    most = max(abs(work(one)), abs(work(other)))
    return {
        "curve_change": apart(one, other, programme),
        "peak_change": change(peak_load(one), peak_load(other), top),
        "end_change": change(float(one.load[-1]), float(other.load[-1]), top),
        "dissipated_change": change(dissipated(one), dissipated(other), most),
        "work_change": change(work(one), work(other), most),
    }


def apart(one: Result, other: Result, programme: Sequence[float]) -> float:
    """Relative L2 distance of the loads: of the envelopes, or of the leg that differs more, as checks of codes have it.

    Envelopes do not contain unloading, which some effects change most.
    """
    curve = cubics(one)
    return max(distance(curve, other), worst_leg(curve, cubics(other), programme))


def change(value: float, before: float, scale: float) -> float:
    """value / before - 1; 0 where both are negligible on the ``scale``, NaN where only ``before`` is."""
    if abs(before) <= ZERO * scale:
        return 0.0 if abs(value) <= ZERO * scale else nan
    return value / before - 1.0


def signed(fraction: float) -> str:
    """A percentage with sign, two significant digits and at most five decimals: +0.69 %."""
    per_cent = 100.0 * fraction
    return "0 %" if abs(per_cent) < 1e-5 else f"{float(f'{per_cent:.2g}'):+.6g} %"
