"""Convergence: values on the sequences of meshes of a scene, and their limits."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from math import isfinite

from verify.pages.style import METHOD_NAMES
from verify.pages.table import Cell, Table
from verify.pages.text import Units, number, percent, quantity
from verify.report.figures.entry import Entry
from verify.scene.schema import Scene
from verify.studies.mesh_sequences import Sequence, sequences
from verify.verdict import SceneReport

_SEQUENCE_TITLES = ("Quantity", "Mesh", "Unknowns", "Elements", "Value", "Change from the coarser")
_SEQUENCE_CAPTION = (
    "Sequences of meshes: the value on each, observed order, Richardson’s limit and the grid convergence index"
)


def table(report: SceneReport, entries: tuple[Entry, ...], anchor: str) -> Table | None:
    """All methods with at least three meshes: a row for each mesh, finest first, then limit and verdict."""
    rows = [row for one in sequences(report) for row in _rows(report.scene, one, entries, anchor)]
    return Table.of(_SEQUENCE_TITLES, rows, _SEQUENCE_CAPTION, "methods told convergence", once=1) if rows else None


def _rows(scene: Scene, one: Sequence, entries: tuple[Entry, ...], anchor: str) -> Iterator[tuple[str | Cell, ...]]:
    units, of_run, found = Units.of(scene.units), {id(entry.run): entry for entry in entries}, one.found
    unit = units.force if one.quantity == "peak load" else units.energy
    name = f"{METHOD_NAMES.get(one.method, one.method)}: {one.quantity}"
    for run, value, step in zip(one.runs, one.value, one.steps, strict=True):
        entry = of_run[id(run)]
        sizes = str(entry.result.dofs or "–"), str(entry.result.elements)
        yield name, entry.cell(anchor), *sizes, quantity(value, unit), "–" if step is None else percent(step)
    order, limit, error, gci = (
        show(value) if isfinite(value) else "–"
        for show, value in (
            (number, found.order),
            (partial(quantity, unit=unit), found.limit),
            (percent, found.error),
            (percent, found.gci),
        )
    )
    yield name, "Limit", f"order {order}", "", limit, f"error {error}, GCI {gci}"
    yield name, Cell(f"{'✓' if found.asymptotic else '○'} {found.verdict}", tone="good" * found.asymptotic)
