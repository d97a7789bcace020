"""The study as a page: the statements, the budget of each as bars, and both curves with a band."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from verify.curves.curve import Curve, envelope, from_origin
from verify.pages.style import HALF, WIDE, Line, Panel, colour, drawing, panel, to_svg
from verify.pages.text import Units, axis
from verify.studies.page import write_study
from verify.studies.uncertainty import Runs, percent
from verify.studies.validation.quantities import WINDOWS, mean_load
from verify.studies.validation.statement import ESTIMATES, Statement, statement

if TYPE_CHECKING:
    from verify.studies.validation.study import Study

#: Colour of a bar by the kind of its part, with the name of the kind.
KINDS = {
    "num": ("numerical", "phase-assembly"),
    "input": ("input", "nurbs"),
    "introduction": ("load introduction", "beam"),
    "data": ("data", "lagrange"),
}

#: Points of the band.
BAND_POINTS = 200


def write(study: Study, path: Path) -> None:
    """Write the page."""
    bars = [budget(one, f"budget-{i}") for i, one in enumerate(study.found)]
    curves = [drawn(study, study.curves)] if study.curves is not None else []
    write_study(study, path, {"percent": percent}, bars=bars, curves=curves, kinds=KINDS, coverage=ESTIMATES.coverage)


def drawn(study: Study, curves: Runs[Curve]) -> Panel:
    """Both curves, and the band of the expanded uncertainty around that of the simulation.

    The mesh is left out: its index describes single quantities, and not a steep drop that moves a little.
    """
    units, data, simulated = Units.of(study.scene.units), study.data.result, envelope(*curves["mesh"][0])
    grid = np.linspace(0.0, WINDOWS.whole * float(np.max(simulated[0])), BAND_POINTS)
    each = [statement(mean_load(np.array([x])), curves, (), curves["mesh"][0], study.plan.stated) for x in grid]
    low, high = zip(*((one.S + end for end in one.interval) for one in each), strict=True)
    with drawing():
        figure, axes = panel(WIDE, 3.4)
        axes.fill_between(grid, low, high, color=colour("accent"), alpha=0.25, linewidth=0)
        axes.plot(*simulated, color=colour("accent"), linewidth=1.2, label=f"S: {study.plan.base.method}")
        of_data = Line("ink", 1.0, (3.0, 1.5), 1.0, 4.0)
        axes.plot(*from_origin(data.opening, data.load), **of_data.options(), label=f"D: {study.data.name}")
        axes.set(xlabel=axis("opening", units.length), ylabel=axis("load", units.force), xlim=(0, None), ylim=(0, None))
        axes.legend(loc="best")
        svg = to_svg(figure, "curves", "Load against opening of the simulation and of the data")
    caption = (
        f"The simulation S with {ESTIMATES.coverage:g} times the standard uncertainty of inputs, introduction of the "
        "load and data at each opening, without that of the mesh; and the data D."
    )
    return Panel(svg, caption, "wide")


def budget(one: Statement, key: str) -> Panel:
    """Bars of the standard uncertainties of a quantity, and of u_val."""
    shown = [
        (part.name if part.kind == "data" else part.name.rpartition(".")[2], abs(part.u), KINDS[part.kind][1])
        for part in one.parts
    ]
    names, sizes, inks = zip(*shown, ("u_val", one.u_val, "ink"), strict=True)
    with drawing():
        figure, axes = panel(HALF, 0.24 * len(names) + 0.75, left=1.55)
        at, size = np.arange(len(names))[::-1], 100.0 * one.part(1.0) * np.array(sizes)
        axes.barh(at, size, 0.6, color=[colour(ink) for ink in inks], linewidth=0)
        for y, x in zip(at, size, strict=True):
            axes.annotate(f"{x:.2f}", (x, y), (3, 0), textcoords="offset points", va="center", size=7)
        axes.set_yticks(at, names)
        axes.grid(False, axis="y")
        axes.set(xlabel="standard uncertainty (% of D)", xlim=(0.0, 1.15 * max(float(np.max(size)), 1e-3)))
        svg = to_svg(figure, key, f"Budget of the {one.quantity}")
    return Panel(svg, f"{one.quantity[:1].upper()}{one.quantity[1:]}: what makes its uncertainty.")
