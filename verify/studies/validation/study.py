"""The study: every run once, and a statement on each quantity that the simulation and the data have."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from math import isfinite
from pathlib import Path
from typing import ClassVar

from verify.checks.foreign_curves import Curve as Data
from verify.curves.curve import Curve
from verify.curves.of_run import cubics
from verify.runs.jobs import Job, Outcome
from verify.studies import frame
from verify.studies.validation.budget import Part
from verify.studies.validation.plan import Plan
from verify.studies.validation.quantities import quantities
from verify.studies.validation.scales import other_units
from verify.studies.validation.statement import COVERAGE, Curves, Known, Statement, statement


@dataclass(frozen=True)
class Row:
    """A line of ``validation.csv``: one quantity; uncertainties are standard ones in its unit."""

    quantity: str
    S: float
    D: float
    E: float
    u_num: float
    u_input: float
    u_introduction: float
    u_D: float
    u_val: float
    low: float
    high: float
    resolved: bool
    doubt: str


def row(of: Statement) -> Row:
    """u_input without the introduction of the load, which has its own column."""
    low, high = of.interval
    parts = of.of("num"), of.of("input"), of.of("introduction"), of.of("data")
    return Row(of.quantity, of.S, of.D, of.E, *parts, of.u_val, low, high, of.resolved, of.doubt)


@dataclass(frozen=True)
class Study(frame.Study):
    """Results; ``left_out`` has a sentence for everything not in the budget, ``failures`` one for every failed run, or
    why the data cannot be those of the scene."""

    NAME: ClassVar[str] = "validation"
    ROW: ClassVar[type] = Row
    PACKAGES: ClassVar[tuple[str, ...]] = ("iga", "fem_reference")

    method: str
    data: Data
    statements: tuple[Statement, ...]
    curves: Curves | None
    known: Known
    failures: tuple[str, ...]

    @property
    def complete(self) -> bool:
        """Whether every run is complete and every statement could be made."""
        return bool(self.statements) and not self.failures and not any(one.doubt for one in self.statements)

    def about(self) -> dict[str, object]:
        return {
            "method": self.method,
            "data": {"name": self.data.name, "file": str(self.data.path)},
            "coverage_factor": COVERAGE,
            "statements": [_as_json(one) for one in self.statements],
            "failures": list(self.failures),
        }

    def lines(self) -> list[str]:
        tables = [line for one in self.statements for line in table(one)]
        remarks = [remark for one in self.statements for remark in one.remarks]
        sentences = [one.sentence for one in self.statements]
        return [*tables, *remarks, *self.left_out, *self.failures, *sentences]


def table(one: Statement) -> list[str]:
    """The budget of a quantity, in parts of the data."""
    head = f"{one.quantity:28}{'stated':>9}{'dq/dx':>9}{'u':>10}{'u / D':>9}"
    sums = {"u_num": one.of("num"), "u_input": one.of("input", "introduction"), "u_D": one.of("data")}
    return [
        head,
        *(_line(one, part) for part in one.parts),
        *(f"  {name:26}{'':18}{u:10.3g}{one.part(u):9.2%}" for name, u in {**sums, "u_val": one.u_val}.items()),
        "",
    ]


def _line(one: Statement, part: Part) -> str:
    stated = f"{part.stated:9.2%}" if part.stated else " " * 9
    slope = f"{part.sensitivity:9.2f}" if isfinite(part.sensitivity) else " " * 9
    return f"  {part.name:26}{stated}{slope}{abs(part.u):10.3g}{one.part(abs(part.u)):9.2%}"


def _as_json(one: Statement) -> dict[str, object]:
    return {
        **asdict(row(one)),
        "where": one.where,
        "sentence": one.sentence,
        "remarks": one.remarks,
        "budget": [asdict(part) for part in one.parts],
    }


def validate(plan: Plan, data: Data, out: Path, at: Sequence[float], jobs: int, scheduler: str | None = None) -> Study:
    """Run the study into ``out``: validation.csv, validation.json, report.html.

    Parameters
    ----------
    data : the curve with which the simulation is compared
    at : openings at which the load is compared, in addition to peak, stiffness and mean of the propagation
    jobs : runs at a time, or with a dask ``scheduler`` its workers
    """
    frame.one_thread()
    study = judged(plan, data, frame.run(plan.jobs, out, jobs, scheduler), at)
    study.write(out)
    return study


def judged(plan: Plan, data: Data, outcomes: Mapping[Job, Outcome], at: Sequence[float]) -> Study:
    """The statements from the runs; none while a run is missing."""
    failures = tuple(f"{job.variant}: {why}" for job in plan.jobs if (why := frame.failure(outcomes[job])))
    statements: tuple[Statement, ...] = ()
    missing: list[str] = []
    curves = None
    if not failures:
        curves, measured = _curves(plan, outcomes), (data.result.opening, data.result.load)
        why = other_units(curves.scene, measured)
        failures = (why,) if why else ()
    if curves is not None and not failures:
        found, missing = quantities(curves.scene, measured, at)
        statements = tuple(statement(one, curves, measured, plan.known) for one in found)
    left_out, rows = (*plan.left_out, *missing), tuple(map(row, statements))
    doubts, scene, method = frame.doubts(outcomes.values()), plan.base.scene, plan.base.method
    return Study(scene, rows, left_out, method, data, statements, curves, plan.known, failures, unresolved=doubts)


def _curves(plan: Plan, outcomes: Mapping[Job, Outcome]) -> Curves:
    results = {job: outcome.result for job, outcome in outcomes.items() if outcome.result is not None}
    curve: dict[Job, Curve] = {job: cubics(result) for job, result in results.items()}
    inputs = {key: (step, curve[low], curve[high]) for key, (step, low, high) in plan.inputs.items()}
    meshes = [(1.0 / results[job].elements, curve[job]) for job in plan.meshes] if len(plan.meshes) > 1 else []
    return Curves(curve[plan.base], inputs, meshes, {place: curve[job] for place, job in plan.places.items()})


def would_run(plan: Plan, out: Path, jobs: int) -> list[str]:
    """The runs with their times, a line each; nothing is run."""
    return frame.would_run(plan.jobs, plan.left_out, out, jobs)
