"""Curves of other codes in a verification: why a curve fails, and what a passed check of a curve does not show.

That is changes of the scene which move the curve by less than the tolerance.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import log1p
from pathlib import Path

import numpy as np

from verify.checks.between_codes import CODE_TOLERANCE
from verify.checks.foreign.given import given
from verify.checks.foreign.judged import in_whole
from verify.checks.proof import SEARCHING, sampled
from verify.curves.curve import Curve
from verify.diagnosis.causes import choices
from verify.diagnosis.classify import diagnose, of_reference, probed
from verify.diagnosis.solutions import solutions
from verify.scene.schema import Scene
from verify.support.programme import only_opens
from verify.verdict import Diagnosis, Run, SceneReport, counted

#: Size of a change of a number whose effect is stated.
SIZE = 0.01


def blind_spots(name: str, scene: Scene, tolerance: float, end: float, expected: Curve, out: Path | None = None) -> str:
    """A sentence on what would move the curve, up to its ``end``, by less than the tolerance; empty where that is not
    known or nothing.

    Nothing is solved where the bond slides: a solution there takes seconds, and a pass must cost little.
    """
    if scene.specimen.slides:
        return ""
    right = np.asarray(expected[0], dtype=float), np.asarray(expected[1], dtype=float)
    solved = solutions(scene, min(end, max(scene.load.opening)), right, 0.3 * tolerance, out)
    base = solved.load() if solved is not None else None
    if solved is None or base is None:
        return ""
    size = float(np.linalg.norm(base))
    moved = {
        f"{number.name} off by {100 * SIZE:g} %": float(np.linalg.norm(load - base) / abs(amount)) * log1p(SIZE) / size
        for number, amount, load in probed(solved)
    }
    made = list(choices(scene))
    for one, load in zip(made, solved.loads([one.changed for one in made]), strict=True):
        moved[one.said] = np.inf if load is None else float(np.linalg.norm(load - base)) / size
    words = [f"{what} ({100 * part:.1g} %)" for what, part in moved.items() if part < tolerance]
    least = f"move the curve by less than {of_reference(tolerance)}"
    return f"{name}: passes, and would pass with any of these, which {least}: {'; '.join(words)}" if words else ""


def explained(report: SceneReport, names: Sequence[str], out: Path | None = None) -> SceneReport:
    """The report with a verdict on every named curve: a diagnosis where it breaks a check, else a remark besides.

    Curves are compared with the run of `SEARCHING`, along a programme that only opens, as far as they go: what they do
    not contain, their rounding and their noise have no cause. The store in ``out`` keeps the solutions for it.
    """
    runs = [run for run in report.runs if run.name in names and run.result is not None]
    right = next((run.result for run in report.runs if run.method == SEARCHING and run.result is not None), None)
    found: list[Diagnosis] = []
    remarks: list[str] = []
    if right is not None and right.load.size >= 2 and only_opens(report.scene.load.opening):
        expected = sampled(right)
        results = {run.name: run.result for run in report.runs if run.result is not None and run.name not in names}
        for run in runs:
            assert run.result is not None
            if _broken(report, run):
                whole = in_whole(given(report.scene, run.name, run.result, results), results)
                why = diagnose(run.name, (whole.opening, whole.load), expected, report.scene, CODE_TOLERANCE, out)
                found += [why] if why is not None else []
            else:
                end = float(np.max(run.result.opening))
                remarks.append(blind_spots(run.name, report.scene, CODE_TOLERANCE, end, expected, out))
    why_not = {one.curve: one.sentence for one in found}
    verdicts = tuple((why_not.get(run.name) or _verdict(report, run)) + _stopped(run) for run in runs)
    said = (*report.remarks, *filter(None, remarks))
    return replace(report, diagnoses=tuple(found), remarks=said, verdicts=verdicts)


def _verdict(report: SceneReport, run: Run) -> str:
    """Whether a curve agrees, and what is known of it besides."""
    checks = [check for check in report.checks if report.judged(check)[:1] == (run,)]
    broken = dict.fromkeys(check.name for check in checks if check.state == "broken")
    counts = counted(checks)
    open_ones = counts.unresolved + counts.not_covered
    rest = f"; {open_ones} could not be judged" if open_ones else ""
    if broken:
        return f"{run.name}: does not agree in {', '.join(broken)}{rest}"
    return (
        f"{run.name}: agrees, {counts.held} of {counts.total} checks hold{rest}"
        if checks
        else f"{run.name}: not judged"
    )


def _stopped(run: Run) -> str:
    """Why a run has not reached the end, behind its verdict."""
    return "" if run.result is None or run.result.complete else f"; {run.result.status}"


def _broken(report: SceneReport, run: Run) -> bool:
    return any(check.state == "broken" and report.judged(check)[:1] == (run,) for check in report.checks)
