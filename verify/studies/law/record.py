"""``law.json``: the verdict on a law, for other programs."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from verify.studies.law.judge import Judgement
from verify.studies.law.tangents import study
from verify.verdict import Check, counted, of_state
from verify.version import __version__

LAW_FILE, PAGE_FILE, PATHS_FILE = "law.json", "law.html", "paths.csv"


def content(found: Judgement, scene: str, law: str) -> dict[str, Any]:
    """The content of the file.

    Parameters
    ----------
    scene, law : names of the scene and of the law that was judged
    """
    return {
        "scene": scene,
        "law": law,
        "passed": found.passed,
        "counts": asdict(counted(found.checks)),
        "checks": [_check(scene, check) for check in found.checks],
        "defects": [
            {
                "name": one.name,
                "path": one.path,
                "error_with": one.error_with,
                "error_without": one.error_without,
                "what": one.what,
            }
            for one in found.defects
        ],
        "remarks": list(found.remarks),
        "tangent_study": [
            {"step": step, "deviation": deviation} for step, deviation in study(found.bond, list(found.given.values()))
        ],
        "bond": asdict(found.bond),
        "paths": {way.name: {"steps": way.g.size, "what": way.what} for way in found.ways},
        "version": __version__,
    }


def _check(scene: str, check: Check) -> dict[str, Any]:
    return {
        "scene": scene,
        "subject": check.subject,
        "name": check.name,
        "value": check.value,
        "tolerance": check.tolerance,
        "kind": check.kind,
        **of_state(check),
        "meaning": check.meaning,
    }
