"""`debond certify`: runs of two codes, and the value and uncertainty of each quantity on which they agree."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from math import isfinite
from pathlib import Path
from typing import ClassVar

import numpy as np

from verify.checks.certified import measured
from verify.checks.proof import REFERENCE, SEARCHING
from verify.methods.mesh_choice import size, spline_mesh
from verify.methods.reference_mesh import reference_mesh
from verify.methods.second_meshes import through
from verify.methods.solve import prepare, require
from verify.result import Result
from verify.runs.jobs import Job, Outcome
from verify.scene.effects import simulated
from verify.scene.schema import Scene
from verify.scene.stated.certified import Certified, CertifiedKind, problem_key
from verify.studies import frame, uncertainty
from verify.studies.certified.values import Value, of_code, shared
from verify.studies.uncertainty import LOAD_PLACES, Runs, able, jobs_of, meshes, results, values, varied
from verify.support.programme import only_opens
from verify.support.refusal import Refusal

#: Load, over the peak load, below which a load is not certified, as relative errors are meaningless for it.
LEAST_CERTIFIED = 0.05


@dataclass(frozen=True)
class Resolution:
    """How fine the runs are; finer ones cost time and make uncertainties smaller.

    ratio : ratio of the element lengths of successive meshes, at least 1.3 (Celik et al. 2008, J. Fluids Eng. 130,
        078001)
    finer : elements of the finest mesh over those of the scene, as a power of ``ratio``. On the mesh of a scene the
        load oscillates by 1e-3 as the front passes from element to element; this falls faster than any order
    bend : `discretization.bend` of steps whose length the codes choose; a quarter of it halves the steps. 150 equal
        steps would leave errors up to 2e-3 of a load between them, a bend of 1e-3 errors of 1e-4 to 1e-3
    degree : least degree of the DOLFINx elements: the error of one quadratic element through a slender arm is larger
        than the uncertainties here
    parts : parts of the largest opening at which loads are certified by default
    """

    ratio: float = 1.4
    finer: Mapping[str, int] = field(default_factory=lambda: {SEARCHING: 2, REFERENCE: 1})
    bend: float = 2.5e-4
    degree: int = 3
    parts: tuple[float, ...] = (0.25, 0.5, 0.75, 1.0)


RESOLUTION = Resolution()


@dataclass(frozen=True)
class Plan:
    """Every run once.

    codes : of each code, first the one that follows the surfaces: "mesh", "steps" half as long, more layers through the
        "thickness". Of the first code also "matched", with pairs of points kept, and other places of the load; a group
        is empty where that cannot be run, or changes nothing
    at : openings of the certified loads
    left_out : a sentence for everything that is in no budget
    """

    codes: Mapping[str, Runs[Job]]
    at: tuple[float, ...]
    left_out: tuple[str, ...]

    @property
    def scene(self) -> Scene:
        return self.codes[SEARCHING]["mesh"][0].scene

    @property
    def jobs(self) -> list[Job]:
        return jobs_of(*self.codes.values())


def planned(source: str, scene: Scene, at: Sequence[float] = (), given: Sequence[str] = ()) -> Plan:
    """The runs of a scene; ``given`` are overrides that ``scene`` has and that every run repeats.

    Raises
    ------
    NotRun, Refusal : one of the codes cannot solve the scene, or its programme turns.
    """
    end = max(scene.load.opening)
    if not only_opens(scene.load.opening) or end <= 0.0:
        raise Refusal(f"load.opening: must only grow from 0 on for debond certify, got {list(scene.load.opening)}")
    if wrong := [one for one in at if not 0.0 < one <= end]:
        raise Refusal(f"--at: must be > 0 and <= {end:g}, the largest opening, got {wrong[0]:g}")
    for method in (SEARCHING, REFERENCE):
        require(prepare(scene, method))
    layers, mesh = spline_mesh(scene).layers, reference_mesh(scene)
    degree = f"dolfinx.degree={max(mesh.degree, RESOLUTION.degree)}", f"dolfinx.layers={mesh.layers}"
    codes: dict[str, dict[str, Sequence[Job]]] = {}
    for name, kept in ((SEARCHING, ()), (REFERENCE, degree)):
        base = Job(source, scene, name, "certified", (*given, *_steps(RESOLUTION.bend), *kept), fields=False)
        scales = [RESOLUTION.ratio ** (RESOLUTION.finer[name] - coarser) for coarser in range(3)]
        runs = meshes(base, size(scene, splines=name == SEARCHING), scales, name)
        more = through(runs[0].solved, layers + 1) if name == SEARCHING else (f"dolfinx.layers={2 * mesh.layers}",)
        codes[name] = {
            "mesh": runs,
            "steps": [varied(runs[0], "steps", *_steps(RESOLUTION.bend / 4.0))],
            "thickness": able(runs[0], "layers", *more),
        }
    left_out = [f"{name}: one layer of elements alone" for name, one in codes.items() if not one["thickness"]]
    first, finest = codes[SEARCHING], codes[SEARCHING]["mesh"][0]
    searches = simulated(scene)["search"]
    first["matched"] = able(finest, "matched", "effects.search=false") if searches else []
    if searches and not first["matched"]:
        lacking = "DOLFINx keeps its pairs of points, and NURBS cannot here: what that changes is not known"
        left_out.insert(0, f"matched interface: {lacking}")
    for place in LOAD_PLACES:
        first[place] = able(finest, f"at-{place}", f'load.at="{place}"') if place != scene.load.at else []
    return Plan(codes, tuple(at) or tuple(part * end for part in RESOLUTION.parts), tuple(left_out))


def _steps(bend: float) -> tuple[str, str]:
    """Overrides for steps whose length the codes choose."""
    return "discretization.steps=auto", f"discretization.bend={bend:g}"


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
    return Row(of.quantity, of.value, of.uncertainty, not of.doubt, *first, *second, of.apart, of.matched, of.doubt)


@dataclass(frozen=True)
class Study(uncertainty.Study):
    """The values ``found``."""

    NAME: ClassVar[str] = "certified"
    ROW: ClassVar[type] = Row

    @property
    def kept(self) -> tuple[Certified, ...]:
        """The content for the file of the package."""
        return tuple(
            Certified(one.quantity, one.kind, one.opening, one.value, one.uncertainty, one.matched)
            for one in self.found
            if not one.doubt
        )

    @property
    def remarks(self) -> tuple[str, ...]:
        """Sentences: what is in no budget, and why a quantity has no certified value."""
        return (*self.left_out, *(one.sentence for one in self.found if one.doubt))

    def about(self) -> dict[str, object]:
        return {
            "problem": problem_key(self.scene),
            "values": [{**asdict(row(one)), **asdict(one)} for one in self.found],
            "failures": list(self.failures),
        }


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


def judged(plan: Plan, outcomes: Mapping[Job, Outcome]) -> Study:
    """The values from the runs; none while a run is missing."""
    found, failures = results(plan.jobs, outcomes)
    end, value = max(plan.scene.load.opening), list[Value]()
    wanted: dict[str, tuple[CertifiedKind, float | None]] = {"peak load": ("peak", None)}
    wanted["opening at the peak"] = "peak_opening", None
    wanted |= {f"load at {one:g}": ("load_at", one) for one in plan.at}
    wanted |= {f"work up to {end:g}": ("work", end), "length of the process zone": ("zone", end)}
    left_out = list(plan.left_out)
    for name, (kind, opening) in wanted.items() if found else ():
        why = _lacking([found[job] for code in plan.codes.values() for job in code["mesh"]], kind, opening, end)
        if why:
            left_out.append(f"{name}: left out: {why}")
        else:
            value.append(_value(plan, found, name, kind, opening))
    doubts, told = frame.doubts(outcomes.values()), shared(value)
    return Study(plan.scene, tuple(map(row, told)), tuple(left_out), told, failures, unresolved=doubts)


def _lacking(runs: Sequence[Result], kind: CertifiedKind, opening: float | None, end: float) -> str:
    """Why the runs on all meshes do not have a quantity; empty where they do."""
    seen = [measured(run, kind, opening) for run in runs]
    if not np.all(np.isfinite(seen)):
        ends = "the crack does not grow all along the last half of the programme, short of the far end"
        return ends if kind == "zone" else "a run ends before"
    if min(seen) <= LEAST_CERTIFIED * max(measured(run, "peak") for run in runs) * (kind == "load_at"):
        return f"the specimen bears less than {LEAST_CERTIFIED:.0%} of its peak load there"
    return "the load still grows at the end" if kind == "peak_opening" and max(seen) >= (1.0 - 1e-6) * end else ""


def _value(plan: Plan, runs: Mapping[Job, Result], name: str, kind: CertifiedKind, opening: float | None) -> Value:
    """One quantity of all runs; that of the second code is corrected to the model of the scene."""
    found = {code: values(one, lambda job: measured(runs[job], kind, opening)) for code, one in plan.codes.items()}
    first, finest = found[SEARCHING], found[SEARCHING]["mesh"][0]
    matched = first["matched"][0] - finest if first["matched"] else None if simulated(plan.scene)["search"] else 0.0
    condition, codes = max(run.condition for run in runs.values()), {}
    for code, seen in found.items():
        sizes = [1.0 / runs[job].elements for job in plan.codes[code]["mesh"]]
        codes[code] = of_code(seen, sizes, condition, -(matched or 0.0) if code == REFERENCE else 0.0)
    places = {place: value - finest for place in LOAD_PLACES for value in first[place] if isfinite(value)}
    return Value(name, kind, opening, codes, matched, places)
