"""Tables of a scene beside those of its runs and checks; without rows where there is nothing to tell."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from math import isfinite

from verify.checks.between_codes import published_load
from verify.methods import zone_resolution
from verify.pages.style import METHOD_NAMES
from verify.pages.table import Cell, Table
from verify.pages.text import Units, number, percent, quantity
from verify.report.figures.entry import Entry
from verify.scene.schema import Scene
from verify.studies import mesh_sequences
from verify.studies.reduce import wording
from verify.studies.reduce.bias import biases, of_run
from verify.verdict import SceneReport

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


def process_zones(scene: Scene, found: Sequence[Entry], anchor: str) -> Table:
    """A row for each run with a mesh along the interface."""
    rows, unit = [], Units.of(scene.units).length
    for entry in (entry for entry in found if entry.agreement is not None):
        zone = zone_resolution.expected(entry.run.scene or scene, entry.method)
        if isfinite(zone.element):
            length = zone_resolution.measured(entry.result)
            measured = (quantity(length, unit, 2), number(length / zone.element, 2)) if isfinite(length) else ("–", "–")
            estimate = quantity(zone.element, unit, 2), quantity(zone.length, unit, 2), number(zone.elements, 2)
            rows.append((entry.cell(anchor), *estimate, *measured, _RESOLVED[zone.resolved]))
    return Table.of(_ZONE_TITLES, rows, "Length of the process zone, and elements in it, by run", "zones")


def published_values(scene: Scene, found: Sequence[Entry], anchor: str) -> Table:
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
    return Table.of(titles, rows, "Published values, and what every run found", "published")


def signed(deviation: float) -> str:
    return ("+" if deviation > 0 else "") + percent(deviation)


_SEQUENCE_TITLES = ("Quantity", "Mesh", "Unknowns", "Elements", "Value", "Change from the coarser")
_SEQUENCE_CAPTION = (
    "Sequences of meshes: the value on each, observed order, Richardson’s limit and the grid convergence index"
)


def convergence(report: SceneReport, entries: tuple[Entry, ...], anchor: str) -> Table:
    """All methods with at least three meshes: a row for each mesh, finest first, then limit and verdict."""
    rows = [row for one in mesh_sequences.sequences(report) for row in _sequence(report.scene, one, entries, anchor)]
    return Table.of(_SEQUENCE_TITLES, rows, _SEQUENCE_CAPTION, "methods told convergence", once=1)


def _sequence(
    scene: Scene, one: mesh_sequences.Sequence, entries: tuple[Entry, ...], anchor: str
) -> Iterator[tuple[str | Cell, ...]]:
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


def toughness(scene: Scene, found: Sequence[Entry]) -> Table:
    """Growth and initiation values of every scheme, of the first of these methods that is complete.

    None of them where specimen or programme have no data reduction, or no run is complete.
    """
    drawn = [entry for entry in found if entry.agreement is not None and entry.complete]
    complete = [entry for method in ("dolfinx", "nurbs", "beam") for entry in drawn if entry.method == method]
    reduction = of_run(scene, complete[0].result) if complete else None
    known = biases(reduction, scene) if reduction is not None else ()
    unit = Units.of(scene.units).toughness
    rows = [
        (
            Cell(bias.scheme.name, bias.scheme.what),
            quantity(bias.scheme.propagation.value, unit, 4),
            *map(wording.percent, (bias.propagation, bias.five, bias.nonlinear)),
        )
        for bias in known
    ]
    caption = "No data reduction"
    if known:
        went_in = quantity(known[0].known, unit, 4)
        caption = f"The curve of {complete[0].label}, reduced as that of a test; {went_in} went in"
    return Table.of(("Scheme", "Propagation", "off", "5 %/max off", "NL off"), rows, caption, "methods told")
