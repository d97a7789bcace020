"""`debond validate`: every run once, and a statement on each quantity that the simulation and the data have."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
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
from verify.studies.uncertainty import Plan, Runs, meshes, places, results, values, varied
from verify.studies.validation.quantities import other_units, quantities, slack
from verify.studies.validation.statement import ESTIMATES, Statement, statement, step_of
from verify.support.refusal import Refusal

#: Ratio of the element lengths of successive meshes: the least that Celik et al. (2008) require, as coarser meshes may
#: not resolve the process zone.
MESH_RATIO = 1.3


def planned(source: str, scene: Scene, method: str, given: Sequence[str] = (), at: Sequence[float] = ()) -> Plan:
    """The runs of a scene with one method: "mesh", places of the load, and for each key of an uncertain number one with
    it smaller and one with it larger; ``given`` are overrides that ``scene`` has and that every run repeats.

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
    runs = {"mesh": [base], **(places(base) if numbers.introduction and meshed else {})}
    one_place = f"{method} has one place of the load in this scene, which is not in the budget"
    lacking = {
        f"load introduction: {one_place}": numbers.introduction and len(runs) == 1,
        f"mesh: the method {method} has none to refine, so that u_num is taken as 0": not meshed,
        "inputs: [uncertainty] of the scene states none, so that their part of u_input is 0": not numbers.inputs,
        "data: [uncertainty] states neither data.load nor data.opening, so that u_D is 0": not any(
            numbers.data.values()
        ),
    }
    if meshed:
        finest = size(prepared.scene, prepared.method.with_dofs)
        runs["mesh"] += meshes(base, finest, (MESH_RATIO**-1, MESH_RATIO**-2), "mesh")
    for key, u in numbers.inputs.items():
        what, value, step = f"uncertainty.{key}", number_at(scene, key), step_of(u)
        assert value is not None  # a scene refuses other keys
        sides = {"smaller": scaled(value, 1.0 - step), "larger": scaled(value, 1.0 + step)}
        runs[key] = [
            job for name, one in sides.items() for job in varied(base, f"{key}-{name}", f"{key}={one}", what=what)
        ]
    return Plan({method: runs}, at, [text for text, absent in lacking.items() if absent])


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
    num, by_input, introduction, data = map(of.of, ("num", "input", "introduction", "data"))
    u = num, by_input, introduction, data, of.u_val
    return Row(of.quantity, of.S, of.D, of.E, *u, *of.model_error, of.resolved, of.doubt)


@dataclass(frozen=True)
class Study(uncertainty.Study):
    """The statements ``found``; the ``curves`` are those of the simulation, empty where a run is missing."""

    NAME: ClassVar[str] = "validation"
    PAGE: ClassVar[str] = "verify.studies.validation.page"
    ROW: ClassVar[type] = Row
    FOUND: ClassVar[str] = "statements"
    INTERVALS: ClassVar[str] = "The error of the model lies in its interval with a probability of 95 %"
    AXIS: ClassVar[str] = "error of the model (% of the data)"

    method: str
    data: Data
    curves: Runs[Curve]

    def about(self) -> dict[str, object]:
        own = {
            "method": self.method,
            "coverage_factor": ESTIMATES.coverage,
            "remarks": self.remarks,
            "verdict": self.verdict,
        }
        return {**own, "data": {"name": self.data.name, "file": str(self.data.path)}, **super().about()}

    @property
    def remarks(self) -> list[str]:
        return [remark for one in self.found for remark in one.remarks]

    @property
    def verdict(self) -> str:
        """In plain words which quantities are off, by how much, and which agree; empty without a statement."""
        told = []
        for one in (one for one in self.found if one.resolved and not one.doubt):
            low, high = sorted(100.0 * abs(one.part(end)) for end in one.model_error)
            told.append(f"{one.quantity} is {low:.2g} to {high:.2g} % too {'high' if one.E > 0.0 else 'low'}")
        if same := [one.quantity for one in self.found if not one.resolved and not one.doubt]:
            told.append(f"{', '.join(same)} agree{'s' * (len(same) == 1)} as far as can be told")
        if open_ones := [one.quantity for one in self.found if one.doubt]:
            told.append(f"{', '.join(open_ones)} cannot be judged")
        return f"the model against {self.data.name}: {'; '.join(told)}" if told else ""

    def lines(self) -> list[str]:
        tables = [f"{one.table.markdown()}\n" for one in self.found]
        return [*[self.verdict] * bool(self.verdict), *tables, *self.remarks, *super().lines()]


def judged(plan: Plan, data: Data, outcomes: Mapping[Job, Outcome]) -> Study:
    """The statements from the runs; none while a run is missing."""
    found, failures = results(plan, outcomes)
    method, measured, left_out = plan.jobs[0].method, (data.result.opening, data.result.load), list(plan.left_out)
    runs = found.get(method, {})
    curves, statements = values(runs, cubics), list[Statement]()
    if curves and (units := other_units(curves["mesh"][0], measured)):
        failures = (units,)
    if not failures:
        asked, missing = quantities(curves["mesh"][0], measured, plan.at)
        sizes = [1.0 / (run.elements or 1) for run in runs["mesh"]]
        statements = [statement(one, curves, sizes, measured, plan.scene.uncertainty) for one in asked]
        left_out += [*missing, *slack(measured)]
    rows, told, doubts = tuple(map(row, statements)), tuple(left_out), frame.doubts(outcomes.values())
    return Study(plan.scene, rows, told, tuple(statements), failures, method, data, curves, unresolved=doubts)
