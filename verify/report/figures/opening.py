"""The growing crack in frames, one per opening: stress in the arms, tractions, and the point on the load curve.

All frames have the same scales.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.transforms import Bbox

from verify.pages.paint import Limits, paint
from verify.pages.style import WIDE, Panel, break_labels, colour, drawing, sheet_of, to_svg
from verify.pages.text import Units, axis, number, quantity
from verify.report.figures.agreement import path
from verify.report.figures.entry import Entry
from verify.report.figures.fields import process_zone
from verify.report.figures.layout import CLOSE_UP, GAP, LEFT, WHOLE, frame
from verify.result import Snapshot

if TYPE_CHECKING:
    from verify.scene.schema import Scene

#: Pixels per inch of the stress: at openings that all runs have stored, and at those of the leading run alone.
_FINE, _COARSE = 150, 75

#: Inches: height of the tractions, gap to the arms above, bottom and top margins, space before the load curve.
_TRACTION, _BETWEEN, _BELOW_TRACTION, _ABOVE_ARMS, _CLEAR = 1.25, 0.3, 0.42, 0.24, 0.05


@dataclass(frozen=True)
class Frame:
    """One opening."""

    opening: str
    text: str  # of the slider: opening, load, process zone
    panel: Panel


@dataclass(frozen=True)
class Scales:
    """Scales of all frames: largest stress, limits along x and y, limits of the traction."""

    stress: float
    x: Limits
    y: Limits
    traction: Limits


def frames(
    scene: Scene,
    groups: Sequence[Sequence[tuple[Entry, Snapshot]]],
    drawn: Sequence[Entry],
    key: str,
    between: bool = True,
) -> tuple[Frame, ...]:
    """Frames of the leading run with the tractions of all runs; empty where fewer than two openings were stored.

    With ``between``, also at the openings that only the leading run has stored, with fewer pixels.

    Parameters
    ----------
    groups : runs with their snapshots, by opening
    drawn : all runs with a curve
    """
    shown = [(group, lead) for group in groups if (lead := _lead(group)) is not None]
    if len(shown) < 2:
        return ()
    leader, openings = shown[0][1][0], {snapshot.opening for _, (_, snapshot) in shown}
    others = [other for other in leader.result.between if between and other.opening not in openings]
    alone = [[(leader, snapshot)] for snapshot in others]
    shown = sorted([*shown, *((group, group[0]) for group in alone)], key=lambda one: one[1][1].opening)
    limit = max(float(np.nanpercentile(np.abs(s.stress_euv), 99.7)) for _, (_, s) in shown) or 1.0
    limits = frame(scene, [snapshot for _, (_, snapshot) in shown])
    strength = scene.interface.strength
    least = min(float(np.nanmin(snapshot.traction_q, initial=0.0)) for group, _ in shown for _, snapshot in group)
    scales = Scales(limit, *limits, (1.1 * max(least, -3.0 * strength) - 0.1 * strength, 1.2 * strength))
    with drawing():
        pictures = [_picture(scene, group, lead, drawn, scales) for group, lead in shown]
        _apart(pictures)
        for picture in pictures:
            break_labels(picture)
        leaders = {lead[0].label: picture for picture, (_, lead) in zip(pictures, shown, strict=True)}
        sheet = Bbox.union([sheet_of(picture) for picture in leaders.values()])  # the others have the same labels
        return tuple(
            _one(scene, lead, scales, picture, sheet, f"{key}-{i}")
            for i, (picture, (_, lead)) in enumerate(zip(pictures, shown, strict=True))
        )


def _lead(group: Sequence[tuple[Entry, Snapshot]]) -> tuple[Entry, Snapshot] | None:
    """The run whose arms are drawn: NURBS, or else the first run with stresses."""
    able = [(entry, snapshot) for entry, snapshot in group if np.size(snapshot.stress_euv)]
    return min(able, key=lambda pair: pair[0].method != "nurbs", default=None)


def _one(scene: Scene, lead: tuple[Entry, Snapshot], scales: Scales, picture: Figure, sheet: Bbox, key: str) -> Frame:
    """A picture with its caption."""
    (entry, snapshot), units, text = lead, Units.of(scene.units), _text(scene, lead[1])
    whose = entry.label if _between(entry, snapshot) else "all runs with fields"
    caption = (
        f"{text[:1].upper()}{text[1:]}. True scale, stress to ± {quantity(scales.stress, units.stress, 3)}; below, the "
        f"normal traction of {whose} along the same axis, and on the right the place on the curve."
    )
    svg = to_svg(picture, key, f"The crack of {scene.name}: {text}", sheet=sheet)
    return Frame(quantity(snapshot.opening, units.length, 3), text, Panel(svg, caption, "wide"))


def _between(entry: Entry, snapshot: Snapshot) -> bool:
    """Whether only this run has stored the opening."""
    return any(snapshot is other for other in entry.result.between)


def _picture(
    scene: Scene,
    group: Sequence[tuple[Entry, Snapshot]],
    lead: tuple[Entry, Snapshot],
    drawn: Sequence[Entry],
    scales: Scales,
) -> Figure:
    """The arms, the tractions below, and the load curve on the right."""
    (entry, snapshot), x, y = lead, scales.x, scales.y
    height = WHOLE * (y[1] - y[0]) / (x[1] - x[0])
    total = _ABOVE_ARMS + height + _BETWEEN + _TRACTION + _BELOW_TRACTION
    figure = Figure(figsize=(WIDE, total))

    def place(left: float, bottom: float, width: float, high: float) -> Axes:
        return figure.add_axes((left / WIDE, bottom / total, width / WIDE, high / total))

    arms = place(LEFT, _BELOW_TRACTION + _TRACTION + _BETWEEN, WHOLE, height)
    tractions = place(LEFT, _BELOW_TRACTION, WHOLE, _TRACTION)
    load = place(LEFT + WHOLE + GAP, _BELOW_TRACTION, CLOSE_UP, total - _BELOW_TRACTION - _ABOVE_ARMS)
    x_euvi = np.asarray(snapshot.X_euvi) + np.asarray(snapshot.u_euvi)
    dpi = _COARSE if _between(entry, snapshot) else _FINE
    paint(arms, x_euvi, np.asarray(snapshot.stress_euv), scales.stress, (x, y), dpi)
    arms.grid(False)
    arms.set_title(f"{entry.label}, stress along the specimen", color=colour(entry.line.colour))
    arms.tick_params(labelbottom=False)
    _tractions(tractions, scene, group, scales)
    _place(load, scene, [other for other in drawn if other.method != "lefm"], entry, snapshot)
    return figure


def _apart(pictures: Sequence[Figure]) -> None:
    """Move the load curves so that their tick labels, those of the first picture, do not overlap the tractions."""
    _, tractions, load = pictures[0].axes[:3]
    ends, begins = tractions.get_tightbbox(), load.yaxis.get_tightbbox()
    if ends is None or begins is None:
        return
    reach = max(ends.x1 - begins.x0 + _CLEAR * pictures[0].dpi, 0.0) / pictures[0].bbox.width
    for picture in pictures:
        picture.axes[2].set_position(picture.axes[2].get_position().translated(reach, 0.0))


def _tractions(axes: Axes, scene: Scene, group: Sequence[tuple[Entry, Snapshot]], scales: Scales) -> None:
    units = Units.of(scene.units)
    for entry, snapshot in group:
        at = np.array([scene.specimen.place(s) for s in snapshot.s_q])
        axes.plot(at, snapshot.traction_q, **entry.line.options())
    zone = process_zone(group[0][1])
    if zone is not None:
        axes.axvspan(*sorted(map(scene.specimen.place, zone)), color=colour("zone"), alpha=0.22, linewidth=0, zorder=0)
    axes.axhline(0, color=colour("ink"), linewidth=0.5)
    axes.set(xlim=scales.x, ylim=scales.traction)
    axes.set(xlabel=axis("position", units.length), ylabel=axis("traction", units.stress))


def _place(axes: Axes, scene: Scene, drawn: Sequence[Entry], entry: Entry, snapshot: Snapshot) -> None:
    """The load curve of the leading run with the point of the frame."""
    units, ink = Units.of(scene.units), colour(entry.line.colour)
    axes.plot(*path(entry.result, 2), **entry.line.options())
    axes.plot(snapshot.opening, snapshot.load, "o", color=ink, markersize=6, zorder=6)
    top = max(float(np.nanmax(other.result.load)) for other in drawn)
    lowest = min(0.0, float(np.nanmin(entry.result.load)))
    axes.set(xlim=(0, None), ylim=(1.05 * lowest, 1.08 * top))
    axes.set(xlabel=axis("opening", units.length), ylabel=axis("load", units.force))
    axes.locator_params(axis="x", nbins=4)


def _text(scene: Scene, snapshot: Snapshot) -> str:
    """Opening, load and the process zone in words."""
    units, zone = Units.of(scene.units), process_zone(snapshot)
    text = f"opening {quantity(snapshot.opening, units.length, 3)}, load {quantity(snapshot.load, units.force, 3)}"
    if zone is None:
        return f"{text}, bond intact"
    return f"{text}, process zone {number(zone[0], 3)} to {quantity(zone[1], units.length, 3)} from the loaded end"
