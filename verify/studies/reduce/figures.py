"""Figures of a reduction: the curve with its toe, lines and initiation points, and the R-curves."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from verify.pages.style import HALF, Panel, colour, drawing, panel, to_svg
from verify.pages.text import Units, axis
from verify.reduction.initiation import FIVE, NL, ONSET, VIS
from verify.reduction.reduce import Reduced, Reduction
from verify.studies.reduce.bias import Bias
from verify.studies.reduce.fit import Fit

#: Scheme -> its colour in the palette, and its dashes in points.
SCHEME_INKS: dict[str, tuple[str, tuple[float, ...]]] = {
    "MBT": ("nurbs", ()),
    "CC": ("lagrange", (4.0, 1.5)),
    "MCC": ("tspline", (1.5, 1.5)),
    "CBT": ("beam", (5.0, 1.5, 1.0, 1.5)),
    "D6671": ("beam", (5.0, 1.5, 1.0, 1.5)),
    "CBBM": ("bad", ()),
    "J": ("ink", (1.0, 1.0)),
}
POINT_MARKS = {NL: "o", FIVE: "s", VIS: "^"}
#: Points of a curve that are drawn, at most: more make the page large.
MOST_DRAWN = 600


def curve(found: Reduction, units: Units, key: str, fit: Fit | None = None) -> Panel:
    """Load over opening, corrected, with the linear part, the 5 % line, and the initiation points."""
    rows, steady, part = found.rows, found.smoothed, found.part
    off = found.part.toe
    with drawing():
        figure, axes = panel(HALF, 3.4)
        some = _some(rows.load.size)
        axes.plot(rows.opening[some], rows.load[some], color=colour("muted"), linewidth=0.6, label="measured")
        if found.smoothed.load is not found.rows.load:
            axes.plot(steady.opening[some], steady.load[some], color=colour("accent"), linewidth=1.2, label="mean")
        top = float(steady.load.max())
        P = np.array([0.0, 1.05 * top])
        axes.plot(off + part.compliance * P, P, color=colour("ink"), linewidth=0.9, label="linear part")
        softer = (1.0 + ONSET.softer) * part.compliance
        axes.plot(off + softer * P, P, "--", color=colour("ink"), linewidth=0.9, label="5 % softer")
        if fit is not None:
            axes.plot(fit.opening, fit.load, color=colour("nurbs"), linewidth=1.2, label="fit")
        ends = part.rows[[0, -1]]
        axes.plot(steady.opening[ends], steady.load[ends], "|", color=colour("ink"), markersize=9)
        if found.settings.toe:
            axes.axvline(0.0, color=colour("rule"), linewidth=0.8)
        for name, i in found.points.items():
            at = steady.opening[i], steady.load[i]
            axes.plot(*at, POINT_MARKS[name], color=colour("bad"), markersize=5, label=name, fillstyle="none")
        axes.set(xlabel=axis("opening", units.length), ylabel=axis("load", units.force), ylim=(0.0, 1.12 * top))
        axes.legend(loc="best")
        svg = to_svg(figure, key, "Load over opening")
    shift = f"The toe of {found.toe:.3g} is taken off. " if found.settings.toe else ""
    return Panel(svg, f"{shift}The linear part is between the ticks; marks are the initiation points.")


def r_curves(found: Reduction, known: tuple[Bias, ...], units: Units, key: str) -> Panel | None:
    """G over crack growth, of every scheme."""
    shown = [one for one in found.schemes if one.G.size]
    if not shown:
        return None
    with drawing():
        figure, axes = panel(HALF, 3.4)
        for one in shown:
            _r_curve(axes, one)
        if known:
            axes.axhline(known[0].known, color=colour("good"), linewidth=1.0, label="input")
        highest = max(float(np.nanpercentile(one.G, 99)) for one in shown)
        axes.set(xlabel=axis("crack growth", units.length), ylabel=axis("G", units.toughness))
        axes.set_ylim(0.0, 1.3 * highest)
        axes.legend(loc="lower right")
        svg = to_svg(figure, key, "R-curves")
    return Panel(svg, "G over the growth of the crack: of the readings, or of the equivalent crack (CBBM, J without).")


def _r_curve(axes: Axes, one: Reduced) -> None:
    ink, dashes = SCHEME_INKS[one.name]
    some = _some(one.G.size)
    axes.plot(
        one.growth[some],
        one.G[some],
        color=colour(ink),
        linestyle=(0, dashes) if dashes else "solid",
        linewidth=1.1,
        marker="o" if one.G.size <= 40 else "",
        markersize=3,
        label=one.name,
    )


def _some(count: int) -> np.ndarray:
    return np.unique(np.linspace(0, count - 1, min(count, MOST_DRAWN)).astype(int)) if count else np.zeros(0, dtype=int)
