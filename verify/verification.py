"""The main job: every method on every scene, each run in a process of its own, then all checks and the report."""

from __future__ import annotations

import os
import shlex
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from verify import given_meshes, introduction, neglected, verdict_file
from verify.checks import run_checks
from verify.crosschecks import cross_checks, remarks
from verify.effects import simulated
from verify.foreign import Curve, joined
from verify.included import Included, found_in
from verify.jobs import Job, Outcome, dry_run, is_missing, run_all
from verify.judgement import NO_DEMANDS, Demands, judged
from verify.mesh_sequences import sequences
from verify.methods import METHODS, WITH_DOFS, known_methods
from verify.odd_one_out import odd_one_out
from verify.paper import peel, peel_statements, statements
from verify.paper import plan as figures
from verify.paper.comparison import lines
from verify.paper.study import measured
from verify.plane_rates import rate_checks, rates
from verify.plane_study import Plate
from verify.plane_study import lines as plane_lines
from verify.plane_study import study as plane_study
from verify.progress import telling
from verify.proof import MATCHED, REFERENCE, SEARCHING, SECOND
from verify.quadrature_study import finding, study
from verify.reference_mesh import reference_mesh, second_mesh
from verify.run import environment
from verify.say import say, write_page
from verify.scene import Scene
from verify.table import check_table, not_held, overview
from verify.verdict import Check, Run, SceneReport

NAMES = {
    "tspline": "T-spline",
    "nurbs": "NURBS",
    "lagrange": "Lagrange",
    "dolfinx": "DOLFINx",
    "beam": "cohesive beam",
    "lefm": "LEFM",
}

#: T-splines that follow the process zone, with at most a third of the unknowns that the meshes at rest have.
ADAPTIVE = ("discretization.adaptive=true", "discretization.dofs=700")

#: About how long interface rules, figures and rates take after the runs, and each mesh from CAD.
STUDIES_SECONDS, PLATE_SECONDS = 15.0, 3.0


def verify(
    scenes: Sequence[tuple[str, Scene]],
    out: Path,
    jobs: int,
    full: bool = False,
    plates: Sequence[Plate] = (),
    scheduler: str | None = None,
    included: Sequence[Included] = (),
    text: bool = False,
    curves: Sequence[Curve] = (),
    demands: Demands = NO_DEMANDS,
) -> bool:
    """Run everything, write ``out``/verdict.json and report.html, print the checks; whether the verification passes.

    It passes where no check is broken and nothing is left out that ``demands`` ask for.

    Parameters
    ----------
    scenes : each with the name or path that it was loaded from
    jobs : runs at a time; with the address of a dask ``scheduler`` its workers do them
    full : finer and coarser meshes as well, the study of the interface rules, the figures of the paper, and the
        rates of the bases in plane elasticity
    plates : meshes from CAD, on which plane problems with exact solutions are solved
    curves : of other codes, each a run in the report of every scene
    included : studies of other commands for the report to show, besides those in folders of ``out``
    text : whether report.md is written, too
    """
    plan, beams, strips = _plans(scenes, full)
    outcomes = {outcome.job: outcome for outcome in run_all(_all_jobs(plan, beams, strips), out, jobs, scheduler)}
    own = [scene_report(scene, [outcomes[job] for job in plan if job.scene is scene], out) for _, scene in scenes]
    reports = tuple(joined(report, curves, out) for report in own)
    page = out / "report.html"
    with telling("studies", STUDIES_SECONDS * full + PLATE_SECONDS * len(plates)):
        quadrature = study() if full else None
        paper = measured(beams, outcomes) if full else None
        peels = peel.measured(strips, outcomes) if full else None
        planes = tuple(plane_study(plate) for plate in plates)
        bases = rates() if full else ()
    studies = tuple({(study.command, study.folder.resolve()): study for study in (*found_in(out), *included)}.values())
    others = [(found.name, check) for found in planes for check in found.checks]
    others += [("plane elasticity", check) for check in rate_checks(bases)]
    judgement = judged(reports, others, demands)
    verdict_file.write(out, reports, judgement, [os.path.relpath(study.folder, out) for study in studies])
    what = (reports, page, environment(), quadrature, paper, planes, bases, peels, studies, text)
    written = write_page("verify.report.page", *what)
    tables = [line for found in planes for line in [*plane_lines(found), *check_table(found.checks), ""]]
    print("\n".join([*overview(reports), *tables, *convergence(reports), *not_held(judgement.checks)]))
    if quadrature is not None:
        print(finding(quadrature))
    if paper is not None:
        print("\n".join(lines("Figures 6 to 8", paper.left_out, statements.statements(paper))))
    if peels is not None:
        print("\n".join(lines("Figure 9", peels.left_out, peel_statements.statements(peels))))
    for gap in judgement.lacking:
        say(f"{gap.scene}: {gap.check or gap.subject} must have been judged: {gap.why}")
    print(f"{judgement.in_short()}: {page if written else out / verdict_file.NAME}")
    return judgement.passed


def would_run(scenes: Sequence[tuple[str, Scene]], out: Path, jobs: int, full: bool = False) -> list[str]:
    """The runs of a verification with their times, a line each; nothing is run."""
    return dry_run(_all_jobs(*_plans(scenes, full)), out, jobs)


def _plans(scenes: Sequence[tuple[str, Scene]], full: bool) -> tuple[list[Job], figures.Plan, peel.PeelPlan]:
    plan = [job for source, scene in scenes for job in planned(source, scene, full)]
    return plan, figures.planned(scenes if full else ()), peel.planned(scenes if full else ())


def _all_jobs(plan: Sequence[Job], beams: figures.Plan, strips: peel.PeelPlan) -> list[Job]:
    return list(dict.fromkeys([*plan, *beams.jobs, *strips.jobs]))


def planned(source: str, scene: Scene, full: bool = False) -> Iterator[Job]:
    """The runs of one scene; those that do not take its mesh files make meshes of their own."""
    own = (given_meshes.OWN,) if scene.specimen.mesh else ()
    for method in known_methods():
        takes = method == given_meshes.METHOD or method not in METHODS
        yield Job(source, scene, method, method, () if takes else own)
    yield Job(source, scene, REFERENCE, SECOND, (*own, *second_mesh(scene)), fields=False)
    effects = simulated(scene, SEARCHING)
    if scene.specimen.kind == "dcb" and effects["kinematics"] == "finite" and effects["search"]:
        yield Job(source, scene, SEARCHING, MATCHED, (*own, "effects.search=false"), fields=False)
    if full and scene.specimen.kind == "dcb":
        cubic = figures.cubic(source, scene)
        yield replace(cubic, overrides=(*own, *cubic.overrides))
        yield Job(source, scene, "tspline", "tspline-adaptive", (*own, *ADAPTIVE))
    if full:
        for parts in (2, 4):
            dofs = scene.discretization.dofs // parts
            yield Job(source, scene, "nurbs", f"nurbs-{dofs}", (*own, f"discretization.dofs={dofs}"))


def scene_report(scene: Scene, outcomes: Sequence[Outcome], out: Path) -> SceneReport:
    """Runs and checks of one scene."""
    runs = tuple(_as_run(outcome, out) for outcome in outcomes)
    checks: list[Check] = []
    for outcome in outcomes:
        if outcome.result is not None:
            on = _with_its_mesh(scene, outcome.job)
            checks += [c for c in run_checks(on, outcome.result, outcome.job.variant) if outcome.job.meant_for(c)]
        elif outcome.failed:
            meaning = "The run ended with a result."
            checks.append(Check("completed", outcome.job.variant, float("nan"), 1e-9, "exact", meaning))
    results = {o.job.variant: o.result for o in outcomes if o.result is not None}
    on_their_own = [o.job.variant for o in outcomes if o.job.variant in results and given_meshes.OWN in o.job.overrides]
    given, own = ({k: r for k, r in results.items() if (k in on_their_own) == other} for other in (False, True))
    left_out = (*neglected.remarks(scene, given), *neglected.remarks(given_meshes.own_mesh(scene), own))
    said = (*remarks(scene, results), *given_meshes.remarks(on_their_own), *left_out, *introduction.remarks(scene))
    checks += cross_checks(scene, results)
    return SceneReport(scene, runs, tuple(checks), (*said, *odd_one_out(scene, checks, results)))


def _with_its_mesh(scene: Scene, job: Job) -> Scene:
    """The scene as far as its mesh files are concerned: without them where the job is."""
    return given_meshes.own_mesh(scene) if given_meshes.OWN in job.overrides else scene


def convergence(reports: Sequence[SceneReport]) -> list[str]:
    """Observed order and grid convergence index of the peak load, where there are three meshes or more."""
    return [
        f"{report.scene.name}: {one.quantity} of {len(one.runs)} {NAMES.get(one.method, one.method)} meshes: order "
        f"{one.found.order:.2f}, limit {one.found.limit:.6g}, GCI {one.found.gci:.2%}; {one.found.verdict}"
        for report in reports
        for one in sequences(report)
        if one.quantity == "peak load"
    ]


def _as_run(outcome: Outcome, out: Path) -> Run:
    job, result = outcome.job, outcome.result
    scene = job.solved
    degrees = {"dolfinx": reference_mesh(scene).degree, **dict.fromkeys(WITH_DOFS, scene.discretization.degree)}
    degree = degrees.get(job.method)
    name = NAMES.get(job.method, job.method) + (f" p={degree}" if degree else "")
    adaptive = job.method == "tspline" and scene.discretization.adaptive
    name, most = (f"{name}, adaptive", "at most ") if adaptive else (name, "")
    name += {SECOND: ", second mesh", MATCHED: ", pairs kept"}.get(job.variant, "")
    label = f"{name}, {most}{result.dofs} unknowns" if result is not None and result.dofs else name
    folder, done = str(job.folder(out).relative_to(out)), result is not None or outcome.failed
    command = shlex.join(["debond", *job.command(out)])
    key, missing = job.task().key if done else "", not done and is_missing(job)
    return Run(label, job.method, result, outcome.left_out, folder, command, scene, key, missing)
