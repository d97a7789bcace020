"""Convergence tables: values on the sequences of meshes of a scene, and their limits."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite

from verify.pages.style import METHOD_NAMES
from verify.pages.text import Units, number, percent, quantity
from verify.report.figures.entry import Entry
from verify.scene.schema import Scene
from verify.studies.mesh_sequences import Sequence, sequences
from verify.verdict import SceneReport


@dataclass(frozen=True)
class MeshRow:
    """One mesh: its entry, the value on it, and the distance to the value on the next coarser mesh."""

    entry: Entry
    value: str
    change: str


@dataclass(frozen=True)
class ConvergenceTable:
    """One quantity of one method on all its meshes, finest first."""

    method: str
    quantity: str
    rows: tuple[MeshRow, ...]
    order: str
    limit: str
    error: str
    gci: str
    asymptotic: bool
    verdict: str


def tables(report: SceneReport, entries: tuple[Entry, ...]) -> tuple[ConvergenceTable, ...]:
    """The tables of all methods with at least three meshes."""
    return tuple(_table(report.scene, one, entries) for one in sequences(report))


def _table(scene: Scene, one: Sequence, entries: tuple[Entry, ...]) -> ConvergenceTable:
    units, of_run = Units.of(scene.units), {id(entry.run): entry for entry in entries}
    unit = units.force if one.quantity == "peak load" else units.energy
    steps = ("–" if step is None else percent(step) for step in one.steps)
    shown = zip(one.runs, one.value, steps, strict=True)
    found = one.found
    return ConvergenceTable(
        METHOD_NAMES.get(one.method, one.method),
        one.quantity,
        tuple(MeshRow(of_run[id(run)], quantity(value, unit), step) for run, value, step in shown),
        order=number(found.order) if isfinite(found.order) else "none",
        limit=quantity(found.limit, unit) if isfinite(found.limit) else "–",
        error=percent(found.error) if isfinite(found.error) else "–",
        gci=percent(found.gci) if isfinite(found.gci) else "–",
        asymptotic=found.asymptotic,
        verdict=found.verdict,
    )
