"""The study as a page: the values, how far the codes are from them, and the budget of each."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from verify.methods.names import METHODS
from verify.pages.style import WIDE, Panel, colour, drawing, panel, to_svg
from verify.studies.page import write_study
from verify.studies.uncertainty import percent

if TYPE_CHECKING:
    from verify.studies.certified.study import Study
    from verify.studies.certified.values import Value


def write(study: Study, path: Path) -> None:
    """Write the page."""
    drawn = [intervals([one for one in study.found if np.isfinite(one.value)])] if study.found else []
    write_study(study, path, {"percent": percent}, drawn=drawn, methods=METHODS)


def intervals(shown: Sequence[Value]) -> Panel:
    """For every quantity the interval of the common value, and those of the codes."""
    with drawing():
        figure, axes = panel(WIDE, 0.42 * len(shown) + 0.8, left=1.7)
        at, value = np.arange(len(shown), dtype=float)[::-1], np.array([one.value for one in shown])
        width = np.array([100 * one.relative for one in shown])
        axes.barh(at, 2 * width, 0.7, left=-width, color=colour("accent"), alpha=0.25, linewidth=0)
        for name, offset, mark in zip(shown[0].codes if shown else (), (0.16, -0.16), "os", strict=False):
            off, reach = ([getattr(one.codes[name], key) for one in shown] for key in ("value", "uncertainty"))
            line = {
                "label": METHODS[name].label,
                "color": colour(name),
                "fmt": mark,
                "markersize": 4,
                "elinewidth": 1.2,
            }
            axes.errorbar(100 * (off / value - 1), at + offset, xerr=100 * reach / np.abs(value), **line)
        axes.set_yticks(at, [one.quantity for one in shown])
        axes.grid(False, axis="y")
        axes.set(xlabel="from the value (%)", ylim=(-0.7, len(shown) - 0.3))
        axes.legend(loc="best")
        svg = to_svg(figure, "intervals", "Values of both codes with their uncertainties, from the value of both")
    caption = "Both codes on their finest meshes with their uncertainties; the band is that of the value."
    return Panel(svg, caption, "wide")
