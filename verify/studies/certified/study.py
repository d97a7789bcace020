"""`debond certify`: runs of two codes, and the value and uncertainty of each quantity on which they agree."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from math import isfinite
from typing import ClassVar

import numpy as np

from verify.checks.certified import measured
from verify.checks.proof import REFERENCE, SEARCHING
from verify.curves.of_run import peak_load
from verify.methods.mesh_choice import size, spline_mesh
from verify.methods.reference_mesh import reference_mesh
from verify.methods.second_meshes import through
from verify.methods.solve import prepare, require
from verify.result import Result
from verify.runs.jobs import Job, Outcome
from verify.scene.effects import simulated
from verify.scene.schema import Scene
from verify.scene.stated.certified import CertifiedKind, problem_key
from verify.studies import frame, uncertainty
from verify.studies.certified.values import OfCode, Value, of_code, shared
from verify.studies.uncertainty import Plan, Runs, meshes, places, results, values, varied
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
        halved = varied(runs[0], "steps", *_steps(RESOLUTION.bend / 4.0), what="discretization.bend")
        codes[name] = {"mesh": runs, "steps": halved, "thickness": varied(runs[0], "layers", *more)}
    left_out = [f"{name}: one layer of elements alone" for name, one in codes.items() if not one["thickness"]]
    first, searches = codes[SEARCHING], simulated(scene)["search"]
    first["matched"] = varied(first["mesh"][0], "matched", "effects.search=false") if searches else []
    if searches and not first["matched"]:
        lacking = "DOLFINx keeps its pairs of points, and NURBS cannot here: what that changes is not known"
        left_out.insert(0, f"matched interface: {lacking}")
    codes[SEARCHING] = first | places(first["mesh"][0])
    return Plan(codes, tuple(at) or tuple(part * end for part in RESOLUTION.parts), left_out)


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
    FOUND: ClassVar[str] = "values"
    INTERVALS: ClassVar[str] = (
        "Both codes on their finest meshes with their uncertainties; the band is that of the value"
    )
    AXIS: ClassVar[str] = "from the value (%)"

    def about(self) -> dict[str, object]:
        return {"problem": problem_key(self.scene), **super().about()}


def judged(plan: Plan, outcomes: Mapping[Job, Outcome]) -> Study:
    """The values from the runs; none while a run is missing."""
    runs, failures = results(plan, outcomes)
    end, left_out, found = max(plan.scene.load.opening), list(plan.left_out), list[Value]()
    wanted: list[tuple[str, CertifiedKind, float | None]] = [
        ("peak load", "peak", None),
        ("opening at the peak", "peak_opening", None),
        *((f"load at {one:g}", "load_at", one) for one in plan.at),
        (f"work up to {end:g}", "work", end),
        ("length of the process zone", "zone", end),
    ]
    for name, kind, opening in wanted if runs else ():
        of = partial(measured, kind=kind, opening=opening)
        if why := _lacking([(of(run), peak_load(run)) for one in runs.values() for run in one["mesh"]], kind, end):
            left_out.append(f"{name}: left out: {why}")
        else:
            codes, matched, others = _values(plan.scene, runs, of)
            found.append(Value(name, kind, opening, codes, matched, others))
    told, doubts = shared(found), frame.doubts(outcomes.values())
    return Study(plan.scene, tuple(map(row, told)), tuple(left_out), told, failures, unresolved=doubts)


def _lacking(seen: Sequence[tuple[float, float]], kind: CertifiedKind, end: float) -> str:
    """Why a quantity is not certified, of which every mesh has this value and this peak load; empty where it is."""
    found, peaks = zip(*seen, strict=True)
    if not np.all(np.isfinite(found)):
        ends = "the crack does not grow all along the last half of the programme, short of the far end"
        return ends if kind == "zone" else "a run ends before"
    if min(found) <= LEAST_CERTIFIED * max(peaks) * (kind == "load_at"):
        return f"the specimen bears less than {LEAST_CERTIFIED:.0%} of its peak load there"
    return "the load still grows at the end" if kind == "peak_opening" and max(found) >= (1.0 - 1e-6) * end else ""


def _values(
    scene: Scene, runs: Mapping[str, Runs[Result]], of: Callable[[Result], float]
) -> tuple[dict[str, OfCode], float | None, dict[str, float]]:
    """One quantity in each code, the second of which is corrected to the model of the scene; its change by keeping the
    pairs of points, and by other places of the load."""
    condition = max(run.condition for one in runs.values() for group in one.values() for run in group)
    seen = {code: values(one, of) for code, one in runs.items()}
    first, finest = seen[SEARCHING], seen[SEARCHING]["mesh"][0]
    matched = first["matched"][0] - finest if first["matched"] else None if simulated(scene)["search"] else 0.0
    shift = {SEARCHING: 0.0, REFERENCE: -(matched or 0.0)}
    codes = {
        code: of_code(found, [1.0 / run.elements for run in runs[code]["mesh"]], condition, shift[code])
        for code, found in seen.items()
    }
    changes = {name.removeprefix("load.at="): one[0] - finest for name, one in first.items() if "load.at=" in name}
    return codes, matched, {place: one for place, one in changes.items() if isfinite(one) and place != scene.load.at}
