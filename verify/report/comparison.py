"""Two curves on one self-contained page: both over the opening, their difference, and the numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from verify.curves.compare import Comparison
from verify.curves.curve import envelope
from verify.pages.style import HALF, Line, Panel, colour, drawing, panel
from verify.pages.table import Cell, Table
from verify.pages.template import rendered
from verify.report.tables import mark
from verify.verdict import Check

_A, _B = Line("lagrange", 1.2, (), 1.0, 4.0), Line("dolfinx", 3.4, (), 0.5, 2.0)
_PATH: Mapping[str, Any] = {"alpha": 0.35, "linewidth": 0.7, "linestyle": "solid"}


def page(
    comparison: Comparison,
    labels: tuple[str, str],
    rows: Sequence[tuple[str, str, str, str, str]],
    found: Sequence[Check],
    remarks: Sequence[str],
) -> str:
    """The HTML.

    Parameters
    ----------
    labels : names of A and B
    rows : quantity, name of its check, value of A, value of B, difference
    found : the requested checks
    remarks : sentences above the numbers
    """
    checks, cells = {check.name: check for check in found}, []
    for name, key, *values in rows:
        judged: tuple[str | Cell, ...] = ("", "")
        if check := checks.get(key):
            judged = "" if key == "end" else f"{100 * check.tolerance:.4g}\u00a0%", mark(check)
        cells.append((name, *values, *judged))
    content = {
        "labels": labels,
        "checks": checks,
        "passed": all(check.passed for check in found),
        "remarks": remarks,
        "table": Table.of(("", "A", "B", "A against B", "Tolerance", "Verdict"), cells, "Numbers of both curves"),
        "panels": (_curves(comparison, labels), _difference(comparison)),
    }
    return rendered("verify.report", "comparison.html.j2", {}, **content)


def _curves(comparison: Comparison, labels: tuple[str, str]) -> Panel:
    with drawing():
        figure, axes = panel(HALF, 3.0)
        for part, style, name in ((comparison.b, _B, f"B: {labels[1]}"), (comparison.a, _A, f"A: {labels[0]}")):
            axes.plot(part.opening, part.load, color=colour(style.colour), **_PATH)
            axes.plot(*envelope(part.opening, part.load), **style.options(), label=name)
            axes.plot(part.peak_opening, part.peak_load, ".", color=colour(style.colour), zorder=5)
        axes.set(xlabel="opening", ylabel="load", xlim=(0, None))
        axes.legend(loc="best")
        caption = "What displacement control would show of both curves, and thin their paths; dots are the peaks."
        return Panel.of(figure, "curves", f"Load against opening of {labels[0]} and {labels[1]}", caption)


def _difference(comparison: Comparison) -> Panel:
    gap = (comparison.load_a_n - comparison.load_b_n) / comparison.b.peak_load
    with drawing():
        figure, axes = panel(HALF, 3.0)
        axes.axhline(0, color=colour("ink"), linewidth=0.6)
        axes.plot(comparison.opening_n, 100 * gap, **_A.options())
        worst = int(np.argmax(np.abs(gap)))
        at = comparison.opening_n[worst], 100 * gap[worst]
        axes.plot(*at, "o", markerfacecolor="none", color=colour("bad"), markersize=6, zorder=6)
        axes.set(xlabel="opening", ylabel="(load of A − load of B) / peak of B (%)", xlim=(0, None))
        caption = "Their difference over the peak of B, where both are sampled; a ring marks the largest."
        return Panel.of(figure, "difference", "Difference of the loads against opening", caption)
