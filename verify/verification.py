"""The main job: every method on every scene, each run in a process of its own, then all checks and the report."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain
from math import inf
from pathlib import Path

from verify.checks.explained import explained
from verify.checks.foreign_curves import Curve, joined
from verify.checks.judgement import NO_DEMANDS, Demands, judged
from verify.checks.proof import REFERENCE, SECOND
from verify.checks.table import not_held, overview
from verify.report import Findings
from verify.runs import junit, verdict_file
from verify.runs.environment import environment
from verify.runs.jobs import Job, Outcome, dry_run, run_all
from verify.scene.schema import Scene
from verify.studies.cost.plan import QUICK
from verify.studies.cost.reference import reference_jobs
from verify.studies.cost.study import Study, searched
from verify.studies.cost.study import would_run as would_search
from verify.studies.found import Included, found_in
from verify.studies.one_scene import convergence, planned, scene_report
from verify.support.say import say, write_page

#: Scene that a quick search is made on where it is verified.
LADDERED = "dcb-czm1"


@dataclass(frozen=True)
class Subjects:
    """What a verification is about.

    Parameters
    ----------
    scenes : each with the name or path that it was loaded from
    full : also finer and coarser meshes
    curves : curves of other codes, each a run in the report of every scene
    included : studies of other commands that the report shows, besides those in folders of the output folder
    ladders : scenes of a quick search, each with the name or path that it was loaded from
    peers : codes of others that take part as methods
    """

    scenes: Sequence[tuple[str, Scene]]
    full: bool = False
    curves: Sequence[Curve] = ()
    included: Sequence[Included] = ()
    ladders: Sequence[tuple[str, Scene]] = ()
    peers: Sequence[str] = ()


def verify(
    subjects: Subjects,
    out: Path,
    jobs: int,
    scheduler: str | None = None,
    text: bool = False,
    demands: Demands = NO_DEMANDS,
    junit_file: Path | None = None,
    budget: float = inf,
) -> bool:
    """Run everything, write ``out``/verdict.json and report.html, print the checks; whether the verification passes.

    It passes where there are checks, none is broken, and everything that ``demands`` ask for was judged.

    Parameters
    ----------
    jobs : runs at a time; with the address of a dask ``scheduler`` its workers do the runs
    text : whether report.md is written, too
    junit_file : where the checks are written as JUnit XML, too
    budget : seconds above which the expected time of the runs is said before them
    """
    plans = _planned(subjects)
    every = _all_jobs(subjects, plans)
    outcomes = {outcome.job: outcome for outcome in run_all(every, out, jobs, scheduler, budget)}
    done = [(scene, [outcomes[job] for job in plan]) for (_, scene), plan in zip(subjects.scenes, plans, strict=True)]
    reports = tuple(joined(scene_report(*runs, out), subjects.curves, out) for runs in done)
    if others := [*(curve.name for curve in subjects.curves), *subjects.peers]:
        reports = tuple(explained(report, others, out) for report in reports)
    page = out / "report.html"
    included = (*found_in(out), *subjects.included)
    studies = tuple({(study.command, study.folder.resolve()): study for study in included}.values())
    judgement = judged(reports, demands)
    prices = _prices(subjects, out, jobs, list(outcomes.values()))
    verdict_file.write(out, reports, judgement, [os.path.relpath(study.folder, out) for study in studies], prices)
    if junit_file is not None:
        junit.write(junit_file, judgement)
    findings = Findings(reports, environment(), studies, prices)
    written = write_page("verify.report.page", findings, page, text)
    print("\n".join([*overview(reports), *convergence(reports), *not_held(judgement.checks)]))
    print("".join(f"{price.ways}\n{price.sentence}\n" for price in prices), end="")
    for gap in judgement.lacking:
        say(f"{gap.scene}: {gap.check or gap.subject} must have been judged: {gap.why}")
    print(f"{judgement.in_short()}: {page if written else out / verdict_file.VERDICT_FILE}")
    print("".join(f"{sentence}\n" for report in reports for sentence in report.verdicts), end="")
    return judgement.passed


def would_run(subjects: Subjects, out: Path, jobs: int) -> list[str]:
    """The runs of a verification with their times, a line each; nothing is run."""
    from verify.diagnosis.solutions import first_solutions

    lines = dry_run(_all_jobs(subjects, _planned(subjects)), out, jobs)
    for _, scene in subjects.scenes if subjects.curves or subjects.peers else ():
        lines.append(f"diagnosis of a curve that fails on {scene.name}: {first_solutions(scene, out)}")
    for source, scene in subjects.ladders:
        lines += [
            "",
            f"quick search on {scene.name}, one run at a time:",
            *would_search(source, scene, (), out, 1, QUICK),
        ]
    return lines


def laddered(scenes: Sequence[tuple[str, Scene]]) -> list[tuple[str, Scene]]:
    """The scene of the quick search: `LADDERED`. A search takes as long as all runs of a scene, and is left to the
    wish of the user elsewhere."""
    return [one for one in scenes if one[0] == LADDERED]


def _prices(subjects: Subjects, out: Path, jobs: int, outcomes: Sequence[Outcome]) -> tuple[Study, ...]:
    """The quick searches; their references are held against the two DOLFINx meshes of a scene that was verified."""
    found = []
    for source, scene in subjects.ladders:
        of_scene = {one.job.variant: one for one in outcomes if one.job.scene == scene}
        other = [of_scene[name] for name in (SECOND, REFERENCE) if name in of_scene]
        found.append(
            searched(source, scene, (), out, jobs, QUICK, [*of_scene.values()], other if len(other) == 2 else ())
        )
    return tuple(filter(None, found))


def _planned(subjects: Subjects) -> list[list[Job]]:
    """The runs of each scene."""
    return [[*planned(source, scene, subjects.full, subjects.peers)] for source, scene in subjects.scenes]


def _all_jobs(subjects: Subjects, plans: Sequence[Sequence[Job]]) -> list[Job]:
    references = [job for one in subjects.ladders for job in reference_jobs(*one, (), QUICK)[0]]
    return list(dict.fromkeys([*chain(*plans), *references]))
