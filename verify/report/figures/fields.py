"""Snapshots of the runs grouped by opening, and the traction along the interface."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from verify.pages.style import HALF, Panel, colour, drawing, panel
from verify.pages.text import Units, axis, quantity
from verify.report.figures.entry import Entry, rank, short_names
from verify.result import Snapshot
from verify.scene.schema import Scene

#: Runs with their snapshots at one opening.
Group = Sequence[tuple[Entry, Snapshot]]


def shared_snapshots(runs: Sequence[Entry]) -> list[Group]:
    """The snapshots of all runs, grouped by opening; the first run in the order of IN_TABLES sets the openings.

    Groups without a run are left out.
    """
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
    return [group for group in groups if group]


def process_zone(snapshot: Snapshot) -> tuple[float, float] | None:
    """Start and end of the damaged part of the interface that is not fully open; None without damage."""
    s, damage = np.asarray(snapshot.s_q), np.asarray(snapshot.damage_q)
    active = (damage > 1e-9) & (damage < 1 - 1e-9)
    if not active.any():
        return None
    return float(s[active].min()), float(s[active].max())


def traction(scene: Scene, group: Group, key: str) -> Panel:
    """Traction of all methods along the interface at one opening."""
    units, strength, opening = Units.of(scene.units), scene.interface.strength, group[0][1].opening
    zones = [process_zone(snapshot) for _, snapshot in group]
    with drawing():
        figure, axes = panel(HALF, 2.65)
        axes.set_xlabel(axis("distance from the loaded end", units.length))
        axes.set_ylabel(axis("normal traction", units.stress))
        window = _window(scene, [zone for zone in zones if zone])
        inside = []
        for entry, snapshot in group:
            options = {**entry.line.options(), "marker": ".", "markersize": 2.6 if entry.line.width < 3 else 0}
            near = np.abs(snapshot.s_q - np.mean(window)) <= np.ptp(window)  # twice as far as is shown
            axes.plot(snapshot.s_q[near], snapshot.traction_q[near], **options)
            inside.append(snapshot.traction_q[(snapshot.s_q >= window[0]) & (snapshot.s_q <= window[1])])
        low = min(float(np.nanmin(traction_q, initial=0.0)) for traction_q in inside)
        low = max(low, -4 * strength)
        top = 1.22 * strength - 0.08 * low
        axes.set(xlim=window, ylim=(1.1 * low - 0.05 * strength, top))
        axes.axhline(strength, color=colour("muted"), linewidth=0.6, dashes=(2, 2))
        axes.axhline(0, color=colour("ink"), linewidth=0.5)
        axes.text(window[1], strength, "strength ", ha="right", va="bottom", color=colour("muted"), fontsize=7)
        if zone := zones[0]:
            axes.axvspan(*zone, color=colour("zone"), alpha=0.22, linewidth=0, zorder=0)
            axes.text(sum(zone) / 2, (strength + top) / 2, "process zone", ha="center", va="center", fontsize=7)
        title = f"Normal traction along the interface at opening {opening:.3g}, {scene.name}"
        names, told = short_names([entry for entry, _ in group]), []
        for (entry, snapshot), zone in zip(group, zones, strict=True):
            if zone:
                elsewhere = abs(snapshot.opening - opening) > 2e-3 * abs(opening)
                where = f" (at {quantity(snapshot.opening, units.length, 3)})" if elsewhere else ""
                told.append(f"{names[entry]} {quantity(zone[1] - zone[0], units.length, 3)}{where}")
        said = f"Process zone, damaged and not yet open: {', '.join(told)}; marked for {names[group[0][0]]}."
        said = said if told else "The interface is still intact everywhere."
        return Panel.of(figure, key, title, f"Opening {quantity(opening, units.length, 3)}. {said}")


def fronts(scene: Scene, groups: Sequence[Group], key: str) -> list[Panel]:
    """Of solids: the front of the crack at every opening, and the energy that the bond takes up along it."""
    known = [[(entry, one) for entry, one in group if one.front_z.size] for group in groups]
    if not any(known):
        return []
    units, tip, half = Units.of(scene.units), scene.specimen.free_length, 0.5 * scene.specimen.width
    across, last = axis("place across the width", units.length), [group for group in known if group][-1]
    panels = []
    with drawing():
        figure, axes = panel(HALF, 2.65)
        for entry, one in (pair for group in known for pair in group):
            z, s = _whole_width(one.front_z, one.front_s)
            axes.plot(s, z, **entry.line.options())
        z, s = _whole_width(last[0][1].front_z, last[0][1].front_s)
        axes.fill_betweenx(z, tip, s, color=colour("zone"), alpha=0.22, linewidth=0, zorder=0)
        axes.set(xlabel=axis("distance from the loaded end", units.length), ylabel=across, ylim=(-half, half))
        openings = ", ".join(f"{group[0][1].opening:.3g}" for group in known if group)
        title = f"Front of the crack over the width, {scene.name}"
        said = f"The delaminated area, shaded, and the front at openings {openings}: where the bond is fully open."
        panels.append(Panel.of(figure, f"{key}-lines", title, said))
        figure, axes = panel(HALF, 2.65)
        for entry, one in (pair for group in known for pair in group):
            axes.plot(*_whole_width(one.front_z, one.front_G), **entry.line.options())
        axes.set(xlabel=across, ylabel=axis("G", units.toughness), xlim=(-half, half))
        axes.set_ylim(0.0, 1.1 * max(scene.interface.toughness, *(one.front_G.max() for _, one in last)))
        axes.axhline(scene.interface.toughness, color=colour("muted"), linewidth=0.6, dashes=(2, 2))
        title = f"Energy that the bond takes up across the width, {scene.name}"
        said = "What the bond takes up along each line of the specimen, then. Dashed: the toughness of opening."
        panels.append(Panel.of(figure, f"{key}-G", title, said))
    return panels


def _whole_width(z: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Places and values from edge to edge; the modelled half is from the middle on."""
    return np.concatenate([-z[::-1], z]), np.concatenate([values[::-1], values])


def _window(scene: Scene, zones: Sequence[tuple[float, float]]) -> tuple[float, float]:
    body = scene.specimen
    bonded = body.extent - body.free_length
    if not zones:
        return body.free_length, body.free_length + 0.15 * bonded
    start, end = min(z[0] for z in zones), max(z[1] for z in zones)
    length = max(end - start, 0.02 * bonded)
    return max(start - 0.35 * length, 0.0), min(end + 1.1 * length, body.extent)
