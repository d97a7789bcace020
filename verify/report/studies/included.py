"""Results of other commands on the page of a verification: cost, effects, vary, hard cases."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import quote

from verify.pages.table import Table
from verify.studies.cost.findings import Level, levels, ways
from verify.studies.cost.page import Chart, chart
from verify.studies.found import Included
from verify.studies.hard.cases import CASES
from verify.studies.hard.one import Verdict
from verify.studies.hard.page import matrix_of
from verify.studies.hard.suite import all_hold
from verify.studies.pairs_page import table

TITLES = {
    "cost": "What accuracy costs",
    "effects": "What each effect does",
    "vary": "What a key changes",
    "hard": "Hard cases",
}


@dataclass(frozen=True, eq=False)
class IncludedSection:
    """A study for the template; ``chart`` and ``levels`` are those of a cost study with runs that were measured.

    prefix : relative path from the page to the folder of the study
    runs : relative path to the runs of its scene
    """

    anchor: str
    command: str
    title: str
    prefix: str
    runs: str
    outdated: bool
    has_page: bool
    lead: tuple[str, ...]
    tables: tuple[Table, ...] = ()
    chart: Chart | None = None
    levels: tuple[Level, ...] = ()


def section(study: Included, out: Path, anchor: str) -> IncludedSection:
    """One study."""
    name = study.about.get("scene", {}).get("name", "")
    prefix = quote(Path(os.path.relpath(study.folder, out)).as_posix())
    head: dict[str, Any] = {
        "anchor": anchor,
        "command": study.command,
        "title": f"{TITLES[study.command]}: {name}" if name else TITLES[study.command],
        "prefix": prefix,
        "runs": f"{prefix}/{quote(name)}",
        "outdated": study.outdated,
        "has_page": (study.folder / "report.html").exists(),
    }
    own = {"cost": _cost, "effects": _pairs, "vary": _pairs, "hard": _hard}[study.command]
    return IncludedSection(**head, **own(study, anchor if own is _cost else prefix))


def _cost(study: Included, anchor: str) -> dict[str, Any]:
    rows, about = study.rows, study.about
    found = levels(rows)
    told = [ways(about["scene"]["name"], rows), *(level.said for level in found)]
    lead = (*told, about["reference"]["sentence"], *about["left_out"])
    measured = any(row.measured for row in rows)
    return {"lead": lead, "chart": chart(rows, anchor) if measured else None, "levels": found}


def _pairs(study: Included, prefix: str) -> dict[str, Any]:
    sentences = study.about.get("sentences") or [row.sentence for row in study.rows]
    return {"lead": (*sentences, *study.about["left_out"]), "tables": (table(study.rows),)}


def _hard(study: Included, prefix: str) -> dict[str, Any]:
    found = {(verdict.case, verdict.basis): verdict for verdict in study.rows}
    cases = [CASES[name] for name in CASES if any(name == case for case, _ in found)]
    wanted = [(case.name, basis) for case in cases for basis in case.bases]
    verdicts = {one: found.get(one, Verdict(*one, why="not run")) for one in wanted}
    held = f"{sum(all_hold(case, verdicts) for case in cases)} of {len(cases)} hard cases hold."
    return {"lead": (held,), "tables": (matrix_of(cases, verdicts, f"{prefix}/"),)}


def sections(studies: Sequence[Included], out: Path) -> tuple[IncludedSection, ...]:
    """The sections of all studies, in their order."""
    return tuple(section(study, out, f"study-{i + 1}") for i, study in enumerate(studies))
