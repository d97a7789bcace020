"""A study of uncertainties as a page: the interval of each quantity, and the budgets by the template of the study."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from verify.methods.names import METHODS
from verify.pages.style import WIDE, Panel, colour, drawing, panel, to_svg
from verify.studies.page import write_study
from verify.studies.uncertainty import Study, percent


def write(study: Study, path: Path, **content: object) -> None:
    """Write the page, with the ``content`` that its template has besides."""
    drawn = [intervals(study)] if study.found else []
    write_study(study, path, {"percent": percent}, "page.html.j2", intervals=drawn, methods=METHODS, **content)


def intervals(study: Study) -> Panel:
    """For every quantity its interval, and those of the codes."""
    shown = [one for one in study.found if np.isfinite(one.interval).all()]
    at = np.arange(len(shown), dtype=float)[::-1]
    with drawing():
        figure, axes = panel(WIDE, 0.42 * len(shown) + 0.8, left=1.7)
        low, high = 100.0 * np.reshape([one.interval for one in shown], (-1, 2)).T
        axes.barh(at, high - low, 0.7, left=low, color=colour("accent"), alpha=0.25, linewidth=0)
        axes.axvline(0.0, color=colour("ink"), linewidth=0.8)
        for name, offset, mark in zip(shown[0].errors if shown else (), (0.16, -0.16), "os", strict=False):
            middle, width = 100.0 * np.array([one.errors[name] for one in shown]).T
            ink, label = colour(name), METHODS[name].label
            axes.errorbar(
                middle, at + offset, xerr=width, label=label, color=ink, fmt=mark, markersize=4, elinewidth=1.2
            )
            axes.legend(loc="best")
        axes.set_yticks(at, [one.quantity for one in shown])
        axes.grid(False, axis="y")
        axes.set(xlabel=study.AXIS, ylim=(-0.7, len(shown) - 0.3))
        svg = to_svg(figure, "intervals", study.INTERVALS)
    return Panel(svg, f"{study.INTERVALS}.", "wide")
