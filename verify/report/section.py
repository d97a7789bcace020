"""One scene of the page: its texts, tables and figures."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from math import inf
from operator import itemgetter
from urllib.parse import quote

import numpy as np

from verify.pages.style import IN_TABLES, Panel
from verify.pages.table import Cell, Table
from verify.pages.text import Units, inputs, modelled, number, percent, quantity, seconds, sentence
from verify.report import cost, tables
from verify.report.figures import curves, drawing, fields, meshes
from verify.report.figures.entry import Entry, entries
from verify.report.tables import EVIDENCE, headline, mark
from verify.scene.schema import Scene
from verify.verdict import Counts, SceneReport, counted

#: Title of the figures that every reader sees.
LOADS = "Load and opening"


@dataclass(frozen=True)
class Figures:
    """Panels that share a heading."""

    title: str
    panels: tuple[Panel, ...]
    legend: tuple[Entry, ...] = ()

    @property
    def folded(self) -> bool:
        return self.title != LOADS


@dataclass(frozen=True)
class Section:
    """One scene; ``open_checks`` has those that do not hold, ``held_checks`` the others."""

    anchor: str
    report: SceneReport
    entries: tuple[Entry, ...]
    sentence: str
    specimen: Panel
    figures: tuple[Figures, ...]
    methods: Table
    runs: Table
    inputs: tuple[Table, ...]
    matched: tuple[str, ...]  # sentences on the error of matched interfaces
    zones: Table
    published: Table
    toughness: Table
    convergence: Table
    open_checks: Table
    held_checks: Table
    notes: tuple[str, ...]

    @property
    def reference(self) -> Entry | None:
        return next((entry for entry in self.entries if entry.is_reference), None)

    @property
    def counts(self) -> Counts:
        return counted(self.report.checks)

    @property
    def headline(self) -> str:
        return headline(self.counts, 1).replace(" on 1 scene", "")

    @property
    def coarse(self) -> bool:
        """Whether a run has too few elements in the process zone."""
        return any(row[-1].tone == "bad" for row in self.zones.cells())

    @property
    def stopped(self) -> bool:
        """Whether a run has failed or has not come to the end of its programme."""
        runs = [entry.run for entry in self.entries]
        return any(run.left_out.startswith("failed") if run.result is None else not run.result.complete for run in runs)


def section(report: SceneReport, anchor: str) -> Section:
    """Compute and draw one scene."""
    found, scene = entries(report), report.scene
    drawn = tuple(entry for entry in found if entry.agreement is not None)
    groups = fields.shared_snapshots(drawn)
    leading = [(fields.process_zone(group[0][1]), group[0][1].opening) for group in groups]
    zone = next(((*zone, opening) for zone, opening in reversed(leading) if zone is not None), None)
    return Section(
        anchor=anchor,
        report=report,
        entries=found,
        sentence=sentence(scene),
        specimen=drawing.specimen(scene, f"{anchor}-specimen", zone),
        figures=tuple(one for one in _figures(report, drawn, groups, anchor) if one.panels) if drawn else (),
        methods=_methods(found, scene, anchor),
        runs=_runs(found, scene, anchor),
        inputs=tuple(
            Table.of(("", ""), [row[1:] for row in rows], group)
            for group, rows in groupby(inputs(scene), itemgetter(0))
        ),
        matched=tables.matched_interfaces(scene, found),
        zones=tables.process_zones(scene, found, anchor),
        published=tables.published_values(scene, found, anchor),
        toughness=tables.toughness(scene, found),
        convergence=tables.convergence(report, found, anchor),
        open_checks=checks(report, anchor, held=False),
        held_checks=checks(report, anchor, held=True),
        notes=(*_notes(found), *report.remarks),
    )


def checks(report: SceneReport, anchor: str, held: bool) -> Table:
    """The checks of the names that all hold, or of the others, by kind and name in the order of their appearance."""
    names = list(dict.fromkeys((check.name, check.meaning) for check in report.checks))
    lost = {(check.name, check.meaning) for check in report.checks if not check.passed}
    shown = [check for check in report.checks if ((check.name, check.meaning) in lost) is not held]
    kinds, rows = list(EVIDENCE), []
    for check in sorted(shown, key=lambda one: (kinds.index(one.kind), names.index((one.name, one.meaning)))):
        runs = report.judged(check)
        subject = Cell(check.subject, link=f"#{anchor}-run-{runs[0].name}" if runs else "")
        value = Cell(number(check.value), f"± {number(check.uncertainty, 2)}" if check.uncertainty else "")
        share = abs(check.value) / check.tolerance if check.tolerance > 0 else 0.0 if check.passed else inf
        used = f"{100 * share:.0f}\u00a0%" if share <= 1.0 else "all"
        name = Cell(check.name, check.meaning)
        rows.append((name, check.kind, subject, value, number(check.tolerance), used, mark(check)))
    titles = ("Check", "Kind", "Run", "Value", "Tolerance", "Used", "Verdict")
    caption = f"Checks on {report.scene.name} that {'hold' if held else 'do not hold, with those of the same names'}"
    return Table.of(titles, rows, caption, "checks", once=2)


def _figures(
    report: SceneReport, drawn: Sequence[Entry], groups: Sequence[fields.Group], anchor: str
) -> Iterator[Figures]:
    """All groups of figures; some of them have no panels."""
    scene, own = report.scene, [entry for entry in drawn if entry.method != "lefm"]
    base = next((entry for entry in drawn if entry.is_reference), None)
    leads = sorted(own, key=lambda entry: entry.method != "nurbs")[:1]
    by_opening = [
        min(group, key=lambda one: (not one[1].stress_euv.size, one[0].method != "nurbs")) for group in groups
    ]
    yield _group(LOADS, drawn, *curves.loads(scene, drawn, f"{anchor}-load"))
    yield _group(
        "Oscillation and J-integral",
        drawn,
        curves.oscillation(scene, drawn, base, f"{anchor}-oscillation") if base else None,
        curves.j_figure(scene, drawn, f"{anchor}-j"),
    )
    pulled = (fields.traction(scene, group, f"{anchor}-traction-{i}") for i, group in enumerate(groups))
    yield _group("Traction along the interface", [entry for entry in drawn if entry.result.snapshots], *pulled)
    yield _group("Front of the crack", drawn, *fields.fronts(scene, groups, f"{anchor}-front"))
    yield _group(
        "Meshes",
        (),
        meshes.undeformed(scene, drawn, f"{anchor}-meshes"),
        meshes.followed(scene, drawn, f"{anchor}-moves"),
    )
    last = (meshes.deformed(scene, group, f"{anchor}-deformed") for group in groups[-1:])
    yield _group("Deformed meshes and stress", (), *last)
    several = by_opening if len(groups) > 1 else []
    yield _group("The opening crack", (), meshes.deformed(scene, several, f"{anchor}-opening"))
    parts = (curves.energies(scene, entry, f"{anchor}-energy") for entry in leads)
    yield _group("Energy", own, *parts, curves.ledger_gap(scene, drawn, f"{anchor}-ledger"))
    yield _group(
        "Cost",
        (),
        cost.timing(scene, drawn, f"{anchor}-timing"),
        cost.error_and_time(scene, drawn, base, f"{anchor}-cost") if base else None,
    )


def _group(title: str, legend: Sequence[Entry], *panels: Panel | None) -> Figures:
    return Figures(title, tuple(one for one in panels if one is not None), tuple(legend))


def _methods(found: Sequence[Entry], scene: Scene, anchor: str) -> Table:
    """Error and time of every run."""
    titles = ("Method", "Curve distance", "Oscillation", "Peak load", "at opening", "Unknowns", "Elements", "Steps")
    rows = []
    for entry in found:
        dofs = entry.run.result.dofs if entry.run.result is not None else 0  # which stand beside the label
        rows.append((entry.cell(anchor, entry.label.removesuffix(f", {dofs} unknowns")), *_measures(entry, scene)))
    caption = f"Error and time by method on {scene.name}"
    return Table.of((*titles, "Newton iterations", "Wall time", "Memory"), rows, caption)


def _measures(entry: Entry, scene: Scene) -> tuple[str, ...]:
    found = entry.agreement
    if found is None:
        return (entry.run.left_out or "no converged step",)
    units, result = Units.of(scene.units), entry.result
    cut = entry.compared and not result.complete
    rejected = f" + {result.rejected_steps} rejected" if result.rejected_steps else ""
    newton = float(np.sum(result.steps.get("newton_iterations", 0.0)))
    return (
        entry.distance + f" up to {quantity(found.end, units.length, 3)}" * cut,
        percent(found.oscillation) if entry.compared else "–",
        quantity(found.peak_load, units.force, 4),
        quantity(found.peak_opening, units.length, 3),
        str(result.dofs or "–"),
        str(result.elements or "–"),
        f"{len(result.opening) - 1}{rejected}",
        number(newton, 6) if newton > 0 else "–",
        seconds(cost.total_seconds(result), "–"),
        f"{number(result.peak_memory_mb, 3)}\u00a0MB" if result.peak_memory_mb > 0 else "–",
    )


def _runs(found: Sequence[Entry], scene: Scene, anchor: str) -> Table:
    """What was modelled, how it ended, and what repeats it."""
    rows = []
    for entry in found:
        run, ended = entry.run, entry.run.left_out or "no converged step"
        if entry.agreement is not None:
            ended = ", ".join(filter(None, (entry.result.status, entry.result.ending)))
        rows.append(
            (
                Cell(entry.label, id=f"{anchor}-run-{run.name}"),
                modelled(scene, entry.method) if entry.method in IN_TABLES or run.scene else "its code knows",
                Cell(ended, tone="" if entry.complete else "absent"),
                Cell(run.folder, run.key, f"./{quote(run.folder)}/") if run.folder else "–",
                run.command or "–",
            )
        )
    caption = f"Runs on {scene.name}: what was modelled, folder, hash and command"
    return Table.of(("Run", "Modelled", "Ended", "Folder, hash", "Command"), rows, caption, "runs")


def _notes(found: Sequence[Entry]) -> Iterator[str]:
    """Remarks on runs that are missing, each reason once, or stopped, and on a missing reference."""
    missing: dict[str, list[str]] = {}
    for entry in found:
        if entry.run.result is None:
            missing.setdefault(entry.run.left_out or "not run", []).append(entry.label)
    yield from (f"{', '.join(labels)}: {why}" for why, labels in missing.items())
    for entry in found:
        if entry.run.result is None:
            continue
        if not entry.complete:
            yield f"{entry.label} {entry.result.status}"
        elif entry.agreement is None:
            yield f"{entry.label}: there is no converged step to show"
    if not any(entry.is_reference for entry in found):
        yield "No distance between curves: neither the DOLFINx nor the beam curve is complete"
