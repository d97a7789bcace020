"""Scenes by seed, by every method: plane codes must agree where all checks hold, else the odd one out must be named.

Those of ordinary materials leave all meshes to the product: of them every check must be judged, too.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import combinations
from math import nan
from pathlib import Path

import numpy as np

from verify.checks.between_codes import distance
from verify.checks.odd_one_out import ODD
from verify.checks.orders import ARMS, ARMS_SECOND, BEAM_RUN
from verify.checks.proof import MATCHED, REFERENCE, SECOND
from verify.runs.folder import write_csv
from verify.runs.jobs import Job
from verify.scene.load import load_scene
from verify.scene.materials import Orthotropic
from verify.scene.process_zone import zone_length
from verify.studies import frame
from verify.studies.one_scene import planned, scene_report
from verify.verdict import SceneReport, counted

#: Runs of every scene; Lagrange elements and LEFM are less accurate than half a percent.
SOLVED_BY = ("tspline", "nurbs", MATCHED, REFERENCE, SECOND, BEAM_RUN, ARMS, ARMS_SECOND)
#: Plane codes with the same model: with projection onto the other face, and with fixed pairs of points. With linear
#: kinematics nothing is projected, and all have the same.
SAME_MODEL = (("tspline", "nurbs"), (MATCHED, REFERENCE))
#: Distance of two plane codes with one model above which one of them is wrong.
LARGEST_DISTANCE = 0.005


@dataclass(frozen=True)
class Row:
    """One scene: its parameters, distances of the codes, counts of its checks, and the fault of the verification."""

    scene: str
    slenderness: float  # a0 / h
    zone: float  # process zone over h
    orthotropic: bool
    plane: str
    kinematics: str
    ductility: float
    apart: float  # largest distance of two plane codes on one model
    beam: float  # distance of the reference to the beam
    checks: int
    broken: int
    unresolved: int
    names: str  # of the checks that do not hold
    odd: str
    fault: str  # "silent", "unnamed", "stopped", "unjudged", or nothing
    unknowns: int  # of NURBS
    seconds: float  # of all runs, in sum


def campaign(family: str, names: Sequence[str], out: Path, jobs: int, scheduler: str | None = None) -> bool:
    """Run the scenes, write ``out``/FAMILY.csv, print a table. Returns whether no row has a fault.

    A fault is *silent* where all checks hold and two plane codes differ by more than `LARGEST_DISTANCE` or were not
    compared, *unnamed* where a check is broken and no run is named as the odd one out, *stopped* where a run did not
    come to the end of its programme, *unjudged* where a mesh that the product chose leaves a check unresolved.
    """
    plan = [_jobs(name) for name in names]
    outcomes = frame.run([job for ones in plan for job in ones], out, jobs, scheduler)
    rows = [row(scene_report(ones[0].scene, [outcomes[job] for job in ones], out)) for ones in plan]
    table_file = out / f"{family}.csv"
    write_csv(table_file, Row, rows)
    print("\n".join(table(rows)))
    right = sum(not one.fault for one in rows)
    print(f"{right} of {len(rows)} {family} scenes without a fault: {table_file}")
    return right == len(rows)


def would_run(names: Sequence[str], out: Path, jobs: int) -> list[str]:
    """One line per run with its expected time; nothing is run."""
    return frame.would_run([job for name in names for job in _jobs(name)], (), out, jobs)


def _jobs(name: str) -> list[Job]:
    return [job for job in planned(name, load_scene(name)) if job.variant in SOLVED_BY]


def row(report: SceneReport) -> Row:
    """The row of a verified scene."""
    scene, counts = report.scene, counted(report.checks)
    results = {run.name: run.result for run in report.runs if run.result is not None and run.result.load.size > 1}
    end = max(scene.load.opening)
    models = SAME_MODEL if scene.effects.kinematics == "finite" else (("tspline", "nurbs", REFERENCE),)
    pairs = [pair for model in models for pair in combinations(model, 2) if set(pair) <= set(results)]
    apart = float(np.max([distance(results[a], results[b], end) for a, b in pairs])) if pairs else nan  # NaN stays NaN
    odd = next((remark for remark in report.remarks if remark.startswith(ODD)), "")
    stopped = [run.name for run in report.runs if run.name != SECOND and not (run.result and run.result.complete)]
    silent = counts.held == counts.total and not apart <= LARGEST_DISTANCE
    fault = "stopped" if stopped else "silent" if silent else "unnamed" if counts.broken and not odd else ""
    if not fault and counts.unresolved and scene.discretization.dofs == "auto":
        fault = "unjudged"
    h = scene.specimen.loaded_thickness
    return Row(
        scene=scene.name,
        slenderness=scene.specimen.free_length / h,
        zone=zone_length(scene) / h,
        orthotropic=isinstance(scene.material, Orthotropic),
        plane=scene.specimen.plane,
        kinematics=str(scene.effects.kinematics),
        ductility=scene.interface.ductility,
        apart=apart,
        beam=distance(results[REFERENCE], results["beam"], end) if {REFERENCE, "beam"} <= set(results) else nan,
        checks=counts.total,
        broken=counts.broken,
        unresolved=counts.unresolved,
        names=" ".join(f"{c.name}:{c.subject.replace(' ', '')}" for c in report.checks if not c.passed),
        odd=odd,
        fault=fault + (f" {','.join(stopped)}" if stopped else ""),
        unknowns=results["nurbs"].dofs if "nurbs" in results else 0,
        seconds=sum((result.seconds or {}).get("total", 0.0) for result in results.values()),
    )


def table(rows: Iterable[Row]) -> list[str]:
    """One line per scene."""
    sizes = f"{'scene':12}{'a0/h':>6}{'zone/h':>8} material  {'model':15}"
    head = f"{sizes}{'apart':>8}{'beam':>8} {'NURBS':>6} {'runs':>8}  checks"
    return [head, *(_line(one) for one in rows)]


def _line(one: Row) -> str:
    kind = "ortho" if one.orthotropic else "iso"
    judged = f"{one.checks - one.broken - one.unresolved}/{one.checks}"
    notes = "; ".join(filter(None, (one.fault, one.names, one.odd)))
    return (
        f"{one.scene:12}{one.slenderness:6.1f}{one.zone:8.2f} {kind:9} {one.plane + ' ' + one.kinematics:15}"
        f"{one.apart:8.2%}{one.beam:8.2%} {one.unknowns:6d} {one.seconds:6.1f} s  {judged} {notes}"
    )
