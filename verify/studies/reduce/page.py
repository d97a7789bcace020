"""A reduction as a page: the curve with its toe, lines and initiation points, the R-curves, and tables."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes

from verify.pages.style import HALF, Panel, colour, drawing, panel
from verify.pages.table import Cell, Table
from verify.pages.text import Units, axis, quantity
from verify.reduction.initiation import FIVE, NL, ONSET, VIS
from verify.reduction.reduce import Reduced, Reduction
from verify.scene.bond.opening import law_of
from verify.scene.schema import Scene
from verify.studies.page import write_template
from verify.studies.reduce.bias import Bias
from verify.studies.reduce.bridging import Bridging
from verify.studies.reduce.fit import Fit
from verify.studies.reduce.wording import cells, facts, heads, remarks
from verify.theory.law import KnownLaw

#: Scheme -> its colour in the palette, and its dashes in points.
SCHEME_INKS: dict[str, tuple[str, tuple[float, ...]]] = {
    "MBT": ("nurbs", ()),
    "CC": ("lagrange", (4.0, 1.5)),
    "MCC": ("tspline", (1.5, 1.5)),
    "CBT": ("beam", (5.0, 1.5, 1.0, 1.5)),
    "D6671": ("beam", (5.0, 1.5, 1.0, 1.5)),
    "CBBM": ("bad", ()),
    "J": ("ink", (1.0, 1.0)),
    "peel": ("nurbs", ()),
}
POINT_MARKS = {NL: "o", FIVE: "s", VIS: "^"}
LAW_INKS = {"law": "nurbs", "input": "good", "test": "muted"}
BRIDGING_CAPTIONS = (
    "The law; what stands for the tip goes on above the drawing.",
    "J over the end opening, corrected; its slope is the law.",
    "The test, and the curve that the beam draws with the law.",
)
#: Points of a curve that are drawn, at most: more make the page large; and of an R-curve with marks.
MOST_DRAWN, MARKED = 600, 40


def write(
    found: Reduction,
    known: tuple[Bias, ...],
    scene: Scene,
    source: str,
    path: Path,
    models: Sequence[Fit | Bridging] = (),
) -> None:
    """Write the page; ``source`` is the file that was reduced."""
    units, of = Units.of(scene.units), found.coupon
    arms, bodies = ("strip", of.thickness[:1]) if of.kind == "peel" else ("arms", of.thickness)
    thick = " and ".join(quantity(h, units.length) for h in dict.fromkeys(bodies))
    width, precrack = quantity(of.width, units.length), quantity(of.precrack, units.length)
    unit = f", in {units.toughness}" if units.toughness else ""
    caption = f"G by every scheme{unit}, with the half width of its 95 % interval; the propagation value is the mean "
    rows = [
        (Cell(one.name), Cell(one.missing, tone="absent"))
        if one.missing
        else (Cell(one.name, one.what), *cells(one, known)[1:])
        for one in sorted(found.schemes, key=lambda one: bool(one.missing))
    ]
    write_template(
        "verify.studies.reduce",
        path,
        source=Path(source).name,
        sentence=f"The {of.kind} specimen of the scene {scene.name}: {arms} {thick} thick, {width} wide, "
        f"precrack {precrack}.",
        panels=[*_r_curves(found, known, units), _curve(found, units, models)],
        schemes=Table.of(heads(known), rows, f"{caption}while the crack grows.").html(),
        facts=Table.of(
            ("", ""), facts(found), "Linear part, corrections, and numbers of the schemes", "environment"
        ).html(),
        remarks=remarks(found),
        models=[(one, _bridging(one, known, scene, units) if isinstance(one, Bridging) else []) for one in models],
    )


def _curve(found: Reduction, units: Units, models: Sequence[Fit | Bridging]) -> Panel:
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
        for fit in (one for one in models if isinstance(one, Fit)):
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
        shift = f"The toe of {found.toe:.3g} is taken off. " if found.settings.toe else ""
        caption = f"{shift}The linear part is between the ticks; marks are the initiation points."
        caption = caption if part.rows.size else "Rows of a growing crack, without a linear part."
        return Panel.of(figure, "reduce-curve", "Load over opening", caption)


def _r_curves(found: Reduction, known: tuple[Bias, ...], units: Units) -> list[Panel]:
    """G over crack growth, of every scheme."""
    shown = [one for one in found.schemes if one.G.size]
    if not shown:
        return []
    with drawing():
        figure, axes = panel(HALF, 3.4)
        for one in shown:
            ink, dashes = SCHEME_INKS[one.name]
            of_growth(axes, one, one.name, color=colour(ink), linestyle=(0, dashes) if dashes else "solid")
        if (curve := found.r_curve) is not None:
            x = np.array([0.0, curve.length, max(float(np.max(one.growth)) for one in shown)])
            line = curve.initiation, curve.plateau, curve.plateau
            axes.plot(x, line, color=colour("ink"), linewidth=2.0, label="initiation, plateau")
        if known:
            axes.axhline(known[0].known, color=colour("good"), linewidth=1.0, label="input")
        axes.set(xlabel=axis("crack growth", units.length), ylabel=axis("G", units.toughness))
        axes.set_ylim(0.0, 1.3 * max(float(np.nanpercentile(one.G, 99)) for one in shown))
        axes.legend(loc="lower right")
        caption = "G over the growth of the crack: of the readings, or of the equivalent crack (CBBM, J without)."
        return [Panel.of(figure, "reduce-growth", "R-curves", caption)]


def _bridging(found: Bridging, known: tuple[Bias, ...], scene: Scene, units: Units) -> list[Panel]:
    """The law, J over the end opening, and load over opening of the test and of the law; with the law of the scene."""
    law, made, w = found.law, [], np.linspace(0.0, 1.1 * found.law.opens, MOST_DRAWN)
    named = {"law": law_of(found.scene), **({"input": law_of(scene)} if known else {})}
    laws = {label: one for label, one in named.items() if isinstance(one, KnownLaw)}
    opens, top = axis("end opening", units.length), 2.0 * float(law.traction(law.first))
    tractions = {label: (w, one.traction(w)) for label, one in laws.items()}
    areas = {label: (w, one.area(w)) for label, one in laws.items()}
    back = {"test": found.measured, "law": found.solved}
    drawn = (
        ("Traction over end opening", opens, axis("traction", units.stress), tractions, top or None),
        ("J over end opening", opens, axis("J", units.toughness), {"test": (found.w, found.J), **areas}, None),
        ("Load over opening", axis("opening", units.length), axis("load", units.force), back, None),
    )
    with drawing():
        for number, (title, x, y, curves, high) in enumerate(drawn):
            figure, axes = panel(HALF, 3.0)
            for label, curve in curves.items():
                _plot(axes, *curve, color=colour(LAW_INKS[label]), linewidth=1.1, label=label)
            axes.set(xlabel=x, ylabel=y, ylim=(0.0, high))
            axes.legend(loc="best")
            made.append(Panel.of(figure, f"bridging-{number}", title, BRIDGING_CAPTIONS[number]))
    return made


def of_growth(axes: Axes, one: Reduced, label: str, **style: object) -> None:
    """The R-curve of a scheme, with marks where it has few points."""
    mark = "o" if one.G.size <= MARKED else ""
    _plot(axes, one.growth, one.G, linewidth=1.1, marker=mark, markersize=3, label=label, **style)


def _plot(axes: Axes, x: np.ndarray, y: np.ndarray, **style: object) -> None:
    """At most `MOST_DRAWN` points of a curve."""
    some = np.unique(np.linspace(0, x.size - 1, min(x.size, MOST_DRAWN)).astype(int))
    axes.plot(x[some], y[some], **style)  # type: ignore[arg-type]
