"""Figures of the verdict on a law: tractions on a path, toughness over the mode ratio, a defect, tangents."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator, NullFormatter

from verify.pages.style import HALF, THIRD, Line, Panel, colour, drawing, panel, to_svg
from verify.pages.text import axis, power_of_ten
from verify.studies.law.distance import apart, work
from verify.studies.law.given.answer import Answer
from verify.studies.law.judge import Judgement
from verify.studies.law.tangents import study
from verify.studies.law.ways.legs import JumpPath

#: Colours of the normal and the shear traction.
_INKS = {"p": "nurbs", "t": "lagrange"}
_WIDE, _THIN, _DASHED = (3.2, (), 0.4, 2.0), (1.1, (), 1.0, 4.0), (1.1, (3.0, 1.5), 1.0, 5.0)


def path(found: Judgement, way: JumpPath, stress: str) -> Panel:
    """Both tractions over the steps of one path: wide pale lines for the definition, thin lines for the law."""
    given, known = found.given[way.name], found.expected[way.name]
    with drawing():
        figure, axes = panel(THIRD, 2.3)
        _tractions(axes, known, _WIDE, "definition")
        _tractions(axes, given, _THIN, "law")
        _finish(axes, stress)
        svg = to_svg(figure, f"path-{way.name}", f"Tractions on the path {way.name}")
    worst = float(apart(found.bond, given, known).max())
    return Panel(svg, f"{way.what} Largest distance: {_short(worst)}.", "third")


def defect(found: Judgement, stress: str) -> Panel | None:
    """Tractions on the path on which the best defect shows most, with those of the definition with this defect."""
    named = [one for one in found.defects if one.candidate is not None]
    if not named:
        return None
    best = named[0]
    way = next(way for way in found.ways if way.name == best.path)
    assert best.candidate is not None
    with drawing():
        figure, axes = panel(HALF, 2.8)
        _tractions(axes, found.expected[way.name], _WIDE, "definition")
        _tractions(axes, found.given[way.name], _THIN, "law")
        _tractions(axes, best.candidate.answer(way), _DASHED, "with the defect", "ink")
        _finish(axes, stress)
        svg = to_svg(figure, "defect", f"The defect {best.name} on the path {way.name}")
    return Panel(svg, f"{best.name} on {way.name}: the law, and the definition without and with the defect.")


def toughness(found: Judgement, unit: str) -> Panel | None:
    """Work to failure at constant mode ratios against the definition, and the criterion where that is another."""
    straight = [way for way in found.ways if way.ratio is not None]
    if len(straight) < 2:
        return None
    B = np.linspace(0.0, 1.0, 101)
    with drawing():
        figure, axes = panel(HALF, 2.8)
        known, said = found.bond.critical(B), found.bond.by_criterion(B)
        axes.plot(B, known, **Line("accent", *_WIDE).options(), label="definition")
        if not np.allclose(known, said):
            axes.plot(B, said, **Line("ink", *_DASHED).options(), label="criterion")
        works = [work(way.g, way.s, found.given[way.name]) for way in straight]
        axes.plot(
            [float(way.ratio or 0.0) for way in straight], works, "o", color=colour("ink"), markersize=4, label="law"
        )
        axes.set(xlabel="mode ratio by energy, B", ylabel=axis("work to failure", unit), ylim=(0, None))
        axes.legend(loc="best")
        svg = to_svg(figure, "toughness", "Work to failure over the mode ratio")
    return Panel(svg, "Work to failure at constant mode ratios, and the toughness of the bond.")


def tangents(found: Judgement) -> Panel | None:
    """Deviation of the tangent from central differences over their step size."""
    sizes = study(found.bond, list(found.given.values()))
    if not sizes:
        return None
    with drawing():
        figure, axes = panel(HALF, 2.8)
        step, off = np.array(sizes).T
        axes.plot(step, np.maximum(off, 1e-16), "o-", color=colour("accent"), linewidth=1.2, markersize=4)
        axes.set(xscale="log", yscale="log", xlabel="step over the largest jump", ylabel="median deviation")
        for part in (axes.xaxis, axes.yaxis):
            part.set_major_formatter(lambda value, _: power_of_ten(value))
            part.set_minor_formatter(NullFormatter())
        svg = to_svg(figure, "tangents", "Deviation of the tangent over the step size of the differences")
    caption = (
        "Tangent against central differences of the law, over the initial stiffness: down to rounding, not further."
    )
    return Panel(svg, caption)


def _tractions(axes: Axes, answer: Answer, style: tuple, name: str, ink: str = "") -> None:
    for key, values in (("p", answer.p), ("t", answer.t)):
        line = Line(ink or _INKS[key], *style)
        axes.plot(np.arange(values.size), values, **line.options(), label=f"{key}, {name}")


def _finish(axes: Axes, stress: str) -> None:
    axes.axhline(0.0, color=colour("rule"), linewidth=0.6)
    axes.xaxis.set_major_locator(MaxNLocator(5, integer=True))
    axes.set(xlabel="step", ylabel=axis("traction", stress))


def _short(value: float) -> str:
    return f"{value:.1e} of the strengths" if value else "none"
