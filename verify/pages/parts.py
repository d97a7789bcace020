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
