"""A reduction as a page: the curve with its toe, lines and initiation points, the R-curves, and tables."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes

from verify.pages.style import HALF, Panel, colour, drawing, panel, to_svg
from verify.pages.table import Cell, Table
from verify.pages.template import rendered
from verify.pages.text import Units, axis, quantity
from verify.reduction.initiation import FIVE, NL, ONSET, VIS
from verify.reduction.reduce import Reduction
from verify.scene.schema import Scene
from verify.studies.reduce.bias import Bias
from verify.studies.reduce.fit import Fit
from verify.studies.reduce.wording import cells, facts, heads, remarks

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


def write(
    found: Reduction, known: tuple[Bias, ...], scene: Scene, source: str, path: Path, fit: Fit | None = None
) -> None:
    """Write the page; ``source`` is the file that was reduced."""
    units, of = Units.of(scene.units), found.coupon
    thick = " and ".join(quantity(h, units.length) for h in dict.fromkeys(of.thickness))
    width, precrack = quantity(of.width, units.length), quantity(of.precrack, units.length)
    unit = f", in {units.toughness}" if units.toughness else ""
    caption = f"G by every scheme{unit}, with the half width of its 95 % interval; the propagation value is the mean "
    rows = [
        (Cell(one.name), Cell(one.missing, tone="absent"))
        if one.missing
        else (Cell(one.name, one.what), *cells(one, known)[1:])
        for one in sorted(found.schemes, key=lambda one: bool(one.missing))
    ]
    page = rendered(
        "verify.studies.reduce",
        "page.html.j2",
        {},
        source=Path(source).name,
        sentence=f"The {of.kind} specimen of the scene {scene.name}: arms {thick} thick, {width} wide, "
        f"precrack {precrack}.",
        panels=[*_r_curves(found, known, units), _curve(found, units, fit)],
        schemes=Table.of(heads(known), rows, f"{caption}while the crack grows.").html(),
        facts=Table.of(
            ("", ""), facts(found), "Linear part, corrections, and numbers of the schemes", "environment"
        ).html(),
        remarks=remarks(found),
        fit=fit,
    )
    path.write_text(page, encoding="utf-8")


def _curve(found: Reduction, units: Units, fit: Fit | None) -> Panel:
    """Load over opening, corrected, with the linear part, the 5 % line, and the initiation points."""
    rows, steady, part = found.rows, found.smoothed, found.part
    ink, top = colour("ink"), float(steady.load.max())
    P = np.array([0.0, 1.05 * top])
    with drawing():
        figure, axes = panel(HALF, 3.4)
        _plot(axes, rows.opening, rows.load, color=colour("muted"), linewidth=0.6, label="measured")
        if not rows.virtual:
            _plot(axes, steady.opening, steady.load, color=colour("accent"), linewidth=1.2, label="mean")
        linear = ((0.0, "-", "linear part"), (ONSET.softer, "--", "5 % softer")) if part.rows.size else ()
        for softer, style, label in linear:
            axes.plot(part.toe + (1.0 + softer) * part.compliance * P, P, style, color=ink, linewidth=0.9, label=label)
        if fit is not None:
            axes.plot(fit.opening, fit.load, color=colour("nurbs"), linewidth=1.2, label="fit")
        ends = part.rows[[0, -1]] if part.rows.size else part.rows
        axes.plot(steady.opening[ends], steady.load[ends], "|", color=ink, markersize=9)
        if found.settings.toe:
            axes.axvline(0.0, color=colour("rule"), linewidth=0.8)
        for name, i in found.points.items():
            at = steady.opening[i], steady.load[i]
            axes.plot(*at, POINT_MARKS[name], color=colour("bad"), markersize=5, label=name, fillstyle="none")
        axes.set(xlabel=axis("opening", units.length), ylabel=axis("load", units.force), ylim=(0.0, 1.12 * top))
        axes.legend(loc="best")
        svg = to_svg(figure, "reduce-curve", "Load over opening")
    if not part.rows.size:
        return Panel(svg, "Readings of a growing crack, without a linear part.")
    shift = f"The toe of {found.toe:.3g} is taken off. " if found.settings.toe else ""
    return Panel(svg, f"{shift}The linear part is between the ticks; marks are the initiation points.")


def _r_curves(found: Reduction, known: tuple[Bias, ...], units: Units) -> list[Panel]:
    """G over crack growth, of every scheme."""
    shown = [one for one in found.schemes if one.G.size]
    if not shown:
        return []
    with drawing():
        figure, axes = panel(HALF, 3.4)
        for one in shown:
            ink, dashes = SCHEME_INKS[one.name]
            style = {"linestyle": (0, dashes) if dashes else "solid", "marker": "o" if one.G.size <= 40 else ""}
            _plot(axes, one.growth, one.G, color=colour(ink), linewidth=1.1, markersize=3, label=one.name, **style)
        if (curve := found.r_curve) is not None:
            x = np.array([0.0, curve.length, max(float(np.max(one.growth)) for one in shown)])
            line = curve.initiation, curve.plateau, curve.plateau
            axes.plot(x, line, color=colour("ink"), linewidth=2.0, label="initiation, plateau")
        if known:
            axes.axhline(known[0].known, color=colour("good"), linewidth=1.0, label="input")
        axes.set(xlabel=axis("crack growth", units.length), ylabel=axis("G", units.toughness))
        axes.set_ylim(0.0, 1.3 * max(float(np.nanpercentile(one.G, 99)) for one in shown))
        axes.legend(loc="lower right")
        svg = to_svg(figure, "reduce-growth", "R-curves")
    caption = "G over the growth of the crack: of the readings, or of the equivalent crack (CBBM, J without)."
    return [Panel(svg, caption)]


def _plot(axes: Axes, x: np.ndarray, y: np.ndarray, **style: object) -> None:
    """At most `MOST_DRAWN` points of a curve."""
    some = np.unique(np.linspace(0, x.size - 1, min(x.size, MOST_DRAWN)).astype(int))
    axes.plot(x[some], y[some], **style)  # type: ignore[arg-type]
