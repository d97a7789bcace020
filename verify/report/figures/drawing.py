"""A specimen to scale, with its loads, supports and bond."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Arc, Polygon, Rectangle

from verify.pages.style import WIDE, Panel, colour, drawing, to_svg
from verify.pages.text import Units, number, quantity
from verify.scene.specimens.delamination import Delamination, Load, Support

if TYPE_CHECKING:
    from verify.scene.schema import Scene

#: Inches: smallest drawn thickness of the thinner body, length of an arrow, size of a foot, radius of a couple.
_THINNEST, _ARROW, _FOOT, _TURN = 5.0 / 72.0, 0.36, 0.12, 0.17

#: Heights of the outer faces of the upper and the lower body, in inches over the bond.
Outer = tuple[float, float]


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
    outer = top, -bottom
    with drawing():
        figure = Figure(figsize=(WIDE, above + top + bottom + below))
        axes = figure.add_axes((0, 0, 1, 1))
        axes.set_axis_off()
        axes.set(xlim=(-left, WIDE - left), ylim=(-bottom - below, top + above))
        for length, y, thickness in zip(body.lengths, (0.0, -bottom), (top, bottom), strict=True):
            box = (0, y), length * scale, thickness
            axes.add_patch(Rectangle(*box, facecolor=colour("muted"), alpha=0.28, edgecolor="none", zorder=1))
            axes.add_patch(Rectangle(*box, fill=False, edgecolor=colour("ink"), linewidth=0.6, zorder=2))
        begins = 0.0 if body.slides else body.loaded_at
        cracked = [((begins, body.tip), "paper")] if body.arms == 2 else []
        for ends, ink in (*cracked, (body.bonded, "accent")):
            x = scale * np.sort(ends)
            axes.plot(x, [0, 0], color=colour(ink), linewidth=2.0, zorder=3, solid_capstyle="butt")
        if body.supports:
            _patches(axes, body, scale, outer)
        else:
            _pulls(axes, body, scale, outer)
            if free:
                _foot(axes, (max(body.lengths) * scale, 0.0), (1.0, 0.0))
                _note(axes, max(body.lengths) * scale + 0.2, "held in x;\nlower arm in y", "left")
            else:
                _ground(axes, (0.0, -bottom), (body.lengths[1] * scale, -bottom), (0.0, -1.0))
        _dimensions(axes, body, units, scale, -bottom - (0.44 if free else 0.22))
        if zone is not None and zone[1] > zone[0]:
            damaged = np.sort([body.place(s) * scale for s in zone[:2]])
            axes.plot(damaged, (0, 0), color=colour("zone"), linewidth=4.0, zorder=6, solid_capstyle="butt")
            long, at = quantity(zone[1] - zone[0], units.length, 2), quantity(zone[2], units.length, 3)
            line = {"arrowstyle": "-", "color": colour("muted"), "linewidth": 0.6}
            middle, height = float(damaged.mean()), top + (0.6 if body.supports else 0.42)
            said = f"process zone at opening {at}: {long} long"
            label = axes.annotate(said, (middle, 0.03), (middle, height), arrowprops=line)
            label.set(ha="center", va="center", fontsize=7.5)
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


def _pulls(axes: Axes, body: Delamination, scale: float, outer: Outer) -> None:
    """Arrows from the middles of the loaded faces to beyond their outer edges."""
    for load in body.loads:
        loaded, left = load.body or 0, load.side == "left"
        sign, edge = np.sign(load.share), outer[loaded]
        x, beside, align = (0.0, -0.1, "right") if left else (body.lengths[loaded] * scale, 0.1, "left")
        _arrow(axes, (x, edge / 2), (x, edge + sign * _ARROW))
        moved = f", {'+' if load.share > 0 else '−'}Δ/2" if body.symmetric else ", Δ" if body.arms == 1 else ""
        axes.text(x + beside, edge + sign * 0.22, f"P{moved}", ha=align, va="center", color=colour("bad"))


def _patches(axes: Axes, body: Delamination, scale: float, outer: Outer) -> None:
    """Arrows of loads, feet and walls of supports on patches."""
    for load in body.loads:
        x, y = _middle(body, load, scale, outer)
        label = f"{number(abs(load.share), 3)} P" if abs(load.share) != 1.0 else "P"
        if load.couple:  # an arc on the left of a face, its arrow at the lower end where it turns anticlockwise
            look = {"color": colour("bad"), "linewidth": 1.2, "zorder": 5}
            axes.add_patch(Arc((x - 0.02, y), 2 * _TURN, 2 * _TURN, theta1=100, theta2=260)).set(**look)
            up = -1.0 if load.share > 0.0 else 1.0
            at = x - 0.02 + _TURN * np.cos(np.radians(100.0)), y + up * _TURN * np.sin(np.radians(100.0))
            _arrow(axes, (at[0] - 0.03, at[1] - 0.01 * up), (at[0] + 0.09, at[1]))
            axes.text(x - _TURN - 0.08, y, label, ha="right", va="center", color=colour("bad"))
            continue
        far = y + np.sign(y) * _ARROW
        _arrow(axes, *(((x, far), (x, y)) if (load.share < 0.0) == (y > 0.0) else ((x, y), (x, far))))
        axes.text(x + 0.06, far - 0.06 * np.sign(y), label, ha="left", va="center", color=colour("bad"))
    for support in body.supports:
        if support.side in ("top", "bottom"):
            _foot(axes, _middle(body, support, scale, outer), (0.0, 1.0 if support.side == "top" else -1.0))
    for side, x, out in (("left", 0.0, -1.0), ("right", body.lengths[0] * scale, 1.0)):
        couples = [support.couple for support in body.supports if support.side == side]
        if couples:  # a wall along which the end slides in X
            _ground(axes, (x, outer[1] - 0.08), (x, outer[0] + 0.08), (out, 0.0))
            words = [*["held in y"] * (not all(couples)), *["does not turn"] * any(couples)]
            _note(axes, x + 0.16 * out, "\n".join(words), "right" if side == "left" else "left")


def _middle(body: Delamination, patch: Load | Support, scale: float, outer: Outer) -> tuple[float, float]:
    """The middle of a patch."""
    end = 0.0 if patch.side == "left" else body.lengths[patch.body or 0]
    X = (end if patch.extent is None else sum(patch.extent) / 2) * scale
    if patch.side in ("left", "right"):
        return X, sum(outer) / 2 if patch.body is None else outer[patch.body] / 2
    on_bond = (patch.side == "bottom") == (patch.body == 0)
    return X, 0.0 if on_bond else outer[patch.body or 0]


def _arrow(axes: Axes, foot: tuple[float, float], tip: tuple[float, float]) -> None:
    arrow = {"arrowstyle": "-|>", "color": colour("bad"), "linewidth": 1.2, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", tip, foot, arrowprops=arrow, zorder=5)


def _note(axes: Axes, x: float, text: str, align: str) -> None:
    axes.text(x, 0.0, text, fontsize=7, color=colour("muted"), ha=align, va="center")


def _foot(axes: Axes, tip: tuple[float, float], out: tuple[float, float]) -> None:
    """A triangle that touches the body, on rollers; ``out`` leads away from the body."""
    away, along = _FOOT * np.array(out), _FOOT * np.array(out[::-1])
    corners = tip + np.array([0.0 * away, away - 0.7 * along, away + 0.7 * along])
    axes.add_patch(Polygon(corners, facecolor=colour("paper"), edgecolor=colour("ink"), linewidth=0.7, zorder=4))
    ends = tip + 1.25 * away + np.array([-along, along])
    axes.plot(*ends.T, color=colour("ink"), linewidth=0.9, zorder=4)


def _ground(axes: Axes, start: tuple[float, float], end: tuple[float, float], out: tuple[float, float]) -> None:
    """A line that does not move, with hatching on its side ``out``."""
    line = np.array([start, end])
    length = np.linalg.norm(line[1] - line[0])
    along = (line[1] - line[0]) / length
    feet = line[0] + along * np.linspace(0.0, length, max(round(length / 0.12), 5))[:, None]
    strokes = np.stack([feet, feet + 0.07 * (np.array(out) - along), np.full_like(feet, np.nan)], axis=1)
    axes.plot(*line.T, color=colour("ink"), linewidth=1.0, zorder=3)
    axes.plot(*strokes.reshape(-1, 2).T, color=colour("muted"), linewidth=0.6)


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
