"""Published values of a scene and the corresponding values of the runs."""

from __future__ import annotations

from collections.abc import Sequence

from verify.checks.between_codes import published_load
from verify.pages.table import Cell, Table
from verify.pages.text import Units, number, percent, quantity
from verify.report.figures.entry import Entry
from verify.scene.schema import Scene


def table(scene: Scene, found: Sequence[Entry], anchor: str) -> Table | None:
    """A row for each published value, a column for each run with a curve; LEFM is shown but not checked."""
    runs, units = [entry for entry in found if entry.agreement is not None], Units.of(scene.units)
    titles: tuple[str | Cell, ...] = ("Quantity", "Published", "Tolerance")
    titles += tuple(entry.cell(anchor, entry.legend) for entry in runs)
    rows = []
    for known in scene.published:
        (low, high), leg = known.value, f" on leg {known.leg}" if known.leg else ""
        at = "peak load" if known.quantity == "peak" else f"load at {quantity(known.opening, units.length)}{leg}"
        value = f"{number(low, 6)} to " * (low != high) + quantity(high, units.force)
        loads = [published_load(known, entry.result, scene.load.opening) for entry in runs]
        cells = [Cell(quantity(load, units.force, 4), signed(known.deviation(load))) for load in loads]
        rows.append((Cell(at, known.source), value, percent(known.tolerance), *cells))
    return Table.of(titles, rows, "Published values, and what every run found", "published") if rows else None


def signed(deviation: float) -> str:
    return ("+" if deviation > 0 else "") + percent(deviation)
