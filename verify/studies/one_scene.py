"""The runs of one scene in a verification, and their checks."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from verify.checks import load_introduction, neglected
from verify.checks.between_codes import cross_checks
from verify.checks.odd_one_out import odd_one_out
from verify.checks.orders import ARMS_SECOND, BEAM_RUN, remarks, second_order
from verify.checks.proof import MATCHED, SEARCHING
from verify.methods import bonds, given_meshes
from verify.methods.mesh_choice import size
from verify.methods.names import WITH_DOFS
from verify.methods.plugins import find, known_methods
from verify.methods.reference_mesh import reference_mesh
from verify.methods.second_meshes import SECONDS, SINGLE, second_runs
from verify.runs.jobs import Job, Outcome, is_missing
from verify.scene.effects import simulated
from verify.scene.schema import Scene
from verify.studies.mesh_sequences import sequences
from verify.verdict import Check, Run, SceneReport

#: Overrides for T-splines whose mesh follows the process zone, with at most a third of the unknowns of fixed meshes.
ADAPTIVE = ("discretization.adaptive=true", "discretization.dofs=700")


def planned(source: str, scene: Scene, full: bool = False, peers: Sequence[str] = ()) -> Iterator[Job]:
    """The runs of one scene; methods that cannot read its mesh files use generated meshes."""
    own = (given_meshes.OWN,) if scene.specimen.mesh else ()
    for method in dict.fromkeys([*known_methods(), *peers]):
        yield Job(
            source, scene, method, method, () if given_meshes.file_kind(scene) in find(method).takes_files else own
        )
    for method, name, finer in second_runs(scene):
        yield Job(source, scene, method, name, (*own, *finer), fields=False)
    for name, order in second_order(scene):
        yield Job(source, scene, "beam", name, (*own, *order), fields=False)
    effects = simulated(scene)
    if scene.specimen.symmetric and effects["kinematics"] == "finite" and effects["search"]:
        yield Job(source, scene, SEARCHING, MATCHED, (*own, "effects.search=false"), fields=False)
    if full and scene.specimen.symmetric:
        yield Job(source, scene, "dolfinx", "dolfinx-p3", (*own, "dolfinx.degree=3"))
        yield Job(source, scene, "tspline", "tspline-adaptive", (*own, *ADAPTIVE))
    if full:
        for parts in (2, 4):
            coarse = size(scene, splines=True).times(1.0 / parts)
            yield Job(source, scene, "nurbs", f"nurbs-{coarse.value:.4g}", (*own, coarse.override))


def scene_report(scene: Scene, outcomes: Sequence[Outcome], out: Path) -> SceneReport:
    """Runs and checks of one scene."""
    runs = tuple(_as_run(outcome, out) for outcome in outcomes)
    checks: list[Check] = []
    for outcome in outcomes:
        judge = find(outcome.job.method).code == BEAM_RUN or outcome.job.variant in SECONDS.values()
        checks += _of_judge(outcome) if judge else outcome.checks
        if outcome.failed:
            meaning = "The run ended with a result."
            checks.append(Check("completed", outcome.job.variant, float("nan"), 1e-9, "exact", meaning))
    results = {o.job.variant: o.result for o in outcomes if o.result is not None}
    on_their_own = [o.job.variant for o in outcomes if o.job.variant in results and given_meshes.OWN in o.job.overrides]
    given, own = ({k: r for k, r in results.items() if (k in on_their_own) == other} for other in (False, True))
    left_out = (*neglected.remarks(scene, given), *neglected.remarks(given_meshes.own_mesh(scene), own))
    noted = (
        *remarks(scene, results),
        *given_meshes.remarks(scene, on_their_own),
        *left_out,
        *load_introduction.remarks(scene),
        *bonds.remarks(scene),
    )
    checks += cross_checks(scene, results)
    return SceneReport(scene, runs, tuple(checks), (*noted, *odd_one_out(scene, checks, results)))


def _of_judge(outcome: Outcome) -> list[Check]:
    """Checks of a run that is there to judge, of the beam or on a second mesh, which is coarser: one that stops judges
    nothing, and is no fault of a code.

    Arms on a second mesh have no checks of their own.
    """
    why = "the run on the second mesh stopped, and the error of the first is not known"
    if find(outcome.job.method).code == BEAM_RUN:
        why = "the beam stopped, and judges nothing; the codes are judged by each other"
    return [
        replace(check, unresolved=why) if check.name == "completed" and check.state == "broken" else check
        for check in outcome.checks
        if outcome.job.variant != ARMS_SECOND
    ]


def convergence(reports: Sequence[SceneReport]) -> list[str]:
    """Observed order and grid convergence index of the peak load, for methods with at least three meshes."""
    return [
        f"{report.scene.name}: {one.quantity} of {len(one.runs)} {find(one.method).label} meshes: order "
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
    name = find(job.method).label + (f" p={degree}" if degree else "")
    adaptive = job.method == "tspline" and scene.discretization.adaptive
    name, most = (f"{name}, adaptive", "at most ") if adaptive else (name, "")
    others = {MATCHED: ", pairs kept", SINGLE: ", one layer", **dict.fromkeys(SECONDS.values(), ", second mesh")}
    name += others.get(job.variant, f", order {scene.beam.order}" if job.method == BEAM_RUN else "")
    label = f"{name}, {most}{result.dofs} unknowns" if result is not None and result.dofs else name
    folder, done = str(job.folder(out).relative_to(out)), result is not None or outcome.failed
    command = shlex.join(["debond", *job.command(out)])
    key, missing = job.task().key if done else "", not done and is_missing(job)
    return Run(label, job.method, result, outcome.left_out, folder, command, scene, key, missing)
