"""The study: every run once, and the value and uncertainty of each quantity."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from math import isfinite
from pathlib import Path
from typing import ClassVar

import numpy as np

from verify.checks.certified import measured
from verify.checks.proof import REFERENCE, SEARCHING
from verify.result import Result
from verify.runs.jobs import Job, Outcome
from verify.scene.effects import simulated
from verify.scene.stated.certified import Certified, CertifiedKind, problem_key
from verify.studies import frame
from verify.studies.certified.budget import Seen, Value, of_code, shared
from verify.studies.certified.plan import CodeRuns, Plan

#: Load, over the peak load, below which a load is not certified, as relative errors are meaningless for it.
LEAST_CERTIFIED = 0.05

#: Quantity, kind and opening, as of `Certified`.
Wanted = tuple[str, CertifiedKind, float | None]


@dataclass(frozen=True)
class Row:
    """A line of ``certified.csv``; uncertainties are expanded, for 95 %, in the unit of the quantity."""

    quantity: str
    value: float
    uncertainty: float
    certified: bool
    nurbs: float
    nurbs_uncertainty: float
    dolfinx: float
    dolfinx_uncertainty: float
    apart: float
    matched: float | None
    why_not: str


def row(of: Value) -> Row:
    first, second = ((one.value, one.uncertainty) for one in of.codes.values())
    return Row(of.quantity, of.value, of.uncertainty, not of.why_not, *first, *second, of.apart, of.matched, of.why_not)


@dataclass(frozen=True)
class Study(frame.Study):
    """Results; ``left_out`` has a sentence for everything in no budget, ``failures`` one for every failed run."""

    NAME: ClassVar[str] = "certified"
    ROW: ClassVar[type] = Row
    PACKAGES: ClassVar[tuple[str, ...]] = ("iga", "fem_reference")

    values: tuple[Value, ...]
    failures: tuple[str, ...]

    @property
    def complete(self) -> bool:
        """Whether every run is complete and every value is certified."""
        return bool(self.values) and not self.failures and not any(one.why_not for one in self.values)

    @property
    def kept(self) -> tuple[Certified, ...]:
        """The content for the file of the package."""
        return tuple(
            Certified(one.quantity, one.kind, one.opening, one.value, one.uncertainty, one.matched)
            for one in self.values
            if not one.why_not
        )

    @property
    def remarks(self) -> tuple[str, ...]:
        """Sentences: what is in no budget, and why a quantity has no certified value."""
        return (*self.left_out, *(one.sentence for one in self.values if one.why_not))

    def about(self) -> dict[str, object]:
        return {
            "problem": problem_key(self.scene),
            "values": [{**asdict(row(one)), **asdict(one)} for one in self.values],
            "failures": list(self.failures),
        }

    def lines(self) -> list[str]:
        return [*self.left_out, *self.failures, *(one.sentence for one in self.values)]


def certify(plan: Plan, out: Path, jobs: int, scheduler: str | None = None) -> Study:
    """Run the study into ``out``: certified.csv, certified.json, report.html.

    Parameters
    ----------
    jobs : runs at a time, or with a dask ``scheduler`` its workers
    """
    frame.one_thread()
    study = judged(plan, frame.run(plan.jobs, out, jobs, scheduler))
    study.write(out)
    return study


def would_run(plan: Plan, out: Path, jobs: int) -> list[str]:
    """The runs with their times, a line each; nothing is run."""
    return frame.would_run(plan.jobs, plan.left_out, out, jobs)


def judged(plan: Plan, outcomes: Mapping[Job, Outcome]) -> Study:
    """The values from the runs; none while a run is missing."""
    failures = tuple(f"{job.variant}: {why}" for job in plan.jobs if (why := frame.failure(outcomes[job])))
    values: tuple[Value, ...] = ()
    missing: list[str] = []
    if not failures:
        runs = {job: outcome.result for job, outcome in outcomes.items() if outcome.result is not None}
        wanted, missing = _wanted(plan, runs)
        values = shared([_value(plan, runs, one) for one in wanted])
    doubts = frame.doubts(outcomes.values())
    return Study(plan.scene, tuple(map(row, values)), (*plan.left_out, *missing), values, failures, unresolved=doubts)


def _wanted(plan: Plan, runs: Mapping[Job, Result]) -> tuple[list[Wanted], list[str]]:
    """The quantities that the runs on all meshes have, and a sentence for each other one."""
    end = max(plan.scene.load.opening)
    loads: list[Wanted] = [(f"load at {one:g}", "load_at", one) for one in plan.at]
    every: list[Wanted] = [("peak load", "peak", None), ("opening at the peak", "peak_opening", None), *loads]
    every += [(f"work up to {end:g}", "work", end), ("length of the process zone", "zone", end)]
    meshes = [runs[job] for code in plan.codes.values() for job in code.meshes]
    found, missing = [], []
    for one in every:
        seen = [measured(run, *one[1:]) for run in meshes]
        least = LEAST_CERTIFIED * max(measured(run, "peak") for run in meshes) if one[1] == "load_at" else 0.0
        if not np.all(np.isfinite(seen)):
            missing.append(f"{one[0]}: left out: {_lacking(one[1])}")
        elif min(seen) <= least:
            missing.append(
                f"{one[0]}: left out: the specimen bears less than {LEAST_CERTIFIED:.0%} of its peak load there"
            )
        elif one[1] == "peak_opening" and max(seen) >= (1.0 - 1e-6) * end:
            missing.append(f"{one[0]}: left out: the load still grows at the end")
        else:
            found.append(one)
    return found, missing


def _lacking(kind: CertifiedKind) -> str:
    if kind == "zone":
        return "the crack does not grow all along the last half of the programme, short of the far end"
    return "a run ends before"


def _value(plan: Plan, runs: Mapping[Job, Result], wanted: Wanted) -> Value:
    """One quantity of all runs."""
    name, kind, opening = wanted

    def of(job: Job) -> float:
        return measured(runs[job], kind, opening)

    finest = of(plan.codes[SEARCHING].meshes[0])
    without_run = None if simulated(plan.scene)["search"] else 0.0
    matched = of(plan.matched) - finest if plan.matched else without_run
    condition = max(run.condition for run in runs.values())
    codes = {
        code: of_code(_seen(made, runs, wanted, condition), -(matched or 0.0) if code == REFERENCE else 0.0)
        for code, made in plan.codes.items()
    }
    places = {place: of(job) - finest for place, job in plan.places.items()}
    known = {place: change for place, change in places.items() if isfinite(change)}
    return Value(name, kind, opening, codes, matched, known)


def _seen(code: CodeRuns, runs: Mapping[Job, Result], wanted: Wanted, condition: float) -> Seen:
    def of(job: Job) -> float:
        return measured(runs[job], *wanted[1:])

    meshes = [(1.0 / runs[job].elements, of(job)) for job in code.meshes]
    return Seen(meshes, of(code.paced), of(code.layered) if code.layered else None, condition)
