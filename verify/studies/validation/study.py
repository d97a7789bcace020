"""`debond validate`: every run once, and a statement on each quantity that the simulation and the data have."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from math import isfinite
from pathlib import Path
from typing import ClassVar

from verify.checks.foreign_curves import Curve as Data
from verify.curves.curve import Curve
from verify.curves.of_run import cubics
from verify.methods.mesh_choice import size
from verify.methods.solve import prepare, require
from verify.runs.jobs import Job, Outcome
from verify.scene import toml
from verify.scene.schema import Scene
from verify.scene.stated.uncertainty import number_at, scaled
from verify.studies import frame, uncertainty
from verify.studies.uncertainty import LOAD_PLACES, Runs, able, jobs_of, meshes, results, values, varied
from verify.studies.validation.quantities import other_units, quantities
from verify.studies.validation.statement import ESTIMATES, Statement, statement, step_of
from verify.support.refusal import Refusal

#: Ratio of the element lengths of successive meshes: the least that Celik et al. (2008) require, as coarser meshes may
#: not resolve the process zone.
MESH_RATIO = 1.3


@dataclass(frozen=True)
class Plan:
    """Runs by what is varied: "mesh", the scene as it is and coarser; "load.at=face" and so on, empty where only one
    place is possible; keys of inputs, each smaller and larger. ``left_out``: a sentence for what is in no budget."""

    runs: Runs[Job]
    left_out: tuple[str, ...]

    @property
    def base(self) -> Job:
        return self.runs["mesh"][0]

    @property
    def jobs(self) -> list[Job]:
        return jobs_of(self.runs)

    @property
    def stated(self) -> dict[str, float]:
        """Relative standard uncertainties by the dotted keys of inputs and of the data, 0 where none is stated."""
        return {**self.base.scene.uncertainty.inputs, **self.base.scene.uncertainty.data}


def planned(source: str, scene: Scene, method: str, given: Sequence[str] = ()) -> Plan:
    """The runs of a scene with one method; ``given`` are overrides that ``scene`` has and that every run repeats.

    Every run keeps the stiffness of the contact, whose default depends on inputs, and effects that are "auto", which
    might change with an input. Steps are chosen by accuracy unless overrides set them.

    Raises
    ------
    NotRun, Refusal : the method cannot solve the scene, or not with an input smaller or larger.
    """
    if max(scene.load.opening) <= 0.0:
        raise Refusal(f"load.opening: must go above 0 for debond validate, got {list(scene.load.opening)}")
    prepared = prepare(scene, method)
    require(prepared)
    numbers, meshed = scene.uncertainty, prepared.method.has_mesh
    held = [f"interface.penalty={prepared.scene.interface.penalty!r}"]
    held += [f"effects.{one.key}={toml.value(one.value)}" for one in prepared.decisions]
    if prepared.method.with_dofs and not any(one.startswith("discretization.steps") for one in given):
        held.append("discretization.steps=auto")
    base = Job(source, scene, method, f"validation/{method}", (*given, *held), fields=False)
    left_out, runs = [], {"mesh": [base]}
    if numbers.introduction and meshed:
        here = scene.load.at
        places = {place: [base] if place == here else able(base, f"load-at-{place}", f"load.at={place}")
                  for place in (here, *LOAD_PLACES)}  # fmt: skip
        if sum(map(len, places.values())) > 1:
            runs |= {f"load.at={place}": found for place, found in places.items() if found}
    if numbers.introduction and len(runs) == 1:
        one_place = f"{method} has one place of the load in this scene, which is not in the budget"
        left_out.append(f"load introduction: {one_place}")
    if meshed:
        finest = size(prepared.scene, prepared.method.with_dofs)
        runs["mesh"] += meshes(base, finest, (MESH_RATIO**-1, MESH_RATIO**-2), "mesh")
    else:
        left_out.append(f"mesh: the method {method} has none to refine, so that u_num is taken as 0")
    if not numbers.inputs:
        left_out.append("inputs: [uncertainty] of the scene states none, so that their part of u_input is 0")
    if not any(numbers.data.values()):
        left_out.append("data: [uncertainty] states neither data.load nor data.opening, so that u_D is 0")
    tables = {name: getattr(scene, name) for name in type(scene).model_fields}
    for key, u in numbers.inputs.items():
        value = number_at(tables, key)
        if value is None:
            raise Refusal(f"uncertainty.{key}: must be that of a number of the scene")
        sides = {"smaller": 1.0 - step_of(u), "larger": 1.0 + step_of(u)}
        what = f"uncertainty.{key}"
        runs[key] = [varied(base, f"{key}-{n}", f"{key}={scaled(value, f)}", what=what) for n, f in sides.items()]
    return Plan(runs, tuple(left_out))


@dataclass(frozen=True)
class Row:
    """A line of ``validation.csv``: one quantity; uncertainties are standard ones in its unit. ``u_input`` is without
    the introduction of the load, which has its own column."""

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
    parts = map(of.of, ("num", "input", "introduction", "data"))
    return Row(of.quantity, of.S, of.D, of.E, *parts, of.u_val, *of.interval, of.resolved, of.doubt)


@dataclass(frozen=True)
class Study(uncertainty.Study):
    """The statements ``found``; the ``curves`` are those of the simulation, None where a run is missing."""

    NAME: ClassVar[str] = "validation"
    ROW: ClassVar[type] = Row

    plan: Plan
    data: Data
    curves: Runs[Curve] | None

    def about(self) -> dict[str, object]:
        return {
            "method": self.plan.base.method,
            "data": {"name": self.data.name, "file": str(self.data.path)},
            "coverage_factor": ESTIMATES.coverage,
            "statements": [
                {
                    **asdict(row(one)),
                    "where": one.where,
                    "sentence": one.sentence,
                    "remarks": one.remarks,
                    "budget": [asdict(part) for part in one.parts],
                }
                for one in self.found
            ],
            "failures": list(self.failures),
        }

    def lines(self) -> list[str]:
        tables = [line for one in self.found for line in budget_lines(one)]
        return [*tables, *(remark for one in self.found for remark in one.remarks), *super().lines()]


def budget_lines(one: Statement) -> list[str]:
    """The budget of a quantity, in parts of the data."""

    def line(name: str, u: float, stated: float = 0.0, slope: float = float("nan")) -> str:
        columns = f"{stated:9.2%}" if stated else " " * 9, f"{slope:9.2f}" if isfinite(slope) else " " * 9
        return f"  {name:26}{''.join(columns)}{u:10.3g}{one.part(u):9.2%}"

    sums = {"u_num": one.of("num"), "u_input": one.of("input", "introduction"), "u_D": one.of("data")}
    return [
        f"{one.quantity:28}{'stated':>9}{'dq/dx':>9}{'u':>10}{'u / D':>9}",
        *(line(part.name, abs(part.u), part.stated, part.sensitivity) for part in one.parts),
        *(line(name, u) for name, u in {**sums, "u_val": one.u_val}.items()),
        "",
    ]


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
    found, failures = results(plan.jobs, outcomes)
    curves: Runs[Curve] | None = None
    statements: tuple[Statement, ...] = ()
    missing: list[str] = []
    if not failures:
        measured = data.result.opening, data.result.load
        of_job = {job: cubics(result) for job, result in found.items()}
        curves = values(plan.runs, of_job.__getitem__)
        units = other_units(curves["mesh"][0], measured)
        failures = (units,) if units else ()
        sizes = [1.0 / found[job].elements for job in plan.runs["mesh"][: 3 if len(plan.runs["mesh"]) > 1 else 0]]
        asked, missing = quantities(curves["mesh"][0], measured, at) if not units else ((), [])
        statements = tuple(statement(one, curves, sizes, measured, plan.stated) for one in asked)
    left_out, doubts = (*plan.left_out, *missing), frame.doubts(outcomes.values())
    scene, rows = plan.base.scene, tuple(map(row, statements))
    return Study(scene, rows, left_out, statements, failures, plan, data, curves, unresolved=doubts)
