"""The report in Markdown, without figures, for terminals and code forges."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING
from urllib.parse import quote

from verify.pages.text import number, seconds
from verify.verdict import Counts

if TYPE_CHECKING:
    from verify.report.figures.entry import Entry
    from verify.report.section import Section
    from verify.report.studies.included import IncludedSection
    from verify.report.summary import Summary
    from verify.studies.hard.page import Row as HardRow
    from verify.verdict import Check

#: Characters that are markup; an angle bracket before a space or a digit is not.
_SPECIAL = re.compile(r"[\\`*\[\]|]|<(?=[A-Za-z/!?])|&(?=#?\w+;)|~(?=~)|^[>#+-]|(?<!\w)_|_(?!\w)")


#: Text of a state in a table.
VERDICTS = {"holds": "✓ holds", "broken": "✗ **broken**", "unresolved": "? unresolved", "not covered": "- not covered"}


def lines(
    summary: Summary,
    sections: Sequence[Section],
    included: Sequence[IncludedSection],
    environment: Mapping[str, str],
) -> list[str]:
    """All texts and tables of the page as lines."""
    text = ["# Verification report", "", f"**{plain(summary.headline)}.**", "", *_summary(summary)]
    for section in sections:
        text += ["", *_scene(section)]
    for study in included:
        text += ["", *_study(study)]
    rows = [[plain(name), plain(value)] for name, value in environment.items()]
    return [*text, "", "## Versions and machine", "", *table(["", ""], rows), ""]


def plain(text: object) -> str:
    """Text on one line, with its markup characters escaped."""
    return _SPECIAL.sub(r"\\\g<0>", re.sub(r"\s*[\r\n]+\s*", " ", str(text)))


def code(text: str) -> str:
    """A code span, also of a text with backticks."""
    text = re.sub(r"[\r\n]+", " ", text)
    fence = "`" * (1 + max((len(run) for run in re.findall("`+", text)), default=0))
    pad = " " if text[:1] == "`" or text[-1:] == "`" else ""
    return f"{fence}{pad}{text}{pad}{fence}"


def table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """A table with aligned columns; cells are Markdown."""
    widths = [max(3, *(len(row[i]) for row in (heads, *rows))) for i in range(len(heads))]

    def line(cells: Iterable[str]) -> str:
        return "| " + " | ".join(cell.ljust(width) for cell, width in zip(cells, widths, strict=True)) + " |"

    return [line(heads), line("-" * width for width in widths), *map(line, rows)]


def _summary(summary: Summary) -> Iterator[str]:
    for price in summary.prices:
        yield from (f"**What accuracy costs.** {plain(price.sentence)}", "")
    yield from (f"- {plain(sentence.text)}" for sentence in summary.sentences)
    if summary.missing:
        yield from ("", "Not run, stopped early, or neglected:", "")
        yield from (f"- {plain(text)}" for text in (*summary.missing, *summary.ways))
    if summary.not_held:
        yield from ("", "Checks that do not hold:", "")
        yield from (f"- {plain(name)}: {_in_words(check)}" for _, name, check in summary.not_held)
    if summary.rows:
        heads = ["Scene", *(plain(column.name) for column in summary.columns), "Checks"]
        caption = "Distance of the load curve to the reference (relative L2 over the opening), and wall time:"
        yield from ("", caption, "")
        yield from table(heads, [_overview(section, cells) for section, cells in summary.rows])
    rows = [[t.kind, _held_of(t.counts), t.meaning] for t in summary.tallies]
    yield from ("", *table(["Kind of check", "Hold", "What it rests on"], rows))


def _in_words(check: Check) -> str:
    value, tolerance = number(check.value), number(check.tolerance)
    why = f": {plain(check.unresolved)}" if check.unresolved else ""
    judged = f"{plain(check.name)} of {plain(check.subject)}, value {value}, tolerance {tolerance} ({check.kind})"
    return f"{check.state}: {judged}{why}"


def _held_of(counts: Counts) -> str:
    return f"{counts.held} of {counts.total}" if counts.total else "none"


def _overview(section: Section, cells: Sequence) -> list[str]:
    held = f"{_held_of(section.counts)} hold" if section.counts.total else "none"
    shown = [plain(", ".join(filter(None, (cell.head, cell.tail)))) for cell in cells]
    return [plain(section.report.scene.name), *shown, held]


def _scene(section: Section) -> Iterator[str]:
    yield from (f"## {plain(section.report.scene.name)}", "", f"{plain(section.sentence)} {plain(section.headline)}.")
    if section.notes:
        yield from ("", *(f"- {plain(note)}" for note in section.notes))
    yield from ("", "### Error and time by method", "", *_methods(section))
    if section.published:
        heads = ["Quantity", "Published", "Tolerance", *(plain(entry.legend) for entry in section.compared)]
        rows = [
            [plain(r.quantity), r.value, r.tolerance, *(plain(" ".join(cell)) for cell in r.cells)]
            for r in section.published
        ]
        yield from ("", "### What others published", "", *table(heads, rows), "")
        yield from (f"- {plain(r.quantity)}: {plain(r.source)}" for r in section.published)
    if section.convergence:
        yield from ("", "### Convergence", "", *_convergence(section))
    yield from ("", "### Checks", "")
    yield from _checks((row.check, row.runs) for _, groups in section.checks for group in groups for row in group.rows)
    yield from ("", "### Runs, and how to repeat them", "", *_runs(section))


def _methods(section: Section) -> list[str]:
    heads = ["Method", "Curve distance", "Oscillation", "Peak load", "at opening", "Unknowns", "Steps", "Wall time"]
    rows = []
    for row in section.rows:
        if row.entry.agreement is None:
            cells = [row.status, *[""] * 6]
        else:
            dofs = str(row.entry.result.dofs or "–")
            cells = [row.error, row.oscillation, row.peak, row.peak_opening, dofs, row.steps, row.seconds]
        rows.append([plain(row.entry.label), *map(plain, cells)])
    return table(heads, rows)


def _convergence(section: Section) -> list[str]:
    heads = ["Quantity", "Meshes", "Values, finest first", "Order", "Richardson", "GCI", "Verdict"]
    rows = [
        [
            f"{one.method}, {one.quantity}",
            str(len(one.rows)),
            plain(", ".join(row.value for row in one.rows)),
            one.order,
            plain(one.limit),
            one.gci,
            plain(one.verdict),
        ]
        for one in section.convergence
    ]
    return table(heads, rows)


def _checks(found: Iterable[tuple[Check, Sequence | None]]) -> list[str]:
    rows = []
    for check, runs in found:
        link = f"[{plain(check.subject)}](<./{quote(runs[0].folder)}/>)" if runs else plain(check.subject)
        verdict = VERDICTS[check.state]
        rows.append([check.kind, plain(check.name), link, number(check.value), number(check.tolerance), verdict])
    if not rows:
        return ["No check was made."]
    return table(["Kind", "Check", "Run", "Value", "Tolerance", "Verdict"], rows)


def _runs(section: Section) -> Iterator[str]:
    for row in section.rows:
        yield f"- {plain(row.entry.label)}: {plain(row.status)}{_traces(row.entry)}"


def _traces(entry: Entry) -> str:
    """Folder, hash and command."""
    run = entry.run
    parts = [f"[{plain(run.folder)}](<./{quote(run.folder)}/>)"] if run.folder else []
    parts += [f"hash {code(run.key)}"] if run.key else []
    parts += [code(run.command)] if run.command else []
    return "".join(f"; {part}" for part in parts)


def _study(study: IncludedSection) -> Iterator[str]:
    yield from (f"## {plain(study.title)}", "", f"Found by `debond {study.command}`; takes no part in the verdict.")
    if study.has_page:
        yield from ("", f"[Its own page](<./{study.prefix}/report.html>)")
    if study.outdated:
        yield from ("", "The solvers have changed since this study was made.")
    yield ""
    yield from (f"- {plain(text)}" for text in study.lead)
    if study.pairs:
        yield from (f"- {plain(row.sentence)}" for row in study.pairs)
    if study.hard:
        rows = [[plain(row.case.name), *(_held(row, basis) for basis in study.bases)] for row in study.hard]
        yield from ("", *table(["Case", *study.bases.values()], rows))


def _held(row: HardRow, basis: str) -> str:
    cell = next((cell for cell, _ in row.cells if cell.basis == basis), None)
    if cell is None:
        return "–"
    if cell.verdict is None:
        return plain(cell.why)
    took = seconds(sum(run.seconds for run in cell.verdict.runs))
    return f"{VERDICTS['holds' if cell.passed else 'broken']}, {took}"
