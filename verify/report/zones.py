"""The process zone of every run: estimated and measured, as length and in elements."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite

from verify.methods import zone_resolution
from verify.pages.table import Cell, Table
from verify.pages.text import Units, number, quantity
from verify.report.figures.entry import Entry
from verify.scene.schema import Scene

_ZONE_TITLES = (
    "Run",
    "Element along the bond",
    "Estimated zone",
    "in elements",
    "Measured zone",
    "in elements",
    "Mesh",
)

#: Whether the estimated zone is resolved.
_RESOLVED = {True: Cell("✓ fine enough", tone="good"), False: Cell("⚠ fewer than 3 elements", tone="bad")}


def table(scene: Scene, found: Sequence[Entry], anchor: str) -> Table | None:
    """A row for each run with a mesh along the interface."""
    rows, unit = [], Units.of(scene.units).length
    for entry in (entry for entry in found if entry.agreement is not None):
        zone = zone_resolution.expected(entry.run.scene or scene, entry.method)
        if isfinite(zone.element):
            length = zone_resolution.measured(entry.result)
            measured = (quantity(length, unit, 2), number(length / zone.element, 2)) if isfinite(length) else "––"
            estimate = quantity(zone.element, unit, 2), quantity(zone.length, unit, 2), number(zone.elements, 2)
            rows.append((entry.cell(anchor), *estimate, *measured, _RESOLVED[zone.resolved]))
    return (
        Table.of(_ZONE_TITLES, rows, "Length of the process zone, and elements in it, by run", "zones")
        if rows
        else None
    )
