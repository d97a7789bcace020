"""Meshes of the runs in rows: undeformed with T-junctions and process zone, and deformed with the stress in them.

Undeformed bodies are drawn with a constant gap between them, so that the T-junctions on both sides of the bond are
visible; the process zone is a band in the gap.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

from verify.pages.paint import Limits, inches, one_path, paint, seen, sides
from verify.pages.style import STRESS_MAP, WIDE, Panel, colour, drawing
from verify.pages.text import Units, axis, number, quantity
from verify.report.figures.entry import Entry
from verify.report.figures.fields import Group, process_zone
from verify.result import Snapshot
from verify.scene.schema import Scene

_TMESH = (
    " Of T-splines the lines of the T-mesh are drawn over the Bézier elements. A line that ends at a T-junction"
    " on the bond adds a function to the row there alone; its extensions divide the elements beyond it."
)

#: Keywords of a matplotlib artist.
Style = Mapping[str, Any]

#: A row of a figure: the run, its snapshot, and the words above.
Row = tuple[Entry, Snapshot, str]

#: Inches: margin, width of the whole specimen, gap, width of the enlarged part; least and largest height of a row.
LEFT, WHOLE, GAP, CLOSE_UP = 0.42, 6.3, 0.5, WIDE - 7.32
LEAST_HEIGHT, MOST_HEIGHT = 0.8, 2.2
#: Inches: smallest height of a row, height of the legend, gap between the arms, which the process zone fills.
_LEAST_ROW, _LEGEND, _APART = 0.62, 0.68, 5.0 / 72.0

#: Distance from Y = 0, over the specimen's length, within which a point lies on the bond.
_ON_BOND = 1e-9

_LINES: Style = {"color": colour("ink"), "linewidth": 0.5, "zorder": 3}
_JUNCTIONS: Style = {"color": colour("bad"), "marker": "s", "markeredgewidth": 0.0, "linestyle": "none", "zorder": 5}
_ELEMENTS: Style = {"linewidth": 0.45, "zorder": 2, "solid_capstyle": "butt"}
_ZONE: Style = {"color": colour("zone"), "linewidth": 72.0 * _APART, "zorder": 1, "solid_capstyle": "butt"}


def undeformed(scene: Scene, drawn: Sequence[Entry], key: str) -> Panel | None:
    """The last mesh with a process zone of every run, one row each; runs on the same mesh share a row."""
    groups: dict[tuple[bytes, bytes], list[tuple[Entry, Snapshot]]] = {}
    for entry in drawn:
        found = [snapshot for snapshot in entry.result.snapshots if np.size(snapshot.X_euvi)]
        for snapshot in (next(reversed([s for s in found if process_zone(s)] or found)),) if found else ():
            last = snapshot.X_euvi.shape[1] - 1
            corners, lines = (
                (np.round(values, 9) + 0.0).tobytes()  # + 0.0 makes 0 of -0
                for values in (snapshot.X_euvi[:, ::last, ::last], snapshot.line_nki)
            )
            groups.setdefault((corners, lines), []).append((entry, snapshot))
    titled = [(*group[0], " and ".join(entry.label for entry, _ in group)) for group in groups.values()]
    title = f"Meshes of all runs, {scene.name}"
    return _undeformed(scene, titled, key, title, "Undeformed meshes.", moving=False) if titled else None


def followed(scene: Scene, drawn: Sequence[Entry], key: str) -> Panel | None:
    """T-meshes of an adaptive run at up to three openings; None where no run changes its mesh."""
    length = Units.of(scene.units).length
    for entry in drawn:
        found = [snapshot for snapshot in entry.result.snapshots if len(snapshot.line_nki)]
        moves = [a for a, b in zip(found, found[1:], strict=False) if not np.array_equal(a.line_nki, b.line_nki)]
        if moves:
            titled = [(entry, s, f"Opening {quantity(s.opening, length, 3)}") for s in (*moves, found[-1])[-3:]]
            words = "T-mesh follows the process zone"
            said = f"The {words} ({entry.label}): fine ahead of the crack, coarse again behind it."
            return _undeformed(scene, titled, key, f"The {words}, {scene.name}", said, moving=True)
    return None


def deformed(scene: Scene, group: Group, key: str) -> Panel | None:
    """Deformed meshes at true scale, a row per method or opening, the process zone enlarged; None without stresses."""
    group = [(entry, snapshot) for entry, snapshot in group if np.size(snapshot.stress_euv)]
    if not group:
        return None
    units = Units.of(scene.units)
    limit = max(float(np.nanpercentile(np.abs(s.stress_euv), 99.7)) for _, s in group) or 1.0
    x, y = frame(scene, [snapshot for _, snapshot in group])
    height = WHOLE * (y[1] - y[0]) / (x[1] - x[0])
    with drawing():
        figure, pairs = rows(len(group), height, 0.95)
        for (whole, close), (entry, snapshot) in zip(pairs, group, strict=True):
            part = zoom(scene, [snapshot], height)
            x_euvi, stress_euv = np.asarray(snapshot.X_euvi) + np.asarray(snapshot.u_euvi), snapshot.stress_euv
            paint(whole, x_euvi, np.asarray(stress_euv), limit, (x, y))
            paint(close, x_euvi, np.asarray(stress_euv), limit, part)
            _mark(whole, part)
            at = quantity(snapshot.opening, units.length, 3), quantity(snapshot.load, units.force, 3)
            whole.set_title(f"{entry.label}, opening {at[0]}, load {at[1]}", color=colour(entry.line.colour))
        _positions(pairs[-1], units)
        tall = figure.get_size_inches()[1]
        place = figure.add_axes((LEFT / WIDE, 0.42 / tall, WHOLE / WIDE, 0.09 / tall))
        bar = figure.colorbar(ScalarMappable(Normalize(-limit, limit), STRESS_MAP), cax=place, orientation="horizontal")
        bar.set_label(axis("Cauchy stress along the specimen", units.stress))
        bar.outline.set_visible(False)
        caption = (
            "Deformed meshes, displacements at true scale, each with its own elements; the framed part is enlarged on "
            f"the right. One scale of colours for all, to ± {quantity(limit, units.stress, 3)}; no averaging between "
            "elements."
        )
        return Panel.of(figure, key, f"Deformed meshes with axial stress, {key}, {scene.name}", caption, "wide")


def bond_element(snapshot: Snapshot, zone: Limits) -> float:
    """Longest element side on the bond, of either body, that overlaps the process zone; NaN without one."""
    ends_nki = sides(np.asarray(snapshot.X_euvi))[:, [0, -1]]
    near = _ON_BOND * np.ptp(ends_nki[..., 0])
    x_nk = np.sort(ends_nki[np.all(np.abs(ends_nki[..., 1]) <= near, axis=1)][..., 0], axis=1)
    met = (x_nk[:, 1] > zone[0] + near) & (x_nk[:, 0] < zone[1] - near)
    return float(np.diff(x_nk[met], axis=1).max(initial=0.0)) or float("nan")


def draw(axes: Axes, snapshot: Snapshot, ink: str, frame: tuple[Limits, Limits], zone: Limits | None) -> None:
    """Draw the mesh within a frame, the limits of the axes: elements, T-mesh, T-junctions, process zone."""
    x, y = frame
    apart = 0.5 * _APART / (inches(axes)[1] - _APART) * (y[1] - y[0])
    frame = x, (y[0] - apart, y[1] + apart)
    X_euvi = np.asarray(snapshot.X_euvi)
    side_e = np.sign(X_euvi[..., 1].mean(axis=(1, 2)))
    for side in np.unique(side_e):
        points_nki = _of_arm(snapshot.junction_ni[:, None], side)
        for lines_nki, label, style in (
            (sides(X_euvi[side_e == side]), "elements", {**_ELEMENTS, "color": ink}),
            (_of_arm(snapshot.line_nki, side), "T-mesh", _LINES),
            (points_nki, "T-junctions", {**_JUNCTIONS, "markersize": 1.8}),
        ):
            within_nki = seen(lines_nki + (0.0, side * apart), frame)
            if len(within_nki):
                axes.plot(*one_path(within_nki).T, label=label, **style)
    if zone is not None:
        axes.plot(zone, (0.0, 0.0), label="zone", **_ZONE)
    axes.set(xlim=frame[0], ylim=frame[1])


def _of_arm(lines_nki: np.ndarray, side: float) -> np.ndarray:
    """Lines of the upper (+1) or lower (-1) arm, each once; lines on the bond, Y = 0, belong to both."""
    own = np.sign(lines_nki[..., 1].mean(axis=1)) * side >= 0
    return np.unique(lines_nki[own], axis=0) if own.any() else lines_nki[own]


def _undeformed(scene: Scene, titled: Sequence[Row], key: str, title: str, said: str, moving: bool) -> Panel:
    """The rows with a legend below; ``moving``: each enlarges a part of its own."""
    units, shown = Units.of(scene.units), [snapshot for _, snapshot, _ in titled]
    left, right, high = _extent(scene, [snapshot.X_euvi for snapshot in shown])
    reach = 1.06 * high
    right = max(right, left + WHOLE / (MOST_HEIGHT - _APART) * 2 * reach)
    to_scale = WHOLE * 2 * reach / (right - left)
    height = max(to_scale + _APART, _LEAST_ROW)
    stretch = (height - _APART) / to_scale
    tmesh = any(len(snapshot.line_nki) for snapshot in shown)
    with drawing():
        figure, pairs = rows(len(titled), height, _LEGEND)
        for (whole, close), (entry, snapshot, name) in zip(pairs, titled, strict=True):
            part = zoom(scene, [snapshot] if moving else shown, height - _APART)
            zone = process_zone(snapshot)  # and then along X
            if zone is not None:
                start, end = map(scene.specimen.place, zone)
                zone = min(start, end), max(start, end)
            for axes, limits in ((whole, ((left, right), (-reach, reach))), (close, part)):
                draw(axes, snapshot, colour(entry.line.colour), limits, zone)
                axes.set_yticks([])
            _mark(whole, (part[0], whole.get_ylim()))
            whole.spines["left"].set_visible(False)
            whole.set_title(f"{name}: {_counted(snapshot, zone, units)}", color=colour(entry.line.colour))
        _positions(pairs[-1], units)
        handles = list(_handles(tmesh))
        place = (LEFT / WIDE, 0.02 / figure.get_size_inches()[1])
        figure.legend(handles=handles, loc="lower left", bbox_to_anchor=place, ncols=len(handles), borderaxespad=0)
        times = f"{number(stretch, 2)} times too thick" if stretch > 1.01 else "to scale"
        said += f" Bodies on the left {times}, on the right to scale; drawn apart, with the process zone between them."
        return Panel.of(figure, key, title, said + _TMESH * tmesh, "wide")


def _positions(pair: tuple[Axes, Axes], units: Units) -> None:
    for axes, word in zip(pair, ("position", "position, enlarged"), strict=True):
        axes.set_xlabel(axis(word, units.length))


def _handles(tmesh: bool) -> Iterator[Line2D]:
    """What the lines of an undeformed mesh are."""
    elements = "(Bézier) elements, in the colour of the method" if tmesh else "elements"
    yield Line2D([], [], label=elements, **{**_ELEMENTS, "color": colour("muted"), "linewidth": 0.8})
    if tmesh:
        yield Line2D([], [], label="line of the T-mesh", **_LINES)
        yield Line2D([], [], label="T-junction", markersize=3.0, **_JUNCTIONS)
    yield Line2D([], [], label="process zone", **_ZONE)


def _counted(snapshot: Snapshot, zone: Limits | None, units: Units) -> str:
    """Numbers of elements in total and in the process zone, and of T-junctions, in words."""
    text = f"{len(snapshot.X_euvi)} elements"
    text += f", {junctions} T-junctions" if (junctions := len(snapshot.junction_ni)) else ""
    if zone is not None and np.isfinite(element := bond_element(snapshot, zone)):
        count = number((zone[1] - zone[0]) / element, 2)
        text += f"; {count} of {quantity(element, units.length, 2)} in the process zone"
    return text


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


def _extent(scene: Scene, x_neuvi: Sequence[np.ndarray]) -> tuple[float, float, float]:
    """Left and right with a hundredth of the specimen beside them, and the largest height, of all positions."""
    x_ni, pad = np.concatenate([np.asarray(x_euvi).reshape(-1, 2) for x_euvi in x_neuvi]), 0.01 * scene.specimen.extent
    return float(x_ni[:, 0].min()) - pad, float(x_ni[:, 0].max()) + pad, float(np.abs(x_ni[:, 1]).max())


def frame(scene: Scene, snapshots: Sequence[Snapshot]) -> tuple[Limits, Limits]:
    """Limits along x and y that contain all snapshots to scale, enlarged where a row would be too low or too high."""
    left, right, reach = _extent(scene, [np.add(s.X_euvi, s.u_euvi) for s in snapshots])
    height = max(2.06 * reach + 0.01 * scene.specimen.extent, LEAST_HEIGHT / WHOLE * (right - left))
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


def _mark(axes: Axes, part: tuple[Limits, Limits]) -> None:
    """Draw the frame of the part that is enlarged."""
    (x0, x1), (y0, y1) = part
    box = (x0, y0), x1 - x0, y1 - y0
    axes.add_patch(Rectangle(*box, fill=False, edgecolor=colour("muted"), linewidth=0.6, zorder=5))
