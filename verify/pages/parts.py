"""Parts of several figures: ticks of a logarithmic axis, bars of the time by phase."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.ticker import LogLocator, NullFormatter

from verify.pages.style import colour


def plain(part: Axis) -> None:
    """Ticks at 1, 2, 5, 10, ... with plain numbers."""
    part.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    part.set_major_formatter(lambda value, _: f"{value:g}")
    part.set_minor_formatter(NullFormatter())


def phase_bars(axes: Axes, labels: Sequence[str], seconds: Mapping[str, Sequence[float]]) -> tuple[np.ndarray, ...]:
    """Stacked bars of the seconds by phase, one per label, the first on top. Returns positions and ends of the bars."""
    at, left = np.arange(len(labels))[::-1], np.zeros(len(labels))
    for name, width in seconds.items():
        axes.barh(at, width, 0.62, left, color=colour(f"phase-{name}"), linewidth=0, label=name)
        left += width
    axes.set_yticks(at, labels)
    axes.grid(False, axis="y")
    return at, left


def name_points(axes: Axes, places: np.ndarray, names: Sequence[str], inks: Sequence[str]) -> None:
    """Write a name beside each point (n, 2), one line above the other; the limits of the axes must be final."""
    at, line, height = axes.transData.transform(places) * 72.0 / axes.figure.dpi, 9.5, -np.inf  # points
    middle = np.mean(axes.get_window_extent().intervalx) * 72.0 / axes.figure.dpi
    for i in np.argsort(at[:, 1]):
        height, left = max(at[i, 1], height + line), at[i, 0] < middle
        shift = 7.0 if left else -7.0, height - at[i, 1] - 3.0
        align = "left" if left else "right"
        axes.annotate(names[i], places[i], shift, textcoords="offset points", color=inks[i], ha=align)
