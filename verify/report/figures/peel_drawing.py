"""The specimen of a peel test to scale, with its load, clamp and interface."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from verify.pages.style import WIDE, Panel, colour, drawing, to_svg
from verify.pages.text import Units, quantity
from verify.report.figures.drawing import mark_zone, measure, pull, zone_label
from verify.scene.bodies import Peel

if TYPE_CHECKING:
    from verify.scene.schema import Scene

_ABOVE_STRIP, _BELOW_SUBSTRATE = 0.75, 0.85  # inches for the load and for the dimensions
_LEFT, _RIGHT = 0.5, 0.9


def specimen(scene: Scene, key: str, zone: tuple[float, float, float] | None = None) -> Panel:
    """Side view of strip and substrate.

    Parameters
    ----------
    zone : start and end of the process zone as distances from the loaded end, and the opening
    """
    body, units = scene.specimen, Units.of(scene.units)
    assert isinstance(body, Peel)
    longest = max(body.strip_length, body.substrate_length)
    scale = (WIDE - _LEFT - _RIGHT) / longest  # inches per unit of length
    top, bottom = body.strip_thickness * scale, body.substrate_thickness * scale
    height = _ABOVE_STRIP + top + bottom + _BELOW_SUBSTRATE
    with drawing():
        figure = Figure(figsize=(WIDE, height))
        axes = figure.add_axes((0, 0, 1, 1))
        axes.set_axis_off()
        axes.set(xlim=(-_LEFT, WIDE - _LEFT), ylim=(-bottom - _BELOW_SUBSTRATE, top + _ABOVE_STRIP))
        for length, base, thick in ((body.strip_length, 0.0, top), (body.substrate_length, -bottom, bottom)):
            _body(axes, length * scale, base, thick)
        bond = body.bond_length * scale
        axes.plot([0, bond], [0, 0], color=colour("accent"), linewidth=2.0, zorder=3, solid_capstyle="butt")
        _clamp(axes, body.substrate_length * scale, -bottom)
        _load(axes, body.strip_length * scale, top)
        _dimensions(axes, body, units, scale, -bottom)
        if zone is not None and zone[1] > zone[0]:
            start, end = (body.place(s) * scale for s in zone[1::-1])
            mark_zone(axes, start, end, top + 0.4, zone_label(zone, units))
        svg = to_svg(figure, key, f"Side view of the specimen of {scene.name}")
    caption = (
        "The undeformed specimen, to scale. The load P is the resultant of a uniform dead traction on the right end of "
        "the strip; the opening Δ is the mean displacement of that face. The base of the substrate is clamped; nothing "
        "else is held across the specimen."
    )
    return Panel(svg, caption, "wide")


def _body(axes: Axes, length: float, base: float, thickness: float) -> None:
    axes.add_patch(
        Rectangle((0, base), length, thickness, facecolor=colour("muted"), alpha=0.28, edgecolor="none", zorder=1)
    )
    frame = Rectangle((0, base), length, thickness, fill=False, edgecolor=colour("ink"), linewidth=0.6, zorder=2)
    axes.add_patch(frame)


def _clamp(axes: Axes, length: float, y: float) -> None:
    """Hatching below the base."""
    feet = np.linspace(0.0, length, max(round(length / 0.12), 2))
    axes.plot([0, length], [y, y], color=colour("ink"), linewidth=1.0, zorder=3)
    for x in feet:
        axes.plot([x, x - 0.07], [y, y - 0.09], color=colour("muted"), linewidth=0.6)


def _load(axes: Axes, x: float, top: float) -> None:
    pull(axes, (x, top / 2), top / 2 + 0.4)
    axes.text(x + 0.1, top + 0.25, "P, Δ", ha="left", va="center", color=colour("bad"))


def _dimensions(axes: Axes, body: Peel, units: Units, scale: float, bottom: float) -> None:
    lengths = (body.bond_length, body.strip_length, body.strip_thickness)
    depths = (body.substrate_length, body.substrate_thickness, body.width)
    bond, strip, thick, substrate, depth, width = (quantity(v, units.length) for v in (*lengths, *depths))
    free = quantity(body.free_length, units.length)
    tip, end, y = body.bond_length * scale, body.strip_length * scale, bottom - 0.22
    measure(axes, 0, tip, y, f"bond {bond}", "accent")
    measure(axes, tip, end, y, f"free {free}")
    measure(axes, 0, end, y - 0.27, f"strip {strip} by {thick}; substrate {substrate} by {depth}; width {width}")
