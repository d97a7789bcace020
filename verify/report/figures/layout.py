"""Figures with a row per method: the whole specimen, and an enlarged part around the process zone."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from verify.pages.paint import Limits
from verify.pages.style import WIDE, colour
from verify.report.figures.fields import process_zone
from verify.result import Snapshot

if TYPE_CHECKING:
    from verify.scene.schema import Scene

#: Inches: margin, width of the whole specimen, gap, width of the enlarged part; least and largest height of a row.
LEFT, WHOLE, GAP, CLOSE_UP = 0.42, 6.3, 0.5, WIDE - 7.32
LEAST_HEIGHT, MOST_HEIGHT = 0.8, 2.2


def rows(count: int, height: float, below: float) -> tuple[Figure, list[tuple[Axes, Axes]]]:
    """A figure with ``count`` rows, each of a wide and a narrow pair of axes of the same ``height`` in inches.

    ``below`` inches are free below the rows.
    """
    between = 0.5
    total = below + count * (height + between)
    figure = Figure(figsize=(WIDE, total))
    pairs = []
    for i in range(count):
        bottom = (total - (i + 1) * (height + between) + 0.15) / total
        places = ((LEFT, WHOLE), (LEFT + WHOLE + GAP, CLOSE_UP))
        whole, close = (figure.add_axes((x / WIDE, bottom, w / WIDE, height / total)) for x, w in places)
        whole.grid(False)
        close.grid(False)
        close.spines[["top", "right"]].set_visible(True)
        close.locator_params(nbins=4)
        pairs.append((whole, close))
    return figure, pairs


def frame(scene: Scene, snapshots: Sequence[Snapshot]) -> tuple[Limits, Limits]:
    """Limits along x and y that contain all snapshots to scale, enlarged where a row would be too low or too high."""
    x_ni = np.concatenate([(np.asarray(s.X_euvi) + np.asarray(s.u_euvi)).reshape(-1, 2) for s in snapshots])
    pad = 0.01 * scene.specimen.extent
    left, right = float(x_ni[:, 0].min()) - pad, float(x_ni[:, 0].max()) + pad
    height = max(2.06 * float(np.abs(x_ni[:, 1]).max()) + pad, LEAST_HEIGHT / WHOLE * (right - left))
    right = max(right, left + WHOLE / MOST_HEIGHT * height)
    return (left, right), (-height / 2, height / 2)


def zoom(scene: Scene, snapshots: Sequence[Snapshot], height: float) -> tuple[Limits, Limits]:
    """Limits of the enlarged part around the first process zone, to scale for axes of ``height`` inches."""
    body = scene.specimen
    zone = next((z for s in snapshots if (z := process_zone(s)) is not None), (body.free_length, body.free_length))
    width = min(max(1.7 * (zone[1] - zone[0]), 5 * body.loaded_thickness), 0.3 * body.extent)
    middle = body.place(min(sum(zone) / 2, body.extent - width / 2))
    reach = width * height / CLOSE_UP / 2
    return (middle - width / 2, middle + width / 2), (-reach, reach)


def mark(axes: Axes, part: tuple[Limits, Limits]) -> None:
    """Draw the frame of the part that is enlarged."""
    (x0, x1), (y0, y1) = part
    frame = Rectangle((x0, y0), x1 - x0, y1 - y0, fill=False, edgecolor=colour("muted"), linewidth=0.6, zorder=5)
    axes.add_patch(frame)
