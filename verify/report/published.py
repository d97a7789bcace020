"""Published values of a scene and the corresponding values of the runs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from verify.checks.between_codes import published_load
from verify.pages.text import Units, number, percent, quantity
from verify.report.figures.entry import Entry
from verify.scene.schema import Scene
from verify.scene.stated.published import Published


@dataclass(frozen=True)
class PublishedRow:
    """A line of the table; ``cells`` are load and deviation of every run with a curve."""

    quantity: str
    value: str
    tolerance: str
    cells: tuple[tuple[str, str], ...]
    source: str


def compared(found: Sequence[Entry]) -> tuple[Entry, ...]:
    """The columns: runs with a curve, including LEFM, which is shown but not checked."""
    return tuple(entry for entry in found if entry.agreement is not None)


def rows(scene: Scene, found: Sequence[Entry]) -> tuple[PublishedRow, ...]:
    """A row for each published value."""
    return tuple(_row(known, scene, compared(found)) for known in scene.published)


def _row(known: Published, scene: Scene, found: Sequence[Entry]) -> PublishedRow:
    (low, high), units = known.value, Units.of(scene.units)
    loads = [published_load(known, entry.result, scene.load.opening) for entry in found]
    leg = f" on leg {known.leg}" if known.leg else ""
    value = quantity(low, units.force) if low == high else f"{number(low, 6)} to {quantity(high, units.force)}"
    return PublishedRow(
        "peak load" if known.quantity == "peak" else f"load at {quantity(known.opening, units.length)}{leg}",
        value,
        percent(known.tolerance),
        tuple((quantity(load, units.force, 4), _signed(known.deviation(load))) for load in loads),
        known.source,
    )


def _signed(deviation: float) -> str:
    return ("+" if deviation > 0 else "") + percent(deviation)
