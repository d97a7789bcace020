"""Parts that several figures have: marks of a logarithmic axis, bars of the time by phase, the distance to a curve."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.ticker import LogLocator, NullFormatter

from verify.curve import PROPAGATION, load_at, peak
from verify.paper.study import Reference, Trial, curve
from verify.report.style import METHOD_NAMES, colour, line


def plain(part: Axis) -> None:
    """Marks at 1, 2, 5, 10, ... as numbers."""
    part.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    part.set_major_formatter(lambda value, _: f"{value:g}")
    part.set_minor_formatter(NullFormatter())


def phase_bars(axes: Axes, labels: Sequence[str], seconds: Mapping[str, Sequence[float]]) -> tuple[np.ndarray, ...]:
    """A bar a label, the first on top, of the seconds of every phase in turn; where bars are and where they end."""
    at, left = np.arange(len(labels))[::-1], np.zeros(len(labels))
    for name, width in seconds.items():
        axes.barh(at, width, 0.62, left, color=colour(f"phase-{name}"), linewidth=0, label=name)
        left += width
    axes.set_yticks(at, labels)
    axes.grid(False, axis="y")
    return at, left


def deviation(axes: Axes, known: Reference, trials: Mapping[str, Trial | None]) -> None:
    """load / reference - 1 of the trial of every basis, and the band in which nothing is said."""
    reference = curve(known.result)
    openings = np.linspace(PROPAGATION * peak(reference)[0], float(np.max(reference[0])), 400)
    band = 100 * max(known.error, known.oscillation)
    axes.axhspan(-band, band, color=colour("muted"), alpha=0.3, linewidth=0)
    for basis, trial in trials.items():
        if trial is not None and trial.result is not None and trial.drawable:
            ratio = load_at(curve(trial.result), openings) / load_at(reference, openings) - 1.0
            axes.plot(openings, 100 * ratio, **line(basis).options(), label=METHOD_NAMES[basis])
    axes.set(ylabel="load / converged load − 1 (%)")
    low, high = axes.get_ylim()
    axes.set_ylim(low, high + 0.15 * (high - low))
    axes.legend(loc="upper right", ncols=3)
