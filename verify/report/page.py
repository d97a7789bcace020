"""The page of a verification: sections by scene, studies of other commands."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from markupsafe import Markup

from verify.pages.style import Panel
from verify.pages.template import rendered
from verify.pages.text import percent, seconds, symbols
from verify.report import markdown
from verify.report.findings import Findings
from verify.report.section import Section, moving, still
from verify.report.studies import interface_rules
from verify.report.studies.included import IncludedSection
from verify.report.studies.included import sections as shown
from verify.report.summary import summarise
from verify.studies.cost.figures import named, work_precision
from verify.studies.cost.page import script as chart_script
from verify.studies.cost.price import Price
from verify.studies.hard.suite import totals
from verify.studies.pairs_page import in_cell
from verify.support.at_once import at_once
from verify.verdict import SceneReport

__all__ = ["write"]

_HERE = Path(__file__).parent

#: Largest number of scenes for which the additional openings of the leading run are drawn, about 120 kB per scene.
FEW = 5

_FILTERS: Mapping[str, Callable] = {
    "symbols": symbols,
    "percent": percent,
    "seconds": seconds,
    "named": named,
    "in_cell": in_cell,
    "totals": totals,
}


def write(findings: Findings, path: Path, text: bool = False) -> None:
    """Write the HTML page, and with ``text`` the report in Markdown beside it; their folder is created."""
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    few = len(findings.reports) <= FEW
    sections = _sections(findings.reports, few)
    summary = summarise(sections, findings.prices)
    studies = shown(findings.included, path.parent)
    page = rendered(
        "verify.report",
        "page.html.j2",
        _FILTERS,
        sections=sections,
        summary=summary,
        prices=[(price, _chart(price, f"price-{i + 1}")) for i, price in enumerate(summary.prices)],
        included=studies,
        scripts=_scripts(sections, studies),
        quadrature=findings.quadrature and interface_rules.section(findings.quadrature, "quadrature"),
        environment=dict(findings.environment),
    )
    path.write_text(page, encoding="utf-8")
    if text:
        lines = markdown.lines(summary, sections, studies, findings.environment)
        path.with_suffix(".md").write_text("\n".join(lines), encoding="utf-8")


def _sections(reports: Sequence[SceneReport], few: bool) -> tuple[Section, ...]:
    """The scenes, each in two parts, so that a single one is drawn on two cores."""
    ways: tuple[Callable[..., Any], ...] = still, partial(moving, between=few)
    parts = at_once(_drawn, [(way, *numbered) for way in ways for numbered in enumerate(reports, 1)])
    halves = zip(parts[: len(reports)], parts[len(reports) :], strict=True)
    return tuple(replace(scene, frames=frames) for scene, frames in halves)


def _drawn(part: tuple[Callable[..., Any], int, SceneReport]) -> Any:
    way, number, report = part
    return way(report, f"scene-{number}")


def _chart(price: Price, key: str) -> Panel | None:
    """The chart of a quick ladder; None where no run was measured."""
    return work_precision(price.rows, key, "half") if any(row.measured for row in price.rows) else None


def _scripts(sections: Sequence[Section], studies: Sequence[IncludedSection]) -> tuple[Markup, ...]:
    """The scripts that the page needs."""
    stepper, folds = ((_HERE / name).read_text(encoding="utf-8") for name in ("stepper.js", "folds.js"))
    return (
        Markup(folds),
        *((Markup(stepper),) if any(s.frames for s in sections) else ()),
        *((chart_script(),) if any(s.chart for s in studies) else ()),
    )
