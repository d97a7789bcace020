"""The study as a page: growth of time and memory, and speed-ups."""

from __future__ import annotations

import re
from collections.abc import Sequence
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes

from verify.pages.parts import phase_bars
from verify.pages.style import HALF, METHOD_NAMES, WIDE, Panel, colour, drawing, panel, to_svg
from verify.runs.environment import environment
from verify.studies.page import logarithmic, write_study
from verify.studies.scaling.growth import Fit
from verify.studies.scaling.plan import DEGREES, SIZES
from verify.studies.scaling.row import PARTS, Row

if TYPE_CHECKING:
    from verify.studies.scaling.study import Study

#: Fitted columns, with their names in the table.
COLUMNS = {
    "iteration": "an iteration",
    **{name: name for name in PARTS},
    "peak_memory_mb": "peak memory",
    "model_memory_mb": "less that of the program",
}

#: Unknowns per rank above which PETSc's documentation recommends parallel runs.
WORTH = 20_000

_MARKS = {"nurbs": "o", "dolfinx": "s"}


def write(study: Study, path: Path) -> None:
    """Write the page."""
    loads = " and ".join(f"{load:.1f}" for load in study.load)
    write_study(
        study,
        path,
        {"power": power, "readable": readable},
        names=METHOD_NAMES,
        degrees=DEGREES,
        columns=COLUMNS,
        parts=PARTS,
        growth=[time_of_an_iteration(study, "time"), memory(study, "memory")] if study.growth else [],
        bars=strong(_strong(study.rows), "strong") if study.shared else None,
        programme=(SIZES.way, SIZES.steps),
        worth=WORTH,
        environment=environment() | {"load average at the beginning and at the end": loads},
    )


def power(one: Fit) -> str:
    """1.02 ± 0.01."""
    return str(one).replace("+-", "±").replace("-", "−").replace("?", "–")


def readable(text: str) -> str:
    """A sentence of the command line with typographic signs: ± and ×."""
    return re.sub(r"(?<=\d) x\b", " ×", text.replace("+-", "±"))


def time_of_an_iteration(study: Study, key: str) -> Panel:
    """Time of an iteration and of its parts over the unknowns, with the fitted lines."""
    with drawing():
        figure, axes = panel(HALF, 3.4)
        for method in study.methods:
            ladder, fits = study.ladder(method), study.growth[method]
            n = np.array([one.dofs for one in ladder])
            _points(axes, n, np.array([one.iteration for one in ladder]), fits["iteration"], method)
            for part, dashes in (("assembly", (4, 2)), ("factor", (1, 1.5))):
                value = [getattr(one, part) for one in ladder]
                axes.plot(n, value, linewidth=0.8, dashes=dashes, color=colour(method), label=f"its {part}")
        logarithmic(axes, "unknowns", "seconds")
        axes.legend(loc="upper left")
        svg = to_svg(figure, key, "Time of a Newton iteration against unknowns")
    return Panel(svg, "Time of a Newton iteration on one core: measured, with the power law through all sizes.")


def memory(study: Study, key: str) -> Panel:
    """Memory over the unknowns: the total, and the part beyond that of the program."""
    with drawing():
        figure, axes = panel(HALF, 3.4)
        for method in study.methods:
            ladder = study.ladder(method)
            n, peak = (np.array([getattr(one, what) for one in ladder]) for what in ("dofs", "peak_memory_mb"))
            added = np.array([study.value(one, "model_memory_mb") for one in ladder])
            _points(axes, n, added, study.growth[method]["model_memory_mb"], method)
            axes.plot(n, peak, linewidth=0.8, dashes=(4, 2), color=colour(method), label="with the program")
        logarithmic(axes, "unknowns", "MB")
        axes.legend(loc="upper left")
        svg = to_svg(figure, key, "Peak memory against unknowns")
    return Panel(svg, "Peak memory of a run: what the mesh adds to that of the program, and both together.")


def strong(rows: Sequence[Row], key: str) -> Panel:
    """Bars of the time of an iteration by its parts, on one rank and on more."""
    with drawing():
        figure, axes = panel(WIDE, 0.32 * len(rows) + 0.95, left=2.1, top=0.4)
        labels = [f"{row.dofs} unknowns, {ranks(row.ranks)}" for row in rows]
        phase_bars(axes, labels, {name: [getattr(row, name) for row in rows] for name in PARTS})
        axes.set(xlabel="seconds")
        figure.legend(loc="upper center", ncols=len(PARTS), handlelength=0.9, columnspacing=1.2, handletextpad=0.4)
        svg = to_svg(figure, key, "Time of a Newton iteration on one rank and on more")
    return Panel(svg, "DOLFINx: time of a Newton iteration, measured on the first rank.", "wide")


def ranks(n: int) -> str:
    return "1 rank" if n == 1 else f"{n} ranks"


def _strong(rows: Sequence[Row]) -> list[Row]:
    """The rows of those sizes that were run on several ranks."""
    ours = [one for one in rows if one.measured and one.method == "dolfinx"]
    sizes = {one.elements for one in ours if one.ranks > 1}
    return sorted((one for one in ours if one.elements in sizes), key=lambda one: (one.dofs, one.ranks))


def _points(axes: Axes, n: np.ndarray, value: np.ndarray, law: Fit, method: str) -> None:
    axes.plot(n, value, _MARKS[method], markersize=4, color=colour(method))
    if isfinite(law.exponent):
        name = f"{METHOD_NAMES[method]}: {law.exponent:.2f}"
        axes.plot(n, law.factor * n**law.exponent, linewidth=1.0, color=colour(method), label=name)
