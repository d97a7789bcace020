"""The top of the page: distances and times of the methods, and the checks that fail."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from verify.methods.dolfinx import DOLFINX_MISSING, DOLFINX_WAYS
from verify.pages.text import percent, seconds, span, tone
from verify.report.cost import total_seconds
from verify.report.figures.entry import Entry, rank
from verify.report.tally import EVIDENCE, Tally, headline, tally
from verify.verdict import counted

if TYPE_CHECKING:
    from verify.report.section import Section
    from verify.studies.cost.price import Price
    from verify.verdict import Check


@dataclass(frozen=True)
class Cell:
    """One method on one scene in the overview."""

    head: str = ""
    tail: str = ""
    tone: str = ""  # "", "reference", "limit", "absent", "stopped"
    run: str = ""  # name of the run


@dataclass(frozen=True)
class Sentence:
    """A sentence at the top, with a link to its evidence on the page."""

    text: str
    target: str = ""
    link: str = ""


@dataclass(frozen=True)
class Column:
    method: str
    name: str


@dataclass(frozen=True)
class Summary:
    headline: str
    tone: str  # "good", "bad", "none"
    sentences: tuple[Sentence, ...]
    missing: tuple[str, ...]
    ways: tuple[str, ...]  # to DOLFINx, where it is missing
    tallies: tuple[Tally, ...]
    columns: tuple[Column, ...]
    rows: tuple[tuple[Section, tuple[Cell, ...]], ...]
    not_held: tuple[tuple[str, str, Check], ...]  # anchor and name of the section, broken or unresolved checks
    prices: tuple[Price, ...] = ()


def summarise(sections: Sequence[Section], prices: Sequence[Price] = ()) -> Summary:
    """The part of the page above the first scene."""
    checks = [(s.anchor, s.report.scene.name, check) for s in sections for check in s.report.checks]
    not_held = tuple((anchor, name, check) for anchor, name, check in checks if not check.passed)
    counts = counted(check for _, _, check in checks)
    columns = _columns(sections)
    no_dolfinx = any(entry.run.left_out == DOLFINX_MISSING for s in sections for entry in s.entries)
    return Summary(
        headline=headline(counts, len(sections)),
        tone=tone(counts),
        sentences=tuple(_sentences(sections)),
        missing=tuple(_missing(sections)),
        ways=DOLFINX_WAYS if no_dolfinx else (),
        tallies=tuple(tally(kind, [check for _, _, check in checks]) for kind in EVIDENCE),
        columns=tuple(Column(method, name) for method, _, name in columns),
        rows=tuple((section, tuple(_cell(section, *column[:2]) for column in columns)) for section in sections),
        not_held=not_held,
        prices=tuple(prices),
    )


def _nth(section: Section, method: str, repeat: int) -> Entry | None:
    return next((e for e in section.entries if (e.method, e.repeat) == (method, repeat)), None)


def _columns(sections: Sequence[Section]) -> list[tuple[str, int, str]]:
    """Method, number of the run of that method, and heading: the label where a method has several runs."""
    places: dict[tuple[int, str, int], list[Entry]] = {}
    for entry in (entry for section in sections for entry in section.entries):
        places.setdefault((rank(entry.method), entry.method, entry.repeat), []).append(entry)
    repeated = {method for _, method, repeat in places if repeat}
    columns = []
    for (_, method, repeat), found in sorted(places.items(), key=lambda item: item[0]):
        labels = {entry.label for entry in found}
        several = found[0].label if len(labels) == 1 else f"{found[0].name} {repeat + 1}"
        columns.append((method, repeat, several if method in repeated else found[0].name))
    return columns


def _cell(section: Section, method: str, repeat: int) -> Cell:
    entry = _nth(section, method, repeat)
    if entry is None:
        return Cell("–", "", "absent")
    if entry.agreement is None:
        return Cell("not run" if entry.run.result is None else "no curve", "", "absent")
    time = seconds(total_seconds(entry.result), "")
    unknowns = f"{entry.result.dofs} unknowns" if entry.result.dofs else ""
    tail = ", ".join(part for part in (time, unknowns) if part)
    run = entry.run.name
    if entry.is_reference:
        return Cell("reference", tail, "reference", run)
    if method == "lefm":
        return Cell("limit, not compared", tail, "limit", run)
    if section.reference is None:
        return Cell("no reference", tail, "absent", run)
    error = percent(entry.agreement.error)
    return Cell(error, tail, "", run) if entry.complete else Cell(f"{error}, stopped", tail, "stopped", run)


def _sentences(sections: Sequence[Section]) -> list[Sentence]:
    """One sentence per method: its largest distance to the reference, and its times."""
    sentences = []
    for method, repeat, name in _columns(sections):
        there = [(s, e) for s in sections if (e := _nth(s, method, repeat)) is not None]
        found = [(e.agreement.error, s, e) for s, e in there if e.agreement is not None]
        times = [t for _, _, e in found if (t := total_seconds(e.result)) == t]
        took = f"{span(times, seconds)} a scene" if times else "time unknown"
        compared = [one for one in found if not math.isnan(one[0])]
        if compared:
            error, worst, entry = max(compared, key=lambda row: row[0])
            bases = sorted({s.reference.name for _, s, _ in compared if s.reference is not None})
            base = bases[0] if len(bases) == 1 else f"the reference ({' or '.join(bases)})"
            whole = all(e.complete for _, _, e in compared)
            extent = "over the whole curve" if whole else "as far as its runs came"
            where = f" (most on {worst.report.scene.name})" if len(compared) > 1 else ""
            agrees = f"load within {percent(error)} of {base} {extent}{where}"
            target = f"{worst.anchor}-run-{entry.run.name}"
            sentences.append(Sentence(f"{_capital(name)}: {agrees}; {took}.", target, "that run"))
        elif any(e.is_reference for _, _, e in found):
            _, section, entry = found[0]
            target = f"{section.anchor}-run-{entry.run.name}"
            sentences.append(Sentence(f"{_capital(name)}: the reference of this page; {took}.", target, "its run"))
    if any(e.method == "lefm" and e.agreement is not None for s in sections for e in s.entries):
        text = (
            "LEFM is the limit of a vanishing process zone. It is drawn for orientation; the distance to it is the "
            "effect of the interface's finite strength, not an error of any method."
        )
        sentences.append(Sentence(text))
    return sentences


def _missing(sections: Sequence[Section]) -> list[str]:
    """Reasons for missing runs and runs that stopped, each once with its scenes."""
    reasons: dict[str, list[str]] = {}
    for section in sections:
        for note in section.notes:
            reasons.setdefault(note, []).append(section.report.scene.name)
    everywhere = len(sections)
    return [
        f"{note} ({'all scenes' if len(names) == everywhere > 1 else ', '.join(names)})"
        for note, names in reasons.items()
    ]


def _capital(name: str) -> str:
    return name[:1].upper() + name[1:]
