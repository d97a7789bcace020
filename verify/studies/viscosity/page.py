"""The study as a page: the error by viscosity, and the time of the runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.ticker import LogLocator

from verify.pages.style import HALF, Panel, colour, drawing, panel, to_svg
from verify.studies.page import logarithmic, write_study
from verify.studies.viscosity.row import Row

if TYPE_CHECKING:
    from verify.studies.viscosity.study import Study

#: Columns of both charts, each with its name, its colour in the palette and its mark.
ERRORS = {
    "curve_error": ("curve", "accent", "o"),
    "peak_error": ("peak load", "nurbs", "s"),
    "work_error": ("work", "beam", "^"),
}
RATIOS = {
    "time_ratio": ("time", "accent", "o"),
    "steps_ratio": ("steps", "nurbs", "s"),
    "iterations_ratio": ("iterations", "beam", "^"),
}


def write(study: Study, path: Path) -> None:
    """Write the page."""
    drawn = [one for one in study.rows[1:] if one.complete]
    shown = [errors(drawn, "errors"), saved(drawn, "saved")] if drawn else []
    write_study(study, path, {"percent": percent}, panels=shown)


def percent(part: float) -> str:
    """A percentage with sign, such as +3.1 %."""
    return f"{100 * part:+.2g} %".replace("-", "−") if np.isfinite(part) else "–"


def errors(rows: Sequence[Row], key: str) -> Panel:
    """Errors over the viscosity."""
    caption = "What viscosity changes, against the same scene without it: measured."
    return _drawn(rows, ERRORS, ("change (%)", 100.0), key, caption)


def saved(rows: Sequence[Row], key: str) -> Panel:
    """Time, steps and iterations over those without viscosity."""
    caption = (
        "What it saves: below the line at 1 it does. Without viscosity the path is followed through its snap-backs."
    )
    return _drawn(rows, RATIOS, ("with viscosity, over that without", 1.0), key, caption)


def _drawn(
    rows: Sequence[Row], columns: Mapping[str, tuple[str, str, str]], axis: tuple[str, float], key: str, caption: str
) -> Panel:
    name, scale = axis
    with drawing():
        figure, axes = panel(HALF, 3.4)
        viscosity = np.array([one.viscosity for one in rows])
        for column, (label, ink, mark) in columns.items():
            value = scale * np.abs([getattr(one, column) for one in rows])
            axes.plot(viscosity, value, marker=mark, markersize=4, color=colour(ink), linewidth=1.0, label=label)
        logarithmic(axes, "viscosity, in durations of the programme", name)
        axes.xaxis.set_major_locator(LogLocator())  # decades only: there is no room for both 0.0001 and 0.0002
        if columns is RATIOS:
            axes.axhline(1.0, color=colour("ink"), linewidth=0.8)
        axes.legend(loc="best")
        svg = to_svg(figure, key, caption.partition(":")[0])
    return Panel(svg, caption)
