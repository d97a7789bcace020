"""The figure of error against time, for pages without scripts and for that of a verification."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from verify.pages.style import HALF, Panel, colour, drawing, panel
from verify.studies.cost.findings import SHOWN, named, pareto
from verify.studies.cost.plan import LEVELS
from verify.studies.cost.row import Row
from verify.studies.page import logarithmic

_MARKERS = {0: "*", 1: "v", 2: "s", 3: "o", 4: "D", 5: "P"}


def work_precision(rows: Sequence[Row], key: str) -> Panel:
    """Error against time: a line through the best runs of every method and degree, the other runs faint."""
    with drawing():
        figure, axes = panel(HALF, 2.8)
        for front, rest in fronts(rows):
            ink = colour(SHOWN[front[0].method][1])
            marker: dict[str, Any] = {"marker": _MARKERS[front[0].degree], "color": ink}
            axes.plot(*_work(rest), linestyle="none", alpha=0.25, markersize=2.5, **marker)
            axes.plot(*_work(front), linewidth=1.1, markersize=4, label=named(front[0]), **marker)
        for level in LEVELS.values():
            axes.axhline(100.0 * level, color=colour("rule"), linewidth=0.8, zorder=0)
        logarithmic(axes, "seconds", "curve error (%)")
        axes.legend(loc="best")
        caption = (
            "Lower left is better. Each line joins the runs of one method and degree that none of their own beats in "
            "both error and time; the others are faint. Grey lines: 1, 0.3 and 0.1 %."
        )
        return Panel.of(figure, key, "Curve error against time", caption)


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
