"""A study of uncertainties as a page: the interval of each quantity, and the budgets by the template of the study."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from verify.methods.names import METHODS
from verify.pages.style import WIDE, Panel, colour, drawing, panel
from verify.studies.page import write_study
from verify.studies.uncertainty import Study, percent


def write(study: Study, path: Path, **content: object) -> None:
    """Write the page, with the ``content`` that its template has besides."""
    drawn = [intervals(study)] if study.found else []
    write_study(study, path, {"percent": percent}, "page.html.j2", intervals=drawn, methods=METHODS, **content)


def intervals(study: Study) -> Panel:
    """For every quantity the interval of its error, and those of the codes."""
    shown = [one for one in study.found if np.isfinite(one.errors[""]).all()]
    at = np.arange(len(shown), dtype=float)[::-1]
    with drawing():
        figure, axes = panel(WIDE, 0.42 * len(shown) + 0.8, left=1.7)
        for name, offset, mark in zip(shown[0].errors if shown else (), (0.0, 0.16, -0.16), " os", strict=False):
            middle, width = 100.0 * np.array([one.errors[name] for one in shown]).T
            if name:
                axes.errorbar(middle, at + offset, None, width, mark, color=colour(name), label=METHODS[name].label)
            else:
                axes.barh(at, 2.0 * width, 0.7, left=middle - width, color=colour("accent"), alpha=0.25, linewidth=0)
        if len(axes.containers) > 1:
            axes.legend(loc="best")
        axes.axvline(0.0, color=colour("ink"), linewidth=0.8)
        axes.set_yticks(at, [one.quantity for one in shown])
        axes.grid(False, axis="y")
        axes.set(xlabel=study.AXIS, ylim=(-0.7, len(shown) - 0.3))
        return Panel.of(figure, "intervals", study.INTERVALS, f"{study.INTERVALS}.", "wide")
