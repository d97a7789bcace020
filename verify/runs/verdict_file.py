"""``verdict.json``: the result of a verification, for other programs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any, Protocol, get_args

from verify.checks.judgement import Judgement
from verify.runs.environment import machine, threads, versions
from verify.runs.folder import write_json
from verify.verdict import Check, Diagnosis, Kind, SceneReport, counted, of_state

VERDICT_FILE = "verdict.json"


class Priced(Protocol):
    """What accuracy costs on a scene (`verify.studies.cost.study`)."""

    def price(self) -> dict[str, Any]: ...


def write(
    out: Path,
    reports: Sequence[SceneReport],
    judgement: Judgement,
    included: Sequence[str] = (),
    prices: Sequence[Priced] = (),
) -> None:
    """Write ``out``/verdict.json.

    Parameters
    ----------
    included : folders of studies that the report shows; they do not affect the verdict
    prices : of accuracy, by quick searches; they do not affect the verdict either
    """
    found = [price.price() for price in prices]
    price = found[0] | {"others": found[1:]} if found else None
    write_json(out / VERDICT_FILE, content(reports, judgement, included) | {"price": price})


def content(reports: Sequence[SceneReport], judgement: Judgement, included: Sequence[str] = ()) -> dict[str, Any]:
    """The content of the file; a NaN, as for a run that failed, becomes null."""
    checks = [check for _, check in judgement.checks]
    of_scene = {report.scene.name: report for report in reports}
    return {
        "passed": judgement.passed,
        "counts": _counts(checks)
        | {"of_kind": {kind: _counts([one for one in checks if one.kind == kind]) for kind in get_args(Kind)}},
        "checks": [_check(name, check, of_scene.get(name)) for name, check in judgement.checks],
        "not_judged": [asdict(gap) for gap in judgement.gaps],
        "runs": [_run(report, run) for report in reports for run in report.runs],
        "remarks": {report.scene.name: list(report.remarks) for report in reports if report.remarks},
        "diagnosis": [_diagnosis(report.scene.name, one) for report in reports for one in report.diagnoses],
        "included": list(included),
        "versions": versions(),
        "machine": machine(),
        "threads": threads(),
    }


def _counts(checks: Sequence[Check]) -> dict[str, int]:
    found = counted(checks)
    counts = {"checks": found.total, "passed": found.held, "failed": found.broken, "unresolved": found.unresolved}
    return counts | ({"not_covered": found.not_covered} if found.not_covered else {})


def _check(scene: str, check: Check, report: SceneReport | None) -> dict[str, Any]:
    runs = report.judged(check) if report is not None else ()
    return {
        "scene": scene,
        "method": runs[0].method if runs else None,
        "subject": check.subject,
        "name": check.name,
        "value": check.value,
        "tolerance": check.tolerance,
        "kind": check.kind,
        **of_state(check),
        "run": runs[0].folder if runs else None,
        "against": runs[1].folder if len(runs) > 1 else None,
        "meaning": check.meaning,
    }


def _diagnosis(scene: str, found: Diagnosis) -> dict[str, Any]:
    """The causes of the deviation of a curve, best first."""
    causes = [
        {key: value for key, value in asdict(one).items() if key not in ("words", "fitted")} for one in found.causes
    ]
    return {"scene": scene, **asdict(found), "causes": causes}


def _run(report: SceneReport, run: Any) -> dict[str, Any]:
    result = run.result
    return {
        "scene": report.scene.name,
        "method": run.method,
        "label": run.label,
        "folder": run.folder,
        "hash": run.key or None,
        "command": run.command,
        "status": result.status if result is not None else run.left_out,
        "seconds": (result.seconds or {}).get("total") if result is not None else None,
    }
