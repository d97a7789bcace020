"""The page of a verification: sections by scene, studies of other commands, and on top the distances and times
of the methods and the checks that fail.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any
from urllib.parse import quote

from verify.methods.dolfinx import DOLFINX_MISSING, DOLFINX_WAYS
from verify.pages.style import IN_TABLES
from verify.pages.table import Cell, Table, of_state
from verify.pages.template import rendered
from verify.pages.text import number, percent, seconds, span, tone
from verify.report import Findings
from verify.report.cost import total_seconds
from verify.report.figures.entry import Entry, rank
from verify.report.section import Section, section
from verify.report.studies.included import sections as shown
from verify.report.tables import EVIDENCE, headline, mark
from verify.studies.cost.figures import work_precision
from verify.studies.cost.findings import named
from verify.studies.cost.page import script as chart_script
from verify.studies.cost.study import Study
from verify.support.at_once import at_once
from verify.verdict import Counts, SceneReport, counted, worst_of_each

#: Method and number of its run.
Key = tuple[str, int]

#: Distance from which on a load is not said to be within it.
FAR_OFF = 0.1

_LEFM = (
    "LEFM is the limit of a vanishing process zone. It is drawn for orientation; the distance to it is the effect of "
    "the interface's finite strength, not an error of any method."
)


def summarise(sections: Sequence[Section]) -> dict[str, Any]:
    """The part of the page above the first scene, for the templates: verdict and its class, a sentence per method with
    the link to its run, what is missing and the ways to DOLFINx where it is, and tables."""
    checks = [(s.anchor, s.report.scene.name, check) for s in sections for check in s.report.checks]
    counts = counted(check for _, _, check in checks)
    no_dolfinx = any(entry.run.left_out == DOLFINX_MISSING for s in sections for entry in s.entries)
    anchors = {name: anchor for anchor, name, _ in checks}
    kinds = {kind: counted(check for _, _, check in checks if check.kind == kind) for kind in EVIDENCE}
    return {
        "headline": headline(counts, len(sections)),
        "tone": tone(counts),
        "verdicts": [verdict for s in sections for verdict in s.report.verdicts],
        "sentences": tuple(_sentences(sections)),
        "missing": tuple(_missing(sections)),
        "ways": DOLFINX_WAYS if no_dolfinx else (),
        "overview": _overview(sections),
        "kinds": Table.of(
            ("Kind of check", "Hold", "What it rests on"),
            [(kind, Cell(_held(found), tone=tone(found)), EVIDENCE[kind]) for kind, found in kinds.items()],
            "What the checks rest on",
            "kinds",
        ),
        "not_held": Table.of(
            ("Verdict", "On", "Check", "Of", "Value", "Tolerance", "Kind"),
            [
                (
                    mark(c),
                    Cell(name, link=f"#{anchors[name]}-checks"),
                    c.name,
                    c.subject + f" and {more} more" * bool(more),
                    *map(number, (c.value, c.tolerance)),
                    c.kind,
                )
                for name, c, more in worst_of_each((name, check) for _, name, check in checks)
            ],
            "Checks that do not hold",
            "lost",
        ),
    }


def _held(counts: Counts) -> str:
    return f"{counts.held} of {counts.total}" if counts.total else "none"


def _overview(sections: Sequence[Section]) -> Table:
    """A row for each scene, a column for each run of a method."""
    columns = _columns(sections)
    titles = [Cell(name, line=found[0].line) for name, found in columns.values()]
    rows = []
    for s in sections:
        of_key = {(entry.method, entry.repeat): entry for entry in s.entries}
        counts = s.counts
        state = "broken" if counts.broken else "unresolved" if counts.unresolved else "not covered"
        state = "holds" if counts.held == counts.total else state
        verdict = of_state(state, _held(counts), f"#{s.anchor}-checks") if counts.total else "none"
        cells = [_cell(s, of_key[key]) if key in of_key else "–" for key in columns]
        rows.append((Cell(s.report.scene.name, link=f"#{s.anchor}"), *cells, verdict))
    caption = "Distance of the load curve to the reference (relative L2 over the opening), and wall time"
    return Table.of(("Scene", *titles, "Checks"), rows, caption, "overview told")


def _columns(sections: Sequence[Section]) -> dict[Key, tuple[str, list[Entry]]]:
    """Heading and runs of each column: the label where a method has several runs."""
    places: dict[Key, list[Entry]] = {}
    for entry in (entry for s in sections for entry in s.entries):
        places.setdefault((entry.method, entry.repeat), []).append(entry)
    repeated = {method for method, repeat in places if repeat}
    columns = {}
    for (method, repeat), found in sorted(places.items(), key=lambda place: (rank(place[0][0]), place[0])):
        several = found[0].label if len({e.label for e in found}) == 1 else f"{found[0].name} {repeat + 1}"
        columns[method, repeat] = several if method in repeated else found[0].name, found
    return columns


def _cell(section: Section, entry: Entry) -> Cell:
    """Distance to the reference as far as the run came; time and size."""
    link = f"#{section.anchor}-run-{entry.run.name}"
    if entry.agreement is None:
        return Cell(entry.run.left_out or "no step", link=link, tone="absent")
    time, dofs = total_seconds(entry.result), entry.result.dofs
    below = ", ".join([*[seconds(time)] * (time == time), *[f"{dofs} unknowns"] * bool(dofs)])
    tone = "absent" if not entry.compared else "" if entry.complete else "bad"
    return Cell(entry.distance + ", stopped" * (tone == "bad"), below, link, tone)


def _sentences(sections: Sequence[Section]) -> Iterator[Cell]:
    """One sentence per method: its largest distance to the reference, and its times."""
    for name, entries in _columns(sections).values():
        found = [(s, e) for s in sections for e in s.entries if e in entries and e.agreement]
        times = [t for _, e in found if (t := total_seconds(e.result)) == t]
        took = f"{span(times, seconds)} a scene" if times else "time unknown"
        compared = [(e.agreement.error, s, e) for s, e in found if e.agreement and e.compared]
        name = name[:1].upper() + name[1:] if entries[0].method in IN_TABLES else name  # that of a user is as given
        if compared:
            error, worst, entry = max(compared, key=lambda one: one[0])
            bases = sorted({s.reference.name for _, s, _ in compared if s.reference is not None})
            base = bases[0] if len(bases) == 1 else f"the reference ({' or '.join(bases)})"
            extent = "over the whole curve" if all(e.complete for _, _, e in compared) else "as far as its runs came"
            where = f" (most on {worst.report.scene.name})" if len(compared) > 1 else ""
            near = f"within {percent(error)} of" if error < FAR_OFF else f"off by {percent(error)} from"
            text = f"{name}: load {near} {base} {extent}{where}; {took}."
            yield Cell(text, link=f"#{worst.anchor}-run-{entry.run.name}")
        elif found and found[0][1].is_reference:
            s, e = found[0]
            yield Cell(f"{name}: the reference of this page; {took}.", link=f"#{s.anchor}-run-{e.run.name}")
    if any(e.method == "lefm" and e.agreement for s in sections for e in s.entries):
        yield Cell(_LEFM)


def _missing(sections: Sequence[Section]) -> Iterator[str]:
    """Reasons for missing runs and runs that stopped, each once with its scenes."""
    reasons: dict[str, list[str]] = {}
    for one in sections:
        for note in one.notes:
            reasons.setdefault(note, []).append(one.report.scene.name)
    for note, names in reasons.items():
        yield f"{note} ({'all scenes' if len(names) == len(sections) > 1 else ', '.join(names)})"


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
