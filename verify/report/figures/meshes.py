"""Deformed meshes at true scale with the stress in them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from verify.pages.paint import paint
from verify.pages.style import STRESS_MAP, WIDE, Panel, colour, drawing, to_svg
from verify.pages.text import Units, axis, quantity
from verify.report.figures.entry import Entry
from verify.report.figures.layout import LEFT, WHOLE, frame, mark, rows, zoom
from verify.result import Snapshot

if TYPE_CHECKING:
    from verify.scene.schema import Scene


def deformed(scene: Scene, group: Sequence[tuple[Entry, Snapshot]], key: str) -> Panel | None:
    """Deformed meshes at true scale, one row per method, with the process zone enlarged; None without stresses."""
    group = [(entry, snapshot) for entry, snapshot in group if np.size(snapshot.stress_euv)]
    if not group:
        return None
    units = Units.of(scene.units)
    limit = max(float(np.nanpercentile(np.abs(s.stress_euv), 99.7)) for _, s in group) or 1.0
    x, y = frame(scene, [snapshot for _, snapshot in group])
    height = WHOLE * (y[1] - y[0]) / (x[1] - x[0])
    part = zoom(scene, [snapshot for _, snapshot in group], height)
    with drawing():
        figure, pairs = rows(len(group), height, 0.95)
        for (whole, close), (entry, snapshot) in zip(pairs, group, strict=True):
            x_euvi = np.asarray(snapshot.X_euvi) + np.asarray(snapshot.u_euvi)
            paint(whole, x_euvi, np.asarray(snapshot.stress_euv), limit, (x, y))
            paint(close, x_euvi, np.asarray(snapshot.stress_euv), limit, part)
            mark(whole, part)
            title = f"{entry.label}, opening {quantity(snapshot.opening, units.length, 3)}"
            whole.set_title(title, color=colour(entry.line.colour))
        pairs[-1][0].set_xlabel(axis("position", units.length))
        pairs[-1][1].set_xlabel(axis("position, enlarged", units.length))
        _scale(figure, limit, axis("Cauchy stress along the specimen", units.stress))
        svg = to_svg(figure, key, f"Deformed meshes with axial stress, {scene.name}", dpi=170)
    caption = (
        "Deformed meshes, displacements at true scale, each with its own elements; the framed part is enlarged on the "
        f"right. One scale of colours for all, to ± {quantity(limit, units.stress, 3)}; no averaging between elements."
    )
    return Panel(svg, caption, "wide")


def _scale(figure: Figure, limit: float, label: str) -> None:
    """The colour scale at the bottom of the figure."""
    height = figure.get_size_inches()[1]
    place = figure.add_axes((LEFT / WIDE, 0.42 / height, WHOLE / WIDE, 0.09 / height))
    bar = figure.colorbar(ScalarMappable(Normalize(-limit, limit), STRESS_MAP), cax=place, orientation="horizontal")
    bar.set_label(label)
    bar.outline.set_visible(False)
