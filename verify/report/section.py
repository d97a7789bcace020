"""One scene of the page: the texts, tables and figures of the template."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from operator import itemgetter
from typing import TYPE_CHECKING, TypeAlias

from verify.pages.style import IN_TABLES, Panel
from verify.pages.text import NO_VALUE, Units, inputs, modelled, number, percent, quantity, seconds, sentence
from verify.report import converged, cost, matched, published, toughness, zones
from verify.report.figures import curves, drawing, fields, meshes, opening, undeformed
from verify.report.figures.entry import Entry, entries
from verify.report.tally import EVIDENCE, Tally, headline, tally
from verify.verdict import Check, Counts, Run, SceneReport, counted

if TYPE_CHECKING:
    from verify.scene.schema import Scene


#: Title of the figures that every reader sees.
LOADS = "Load and opening"


@dataclass(frozen=True)
class Figures:
    """Panels that share a heading."""

    title: str
    panels: tuple[Panel, ...]
    legend: tuple[Entry, ...] = ()
    folded: bool = True


@dataclass(frozen=True)
class CheckRow:
    check: Check
    runs: tuple[Run, ...]  # the runs of its subject
    value: str
    tolerance: str
    used: float  # value over tolerance, at most 1
    uncertainty: str = ""  # of the reference

    @property
    def parts(self) -> tuple[tuple[str, Run | None], ...]:
        """The names in its subject, each with its run."""
        named = {run.name: run for run in self.runs}
        return tuple((name, named.get(name)) for name in self.check.subject.split(" / "))


@dataclass(frozen=True)
class CheckGroup:
    """The checks of one name, one per run."""

    name: str
    meaning: str
    rows: tuple[CheckRow, ...]

    @property
    def holds(self) -> bool:
        return all(row.check.state == "holds" for row in self.rows)


#: Checks of every kind, by name.
Kinds: TypeAlias = tuple[tuple[Tally, tuple[CheckGroup, ...]], ...]


@dataclass(frozen=True)
class RunRow:
    """A line of the table of error and time."""

    entry: Entry
    status: str
    modelled: str
    error: str = NO_VALUE
    oscillation: str = NO_VALUE
    peak: str = NO_VALUE
    peak_opening: str = NO_VALUE
    steps: str = NO_VALUE
    newton: str = NO_VALUE
    seconds: str = NO_VALUE
    memory: str = NO_VALUE


@dataclass(frozen=True)
class Section:
    """One scene."""

    anchor: str
    report: SceneReport
    entries: tuple[Entry, ...]
    sentence: str
    headline: str
    inputs: tuple[tuple[str, tuple[tuple[str, str], ...]], ...]  # group, (name, value) ...
    specimen: Panel
    frames: tuple[opening.Frame, ...]
    convergence: tuple[converged.ConvergenceTable, ...]
    figures: tuple[Figures, ...]
    checks: Kinds
    rows: tuple[RunRow, ...]
    matched: tuple[str, ...]  # sentences on the error of matched interfaces
    zones: tuple[zones.ZoneRow, ...]
    published: tuple[published.PublishedRow, ...]
    compared: tuple[Entry, ...]  # columns of the table of published values
    toughness: toughness.ToughnessTable | None
    notes: tuple[str, ...]

    @property
    def reference(self) -> Entry | None:
        return next((entry for entry in self.entries if entry.is_reference), None)

    @property
    def counts(self) -> Counts:
        return counted(self.report.checks)

    @property
    def open_checks(self) -> Kinds:
        """The checks of a name of which one does not hold."""
        return self._checks(held=False)

    @property
    def held_checks(self) -> Kinds:
        """The checks of a name that all hold."""
        return self._checks(held=True)

    def _checks(self, held: bool) -> Kinds:
        kept = ((kind, tuple(group for group in groups if group.holds is held)) for kind, groups in self.checks)
        return tuple((kind, groups) for kind, groups in kept if groups)

    @property
    def coarse(self) -> bool:
        """Whether a run has too few elements in the process zone."""
        return any(not row.resolved for row in self.zones)

    @property
    def stopped(self) -> bool:
        """Whether a run has failed or has not come to the end of its programme."""
        runs = [entry.run for entry in self.entries]
        return any(run.left_out.startswith("failed") if run.result is None else not run.result.complete for run in runs)


def section(report: SceneReport, anchor: str, between: bool = True) -> Section:
    """Compute and draw one scene; ``between``: also at openings that only the leading run has stored."""
    return replace(still(report, anchor), frames=moving(report, anchor, between))


def moving(report: SceneReport, anchor: str, between: bool = True) -> tuple[opening.Frame, ...]:
    """The frames of a scene, half of the work."""
    drawn = tuple(entry for entry in entries(report) if entry.agreement is not None)
    groups = [group for group in fields.shared_snapshots(drawn) if group]
    return opening.frames(report.scene, groups, drawn, f"{anchor}-frame", between)


def still(report: SceneReport, anchor: str) -> Section:
    """One scene without its frames."""
    found = entries(report)
    drawn = tuple(entry for entry in found if entry.agreement is not None)
    checks = report.checks
    groups = fields.shared_snapshots(drawn)
    return Section(
        anchor=anchor,
        report=report,
        entries=found,
        sentence=sentence(report.scene),
        headline=headline(counted(checks), 1).removesuffix(" on 1 scene"),
        inputs=tuple((k, tuple(row[1:] for row in g)) for k, g in groupby(inputs(report.scene), itemgetter(0))),
        specimen=drawing.specimen(report.scene, f"{anchor}-specimen", _zone(groups)),
        frames=(),
        convergence=converged.tables(report, found),
        figures=_figures(report, drawn, groups, anchor),
        checks=tuple((tally(kind, checks), _check_groups(kind, report)) for kind in EVIDENCE),
        rows=tuple(_run_row(entry, report.scene) for entry in found),
        matched=matched.sentences(report.scene, found),
        zones=zones.rows(report.scene, found),
        published=published.rows(report.scene, found),
        compared=published.compared(found),
        toughness=toughness.table(report.scene, found),
        notes=(*_notes(found), *report.remarks),
    )


def _zone(groups: Sequence[Sequence[tuple[Entry, fields.Snapshot]]]) -> tuple[float, float, float] | None:
    """Process zone of the leading run at the last opening with one, and that opening."""
    for group in reversed(groups):
        if group and (zone := fields.process_zone(group[0][1])) is not None:
            return (*zone, group[0][1].opening)
    return None


def _figures(
    report: SceneReport,
    drawn: Sequence[Entry],
    groups: Sequence[Sequence[tuple[Entry, fields.Snapshot]]],
    anchor: str,
) -> tuple[Figures, ...]:
    if not drawn:
        return ()
    scene = report.scene
    base = next((entry for entry in drawn if entry.is_reference), None)
    ledger = next((e for e in sorted(drawn, key=lambda e: e.method != "nurbs") if e.method != "lefm"), None)
    groups = [group for group in groups if group]
    load = [curves.load_opening(scene, drawn, f"{anchor}-load"), curves.peak(scene, drawn, f"{anchor}-peak")]
    finer = [curves.j_figure(scene, drawn, f"{anchor}-j")]
    if base is not None and any(e is not base and e.method != "lefm" for e in drawn):
        finer.insert(0, curves.oscillation(scene, drawn, base, f"{anchor}-oscillation"))
    small = len(groups) % 3 == 0
    interface = [fields.traction(scene, group, f"{anchor}-traction-{i}", small) for i, group in enumerate(groups)]
    plain = [
        undeformed.undeformed(scene, drawn, f"{anchor}-meshes"),
        undeformed.followed(scene, drawn, f"{anchor}-moves"),
    ]
    deformed = [meshes.deformed(scene, groups[-1], f"{anchor}-deformed")] if groups else []
    ledgers = [curves.energies(scene, ledger, f"{anchor}-energy")] if ledger is not None else []
    ledgers.append(curves.ledger_gap(scene, drawn, f"{anchor}-ledger"))
    times = [cost.timing(scene, drawn, f"{anchor}-timing")]
    if base is not None:
        times.append(cost.error_and_time(scene, drawn, base, f"{anchor}-cost"))
    titled = (
        (LOADS, load, drawn),
        ("Oscillation and J-integral", finer, drawn),
        ("Traction along the interface", interface, [entry for entry in drawn if entry.result.snapshots]),
        ("Meshes", plain, ()),
        ("Deformed meshes and stress", deformed, ()),
        ("Energy", ledgers, [entry for entry in drawn if entry.method != "lefm"]),
        ("Cost", times, ()),
    )
    kept = [(title, tuple(p for p in panels if p is not None), tuple(legend)) for title, panels, legend in titled]
    return tuple(Figures(*figures, folded=figures[0] != LOADS) for figures in kept if figures[1])


def _check_groups(kind: str, report: SceneReport) -> tuple[CheckGroup, ...]:
    """Checks of one kind, grouped by name in the order of their first appearance."""
    groups: dict[tuple[str, str], list[CheckRow]] = {}
    for c in report.checks:
        if c.kind == kind:
            error = number(c.uncertainty, 2) if c.uncertainty else ""
            row = CheckRow(c, report.judged(c), number(c.value), number(c.tolerance), _used(c), error)
            groups.setdefault((c.name, c.meaning), []).append(row)
    return tuple(CheckGroup(name, meaning, tuple(rows)) for (name, meaning), rows in groups.items())


def _used(check: Check) -> float:
    share = abs(check.value) / check.tolerance if check.tolerance > 0 else float(not check.passed)
    return min(share, 1.0) if share == share else 1.0


def _run_row(entry: Entry, scene: Scene) -> RunRow:
    units, ours = Units.of(scene.units), entry.method in IN_TABLES or entry.run.scene is not None
    effects = modelled(scene, entry.method) if ours else "its code knows"
    if entry.agreement is None:
        return RunRow(entry, entry.run.left_out or "no converged step", effects)
    result, found = entry.result, entry.agreement
    newton = result.steps.get("newton_iterations")
    iterations = float(newton.sum()) if newton is not None else float("nan")
    extent = "" if result.complete else f" up to {quantity(found.end, units.length, 3)}"
    compared = percent(found.error) + extent
    if entry.is_reference:
        compared = "reference"
    elif entry.method == "lefm":
        compared = "limit, not compared"
    elif found.error != found.error:
        compared = "no reference"
    own = not entry.is_reference and entry.method != "lefm"
    return RunRow(
        entry,
        status=", ".join(filter(None, (result.status, result.ending))),
        modelled=effects,
        error=compared,
        oscillation=percent(found.oscillation) if own else "–",
        peak=quantity(found.peak_load, units.force, 4),
        peak_opening=quantity(found.peak_opening, units.length, 3),
        steps=_steps(len(result.opening) - 1, result.rejected_steps),
        newton=number(iterations, 6) if iterations > 0 else "–",
        seconds=seconds(cost.total_seconds(result), "–"),
        memory=f"{number(result.peak_memory_mb, 3)} MB" if result.peak_memory_mb > 0 else "–",
    )


def _steps(accepted: int, rejected: int) -> str:
    return f"{accepted} + {rejected} rejected" if rejected else str(accepted)


def _notes(found: Sequence[Entry]) -> list[str]:
    """Remarks on runs that are missing or stopped, and on a missing reference."""
    notes = []
    for entry in found:
        if entry.run.result is None:
            notes.append(f"{entry.label}: {entry.run.left_out or 'not run'}")
        elif not entry.complete:
            notes.append(f"{entry.label} {entry.result.status}")
        elif entry.agreement is None:
            notes.append(f"{entry.label}: there is no converged step to show")
    if not any(entry.is_reference for entry in found):
        notes.append("No distance between curves: neither the DOLFINx nor the beam curve is complete")
    return notes
