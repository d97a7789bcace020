"""A specimen to scale, with its load, supports and bond."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Rectangle

from verify.pages.style import WIDE, Panel, colour, drawing, to_svg
from verify.pages.text import Units, number, quantity
from verify.report.figures.supports import acting, pull
from verify.scene.specimens.delamination import Delamination

if TYPE_CHECKING:
    from verify.scene.schema import Scene

_THINNEST = 5.0 / 72.0  # smallest drawn thickness of the thinner body, inches
_ARROW, _LABEL = 0.36, 0.22  # heights of the arrow of a load and of its label above or below the body, inches


def specimen(scene: Scene, key: str, zone: tuple[float, float, float] | None = None) -> Panel:
    """Side view of a specimen.

    Parameters
    ----------
    zone : start and end of the process zone as distances from the loaded end, and the opening
    """
    body, units, free = scene.specimen, Units.of(scene.units), not scene.specimen.clamps
    # inches for labels beside the bodies, for the load above and for the dimensions below
    left, right, above, below = (0.9, 1.2, 0.73, 1.03) if free else (0.5, 0.9, 0.75, 0.85)
    scale = (WIDE - left - right) / max(body.lengths)  # inches per unit of length
    thicker = max(1.0, _THINNEST / (min(body.thicknesses) * scale))
    top, bottom = (thickness * scale * thicker for thickness in body.thicknesses)
    with drawing():
        figure = Figure(figsize=(WIDE, above + top + bottom + below))
        axes = figure.add_axes((0, 0, 1, 1))
        axes.set_axis_off()
        axes.set(xlim=(-left, WIDE - left), ylim=(-bottom - below, top + above))
        for length, y, thickness in zip(body.lengths, (0.0, -bottom), (top, bottom), strict=True):
            _rectangle(axes, length * scale, y, thickness)
        _bond(axes, body, scale)
        if body.supports:
            acting(axes, body, scale, (top, -bottom))
        else:
            _loads(axes, body, scale, (top, -bottom))
            _float(axes, max(body.lengths) * scale) if free else _clamp(axes, body.lengths[1] * scale, -bottom)
        _dimensions(axes, body, units, scale, -bottom - (0.44 if free else 0.22))
        if zone is not None and zone[1] > zone[0]:
            start, end = sorted(body.place(s) * scale for s in zone[:2])
            mark_zone(axes, start, end, top + (0.6 if body.supports else 0.42), zone_label(zone, units))
        svg = to_svg(figure, key, f"Side view of the specimen of {scene.name}")
    return Panel(svg, _caption(body, thicker), "wide")


def _caption(body: Delamination, thicker: float) -> str:
    exaggerated = f"lengths to scale, {body.body}s {number(thicker, 2)} times too thick"
    drawn = f"The undeformed specimen, {exaggerated if thicker > 1.001 else 'to scale'}."
    if body.supports:
        return (
            f"{drawn} Loads and supports act on patches, a load as an even dead traction with its share of the load P. "
            "The opening is what P works on: the sum of these shares times the mean displacements, or rotations, of "
            "their patches. A support holds the mean displacement of its patch at 0."
        )
    if not body.clamps:
        return (
            f"{drawn} The load is a uniform dead traction on each loaded face, its resultant is the load P; the "
            "opening Δ is the separation of the mean displacements of the two faces. The supports carry nothing."
        )
    upper, lower = body.bodies
    return (
        f"{drawn} The load P is the resultant of a uniform dead traction on the {body.loads[0].side} end of the "
        f"{upper}; the opening Δ is the mean displacement of that face. The base of the {lower} is clamped; nothing "
        "else is held across the specimen."
    )


def _rectangle(axes: Axes, length: float, y: float, thickness: float) -> None:
    axes.add_patch(
        Rectangle((0, y), length, thickness, facecolor=colour("muted"), alpha=0.28, edgecolor="none", zorder=1)
    )
    frame = Rectangle((0, y), length, thickness, fill=False, edgecolor=colour("ink"), linewidth=0.6, zorder=2)
    axes.add_patch(frame)


def _bond(axes: Axes, body: Delamination, scale: float) -> None:
    """The bond, and the crack between two arms."""
    begins = 0.0 if body.slides else body.loaded_at
    cracked = [((begins, body.tip), "paper")] if body.arms == 2 else []
    for ends, ink in (*cracked, (body.bonded, "accent")):
        x = [end * scale for end in sorted(ends)]
        axes.plot(x, [0, 0], color=colour(ink), linewidth=2.0, zorder=3, solid_capstyle="butt")


def _loads(axes: Axes, body: Delamination, scale: float, outer: tuple[float, float]) -> None:
    """Arrows from the middles of the loaded faces to beyond their ``outer`` edges."""
    for load in body.loads:
        loaded, left = load.body or 0, load.side == "left"
        sign, edge = np.sign(load.share), outer[loaded]
        x, beside, align = (0.0, -0.1, "right") if left else (body.lengths[loaded] * scale, 0.1, "left")
        pull(axes, (x, edge / 2), sign * (abs(edge) / 2 + _ARROW))
        moved = f", {'+' if load.share > 0 else '−'}Δ/2" if body.symmetric else ", Δ" if body.arms == 1 else ""
        axes.text(x + beside, edge + sign * _LABEL, f"P{moved}", ha=align, va="center", color=colour("bad"))


def _clamp(axes: Axes, length: float, y: float) -> None:
    """Hatching below the base."""
    feet = np.linspace(0.0, length, max(round(length / 0.12), 2))
    axes.plot([0, length], [y, y], color=colour("ink"), linewidth=1.0, zorder=3)
    for x in feet:
        axes.plot([x, x - 0.07], [y, y - 0.09], color=colour("muted"), linewidth=0.6)


def _float(axes: Axes, length: float) -> None:
    """The support of a specimen whose loads balance each other."""
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


def _dimensions(axes: Axes, body: Delamination, units: Units, scale: float, y: float) -> None:
    free, bond = ("precrack", "interface") if body.arms == 2 else ("free", "bond")
    for word, ends, ink in ((free, (body.loaded_at, body.tip), "muted"), (bond, body.bonded, "accent")):
        start, end = sorted(ends)
        measure(axes, start * scale, end * scale, y, f"{word} {quantity(end - start, units.length)}", ink)
    lengths, thicknesses, (width,) = (
        [quantity(value, units.length) for value in values] for values in (body.lengths, body.thicknesses, [body.width])
    )
    if body.symmetric:
        sizes = f"length {lengths[0]}; two arms of thickness {thicknesses[0]}, width {width}"
    else:
        each = zip(body.bodies, lengths, thicknesses, strict=True)
        sizes = "; ".join([*(f"{name} {length} by {thick}" for name, length, thick in each), f"width {width}"])
    measure(axes, 0, body.lengths[0] * scale, y - 0.25, sizes)


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
