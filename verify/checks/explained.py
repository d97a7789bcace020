"""Curves of other codes in a verification: why a curve fails, and what a passed check of a curve does not show."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from verify.checks.between_codes import CODE_TOLERANCE
from verify.checks.foreign.given import given
from verify.checks.foreign.judged import in_whole
from verify.checks.proof import SEARCHING, sampled
from verify.diagnosis.blind import blind_spots
from verify.diagnosis.classify import diagnose
from verify.support.programme import only_opens
from verify.verdict import Diagnosis, Run, SceneReport


def explained(report: SceneReport, names: Sequence[str], out: Path | None = None) -> SceneReport:
    """The report with a diagnosis of every named curve that breaks a check, and a remark on the others.

    Curves are compared with the run of `SEARCHING`, along a programme that only opens, as far as they go: what they do
    not contain, their rounding and their noise have no cause. The store in ``out`` keeps the solutions for it.
    """
    right = next((run.result for run in report.runs if run.method == SEARCHING and run.result is not None), None)
    if right is None or right.load.size < 2 or not only_opens(report.scene.load.opening):
        return report
    expected, found = sampled(right), []
    results = {run.name: run.result for run in report.runs if run.result is not None and run.name not in names}
    remarks: list[str] = []
    for run in (run for run in report.runs if run.name in names and run.result is not None):
        assert run.result is not None
        if _broken(report, run):
            whole = in_whole(given(report.scene, run.name, run.result, results), results)
            curve = (whole.opening, whole.load)
            found.append(diagnose(run.name, curve, expected, report.scene, CODE_TOLERANCE, out))
        else:
            end = float(np.max(run.result.opening))
            remarks.append(blind_spots(run.name, report.scene, CODE_TOLERANCE, end, expected, out))
    diagnoses: tuple[Diagnosis, ...] = tuple(filter(None, found))
    return replace(report, diagnoses=diagnoses, remarks=(*report.remarks, *filter(None, remarks)))


def _broken(report: SceneReport, run: Run) -> bool:
    return any(check.state == "broken" and report.judged(check)[:1] == (run,) for check in report.checks)
