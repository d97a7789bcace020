"""The toughness that schemes of data reduction find in the curve of a run, against what went in."""

from __future__ import annotations

from collections.abc import Sequence

from verify.pages.table import Cell, Column, Table
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
    columns = (
        Column("scheme", "Scheme", lambda scheme: Cell(scheme.name, scheme.what)),
        Column("scheme", "Propagation", lambda scheme: quantity(scheme.propagation.value, unit, 4)),
        Column("propagation", "off", percent),
        Column("five", "5 %/max off", percent),
        Column("nonlinear", "NL off", percent),
    )
    went_in = quantity(known[0].known, unit, 4)
    caption = f"The curve of {complete[0].label}, reduced as that of a test; {went_in} went in"
    return Table(columns, known, caption, kind="methods told")
