"""The page of a verification: sections by scene, studies of other commands."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from urllib.parse import quote

from verify.pages.table import Cell, Table
from verify.pages.template import rendered
from verify.pages.text import number, percent, seconds
from verify.report import Findings
from verify.report.section import Section, section
from verify.report.studies.included import sections as shown
from verify.report.summary import summarise
from verify.studies.cost.figures import work_precision
from verify.studies.cost.findings import named
from verify.studies.cost.page import script as chart_script
from verify.studies.cost.study import Study
from verify.support.at_once import at_once
from verify.verdict import SceneReport

__all__ = ["write"]

_FILTERS: Mapping[str, Callable] = {"percent": percent, "seconds": seconds, "named": named}


def write(findings: Findings, path: Path, text: bool = False) -> None:
    """Write the HTML page, and with ``text`` the report in Markdown beside it; their folder is created."""
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    sections = at_once(_numbered, list(enumerate(findings.reports, 1)))
    studies = shown(findings.included, path.parent)
    charts = [
        work_precision(price.rows, f"price-{i}") if any(row.measured for row in price.rows) else None
        for i, price in enumerate(findings.prices, 1)
    ]
    content = {
        "sections": sections,
        "summary": summarise(sections),
        "prices": [(one, _runs(one), charts[i]) for i, one in enumerate(findings.prices)],
        "cheapest_ways": [*(one.ways for one in findings.prices), *(one.lead[0] for one in studies if one.levels)],
        "included": studies,
        "chart_script": chart_script() if any(study.chart for study in studies) else "",
        "environment": Table.of(("", ""), findings.environment.items(), "Versions and machine", "environment"),
    }
    path.write_text(rendered("verify.report", "page.html.j2", _FILTERS, **content), encoding="utf-8")
    if text:
        written = rendered("verify.report", "page.md.j2", {}, **content)
        path.with_suffix(".md").write_text(written, encoding="utf-8")


def _numbered(numbered: tuple[int, SceneReport]) -> Section:
    number, report = numbered
    return section(report, f"scene-{number}")


def _runs(price: Study) -> Table:
    """The runs of a quick search."""
    rows = []
    for row in sorted(price.rows, key=lambda row: (row.family, row.dofs, row.seconds)):
        name = Cell(named(row), link=f"./{quote(price.scene.name)}/{quote(row.run)}/")
        sizes = str(row.dofs), f"{row.steps} ({row.asked})", percent(row.curve_error)
        rows.append((name, *sizes, number(row.seconds, 2), f"{row.times} ×") if row.measured else (name, row.status))
    titles = ("Run", "Unknowns", "Steps (asked)", "Curve error", "Seconds", "Timed")
    return Table.of(titles, rows, f"Runs of the quick search on {price.scene.name}")
