"""Figures of cost: time by phase, and error against time."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from verify.pages.style import HALF, SHOWN_PHASES, Panel, colour, drawing, name_points, panel, phase_bars, plain
from verify.pages.text import seconds
from verify.report.figures.entry import Entry, short_names
from verify.result import Result
from verify.scene.schema import Scene


def total_seconds(result: Result) -> float:
    """Wall time of the run: the recorded total, or the sum of its phases; NaN where nothing was timed."""
    times = result.seconds or {}
    return float(times.get("total", sum(times.values()))) or float("nan")


def phase_seconds(result: Result) -> dict[str, float]:
    """Time by phase; ``other`` is the rest of the total."""
    times = dict(result.seconds or {})
    named = {name: float(times.get(name, 0.0)) for name in SHOWN_PHASES}
    if "other" not in times and "total" in times:
        named["other"] = max(float(times["total"]) - sum(named.values()), 0.0)
    return named


def timing(scene: Scene, runs: Sequence[Entry], key: str) -> Panel | None:
    """Stacked bars of the time by phase, one per run; None where nothing was timed."""
    timed = [entry for entry in runs if total_seconds(entry.result) > 0]
    if not timed:
        return None
    with drawing():
        names = list(short_names(timed).values())
        left_margin = 0.15 + 0.068 * max(len(name) for name in names)
        figure, axes = panel(HALF, 0.42 * len(timed) + 0.85, left=left_margin, top=0.4)
        longest = max(total_seconds(entry.result) for entry in timed)
        taken = {phase: [phase_seconds(entry.result)[phase] for entry in timed] for phase in SHOWN_PHASES}
        ends = phase_bars(axes, names, {phase: width for phase, width in taken.items() if sum(width) > 0})
        for row, end, entry in zip(*ends, timed, strict=True):
            axes.text(end + 0.015 * longest, row, seconds(total_seconds(entry.result)), va="center", fontsize=7.5)
        axes.tick_params(axis="y", length=0, labelcolor=colour("ink"))
        axes.set(xlabel="wall time (s)", xlim=(0, 1.2 * longest or 1.0))
        axes.spines["left"].set_visible(False)
        figure.legend(loc="upper center", ncols=6, handlelength=0.9, columnspacing=0.9, handletextpad=0.4)
        caption = "Where the time went. Runs made at the same time on one machine slow each other down."
        return Panel.of(figure, key, f"Wall time by phase and method, {scene.name}", caption)


def error_and_time(scene: Scene, runs: Sequence[Entry], base: Entry, key: str) -> Panel | None:
    """Curve error against wall time, both logarithmic; ``base`` is the reference run."""
    shown = [
        entry for entry in runs if entry.agreement and entry.agreement.error > 0 and total_seconds(entry.result) > 0
    ]
    if not shown:
        return None
    names, inks = short_names(runs), [colour(entry.line.colour) for entry in shown]
    errors = [100 * entry.agreement.error for entry in shown if entry.agreement]
    places = np.column_stack([[max(total_seconds(entry.result), 1e-3) for entry in shown], errors])
    with drawing():
        figure, axes = panel(HALF, 2.5)
        for place, ink in zip(places, inks, strict=True):
            axes.plot(*place, "o", color=ink, markersize=6)
        axes.set(xscale="log", yscale="log", xlabel="wall time (s)", ylabel=f"distance to {base.name} (%)")
        axes.margins(0.3, 0.3)
        for part in (axes.xaxis, axes.yaxis):
            plain(part)
        axes.minorticks_off()
        axes.autoscale_view()
        name_points(axes, places, [names[entry] for entry in shown], inks)
        caption = (
            f"What the time bought: relative L2 distance of the load to {base.label}, against wall time. The "
            "reference has an error of its own; a distance below that says no more."
        )
        return Panel.of(figure, key, f"Curve error against time, {scene.name}", caption)
