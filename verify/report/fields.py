"""Figures of fields: traction along the interface, deformed meshes with stress."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from verify.report.entry import Entry, rank
from verify.report.style import HALF, STRESS_MAP, THIRD, WIDE, Panel, colour, drawing, to_svg
from verify.report.text import Units, axis, quantity
from verify.result import Snapshot

if TYPE_CHECKING:
    from verify.scene import Scene

_REFINE = 3  # colour cells per sampling interval
_MANY_ELEMENTS = 900  # from here on outlines become pixels


def shared_snapshots(runs: Sequence[Entry]) -> list[list[tuple[Entry, Snapshot]]]:
    """The snapshots of all runs, grouped by opening; the first run in the order of METHODS sets the openings."""
    owners = sorted(
        (entry for entry in runs if entry.result.snapshots),
        key=lambda entry: (-len(entry.result.snapshots), rank(entry.method)),
    )
    if not owners:
        return []
    openings = np.array([snapshot.opening for snapshot in owners[0].result.snapshots])
    reach = 0.25 * (np.min(np.diff(openings)) if len(openings) > 1 else openings[0])
    groups: list[list[tuple[Entry, Snapshot]]] = [[] for _ in openings]
    for entry in sorted(owners, key=lambda entry: rank(entry.method)):
        for snapshot in entry.result.snapshots:
            nearest = int(np.argmin(np.abs(openings - snapshot.opening)))
            if abs(openings[nearest] - snapshot.opening) <= reach:
                groups[nearest].append((entry, snapshot))
    return groups


def process_zone(snapshot: Snapshot) -> tuple[float, float] | None:
    """Start and end of the damaged, not yet open part of the interface; None where nothing is damaged."""
    s, damage = np.asarray(snapshot.s_q), np.asarray(snapshot.damage_q)
    active = (damage > 1e-9) & (damage < 1 - 1e-9)
    if not active.any():
        return None
    return float(s[active].min()), float(s[active].max())


def traction(scene: Scene, group: Sequence[tuple[Entry, Snapshot]], key: str, small: bool) -> Panel:
    """Traction along the interface at one opening, all methods over each other; ``small`` for three in a row."""
    units, strength = Units.of(scene.units), scene.interface.strength
    opening = group[0][1].opening
    zone = process_zone(group[0][1])
    with drawing():
        figure = Figure(figsize=(THIRD if small else HALF, 2.4 if small else 2.75))
        axes = figure.add_subplot()
        axes.set(xlabel=axis("position along the specimen", units.length), ylabel=axis("normal traction", units.stress))
        for entry, snapshot in group:
            options = {**entry.line.options(), "marker": ".", "markersize": 2.6 if entry.line.width < 3 else 0}
            axes.plot(snapshot.s_q, snapshot.traction_q, **options)
        window = _window(scene, group)
        low = min(float(np.nanmin(_inside(s.s_q, s.traction_q, window), initial=0.0)) for _, s in group)
        axes.set(xlim=window, ylim=(1.15 * max(low, -1.2 * strength) - 0.05 * strength, 1.22 * strength))
        axes.axhline(strength, color=colour("muted"), linewidth=0.6, dashes=(2, 2))
        axes.axhline(0, color=colour("ink"), linewidth=0.5)
        axes.text(window[1], strength, "strength ", ha="right", va="bottom", color=colour("muted"), fontsize=7)
        if zone is not None:
            axes.axvspan(*zone, color=colour("zone"), alpha=0.22, linewidth=0, zorder=0)
            axes.text(sum(zone) / 2, 1.14 * strength, "process zone", ha="center", va="center", fontsize=7)
        svg = to_svg(figure, key, f"Normal traction along the interface at opening {opening:.3g}, {scene.name}")
    return Panel(svg, _traction_caption(group, units), "third" if small else "half")


def _traction_caption(group: Sequence[tuple[Entry, Snapshot]], units: Units) -> str:
    head = f"Opening {quantity(group[0][1].opening, units.length, 3)}. "
    lengths = [(entry.label, process_zone(snapshot)) for entry, snapshot in group]
    known = [f"{label}: {quantity(z[1] - z[0], units.length, 3)}" for label, z in lengths if z is not None]
    if not known:
        return head + "The interface is still intact everywhere."
    return head + f"Process zone (damaged, not yet open; marked for {lengths[0][0]}): " + "; ".join(known) + "."


def _inside(s: np.ndarray, values: np.ndarray, window: tuple[float, float]) -> np.ndarray:
    return np.asarray(values)[(s >= window[0]) & (s <= window[1])]


def _window(scene: Scene, group: Sequence[tuple[Entry, Snapshot]]) -> tuple[float, float]:
    zones = [zone for _, snapshot in group if (zone := process_zone(snapshot)) is not None]
    bonded = scene.specimen.length - scene.specimen.precrack
    if not zones:
        return scene.specimen.precrack, scene.specimen.precrack + 0.15 * bonded
    start, end = min(z[0] for z in zones), max(z[1] for z in zones)
    length = max(end - start, 0.02 * bonded)
    return max(start - 0.35 * length, 0.0), min(end + 1.1 * length, scene.specimen.length)


def deformed(scene: Scene, group: Sequence[tuple[Entry, Snapshot]], key: str) -> Panel | None:
    """Deformed meshes at true scale, one row a method, the process zone enlarged beside each."""
    group = [(entry, snapshot) for entry, snapshot in group if np.size(snapshot.stress_euv)]
    if not group:
        return None
    units = Units.of(scene.units)
    limit = max(float(np.nanpercentile(np.abs(s.stress_euv), 99.7)) for _, s in group) or 1.0
    x, frame = _frame(scene, group)
    zoom = _zoom(scene, group, frame / (x[1] - x[0]))
    with drawing():
        figure, rows = _rows(len(group), frame / (x[1] - x[0]))
        for (whole, close), (entry, snapshot) in zip(rows, group, strict=True):
            for axes in (whole, close):
                _draw(axes, snapshot, limit)
                axes.grid(False)
            whole.set(xlim=x, ylim=(-frame / 2, frame / 2))
            close.set(xlim=zoom[0], ylim=zoom[1])
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


def _rows(count: int, ratio: float) -> tuple[Figure, list[tuple[Axes, Axes]]]:
    """A figure with one row a method: the whole specimen, ``ratio`` as high as wide, and an enlarged part as high."""
    left, whole, gap, close, below, between = 0.42, 6.3, 0.5, WIDE - 7.32, 0.95, 0.5
    height = min(max(whole * ratio, 0.8), 2.2)
    total = below + count * (height + between)
    figure = Figure(figsize=(WIDE, total), layout="none")
    rows = []
    for i in range(count):
        bottom = (total - (i + 1) * (height + between) + 0.15) / total
        places = ((left, whole), (left + whole + gap, close))
        rows.append(tuple(figure.add_axes((x / WIDE, bottom, w / WIDE, height / total)) for x, w in places))
    for axes in figure.axes:
        axes.set_aspect("equal", adjustable="datalim")
    return figure, rows


def _scale(figure: Figure, limit: float, label: str) -> None:
    """The colour scale, along the foot of the figure."""
    height = figure.get_size_inches()[1]
    place = figure.add_axes((0.42 / WIDE, 0.42 / height, 6.3 / WIDE, 0.09 / height))
    bar = figure.colorbar(ScalarMappable(Normalize(-limit, limit), STRESS_MAP), cax=place, orientation="horizontal")
    bar.set_label(label)
    bar.outline.set_visible(False)


def _draw(axes: Axes, snapshot: Snapshot, limit: float) -> None:
    x_euvi = np.asarray(snapshot.X_euvi) + np.asarray(snapshot.u_euvi)
    x_fine, stress = _finer(x_euvi), _finer(np.asarray(snapshot.stress_euv)[..., None])[..., 0]
    corners = np.stack([x_fine[:, :-1, :-1], x_fine[:, 1:, :-1], x_fine[:, 1:, 1:], x_fine[:, :-1, 1:]], axis=-2)
    middle = (stress[:, :-1, :-1] + stress[:, 1:, :-1] + stress[:, 1:, 1:] + stress[:, :-1, 1:]) / 4
    fill = PolyCollection(corners.reshape(-1, 4, 2), array=middle.ravel(), cmap=STRESS_MAP, rasterized=True, zorder=1)
    fill.set(clim=(-limit, limit), antialiased=False, edgecolor="none")
    axes.add_collection(fill)
    many = len(x_euvi) > _MANY_ELEMENTS
    ink = "#808a96" if many else colour("ink")  # pixels cannot follow the page
    outline = LineCollection(_perimeter(x_euvi), colors=ink, linewidths=0.25, alpha=0.7, zorder=2, rasterized=many)
    axes.add_collection(outline)


def _finer(values: np.ndarray) -> np.ndarray:
    """Bilinear refinement of the sampling grids (n_e, m, m, c) -> (n_e, r (m-1) + 1, r (m-1) + 1, c)."""
    m = values.shape[1]
    at = np.linspace(0, m - 1, _REFINE * (m - 1) + 1)
    left = np.minimum(at.astype(int), m - 2)
    t = at - left
    weights = np.zeros((len(at), m))
    weights[np.arange(len(at)), left] = 1 - t
    weights[np.arange(len(at)), left + 1] += t
    return np.einsum("Uu,Vv,euvc->eUVc", weights, weights, values)


def _perimeter(x_euvi: np.ndarray) -> np.ndarray:
    """Closed outlines of the elements (n_e, 4 k + 1, 2)."""
    sides = (x_euvi[:, :-1, 0], x_euvi[:, -1, :-1], x_euvi[:, :0:-1, -1], x_euvi[:, 0, ::-1])
    return np.concatenate(sides, axis=1)


def _frame(scene: Scene, group: Sequence[tuple[Entry, Snapshot]]) -> tuple[tuple[float, float], float]:
    """Limits along the specimen and total height of the full view."""
    x = np.concatenate([(np.asarray(s.X_euvi) + np.asarray(s.u_euvi)).reshape(-1, 2) for _, s in group])
    pad = 0.01 * scene.specimen.length
    return (float(x[:, 0].min()) - pad, float(x[:, 0].max()) + pad), 2.06 * float(np.abs(x[:, 1]).max()) + pad


def _zoom(
    scene: Scene, group: Sequence[tuple[Entry, Snapshot]], ratio: float
) -> tuple[tuple[float, float], tuple[float, float]]:
    """Limits of the enlarged part, around the process zone; its frame is ``6.3 ratio`` inches high."""
    body = scene.specimen
    zone = next((z for _, s in group if (z := process_zone(s)) is not None), (body.precrack, body.precrack))
    width = min(max(1.7 * (zone[1] - zone[0]), 5 * body.arm_thickness), 0.3 * body.length)
    middle = min(sum(zone) / 2, body.length - width / 2)
    height = width * min(max(6.3 * ratio, 0.8), 2.2) / (WIDE - 7.32)
    return (middle - width / 2, middle + width / 2), (-height / 2, height / 2)


def _mark(axes: Axes, zoom: tuple[tuple[float, float], tuple[float, float]]) -> None:
    (x0, x1), (y0, y1) = zoom
    frame = Rectangle((x0, y0), x1 - x0, y1 - y0, fill=False, edgecolor=colour("muted"), linewidth=0.6, zorder=5)
    axes.add_patch(frame)
