"""A specimen to scale, with its loads, supports and bond."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Rectangle

from verify.pages.style import WIDE, Panel, colour, drawing
from verify.pages.text import Units, number, quantity
from verify.scene.schema import Scene
from verify.scene.specimens.delamination import Delamination, Load, Support

#: Inches: smallest drawn thickness of the thinner body, length of an arrow, size of a foot.
_THINNEST, _ARROW, _FOOT = 5.0 / 72.0, 0.36, 0.12

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
        _loads(axes, body, scale, outer)
        if free and not body.supports:
            _foot(axes, (max(body.lengths) * scale, 0.0), (1.0, 0.0))
            _words(axes, max(body.lengths) * scale + 0.2, 0.0, "held in x;\nlower arm in y", 1.0, "muted")
        elif not free:
            _ground(axes, (0.0, -bottom), (body.lengths[1] * scale, -bottom), (0.0, -1.0))
        _supports(axes, body, scale, outer)
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
        return Panel.of(figure, key, f"Side view of the specimen of {scene.name}", _caption(body, thicker), "wide")


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


def _loads(axes: Axes, body: Delamination, scale: float, outer: Outer) -> None:
    """Arrows from the middles of loaded faces to beyond their outer edges, and on patches; couples by their sense."""
    for load in body.loads:
        (x, y), share = _middle(body, load, scale, outer), abs(load.share)
        on_end, out = load.side in ("left", "right"), -1.0 if load.side == "left" else 1.0
        label = f"{number(share, 3)} P" if share != 1.0 and body.supports else "P"
        if load.couple:
            _words(axes, x - 0.1, y, f"{'↺' if load.share > 0.0 else '↻'} {label}", -1.0, "bad")
            continue
        if not body.supports:
            moved = f", {'+' if load.share > 0 else '−'}Δ/2" if body.symmetric else ", Δ" if body.arms == 1 else ""
            label = f"P{moved}"
        edge = outer[load.body or 0] if on_end else y
        far = edge + np.sign(load.share if on_end else y) * _ARROW
        start, end = ((x, y), (x, far)) if on_end or (load.share < 0.0) != (y > 0.0) else ((x, far), (x, y))
        _arrow(axes, start, end, "-|>", "bad", 1.2)
        _words(axes, x + 0.08 * out, 0.4 * edge + 0.6 * far, label, out, "bad")


def _supports(axes: Axes, body: Delamination, scale: float, outer: Outer) -> None:
    """Feet below and above faces, and walls along which an end slides in X."""
    for support in body.supports:
        if support.side in ("top", "bottom"):
            _foot(axes, _middle(body, support, scale, outer), (0.0, 1.0 if support.side == "top" else -1.0))
    for side, x, out in (("left", 0.0, -1.0), ("right", body.lengths[0] * scale, 1.0)):
        couples = [support.couple for support in body.supports if support.side == side]
        if couples:
            _ground(axes, (x, outer[1] - 0.08), (x, outer[0] + 0.08), (out, 0.0))
            words = [*["held in y"] * (not all(couples)), *["does not turn"] * any(couples)]
            _words(axes, x + 0.16 * out, 0.0, "\n".join(words), out, "muted")


def _middle(body: Delamination, patch: Load | Support, scale: float, outer: Outer) -> tuple[float, float]:
    """The middle of a patch."""
    X = body.middle(patch) * scale
    if patch.side in ("left", "right"):
        return X, sum(outer) / 2 if patch.body is None else outer[patch.body] / 2
    on_bond = (patch.side == "bottom") == (patch.body == 0)
    return X, 0.0 if on_bond else outer[patch.body or 0]


def _words(axes: Axes, x: float, y: float, text: str, out: float, ink: str) -> None:
    """A text that goes away from the body."""
    axes.text(x, y, text, fontsize=7.5, color=colour(ink), ha="left" if out > 0.0 else "right", va="center")


def _arrow(axes: Axes, start: tuple[float, float], end: tuple[float, float], kind: str, ink: str, width: float) -> None:
    arrow = {"arrowstyle": kind, "color": colour(ink), "linewidth": width, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", end, start, arrowprops=arrow, zorder=5)


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
    """Lines with arrows at both ends and labels below."""
    lengths, thicknesses = ([quantity(value, units.length) for value in v] for v in (body.lengths, body.thicknesses))
    sizes = f"length {lengths[0]}; two arms of thickness {thicknesses[0]}"
    if not body.symmetric:
        each = zip(body.bodies, lengths, thicknesses, strict=True)
        sizes = "; ".join(f"{name} {length} by {thick}" for name, length, thick in each)
    free, bond = ("precrack", "interface") if body.arms == 2 else ("free", "bond")
    for ends, height, word, ink in (
        ((body.loaded_at, body.tip), y, free, "muted"),
        (body.bonded, y, bond, "accent"),
        ((0.0, body.lengths[0]), y - 0.25, f"{sizes}, width {quantity(body.width, units.length)}", "muted"),
    ):
        start, end = sorted(ends)
        label = f"{word} {quantity(end - start, units.length)}" if word in (free, bond) else word
        _arrow(axes, (start * scale, height), (end * scale, height), "<->", ink, 0.7)
        middle = 0.5 * scale * (start + end), height - 0.035
        axes.text(*middle, label, ha="center", va="top", color=colour(ink), fontsize=7.5)
