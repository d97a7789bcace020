"""Deformed meshes at true scale with the stress in them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from verify.report.entry import Entry
from verify.report.fields import process_zone
from verify.report.paint import Limits, paint
from verify.report.style import STRESS_MAP, WIDE, Panel, colour, drawing, to_svg
from verify.report.text import Units, axis, quantity
from verify.result import Snapshot

if TYPE_CHECKING:
    from verify.scene import Scene

#: Inches: margin, width of the whole specimen, gap, width of the enlarged part; least and largest height of a row.
_LEFT, _WHOLE, _GAP, _CLOSE = 0.42, 6.3, 0.5, WIDE - 7.32
_LOWEST, _HIGHEST = 0.8, 2.2


def deformed(scene: Scene, group: Sequence[tuple[Entry, Snapshot]], key: str) -> Panel | None:
    """Deformed meshes at true scale, one row a method, the process zone enlarged beside each."""
    group = [(entry, snapshot) for entry, snapshot in group if np.size(snapshot.stress_euv)]
    if not group:
        return None
    units = Units.of(scene.units)
    limit = max(float(np.nanpercentile(np.abs(s.stress_euv), 99.7)) for _, s in group) or 1.0
    x, y = _frame(scene, group)
    height = _WHOLE * (y[1] - y[0]) / (x[1] - x[0])
    zoom = _zoom(scene, group, height)
    with drawing():
        figure, rows = _rows(len(group), height)
        for (whole, close), (entry, snapshot) in zip(rows, group, strict=True):
            x_euvi = np.asarray(snapshot.X_euvi) + np.asarray(snapshot.u_euvi)
            paint(whole, x_euvi, np.asarray(snapshot.stress_euv), limit, x, y)
            paint(close, x_euvi, np.asarray(snapshot.stress_euv), limit, *zoom)
            whole.grid(False)
            close.grid(False)
            close.spines[["top", "right"]].set_visible(True)
            close.locator_params(nbins=4)
            _mark(whole, zoom)
            title = f"{entry.label}, opening {quantity(snapshot.opening, units.length, 3)}"
            whole.set_title(title, color=colour(entry.line.colour))
        rows[-1][0].set_xlabel(axis("position", units.length))
        rows[-1][1].set_xlabel(axis("position, enlarged", units.length))
        _scale(figure, limit, axis("Cauchy stress along the specimen", units.stress))
        svg = to_svg(figure, key, f"Deformed meshes with axial stress, {scene.name}", dpi=170)
    caption = (
        "Deformed meshes, displacements at true scale, each with its own elements; the framed part is enlarged on the "
        f"right. One scale of colours for all, to ± {quantity(limit, units.stress, 3)}; no averaging between elements."
    )
    return Panel(svg, caption, "wide")


def _rows(count: int, height: float) -> tuple[Figure, list[tuple[Axes, Axes]]]:
    """A figure with one row a method: the whole specimen, and an enlarged part of the same ``height`` in inches."""
    below, between = 0.95, 0.5
    total = below + count * (height + between)
    figure = Figure(figsize=(WIDE, total))
    rows = []
    for i in range(count):
        bottom = (total - (i + 1) * (height + between) + 0.15) / total
        places = ((_LEFT, _WHOLE), (_LEFT + _WHOLE + _GAP, _CLOSE))
        rows.append(tuple(figure.add_axes((x / WIDE, bottom, w / WIDE, height / total)) for x, w in places))
    return figure, rows


def _scale(figure: Figure, limit: float, label: str) -> None:
    """The colour scale, along the foot of the figure."""
    height = figure.get_size_inches()[1]
    place = figure.add_axes((_LEFT / WIDE, 0.42 / height, _WHOLE / WIDE, 0.09 / height))
    bar = figure.colorbar(ScalarMappable(Normalize(-limit, limit), STRESS_MAP), cax=place, orientation="horizontal")
    bar.set_label(label)
    bar.outline.set_visible(False)


def _frame(scene: Scene, group: Sequence[tuple[Entry, Snapshot]]) -> tuple[Limits, Limits]:
    """Limits of the full view; grown in one direction where the row would be too low or too high at true scale."""
    x_ni = np.concatenate([(np.asarray(s.X_euvi) + np.asarray(s.u_euvi)).reshape(-1, 2) for _, s in group])
    pad = 0.01 * scene.specimen.length
    left, right = float(x_ni[:, 0].min()) - pad, float(x_ni[:, 0].max()) + pad
    height = max(2.06 * float(np.abs(x_ni[:, 1]).max()) + pad, _LOWEST / _WHOLE * (right - left))
    right = max(right, left + _WHOLE / _HIGHEST * height)
    return (left, right), (-height / 2, height / 2)


def _zoom(scene: Scene, group: Sequence[tuple[Entry, Snapshot]], height: float) -> tuple[Limits, Limits]:
    """Limits of the enlarged part, around the process zone; its frame is ``height`` inches high."""
    body = scene.specimen
    zone = next((z for _, s in group if (z := process_zone(s)) is not None), (body.precrack, body.precrack))
    width = min(max(1.7 * (zone[1] - zone[0]), 5 * body.arm_thickness), 0.3 * body.length)
    middle = min(sum(zone) / 2, body.length - width / 2)
    reach = width * height / _CLOSE / 2
    return (middle - width / 2, middle + width / 2), (-reach, reach)


def _mark(axes: Axes, zoom: tuple[Limits, Limits]) -> None:
    (x0, x1), (y0, y1) = zoom
    frame = Rectangle((x0, y0), x1 - x0, y1 - y0, fill=False, edgecolor=colour("muted"), linewidth=0.6, zorder=5)
    axes.add_patch(frame)
