"""The process zone of every run: estimated and measured, as length and in elements."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite

from verify.methods import zone_resolution
from verify.pages.text import Units, number, quantity
from verify.report.figures.entry import Entry
from verify.scene.schema import Scene

_NOT_MEASURED = "–"


@dataclass(frozen=True)
class ZoneRow:
    """A line of the table; ``resolved`` refers to the estimate."""

    entry: Entry
    element: str
    estimate: str
    elements: str
    measured: str
    measured_elements: str
    resolved: bool


def rows(scene: Scene, found: Sequence[Entry]) -> tuple[ZoneRow, ...]:
    """A row for each run with a mesh along the interface."""
    lines = (_row(scene, entry) for entry in found if entry.agreement is not None)
    return tuple(line for line in lines if line is not None)


def _row(scene: Scene, entry: Entry) -> ZoneRow | None:
    zone = zone_resolution.expected(entry.run.scene or scene, entry.method)
    if not isfinite(zone.element):
        return None
    length, unit = zone_resolution.measured(entry.result), Units.of(scene.units).length
    return ZoneRow(
        entry,
        element=quantity(zone.element, unit, 2),
        estimate=quantity(zone.length, unit, 2),
        elements=number(zone.elements, 2),
        measured=quantity(length, unit, 2) if isfinite(length) else _NOT_MEASURED,
        measured_elements=number(length / zone.element, 2) if isfinite(length) else _NOT_MEASURED,
        resolved=zone.resolved,
    )
