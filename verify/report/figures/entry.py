"""A run with its line style and its distance to the reference."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from verify.curves.curve import Curve, curve_error, oscillation, peak
from verify.curves.leg_checks import worst_leg
from verify.pages.style import IN_TABLES, METHOD_NAMES, Line, line
from verify.pages.table import Cell
from verify.pages.text import percent
from verify.result import Result
from verify.verdict import Run, SceneReport


@dataclass(frozen=True)
class Agreement:
    """One run against the reference run of its scene."""

    error: float  # relative L2 of the load over the opening; where the programme turns, the largest one of its legs
    oscillation: float  # RMS of load / reference - 1 on the propagation branch, mean removed
    peak_load: float
    peak_opening: float
    end: float  # compared up to this opening


@dataclass(frozen=True, eq=False)
class Entry:
    """A run on the page; ``agreement`` is None for a run without a curve."""

    run: Run
    repeat: int  # how many runs of the same method come before, or of methods of other packages and other codes
    line: Line
    agreement: Agreement | None
    is_reference: bool

    @property
    def method(self) -> str:
        return self.run.method

    @property
    def label(self) -> str:
        return self.run.label

    @property
    def name(self) -> str:
        """The method's name."""
        return METHOD_NAMES.get(self.run.method, self.run.method)

    @property
    def beside_its_numbers(self) -> str:
        """The label where its number of unknowns stands beside it."""
        dofs = self.run.result.dofs if self.run.result is not None else 0
        return self.label.removesuffix(f", {dofs} unknowns")

    @property
    def legend(self) -> str:
        """The label, marked for LEFM, whose curve is a limit."""
        return f"{self.label} (limit)" if self.method == "lefm" else self.label

    @property
    def result(self) -> Result:
        assert self.run.result is not None, "entries with an agreement alone are drawn"
        return self.run.result

    @property
    def compared(self) -> bool:
        """Whether there is a distance to the reference; not of the reference itself and of LEFM."""
        return self.agreement is not None and self.agreement.error == self.agreement.error

    @property
    def distance(self) -> str:
        """The distance to the reference, or why there is none."""
        if self.agreement is not None and self.compared:
            return percent(self.agreement.error)
        return "reference" if self.is_reference else "limit, not compared" if self.method == "lefm" else "no reference"

    def cell(self, anchor: str, text: str = "") -> Cell:
        """Its label in a table, with its line, linked to its folder and command in the section ``anchor``."""
        return Cell(text or self.label, link=f"#{anchor}-run-{self.run.name}", line=self.line)

    @property
    def complete(self) -> bool:
        return self.run.result is not None and self.run.result.complete


def rank(method: str) -> int:
    """Position of a method in tables and legends."""
    return IN_TABLES.index(method) if method in IN_TABLES else len(IN_TABLES)


def short_names(among: Sequence[Entry]) -> dict[Entry, str]:
    """The method's name of each run, or its label where several runs have the same method."""
    methods = [entry.method for entry in among]
    return {entry: entry.label if methods.count(entry.method) > 1 else entry.name for entry in among}


def entries(report: SceneReport) -> tuple[Entry, ...]:
    """All runs of a scene, the reference method first, LEFM last."""
    reference = reference_run(report)
    seen: dict[str, int] = {}
    found = []
    for run in sorted(report.runs, key=lambda run: rank(run.method)):
        kind = run.method if run.method in IN_TABLES else ""  # the others share a line
        repeat = seen.get(kind, 0)
        seen[kind] = repeat + 1
        compared = agreement(run, reference, report.scene.load.opening) if usable(run) else None
        found.append(Entry(run, repeat, line(run.method, repeat), compared, run is reference))
    return tuple(found)


def usable(run: Run) -> bool:
    """Whether there is a curve to draw."""
    return run.result is not None and len(run.result.opening) > 1


def reference_run(report: SceneReport) -> Run | None:
    """The reference of the scene: DOLFINx, or else the cohesive beam; never LEFM, which is a limit."""
    for method in ("dolfinx", "beam"):
        runs = [run for run in report.runs if run.method == method and usable(run)]
        complete = [(run.result.dofs, run) for run in runs if run.result is not None and run.result.complete]
        if complete:
            return max(complete, key=lambda one: one[0])[1]
    return None


def agreement(run: Run, reference: Run | None, programme: Sequence[float]) -> Agreement:
    """The measures of one run; distances are NaN without a reference, for the reference itself and for LEFM."""
    curve, base = (_curve(one) for one in (run, reference or run))
    (peak_opening, peak_load), end = peak(curve), float(np.max(curve[0]))
    if reference is None or run is reference or run.method == "lefm":
        return Agreement(math.nan, math.nan, peak_load, peak_opening, end)
    end = min(end, float(np.max(base[0])))
    error = max(curve_error(curve, base, end, drops=True), worst_leg(curve, base, programme))
    return Agreement(error, oscillation(curve, base, end)["rms"], peak_load, peak_opening, end)


def _curve(run: Run) -> Curve:
    assert run.result is not None, "usable runs alone have a curve"
    return run.result.opening, run.result.load
