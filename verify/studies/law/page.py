"""The verdict on a law as a page: one self-contained HTML file with a figure for every path."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from verify.pages.style import Panel
from verify.pages.template import rendered
from verify.pages.text import Units
from verify.scene.schema import Scene
from verify.studies.law import figures
from verify.studies.law.judge import Judgement, worst_first
from verify.studies.law.wording import sentences
from verify.verdict import Check, Counts, counted

#: Kind of evidence -> what stands behind it.
STANDS_BEHIND = {
    "exact": "holds of any law of this kind",
    "analytical": "the definition, in closed form",
    "cross-code": "the law of another code",
}


@dataclass(frozen=True)
class Row:
    """All checks of one name: the worst, how many there are, and how many hold."""

    worst: Check
    counts: Counts


def write(found: Judgement, scene: Scene, law: str, path: Path) -> None:
    """Write the page.

    Parameters
    ----------
    law : name of the law that was judged
    """
    stress = Units.of(scene.units).stress
    page = rendered(
        "verify.studies.law",
        "page.html.j2",
        {},
        scene=scene.name,
        law=law,
        passed=found.passed,
        total=counted(found.checks),
        kinds={kind: counted([c for c in found.checks if c.kind == kind]) for kind in STANDS_BEHIND},
        evidence=STANDS_BEHIND,
        rows=rows(found.checks),
        broken=[check for check in worst_first(found.checks) if not check.passed],
        defects=sentences(found.defects),
        remarks=found.remarks,
        overview=_overview(found, scene),
        panels=[(way, _states(found, way.name), figures.path(found, way, stress)) for way in found.ways],
        count=len(found.ways),
    )
    path.write_text(page, encoding="utf-8")


def rows(checks: Sequence[Check]) -> list[Row]:
    """One row for each name of a check, in the order of the checks, broken ones first."""
    names = dict.fromkeys(check.name for check in checks)
    same = [[check for check in checks if check.name == name] for name in names]
    found = [Row(worst_first(one)[0], counted(one)) for one in same]
    return sorted(found, key=lambda row: row.counts.broken == 0)


def _states(found: Judgement, name: str) -> str:
    held = all(check.passed for check in found.checks if check.subject == name)
    return "holds" if held else "broken"


def _overview(found: Judgement, scene: Scene) -> list[Panel]:
    units = Units.of(scene.units)
    made = [figures.toughness(found, units.toughness), figures.defect(found, units.stress), figures.tangents(found)]
    return [one for one in made if one is not None]
