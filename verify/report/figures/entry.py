"""A run with its line style and its distance to the reference."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from verify.curves.curve import curve_error, oscillation, peak
from verify.curves.leg_checks import worst_leg
from verify.pages.style import IN_TABLES, METHOD_NAMES, Line, line
from verify.pages.table import Cell
from verify.pages.text import percent
from verify.result import Result
from verify.verdict import Run, SceneReport


@dataclass(frozen=True)
class Agreement:
    """One run against the reference run of its scene; distances are NaN where there is none."""

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
        return METHOD_NAMES.get(self.method, self.method)

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
    runs = sorted(report.runs, key=lambda run: rank(run.method))
    reference, kinds, found = _reference(runs), list[str](), []
    for run in runs:
        kinds.append(run.method if run.method in IN_TABLES else "")  # the others share a line
        repeat, curve = kinds.count(kinds[-1]) - 1, _curve(run)
        compared = None if curve is None else _agreement(curve, run.method, reference, report.scene.load.opening)
        is_reference = reference is not None and curve is reference
        found.append(Entry(run, repeat, line(run.method, repeat), compared, is_reference))
    return tuple(found)


def _curve(run: Run) -> Result | None:
    """The result of a run, where there is a curve to draw."""
    return run.result if run.result is not None and len(run.result.opening) > 1 else None


def _reference(runs: Sequence[Run]) -> Result | None:
    """The finest run of DOLFINx, or else of the cohesive beam; never LEFM, which is a limit."""
    for method in ("dolfinx", "beam"):
        complete = [one for run in runs if run.method == method and (one := _curve(run)) and one.complete]
        if complete:
            return max(complete, key=lambda one: one.dofs)
    return None


def _agreement(result: Result, method: str, reference: Result | None, programme: Sequence[float]) -> Agreement:
    curve = result.opening, result.load
    (peak_opening, peak_load), end = peak(curve), float(np.max(result.opening))
    if reference is None or result is reference or method == "lefm":
        return Agreement(math.nan, math.nan, peak_load, peak_opening, end)
    base, end = (reference.opening, reference.load), min(end, float(np.max(reference.opening)))
    error = max(curve_error(curve, base, end, drops=True), worst_leg(curve, base, programme))
    return Agreement(error, oscillation(curve, base, end)["rms"], peak_load, peak_opening, end)
