"""The study as a page: the statements, the budget of each as bars, and both curves with a band."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from verify.curves.curve import envelope, from_origin
from verify.pages.style import HALF, WIDE, Line, Panel, colour, drawing, panel, to_svg
from verify.pages.text import Units, axis
from verify.studies.page import write_study
from verify.studies.validation.band import band
from verify.studies.validation.quantities import WINDOWS
from verify.studies.validation.statement import COVERAGE, Curves, Statement

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
BAND_POINTS = 600


def write(study: Study, path: Path) -> None:
    """Write the page."""
    bars = [budget(one, f"budget-{i}") for i, one in enumerate(study.statements)]
    curves = [drawn(study, study.curves, "curves")] if study.curves is not None else []
    filters = {"signed": signed, "share": share}
    write_study(study, path, filters, bars=bars, curves=curves, kinds=KINDS, coverage=COVERAGE)


def signed(part: float) -> str:
    """A percentage with sign, such as +3.1 %."""
    return f"{100 * part:+.2f}\u00a0%".replace("-", "−") if np.isfinite(part) else "–"


def share(part: float) -> str:
    """A percentage without sign, such as 0.31 %."""
    return f"{100 * abs(part):.2f}\u00a0%" if np.isfinite(part) else "–"


def drawn(study: Study, curves: Curves, key: str) -> Panel:
    """Both curves, and the band of the expanded uncertainty around that of the simulation."""
    units = Units.of(study.scene.units)
    data = study.data.result
    with drawing():
        figure, axes = panel(WIDE, 3.4)
        grid = np.linspace(0.0, WINDOWS.whole * float(np.max(envelope(*curves.scene)[0])), BAND_POINTS)
        load, u = band(curves, study.known, grid)
        axes.fill_between(
            grid, load - COVERAGE * u, load + COVERAGE * u, color=colour("accent"), alpha=0.25, linewidth=0
        )
        axes.plot(*envelope(*curves.scene), color=colour("accent"), linewidth=1.2, label=f"S: {study.method}")
        of_data = Line("ink", 1.0, (3.0, 1.5), 1.0, 4.0)
        axes.plot(*from_origin(data.opening, data.load), **of_data.options(), label=f"D: {study.data.name}")
        axes.set(xlabel=axis("opening", units.length), ylabel=axis("load", units.force), xlim=(0, None), ylim=(0, None))
        axes.legend(loc="best")
        svg = to_svg(figure, key, "Load against opening of the simulation and of the data")
    caption = (
        f"The simulation S with {COVERAGE:g} times the standard uncertainty of inputs, introduction of the load and "
        "data at each opening, without that of the mesh; and the data D."
    )
    return Panel(svg, caption, "wide")


def budget(one: Statement, key: str) -> Panel:
    """Bars of the standard uncertainties of a quantity, and of u_val."""
    shown = [(part.name, abs(one.part(part.u)), KINDS[part.kind][1]) for part in one.parts]
    shown.append(("u_val", one.part(one.u_val), "ink"))
    with drawing():
        figure, axes = panel(HALF, 0.24 * len(shown) + 0.75, left=1.55)
        at = np.arange(len(shown))[::-1]
        size = np.array([100 * value for _, value, _ in shown])
        axes.barh(at, size, 0.6, color=[colour(ink) for _, _, ink in shown], linewidth=0)
        for y, x in zip(at, size, strict=True):
            axes.annotate(f"{x:.2f}", (x, y), (3, 0), textcoords="offset points", va="center", size=7)
        axes.set_yticks(at, [name.rpartition(".")[2] if "data." not in name else name for name, _, _ in shown])
        axes.grid(False, axis="y")
        axes.set(xlabel="standard uncertainty (% of D)", xlim=(0.0, 1.15 * max(float(np.max(size)), 1e-3)))
        svg = to_svg(figure, key, f"Budget of the {one.quantity}")
    return Panel(svg, f"{one.quantity[:1].upper()}{one.quantity[1:]}: what makes its uncertainty.")
