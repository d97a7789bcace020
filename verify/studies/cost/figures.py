"""Figures of the page: error against time, error against unknowns with orders, the phases of the cheapest runs."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from operator import attrgetter
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from verify.pages.style import HALF, SHOWN_PHASES, Panel, colour, drawing, panel, phase_bars, to_svg
from verify.studies.cost.findings import SHOWN, by_family, named, pareto
from verify.studies.cost.plan import LEVELS
from verify.studies.cost.row import Row
from verify.studies.page import logarithmic

_MARKERS = {0: "*", 1: "v", 2: "s", 3: "o", 4: "D", 5: "P"}

Value = Callable[[Row], float]
_UNKNOWNS, _SECONDS = attrgetter("dofs"), attrgetter("seconds")


def work_precision(rows: Sequence[Row], key: str, size: str = "wide") -> Panel:
    """Error against time: a line through the best runs of every method and degree, the other runs faint.

    Parameters
    ----------
    size : "wide", or "half" of a page
    """
    with drawing():
        figure, axes = _beside_names(3.6) if size == "wide" else panel(HALF, 2.8)
        for front, rest in fronts(rows):
            marker = {"marker": _MARKERS[front[0].degree], **_ink(front[0])}
            axes.plot(*_work(rest), linestyle="none", alpha=0.25, markersize=2.5, **marker)
            axes.plot(*_work(front), linewidth=1.1, markersize=4, label=named(front[0]), **marker)
        _levels(axes)
        logarithmic(axes, "seconds", "curve error (%)")
        axes.legend(**(_BESIDE if size == "wide" else {"loc": "best"}))
        svg = to_svg(figure, key, "Curve error against time")
    caption = (
        "Lower left is better. Each line joins the runs of one method and degree that none of their own beats in both "
        "error and time; the others are faint. Grey lines: 1, 0.3 and 0.1 %."
    )
    return Panel(svg, caption, size)


#: Where names stand beside a chart.
_BESIDE: Mapping[str, Any] = {"loc": "center left", "bbox_to_anchor": (1.02, 0.5)}


def _beside_names(height: float) -> tuple[Figure, Axes]:
    """A wide figure with room for names beside its axes."""
    figure, axes = panel(HALF * 1.7, height)
    box = axes.get_position()
    axes.set_position((box.x0, box.y0, 0.68 * box.width, box.height))
    return figure, axes


def fronts(rows: Sequence[Row]) -> list[tuple[list[Row], list[Row]]]:
    """For every method and degree its Pareto front of error and time, and its other runs."""
    found: dict[str, list[Row]] = {}
    for row in rows:
        if row.measured:
            found.setdefault(row.family, []).append(row)
    best = {name: pareto(ones) for name, ones in sorted(found.items())}
    return [(front, [row for row in found[name] if row not in front]) for name, front in best.items()]


def _work(rows: Sequence[Row]) -> tuple[list[float], list[float]]:
    return [row.seconds for row in rows], [100.0 * row.curve_error for row in rows]


def error_and_unknowns(rows: Sequence[Row], orders: Mapping[str, float], key: str) -> Panel:
    """Error against unknowns for every family."""
    with drawing():
        figure, axes = _beside_names(3.4)
        for name, ladder in sorted(_with_mesh(rows).items()):
            order = orders.get(name, np.nan)
            label = f"{named(ladder[0])}: {order:.1f}" if np.isfinite(order) else named(ladder[0])
            _curve(axes, ladder, _UNKNOWNS, lambda row: 100.0 * row.curve_error, label)
        _levels(axes)
        logarithmic(axes, "unknowns", "curve error (%)")
        axes.legend(**_BESIDE)
        svg = to_svg(figure, key, "Curve error against unknowns")
    caption = (
        "Curve error against unknowns, at equal steps; the number is the observed order in one over the unknowns, of "
        "the four finest meshes whose error the reference can tell. The kink at the tip of the zone bounds the orders."
    )
    return Panel(svg, caption, "wide")


def _with_mesh(rows: Sequence[Row]) -> dict[str, list[Row]]:
    return {name: ladder for name, ladder in by_family(rows).items() if ladder[0].dofs}


def phases(rows: Sequence[Row], key: str) -> Panel:
    """Bars of the time by phase of the cheapest runs."""
    with drawing():
        left_margin = 0.3 + 0.062 * max(len(named(row)) + 7 for row in rows)
        figure, axes = panel(HALF * 1.5, 0.3 * len(rows) + 0.85, left=left_margin, top=0.4)
        labels = [f"{named(row)}, {row.dofs}" if row.dofs else named(row) for row in rows]
        phase_bars(axes, labels, {name: [getattr(row, name) for row in rows] for name in SHOWN_PHASES})
        axes.set(xlabel="seconds")
        figure.legend(loc="upper center", ncols=6, handlelength=0.9, columnspacing=0.9, handletextpad=0.4)
        svg = to_svg(figure, key, "Where the time of the cheapest runs goes")
    return Panel(svg, "Where the time goes: the cheapest run of every method for an error of 0.3 %.", "wide")


def _curve(axes: Axes, ladder: Sequence[Row], x: Value, y: Value, label: str) -> None:
    style: dict[str, Any] = {"marker": _MARKERS[ladder[0].degree], "markersize": 3, "linewidth": 0.9, **_ink(ladder[0])}
    axes.plot([x(row) for row in ladder], [y(row) for row in ladder], label=label, **style)


def _ink(row: Row) -> dict[str, Any]:
    return {"color": colour(SHOWN[row.method][1])}


def _levels(axes: Axes) -> None:
    for level in LEVELS.values():
        axes.axhline(100.0 * level, color=colour("rule"), linewidth=0.8, zorder=0)
