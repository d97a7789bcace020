"""Runs in pairs as a page: what they differ by over a number, or as bars, and what it costs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from math import isfinite
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import LogLocator

from verify.curves.of_run import cubics
from verify.pages.style import HALF, WIDE, Panel, colour, drawing, panel
from verify.pages.table import Column, Table
from verify.pages.text import Units, axis
from verify.studies.page import logarithmic, write_study
from verify.studies.pairs import CHANGES, Row, Study, signed

#: Changes in the charts, each with its name and its colour in the palette.
BARS = {
    "curve_change": ("curve", "accent"),
    "peak_change": (CHANGES["peak_change"], "nurbs"),
    "end_change": (CHANGES["end_change"], "dolfinx"),
    "dissipated_change": (CHANGES["dissipated_change"], "lagrange"),
    "work_change": (CHANGES["work_change"], "beam"),
}

#: What a run takes over what the first one takes.
COSTS = {"seconds": ("time", "accent"), "steps": ("steps", "nurbs"), "newton_iterations": ("iterations", "beam")}

#: Other columns of the table with their titles, before and behind the changes.
PAIR_HEADS = {"name": "run", "value": "value", "against": "against", "scene_has": "the scene has it"}
PAIR_COUNTS = {
    "dofs": "unknowns",
    "steps": "steps",
    "newton_iterations": "iterations",
    "rejected_steps": "steps taken back",
    "peak_memory_mb": "MB",
    "seconds": "seconds",
    "seconds_against": "of the other",
    "time_ratio": "ratio",
    "time_spread": "equal runs",
}

#: Left end of the logarithmic axis; smaller changes have no bar.
SMALLEST_BAR = 1e-5

#: Marks of lines, in the order of their names.
MARKS = "os^Dv"


def write(study: Study, path: Path) -> None:
    """Write the page."""
    drawn = [one for one in study.rows if one.complete]
    if len(numbers(drawn)) > 2:
        panels = [
            lines(drawn, BARS, "change (%)", "changes", "What it changes, against the first value."),
            lines(drawn, COSTS, "over that with the first value", "costs", "What it costs: below the line it saves."),
        ]
    else:
        panels = [changed(drawn, "changes"), times(drawn, "times")] if drawn else []
    panels += [planes(study)] if study.planes else []
    write_study(study, path, {}, "studies/pairs.html.j2", table=table(study.rows), panels=panels)


def table(rows: Sequence[Row]) -> Table:
    """The pairs as a table; one without a number has its reason."""
    columns = (
        *(Column(key, title) for key, title in PAIR_HEADS.items()),
        *(Column(key, name, partial(in_cell, column=key)) for key, (name, _) in BARS.items()),
        *(Column(key, title) for key, title in PAIR_COUNTS.items()),
    )
    told = [row if row.complete else {"name": row.name, "value": row.status} for row in rows]
    return Table(columns, told, "Runs that differ by one thing, everything else as the scene says", kind="methods told")


def numbers(rows: Sequence[Row]) -> list[float]:
    """The values of the rows, where all are numbers; else nothing."""
    try:
        found = [float(one.value) for one in rows]
    except ValueError:
        return []
    return found if all(map(isfinite, found)) else []


def in_cell(fraction: float, column: str) -> str:
    """A change as text; distances of curves have no sign."""
    text = signed(fraction).replace("-", "−") if np.isfinite(fraction) else "–"
    return text.lstrip("+") if column == "curve_change" else text


def lines(rows: Sequence[Row], columns: Mapping[str, tuple[str, str]], what: str, key: str, caption: str) -> Panel:
    """Columns over the values of the varied key: changes in per cent, or costs over those of the first row."""
    x, first = np.array(numbers(rows)), rows[0]
    with drawing():
        figure, axes = panel(HALF, 3.4)
        for mark, (column, (name, ink)) in zip(MARKS, columns.items(), strict=False):
            value = np.array([float(getattr(one, column)) for one in rows])
            y = 100.0 * np.abs(value) if columns is BARS else value / (getattr(first, column) or np.nan)
            there = (x > 0.0) & (y > 0.0)
            axes.plot(x[there], y[there], marker=mark, markersize=4, color=colour(ink), linewidth=1.0, label=name)
        logarithmic(axes, first.key, what)
        axes.xaxis.set_major_locator(LogLocator())  # decades only: there is no room for both 0.0001 and 0.0002
        if columns is COSTS:
            axes.axhline(1.0, color=colour("ink"), linewidth=0.8)
        axes.legend(loc="best")
        return Panel.of(figure, key, caption, caption)


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
        axes.set(xscale="log", xlabel="change (%)", xlim=(100 * SMALLEST_BAR, None))
        axes.xaxis.set_major_formatter(lambda value, _: f"{value:g}")
        axes.set_xlim(right=8 * axes.get_xlim()[1])
        _named(axes, rows)
        figure.legend(loc="upper center", ncols=len(BARS), handlelength=0.9, columnspacing=1.2, handletextpad=0.4)
        return Panel.of(figure, key, "What changes", "What changes, against the other run of the pair.", "wide")


def times(rows: Sequence[Row], key: str) -> Panel:
    """Bars of the time of each run over that of the other."""
    with drawing():
        figure, axes = panel(WIDE, 0.35 * len(rows) + 0.9, left=1.5)
        at, ratio = np.arange(len(rows))[::-1], np.array([one.time_ratio for one in rows])
        axes.barh(at, ratio - 1.0, 0.5, 1.0, color=colour("accent"), linewidth=0)
        axes.axvline(1.0, color=colour("ink"), linewidth=0.8)
        for y, x in zip(at, ratio, strict=True):
            text = f"{x:.2g} ×" if np.isfinite(x) else ""
            axes.annotate(text, (max(x, 1.0), y), (3, 0), textcoords="offset points", va="center", size=7)
        axes.set(xlabel="time, in parts of that of the other run", xlim=(0.0, None))
        axes.set_xlim(right=1.1 * axes.get_xlim()[1])
        _named(axes, rows)
        caption = "What it costs: left of the line it saves time."
        return Panel.of(figure, key, "What it costs in time", caption, "wide")


def planes(study: Study) -> Panel:
    """Load over opening by what is assumed of the width."""
    units = Units.of(study.scene.units)
    with drawing():
        figure, axes = panel(HALF, 3.0)
        for (plane, run), ink in zip(study.planes.items(), ("accent", "dolfinx", "lagrange"), strict=False):
            name = plane if plane == "solid" else f"plane {plane}"
            axes.plot(*cubics(run, 6), color=colour(ink), linewidth=1.2, label=name)
        axes.set(xlabel=axis("opening", units.length), ylabel=axis("load", units.force))
        axes.legend(loc="best")
        return Panel.of(figure, "planes", "Load by what is assumed of the width", "What is assumed of the width.")


def _named(axes: Axes, rows: Sequence[Row]) -> None:
    axes.set_yticks(np.arange(len(rows))[::-1], [one.name for one in rows])
    axes.grid(False, axis="y")
