"""The study as a page: one self-contained HTML file with a table and bars."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes

from verify.pages.style import WIDE, Panel, colour, drawing, panel, to_svg
from verify.studies.effects.row import CHANGES, Row, signed
from verify.studies.page import write_study

if TYPE_CHECKING:
    from verify.studies.effects.study import Study

#: Columns of the chart, each with its name and its colour in the palette.
BARS = {
    "curve_change": ("curve", "accent"),
    "peak_change": (CHANGES["peak_change"], "nurbs"),
    "end_change": (CHANGES["end_change"], "dolfinx"),
    "dissipated_change": (CHANGES["dissipated_change"], "lagrange"),
    "work_change": (CHANGES["work_change"], "beam"),
}

#: Left end of the logarithmic axis; smaller changes have no bar.
SMALLEST_BAR = 1e-5


def write(study: Study, path: Path) -> None:
    """Write the page."""
    drawn = [one for one in study.rows if one.complete]
    bars = [changed(drawn, "changes"), times(drawn, "times")] if drawn else []
    write_study(study, path, {"in_cell": in_cell}, columns=BARS, bars=bars)


def in_cell(fraction: float, column: str) -> str:
    """A change as text; distances of curves have no sign."""
    text = signed(fraction).replace("-", "−") if np.isfinite(fraction) else "–"
    return text.lstrip("+") if column == "curve_change" else text


def changed(rows: Sequence[Row], key: str) -> Panel:
    """Bars of the absolute changes on a logarithmic axis, with the signed values beside them."""
    with drawing():
        figure, axes = panel(WIDE, 0.9 * len(rows) + 1.0, left=1.5, top=0.4)
        step = 0.8 / len(BARS)
        for i, (column, (name, ink)) in enumerate(BARS.items()):
            value = np.array([getattr(one, column) for one in rows])
            size = np.where(np.abs(value) > SMALLEST_BAR, np.abs(value), SMALLEST_BAR)
            at = np.arange(len(rows))[::-1] + 0.4 - (i + 0.5) * step
            axes.barh(at, 100 * size, 0.9 * step, color=colour(ink), linewidth=0, label=name)
            for y, x, change in zip(at, size, value, strict=True):
                text = in_cell(change, column) if np.isfinite(change) else ""
                axes.annotate(text, (100 * x, y), (3, 0), textcoords="offset points", va="center", size=6.5)
        axes.set(xscale="log", xlabel="change with the effect (%)", xlim=(100 * SMALLEST_BAR, None))
        axes.xaxis.set_major_formatter(lambda value, _: f"{value:g}")
        axes.set_xlim(right=8 * axes.get_xlim()[1])
        _named(axes, rows)
        figure.legend(loc="upper center", ncols=len(BARS), handlelength=0.9, columnspacing=1.2, handletextpad=0.4)
        svg = to_svg(figure, key, "What each effect changes")
    return Panel(svg, "What each effect changes, against the same without it.", "wide")


def times(rows: Sequence[Row], key: str) -> Panel:
    """Bars of the time with each effect over the time without it."""
    with drawing():
        figure, axes = panel(WIDE, 0.35 * len(rows) + 0.9, left=1.5)
        at, ratio = np.arange(len(rows))[::-1], np.array([one.time_ratio for one in rows])
        axes.barh(at, ratio - 1.0, 0.5, 1.0, color=colour("accent"), linewidth=0)
        axes.axvline(1.0, color=colour("ink"), linewidth=0.8)
        for y, x in zip(at, ratio, strict=True):
            text = f"{x:.2g} ×" if np.isfinite(x) else ""
            axes.annotate(text, (max(x, 1.0), y), (3, 0), textcoords="offset points", va="center", size=7)
        axes.set(xlabel="time with the effect, in parts of the time without it", xlim=(0.0, None))
        axes.set_xlim(right=1.1 * axes.get_xlim()[1])
        _named(axes, rows)
        svg = to_svg(figure, key, "What each effect costs in time")
    return Panel(svg, "What each effect costs: left of the line it saves time.", "wide")


def _named(axes: Axes, rows: Sequence[Row]) -> None:
    axes.set_yticks(np.arange(len(rows))[::-1], [one.effect for one in rows])
    axes.grid(False, axis="y")
