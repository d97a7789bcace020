"""Undeformed meshes: the elements of every run, T-meshes and their T-junctions, and the process zone.

The bodies are drawn with a constant gap between them, so that the T-junctions on both sides of the bond are visible;
the process zone is a band in the gap.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from verify.pages.paint import Limits, inches, seen
from verify.pages.strokes import sides, strokes
from verify.pages.style import WIDE, Panel, colour, drawing, to_svg
from verify.pages.text import Units, axis, number, quantity
from verify.report.figures.entry import Entry
from verify.report.figures.fields import process_zone
from verify.report.figures.layout import LEFT, MOST_HEIGHT, WHOLE, mark, rows, zoom
from verify.result import Snapshot

if TYPE_CHECKING:
    from verify.scene.schema import Scene

#: Keywords of a matplotlib artist.
Style = Mapping[str, Any]

#: Inches: smallest height of a row, height of the legend, gap between the arms, which the process zone fills.
_LEAST_ROW, _LEGEND, _APART = 0.62, 0.68, 5.0 / 72.0

#: Distance from Y = 0, over the specimen's length, within which a point lies on the bond.
_ON_BOND = 1e-9

_LINES: Style = {"color": colour("ink"), "linewidth": 0.5, "zorder": 3}
_JUNCTIONS: Style = {"color": colour("bad"), "marker": "s", "markersize": 3.0, "markeredgewidth": 0.0, "zorder": 5}
_ELEMENTS: Style = {"linewidth": 0.45, "zorder": 2, "solid_capstyle": "butt"}
_ZONE: Style = {"color": colour("zone"), "linewidth": 72.0 * _APART, "zorder": 1, "solid_capstyle": "butt"}


def undeformed(scene: Scene, drawn: Sequence[Entry], key: str) -> Panel | None:
    """The mesh of every run, one row each; runs on the same mesh share a row."""
    shown = _distinct([(entry, snapshot) for entry in drawn if (snapshot := _last(entry)) is not None])
    if not shown:
        return None
    titled = [(entries[0], snapshot, _names(entries)) for entries, snapshot in shown]
    title = f"Meshes of all runs, {scene.name}"
    svg, stretch = _picture(scene, titled, key, title, moving=False)
    return Panel(svg, f"Undeformed meshes. {_explained(titled, stretch)}", "wide")


def followed(scene: Scene, drawn: Sequence[Entry], key: str) -> Panel | None:
    """T-meshes of an adaptive run at up to three openings; None where no run changes its mesh."""
    found = next(((entry, moves) for entry in drawn if len(moves := _changes(entry)) > 1), None)
    if found is None:
        return None
    entry, moves = found
    length = Units.of(scene.units).length
    titled = [(entry, s, f"Opening {quantity(s.opening, length, 3)}") for s in moves[-3:]]
    title = f"The T-mesh follows the process zone, {scene.name}"
    svg, _ = _picture(scene, titled, key, title, moving=True)
    head = f"The T-mesh follows the process zone ({entry.label}): fine ahead of the crack, coarse again behind it."
    return Panel(svg, f"{head} Drawn as above.", "wide")


def zone_at(scene: Scene, snapshot: Snapshot) -> Limits | None:
    """Start and end of the process zone along X; None without damage."""
    zone = process_zone(snapshot)
    if zone is None:
        return None
    start, end = sorted(map(scene.specimen.place, zone))
    return start, end


def bond_element(snapshot: Snapshot, zone: Limits) -> float:
    """Longest element side on the bond, of either body, that overlaps the process zone; NaN without one."""
    X_eki = _corners(snapshot)
    ends_nki = np.stack([X_eki, np.roll(X_eki, -1, axis=1)], axis=2).reshape(-1, 2, 2)
    near = _ON_BOND * np.ptp(X_eki[..., 0])
    x_nk = np.sort(ends_nki[np.all(np.abs(ends_nki[..., 1]) <= near, axis=1)][..., 0], axis=1)
    met = (x_nk[:, 1] > zone[0] + near) & (x_nk[:, 0] < zone[1] - near)
    return float(np.diff(x_nk[met], axis=1).max(initial=0.0)) or float("nan")


def draw(axes: Axes, snapshot: Snapshot, ink: str, frame: tuple[Limits, Limits], zone: Limits | None) -> None:
    """Draw the mesh within a frame, the limits of the axes: elements, T-mesh, T-junctions, process zone."""
    x, y = frame
    height = inches(axes)[1]
    apart = 0.5 * _APART / (height - _APART) * (y[1] - y[0])
    frame = x, (y[0] - apart, y[1] + apart)
    X_euvi = np.asarray(snapshot.X_euvi)
    side_e = np.sign(X_euvi[..., 1].mean(axis=(1, 2)))
    for side in np.unique(side_e):
        shift = np.array([0.0, side * apart])
        _plot(axes, sides(X_euvi[side_e == side]) + shift, frame, "elements", {**_ELEMENTS, "color": ink})
        _plot(axes, _of_arm(snapshot.line_nki, side) + shift, frame, "T-mesh", _LINES)
        points_nki = _of_arm(snapshot.junction_ni[:, None], side) + shift
        points_ni = points_nki[seen(points_nki, frame), 0]
        if len(points_ni):
            axes.plot(*points_ni.T, linestyle="none", label="T-junctions", **{**_JUNCTIONS, "markersize": 1.8})
    if zone is not None:
        axes.plot(zone, (0.0, 0.0), label="zone", **_ZONE)
    axes.set(xlim=frame[0], ylim=frame[1])


def _picture(
    scene: Scene, titled: Sequence[tuple[Entry, Snapshot, str]], key: str, title: str, moving: bool
) -> tuple[str, float]:
    """The drawing, and the factor by which the specimen is too thick on the left; ``moving``: a frame per row."""
    units = Units.of(scene.units)
    whole_frame, height, stretch = _frame(scene, [snapshot for _, snapshot, _ in titled])
    with drawing():
        figure, pairs = rows(len(titled), height, _LEGEND)
        for (whole, close), (entry, snapshot, name) in zip(pairs, titled, strict=True):
            part = zoom(scene, [snapshot] if moving else [s for _, s, _ in titled], height - _APART)
            zone = zone_at(scene, snapshot)
            for axes, frame in ((whole, whole_frame), (close, part)):
                draw(axes, snapshot, colour(entry.line.colour), frame, zone)
            mark(whole, (part[0], whole.get_ylim()))
            whole.spines["left"].set_visible(False)
            for axes in (whole, close):
                axes.set_yticks([])
            whole.set_title(f"{name}: {_counted(snapshot, zone, units)}", color=colour(entry.line.colour))
        pairs[-1][0].set_xlabel(axis("position", units.length))
        pairs[-1][1].set_xlabel(axis("position, enlarged", units.length))
        _legend(figure, any(len(snapshot.line_nki) for _, snapshot, _ in titled))
        return to_svg(figure, key, title), stretch


def _explained(titled: Sequence[tuple[Entry, Snapshot, str]], stretch: float) -> str:
    left = f"on the left {number(stretch, 2)} times too thick" if stretch > 1.01 else "on the left to scale"
    text = f"Bodies {left}, on the right to scale; drawn apart, with the process zone between them."
    if any(len(snapshot.junction_ni) for _, snapshot, _ in titled):
        text += (
            " Of T-splines the lines of the T-mesh are drawn over the Bézier elements. A line that ends at a T-junction"
            " on the bond adds a function to the row there alone; its extensions divide the elements beyond it."
        )
    return text


def _counted(snapshot: Snapshot, zone: Limits | None, units: Units) -> str:
    """Numbers of elements in total and in the process zone, and of T-junctions, in words."""
    text = f"{len(snapshot.X_euvi)} elements"
    text += f", {junctions} T-junctions" if (junctions := len(snapshot.junction_ni)) else ""
    if zone is not None and np.isfinite(element := bond_element(snapshot, zone)):
        count = number((zone[1] - zone[0]) / element, 2)
        text += f"; {count} of {quantity(element, units.length, 2)} in the process zone"
    return text


def _last(entry: Entry) -> Snapshot | None:
    """The last snapshot with a mesh, and with a process zone if there is one."""
    found = [snapshot for snapshot in entry.result.snapshots if np.size(snapshot.X_euvi)]
    zoned = [snapshot for snapshot in found if process_zone(snapshot) is not None]
    return next(reversed(zoned or found), None)


def _changes(entry: Entry) -> list[Snapshot]:
    """The last snapshot on each of the T-meshes of a run."""
    found = [snapshot for snapshot in entry.result.snapshots if len(snapshot.line_nki)]
    pairs = zip(found, found[1:], strict=False)
    return [before for before, after in pairs if not np.array_equal(before.line_nki, after.line_nki)] + found[-1:]


def _distinct(shown: Sequence[tuple[Entry, Snapshot]]) -> list[tuple[list[Entry], Snapshot]]:
    """Runs grouped by mesh: equal elements and equal T-meshes."""
    groups: dict[tuple[bytes, bytes], tuple[list[Entry], Snapshot]] = {}
    for entry, snapshot in shown:
        elements, lines = (
            (np.round(values, 9) + 0.0).tobytes()  # + 0.0 makes 0 of -0
            for values in (_corners(snapshot), snapshot.line_nki)
        )
        groups.setdefault((elements, lines), ([], snapshot))[0].append(entry)
    return list(groups.values())


def _names(entries: Sequence[Entry]) -> str:
    return " and ".join(entry.label for entry in entries)


def _corners(snapshot: Snapshot) -> np.ndarray:
    """Corners (n_e, 4, 2) in cyclic order."""
    X_euvi = np.asarray(snapshot.X_euvi)
    return np.stack([X_euvi[:, 0, 0], X_euvi[:, -1, 0], X_euvi[:, -1, -1], X_euvi[:, 0, -1]], axis=1)


def _frame(scene: Scene, snapshots: Sequence[Snapshot]) -> tuple[tuple[Limits, Limits], float, float]:
    """Limits of the full view, height of a row in inches, and stretch of the specimen through its thickness."""
    x_ni = np.concatenate([np.asarray(s.X_euvi).reshape(-1, 2) for s in snapshots])
    pad = 0.01 * scene.specimen.extent
    left, right = float(x_ni[:, 0].min()) - pad, float(x_ni[:, 0].max()) + pad
    reach = 1.06 * float(np.abs(x_ni[:, 1]).max())
    right = max(right, left + WHOLE / (MOST_HEIGHT - _APART) * 2 * reach)
    to_scale = WHOLE * 2 * reach / (right - left)
    height = max(to_scale + _APART, _LEAST_ROW)
    return ((left, right), (-reach, reach)), height, (height - _APART) / to_scale


def _plot(axes: Axes, lines_nki: np.ndarray, frame: tuple[Limits, Limits], label: str, style: Style) -> None:
    """The visible lines as one path."""
    lines_nki = lines_nki[seen(lines_nki, frame)]
    if len(lines_nki):
        axes.plot(*strokes(lines_nki).T, label=label, **style)


def _of_arm(lines_nki: np.ndarray, side: float) -> np.ndarray:
    """Lines of the upper (+1) or lower (-1) arm, each once; lines on the bond, Y = 0, belong to both."""
    own = np.sign(lines_nki[..., 1].mean(axis=1)) * side >= 0
    return np.unique(lines_nki[own], axis=0) if own.any() else lines_nki[own]


def _legend(figure: Figure, tmesh: bool) -> None:
    handles = [Line2D([], [], label="elements", **{**_ELEMENTS, "color": colour("muted"), "linewidth": 0.8})]
    if tmesh:
        handles[0].set_label("(Bézier) elements, in the colour of the method")
        handles.append(Line2D([], [], label="line of the T-mesh", **_LINES))
        handles.append(Line2D([], [], label="T-junction", linestyle="none", **_JUNCTIONS))
    handles.append(Line2D([], [], label="process zone", **_ZONE))
    width, height = figure.get_size_inches()
    place = (LEFT / WIDE, 0.02 / height)
    figure.legend(handles=handles, loc="lower left", bbox_to_anchor=place, ncols=len(handles), borderaxespad=0)
