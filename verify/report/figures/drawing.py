"""The specimen to scale, with its load, supports and interface."""

from __future__ import annotations

from typing import TYPE_CHECKING

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Rectangle

from verify.pages.style import WIDE, Panel, colour, drawing, to_svg
from verify.pages.text import Units, number, quantity
from verify.scene.bodies import Dcb

if TYPE_CHECKING:
    from verify.scene.schema import Scene

_LOAD_HEIGHT, _DIMENSIONS_HEIGHT = 0.73, 1.03  # for the load and for the dimensions, inches
_THINNEST = 5.0 / 72.0  # smallest drawn thickness of an arm, inches


def specimen(scene: Scene, key: str, zone: tuple[float, float, float] | None = None) -> Panel:
    """Side view of the double cantilever beam.

    Parameters
    ----------
    zone : start and end of the process zone along the specimen, and the opening
    """
    body, units = scene.specimen, Units.of(scene.units)
    assert isinstance(body, Dcb)
    scale = (WIDE - 2.1) / body.length  # inches per unit of length
    thickness = max(body.arm_thickness * scale, _THINNEST)
    with drawing():
        figure = Figure(figsize=(WIDE, _LOAD_HEIGHT + 2 * thickness + _DIMENSIONS_HEIGHT))
        axes = figure.add_axes((0, 0, 1, 1))
        axes.set_axis_off()
        # inches from the middle of the loaded end
        axes.set(xlim=(-0.9, WIDE - 0.9), ylim=(-thickness - _DIMENSIONS_HEIGHT, thickness + _LOAD_HEIGHT))
        _bodies(axes, body.length * scale, body.precrack * scale, thickness)
        _loads(axes, thickness)
        _supports(axes, body.length * scale)
        _dimensions(axes, body, units, scale, thickness)
        if zone is not None and zone[1] > zone[0]:
            mark_zone(axes, zone[0] * scale, zone[1] * scale, thickness + 0.42, zone_label(zone, units))
        svg = to_svg(figure, key, f"Side view of the specimen of {scene.name}")
    exaggeration = thickness / (body.arm_thickness * scale)
    thick = f"lengths to scale, arms {number(exaggeration, 2)} times too thick" if exaggeration > 1.001 else "to scale"
    caption = (
        f"The undeformed specimen, {thick}. The load is a uniform dead traction on each loaded face, its resultant is "
        "the load P; the opening Δ is the separation of the mean displacements of the two faces. "
        "The supports carry nothing."
    )
    return Panel(svg, caption, "wide")


def _bodies(axes: Axes, length: float, precrack: float, thickness: float) -> None:
    for y in (0.0, -thickness):
        axes.add_patch(
            Rectangle((0, y), length, thickness, facecolor=colour("muted"), alpha=0.28, edgecolor="none", zorder=1)
        )
        frame = Rectangle((0, y), length, thickness, fill=False, edgecolor=colour("ink"), linewidth=0.6, zorder=2)
        axes.add_patch(frame)
    axes.plot([0, precrack], [0, 0], color=colour("paper"), linewidth=2.0, zorder=3, solid_capstyle="butt")
    axes.plot([precrack, length], [0, 0], color=colour("accent"), linewidth=2.0, zorder=3, solid_capstyle="butt")


def _loads(axes: Axes, thickness: float) -> None:
    for sign, label in ((1, "P, +Δ/2"), (-1, "P, −Δ/2")):
        pull(axes, (0, sign * thickness / 2), sign * (thickness / 2 + 0.36))
        axes.text(-0.1, sign * (thickness + 0.22), label, ha="right", va="center", color=colour("bad"))


def pull(axes: Axes, foot: tuple[float, float], length: float) -> None:
    """The arrow of a transverse load."""
    arrow = {"arrowstyle": "-|>", "color": colour("bad"), "linewidth": 1.2, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", (foot[0], foot[1] + length), foot, arrowprops=arrow, zorder=5)


def _supports(axes: Axes, length: float) -> None:
    size = 0.11
    axes.add_patch(
        Polygon(
            [(length, 0), (length + size, size * 0.65), (length + size, -size * 0.65)],
            facecolor=colour("paper"),
            edgecolor=colour("ink"),
            linewidth=0.7,
            zorder=4,
        )
    )
    axes.plot([length + size] * 2, [-0.13, 0.13], color=colour("ink"), linewidth=0.9)
    note = "held in x;\nlower arm in y"
    axes.text(length + size + 0.06, 0, note, ha="left", va="center", fontsize=7, color=colour("muted"))


def _dimensions(axes: Axes, body: Dcb, units: Units, scale: float, thickness: float) -> None:
    below = -thickness - 0.44
    a, length = body.precrack * scale, body.length * scale
    length_of, thick, wide = (quantity(v, units.length) for v in (body.length, body.arm_thickness, body.width))
    measure(axes, 0, a, below, f"precrack {quantity(body.precrack, units.length)}")
    measure(axes, a, length, below, f"interface {quantity(body.length - body.precrack, units.length)}", "accent")
    whole = f"length {length_of}; two arms of thickness {thick}, width {wide}"
    measure(axes, 0, length, below - 0.25, whole)


def measure(axes: Axes, start: float, end: float, y: float, label: str, ink: str = "muted") -> None:
    """A line with arrows at both ends and its label below."""
    arrow = {"arrowstyle": "<->", "color": colour(ink), "linewidth": 0.7, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", (end, y), (start, y), arrowprops=arrow)
    axes.text((start + end) / 2, y - 0.035, label, ha="center", va="top", color=colour(ink), fontsize=7.5)


def zone_label(zone: tuple[float, float, float], units: Units) -> str:
    """Opening and length of the process zone in words."""
    start, end, opening = zone
    length = quantity(end - start, units.length, 2)
    return f"process zone at opening {quantity(opening, units.length, 3)}: {length} long"


def mark_zone(axes: Axes, start: float, end: float, y: float, label: str) -> None:
    """The process zone on the interface, Y = 0, and its label at height ``y``."""
    axes.plot((start, end), (0, 0), color=colour("zone"), linewidth=4.0, zorder=6, solid_capstyle="butt")
    line = {"arrowstyle": "-", "color": colour("muted"), "linewidth": 0.6}
    middle = (start + end) / 2
    axes.annotate(label, (middle, 0.03), (middle, y), ha="center", va="center", fontsize=7.5, arrowprops=line)
