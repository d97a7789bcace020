"""The page of a verification: sections by scene, plane problems, figures of the paper, studies of other commands."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from markupsafe import Markup

from verify.pages.template import rendered
from verify.pages.text import percent, seconds, symbols
from verify.report import markdown
from verify.report.section import Section, section
from verify.report.studies import interface_rules, plane, plane_rates
from verify.report.studies.included import IncludedSection
from verify.report.studies.included import sections as shown
from verify.report.studies.paper import section as paper_section
from verify.report.summary import summarise
from verify.studies.cost.figures import named
from verify.studies.cost.page import script as chart_script
from verify.studies.effects.page import in_cell
from verify.studies.found import Included
from verify.studies.hard.suite import totals
from verify.studies.interface_rules import Study
from verify.studies.paper.study import Study as Figures
from verify.studies.plane.rates import Convergence
from verify.studies.plane.study import PlaneStudy
from verify.verdict import SceneReport

__all__ = ["write"]

_HERE = Path(__file__).parent

#: Up to so many scenes have more openings than those that all runs keep, of about 120 kB a scene.
FEW = 5

_FILTERS: Mapping[str, Callable] = {
    "symbols": symbols,
    "percent": percent,
    "seconds": seconds,
    "named": named,
    "in_cell": in_cell,
    "totals": totals,
}


def write(
    reports: tuple[SceneReport, ...],
    path: Path,
    environment: Mapping[str, str],
    quadrature: Study | None = None,
    paper: Figures | None = None,
    planes: Sequence[PlaneStudy] = (),
    rates: tuple[Convergence, ...] = (),
    peels: Figures | None = None,
    included: Sequence[Included] = (),
    text: bool = False,
) -> None:
    """Write the page.

    Parameters
    ----------
    reports : one for each scene, in the order of the page
    path : the HTML file; its folder is made
    environment : what to print about versions and machine, name to value
    quadrature : the study of the interface rules, where it was made
    paper : the runs behind the figures of the paper, where they were made
    planes : the studies of plane problems, one a mesh file
    rates : the convergence of the bases in plane elasticity, where it was measured
    peels : the runs behind Figure 9 of the paper, where they were made
    included : studies of other commands, to be shown as well
    text : whether the same is written in Markdown, too, beside the page
    """
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    few = len(reports) <= FEW
    sections = tuple(section(report, f"scene-{i + 1}", between=few) for i, report in enumerate(reports))
    plane_sections = tuple(plane.section(found, f"plane-{i + 1}") for i, found in enumerate(planes))
    rates_section = plane_rates.section(rates, "rates") if rates else None
    summary = summarise(sections, (*plane_sections, *filter(None, [rates_section])))
    studies = shown(included, path.parent)
    page = rendered(
        "verify.report",
        "page.html.j2",
        _FILTERS,
        sections=sections,
        summary=summary,
        included=studies,
        scripts=_scripts(sections, studies),
        planes=plane_sections,
        rates=rates_section,
        quadrature=None if quadrature is None else interface_rules.section(quadrature, "quadrature"),
        papers=[
            paper_section(study, anchor)
            for study, anchor in ((paper, "figures"), (peels, "figure-9"))
            if study is not None
        ],
        environment=dict(environment),
    )
    path.write_text(page, encoding="utf-8")
    if text:
        told = markdown.lines(summary, sections, plane_sections, rates_section, studies, environment)
        path.with_suffix(".md").write_text("\n".join(told), encoding="utf-8")


def _scripts(sections: Sequence[Section], studies: Sequence[IncludedSection]) -> tuple[Markup, ...]:
    """Those that something on the page needs."""
    stepper = (_HERE / "stepper.js").read_text(encoding="utf-8")
    return (
        *((Markup(stepper),) if any(s.frames for s in sections) else ()),
        *((chart_script(),) if any(s.chart for s in studies) else ()),
    )
