"""Tables and sentences of a scene beside those of its runs and checks, empty where there is nothing to tell; the words
for the state of checks."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from math import degrees, isfinite

from verify.checks import matched
from verify.checks.between_codes import published_load
from verify.methods import zone_resolution
from verify.methods.solve import prepare
from verify.pages.style import METHOD_NAMES
from verify.pages.table import Cell, Table, of_state
from verify.pages.text import Units, number, percent, quantity
from verify.report.figures.entry import Entry
from verify.scene.effects import simulated
from verify.scene.schema import Scene
from verify.studies import mesh_sequences
from verify.studies.reduce import wording
from verify.studies.reduce.bias import biases, of_run
from verify.verdict import Check, Counts, SceneReport

#: Kind of a check -> the evidence behind it, in words.
EVIDENCE = {
    "exact": "An identity that any solution must meet. Nothing else is needed to judge it.",
    "analytical": "Against a closed form or the cohesive-beam solution, which rests on beam theory.",
    "certified": "Against values of two codes on three meshes each, with a stated uncertainty; kept, not run again.",
    "cross-code": "Against another code or a published value: two programs that share nothing but the problem.",
    "regression": "Against this code, earlier: says that nothing has changed, not that it is right.",
}

#: Whether the estimated zone is resolved.
_RESOLVED = {True: Cell("✓ fine enough", tone="good"), False: Cell("⚠ fewer than 3 elements", tone="bad")}


def mark(check: Check) -> Cell:
    """The state, and why it cannot be judged."""
    return of_state(check.state, check.unresolved)


def headline(counts: Counts, scenes: int) -> str:
    """The verdict in one line."""
    total = counts.total
    where = f"on {scenes} scene{'s' if scenes != 1 else ''}"
    if not total:
        return f"No check was made {where}"
    if counts.held == total:
        return f"All {total} checks hold {where}" if total > 1 else f"The one check holds {where}"
    broken = f"{counts.broken or 'none'} {'are' if counts.broken > 1 else 'is'} broken"
    open_ones = counts.unresolved + counts.not_covered
    return f"{counts.held} of {total} checks hold {where}, {broken}" + f"; {open_ones} not judged" * bool(open_ones)


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
    zones = ("Estimated zone", "in elements", "Measured zone", "in elements")
    titles = ("Run", "Element along the bond", *zones, "Mesh")
    return Table.of(titles, rows, "Length of the process zone, and elements in it, by run", "zones")


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
        cells = []
        for entry in runs:
            load = published_load(known, entry.result, scene.load.opening)
            off = known.deviation(load)
            cells.append(Cell(quantity(load, units.force, 4), "+" * (off > 0) + percent(off)))
        rows.append((Cell(at, known.source), value, percent(known.tolerance), *cells))
    return Table.of(titles, rows, "Published values, and what every run found", "published")


def convergence(report: SceneReport, entries: tuple[Entry, ...], anchor: str) -> Table:
    """All methods with at least three meshes: a row for each mesh, finest first, then limit and verdict."""
    rows = [row for one in mesh_sequences.sequences(report) for row in _sequence(report.scene, one, entries, anchor)]
    titles = ("Quantity", "Mesh", "Unknowns", "Elements", "Value", "Change from the coarser")
    caption = (
        "Sequences of meshes: the value on each, observed order, Richardson’s limit and the grid convergence index"
    )
    return Table.of(titles, rows, caption, "methods told convergence", once=1)


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


def matched_interfaces(scene: Scene, found: Sequence[Entry]) -> tuple[str, ...]:
    """A sentence on the error of a matched interface for each DOLFINx run of a peel test with finite kinematics."""
    if not scene.specimen.clamped or simulated(scene)["kinematics"] == "linear":
        return ()
    return tuple(_matched(scene, one) for one in found if one.method == "dolfinx" and one.agreement is not None)


def _matched(scene: Scene, entry: Entry) -> str:
    found = matched.of_run(prepare(entry.run.scene or scene, entry.method), entry.result)
    how = f"{entry.label} keeps its pairs of points and measures gaps along the undeformed normal"
    if found is None:
        return f"{how}; the error of that is unknown, as the run kept no fields"
    what = (
        f"In the fields that were kept the substrate tilts by at most {number(degrees(found.tilt), 2)}° where it is "
        f"pulled; along its own normal gaps would change by {percent(found.gap)} of g_u in the process zone, and "
        f"tractions would pull lengthwise with {percent(found.pull)} of the load"
    )
    bound, most = percent(found.bound), percent(matched.NEGLIGIBLE)
    then = (
        f"This changes G_Ic and load by at most {bound}"
        if found.valid
        else f"Not valid here: this may change G_Ic and load by {bound}, more than {most}, so its distance to a code "
        "that follows the surfaces is not meaningful"
    )
    return f"{how}. {what}. {then}"
