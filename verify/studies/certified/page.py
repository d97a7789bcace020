"""The study as a page: the values, how far the codes are from them, and the budget of each."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from verify.methods.names import METHODS
from verify.pages.style import WIDE, Panel, colour, drawing, panel, to_svg
from verify.studies.page import write_study

if TYPE_CHECKING:
    from verify.studies.certified.study import Study


def write(study: Study, path: Path) -> None:
    """Write the page."""
    drawn = [intervals(study, "intervals")] if study.values else []
    names = {name: METHODS[name].label for one in study.values for name in one.codes}
    write_study(study, path, {"share": share, "signed": signed}, drawn=drawn, names=names)


def share(part: float) -> str:
    """A percentage such as 0.031 %, or "less than 0.001 %"."""
    return _percent(abs(part), "")


def signed(part: float) -> str:
    """A percentage with sign such as +0.031 %, or "less than 0.001 %"."""
    return _percent(part, "+").replace("-", "−")


def _percent(part: float, sign: str) -> str:
    if not np.isfinite(part) or part == 0.0:
        return "–" if part else "0"
    return f"{100 * part:{sign}.3f}\u00a0%" if abs(part) >= 1e-5 else "< 0.001\u00a0%"


def intervals(study: Study, key: str) -> Panel:
    """For every quantity the interval of the common value, and those of the codes."""
    with drawing():
        shown = [one for one in study.values if np.isfinite(one.value)]
        figure, axes = panel(WIDE, 0.42 * len(shown) + 0.8, left=1.7)
        at = np.arange(len(shown), dtype=float)[::-1]
        for y, one in zip(at, shown, strict=True):
            width = 100 * one.relative
            axes.barh(y, 2 * width, 0.7, left=-width, color=colour("accent"), alpha=0.25, linewidth=0)
        for place, (name, offset) in enumerate(zip(shown[0].codes if shown else (), (0.16, -0.16), strict=False)):
            off = [100 * (one.codes[name].value / one.value - 1) for one in shown]
            reach = [100 * one.codes[name].uncertainty / abs(one.value) for one in shown]
            ink, mark = colour(name), "os"[place]
            label = METHODS[name].label
            axes.errorbar(off, at + offset, xerr=reach, label=label, color=ink, fmt=mark, markersize=4, elinewidth=1.2)
        axes.set_yticks(at, [one.quantity for one in shown])
        axes.grid(False, axis="y")
        axes.set(xlabel="from the value (%)", ylim=(-0.7, len(shown) - 0.3))
        axes.legend(loc="best")
        svg = to_svg(figure, key, "Values of both codes with their uncertainties, from the value of both")
    return Panel(
        svg, "Both codes on their finest meshes with their uncertainties; the band is that of the value.", "wide"
    )
