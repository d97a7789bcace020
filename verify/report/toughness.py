"""The toughness that schemes of data reduction find in the curve of a run, against what went in."""

from __future__ import annotations

from collections.abc import Sequence

from verify.pages.table import Cell, Table
from verify.pages.text import Units, quantity
from verify.report.figures.entry import Entry
from verify.scene.schema import Scene
from verify.studies.reduce.bias import biases, of_run
from verify.studies.reduce.wording import percent


def table(scene: Scene, found: Sequence[Entry]) -> Table | None:
    """Growth and initiation values of every scheme, of the first of these methods that is complete.

    None where specimen or programme have no data reduction, or no run is complete.
    """
    drawn = [entry for entry in found if entry.agreement is not None and entry.complete]
    complete = [entry for method in ("dolfinx", "nurbs", "beam") for entry in drawn if entry.method == method]
    reduction = of_run(scene, complete[0].result) if complete else None
    known = biases(reduction, scene) if reduction is not None else ()
    if not known:
        return None
    unit = Units.of(scene.units).toughness
    rows = [
        (
            Cell(bias.scheme.name, bias.scheme.what),
            quantity(bias.scheme.propagation.value, unit, 4),
            *map(percent, (bias.propagation, bias.five, bias.nonlinear)),
        )
        for bias in known
    ]
    went_in = quantity(known[0].known, unit, 4)
    caption = f"The curve of {complete[0].label}, reduced as that of a test; {went_in} went in"
    return Table.of(("Scheme", "Propagation", "off", "5 %/max off", "NL off"), rows, caption, "methods told")
