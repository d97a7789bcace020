"""The toughness that schemes of data reduction find in the curve of a run, against what went in."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from verify.pages.text import Units, quantity
from verify.report.figures.entry import Entry
from verify.scene.schema import Scene
from verify.studies.reduce.bias import Bias, biases, of_run
from verify.studies.reduce.wording import percent

#: Where a run is taken from, the first one that is complete.
_BEST = ("dolfinx", "nurbs", "beam")


@dataclass(frozen=True)
class ToughnessTable:
    """Of one run: name, growth and initiation values of every scheme against the toughness ``known``."""

    entry: Entry
    known: str
    rows: tuple[tuple[str, str, str, str, str, str], ...]  # scheme, what it is, G, and deviations


def table(scene: Scene, found: Sequence[Entry]) -> ToughnessTable | None:
    """None where specimen or programme have no data reduction, or no run is complete."""
    unit = Units.of(scene.units).toughness
    for method in _BEST:
        for entry in found:
            if entry.method == method and entry.agreement is not None and entry.complete:
                reduction = of_run(scene, entry.result)
                known = biases(reduction, scene) if reduction is not None else ()
                return _table(entry, known, unit) if known else None
    return None


def _table(entry: Entry, known: Sequence[Bias], unit: str) -> ToughnessTable:
    rows = (
        (
            bias.scheme.name,
            bias.scheme.what,
            quantity(bias.scheme.propagation.value, unit, 4),
            percent(bias.propagation),
            percent(bias.five),
            percent(bias.nonlinear),
        )
        for bias in known
    )
    return ToughnessTable(entry, quantity(known[0].known, unit, 4), tuple(rows))
