"""Figures over the opening: load, J-integral, energies."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from verify.curves.curve import PROPAGATION, SAMPLES, Curve, envelope, load_at, peak
from verify.curves.of_run import cubics
from verify.pages.style import HALF, Panel, colour, drawing, panel
from verify.pages.text import Units, axis, power_of_ten
from verify.report.figures.entry import Entry
from verify.result import Result
from verify.scene.schema import Scene

#: Columns of the ledger; curves of other codes may do without them.
_LEDGER = {"external_work", "stored_energy", "dissipated_energy"}

#: The area of each part of the energy: colour and its opacity.
_PARTS = {
    "dissipated": ("phase-solve", 0.55),
    "stored in the interface": ("zone", 0.8),
    "stored in the bodies": ("phase-assembly", 0.45),
}


def path(result: Result) -> Curve:
    """Opening and load to draw: cubics between converged steps; LEFM is a polygon, as its path has a kink."""
    return (result.opening, result.load) if result.method == "lefm" else cubics(result, 6)


def _over_opening(scene: Scene, y_label: str) -> tuple[Figure, Axes]:
    figure, axes = panel(HALF, 3.0)
    axes.set(xlabel=axis("opening", Units.of(scene.units).length), ylabel=y_label)
    return figure, axes


def loads(scene: Scene, runs: Sequence[Entry], key: str) -> list[Panel]:
    """Load over opening of all runs, whole, and near the peak with the converged steps."""
    own = [entry for entry in runs if entry.method != "lefm"] or runs
    tops = [peak(envelope(*path(entry.result))) for entry in own]
    (x, y), top = np.median(tops, axis=0), max(load for _, load in tops)
    every = np.concatenate([entry.result.load for entry in runs])
    whole = (0, None), (min(0.0, 1.05 * np.nanmin(every)), min(1.06 * np.nanmax(every), 1.4 * (top or 1.0)))
    near = (0.72 * x, 1.45 * x), (0.8 * y, 1.05 * top)
    panels: list[Panel] = []
    for title, (xlim, ylim), caption in (
        ("Load against opening", whole, "Load against opening. A cross marks the end of a run that stopped early."),
        ("Load against opening near the peak", near, "The same near the peak; dots are converged steps."),
    ):
        with drawing():
            figure, axes = _over_opening(scene, axis("load", Units.of(scene.units).force))
            for entry in runs:
                opening, load, ink = entry.result.opening, entry.result.load, colour(entry.line.colour)
                axes.plot(*path(entry.result), **entry.line.options())
                if xlim == whole[0]:
                    if not entry.result.complete:
                        axes.plot(opening[-1], load[-1], "x", color=ink, zorder=6)
                elif entry.method not in ("lefm", "dolfinx"):
                    shown = (opening > xlim[0]) & (opening < xlim[1])
                    axes.plot(opening[shown], load[shown], ".", markersize=4.5, color=ink, zorder=5)
            axes.set(xlim=xlim, ylim=ylim)
            panels.append(Panel.of(figure, f"{key}-{len(panels)}", f"{title}, {scene.name}", caption))
    return panels


def oscillation(scene: Scene, runs: Sequence[Entry], reference: Entry, key: str) -> Panel | None:
    """Deviation from the reference on the propagation branch; None where there is no other run."""
    others = [entry for entry in runs if entry is not reference and entry.method != "lefm"]
    if not others:
        return None
    with drawing():
        figure, axes = _over_opening(scene, f"load / {reference.name} − 1 (%)")
        axes.axhline(0, color=colour(reference.line.colour), linewidth=2.4, alpha=0.5)
        base = path(reference.result)
        start = PROPAGATION * peak(envelope(*base))[0]
        for entry in others:
            end = min(float(one.result.opening.max()) for one in (reference, entry))
            x = np.linspace(start, end, SAMPLES if end > start else 0)
            ratio = load_at(path(entry.result), x) / load_at(base, x)
            axes.plot(x, 100 * (ratio - 1), **entry.line.options())
        caption = (
            f"Propagation branch: deviation of the load from {reference.label} (thick line at zero). "
            "A ripple with the spacing of the elements is discretisation, of either curve."
        )
        return Panel.of(figure, key, f"Oscillation of the load about {reference.label}, {scene.name}", caption)


def j_figure(scene: Scene, runs: Sequence[Entry], key: str) -> Panel | None:
    """J / G_Ic over the opening, from the end faces, with an enlarged range around 1.

    J w = P (abs(s_top) + abs(s_bottom)) - w * face energy, after Rice 1968 on a contour along the end faces and
    the free surfaces; None where no run has these slopes.
    """
    known = []
    for entry in runs:
        steps = entry.result.steps
        if {"face_slope_top", "face_slope_bottom", "face_energy"} <= set(steps):
            slopes = np.abs(steps["face_slope_top"]) + np.abs(steps["face_slope_bottom"])
            J = (steps["load"] * slopes / scene.specimen.width - steps["face_energy"]) / scene.interface.toughness
            if np.isfinite(J).any():
                known.append((entry, steps["opening"], J))
    if not known:
        return None
    end = max(float(x.max()) for _, x, _ in known)
    risen = max((float(x[np.argmax(J > 0.985)]) for _, x, J in known if np.nanmax(J) > 0.985), default=0.0)
    start = min(1.12 * risen, 0.9 * end)  # from there on J is constant in every run
    off = np.abs(np.concatenate([J[(x >= start) & np.isfinite(J)] for _, x, J in known]) - 1)
    reach = min(max(0.006, 1.2 * float(np.max(off, initial=0.0))), 0.2)
    with drawing():
        figure, axes = _over_opening(scene, "")
        axes.set_ylabel("$J / G_{Ic}$", parse_math=True)
        inset = axes.inset_axes((0.42, 0.16, 0.56, 0.5))
        for entry, x, J in known:
            for plot in (axes, inset):
                plot.plot(x, J, **entry.line.options())
        inset.axhspan(0.995, 1.005, color=colour("muted"), alpha=0.15, linewidth=0)
        inset.set(xlim=(start, end), ylim=(1 - reach, 1 + 1.5 * reach))  # room for the title, clear of other curves
        inset.set_title("close-up; band ± 0.5 %", loc="center", fontsize=7, y=0.88, pad=0)
        inset.tick_params(labelsize=6.5)
        axes.axhline(1, color=colour("ink"), linewidth=0.6, zorder=1)
        axes.set(xlim=(0, None), ylim=(0, 1.12))
        caption = (
            "J-integral from the slopes of the loaded faces. Once the tip of the bond is fully open it must equal the "
            "toughness, whatever the shape of the traction law: an identity, not a comparison."
        )
        return Panel.of(figure, key, f"J-integral over toughness against opening, {scene.name}", caption)


def energies(scene: Scene, entry: Entry, key: str) -> Panel | None:
    """Energies of one run over the opening as far as it grows, and the work of its load."""
    before = np.maximum.accumulate(np.append(-np.inf, entry.result.opening))[:-1]
    grows = entry.result.opening > before
    steps = {name: column[grows] for name, column in entry.result.steps.items()}
    x, lost, nothing = steps["opening"], steps["dissipated_energy"], np.zeros(np.sum(grows))
    if not (np.isfinite(steps["stored_energy"]) & np.isfinite(lost)).any():
        return None
    bond = steps.get("cohesive_energy", nothing) + steps.get("contact_energy", nothing)
    bounds = nothing, lost, lost + bond, lost + steps["stored_energy"]
    with drawing():
        figure, axes = _over_opening(scene, axis("energy", Units.of(scene.units).energy))
        for low, high, (label, (ink, alpha)) in zip(bounds, bounds[1:], _PARTS.items(), strict=False):
            axes.fill_between(x, low, high, color=colour(ink), alpha=alpha, linewidth=0, zorder=1, label=label)
        (work,) = axes.plot(x, steps["external_work"], color=colour("ink"), label="work of the load")
        work.set(linewidth=1.2, dashes=(5, 2))
        axes.set(xlim=(0, x[-1]), ylim=(0, None))
        axes.legend(loc="upper left")
        caption = f"Energy ledger of {entry.label}: the coloured parts must fill the area under the dashed line."
        return Panel.of(figure, key, f"Energies against opening, {entry.label}, {scene.name}", caption)


def ledger_gap(scene: Scene, runs: Sequence[Entry], key: str) -> Panel | None:
    """Gap of the energy ledger of each run, relative to the work up to that step."""
    gaps = []
    for entry in runs:
        steps = entry.result.steps
        if entry.method == "lefm" or not _LEDGER <= set(steps):
            continue
        miss = np.abs(steps["external_work"] - steps["stored_energy"] - steps["dissipated_energy"])
        if np.isfinite(miss).any():
            done = np.maximum.accumulate(np.abs(steps["external_work"]))
            seen = (miss > 0) & (done > 0)
            gaps.append((entry, entry.result.opening[seen], miss[seen] / done[seen]))
    if not gaps:
        return None
    least = min((float(gap.min()) for _, _, gap in gaps if gap.size), default=1e-6)
    with drawing():
        figure, axes = _over_opening(scene, "|work − stored − dissipated| / work")
        for entry, x, gap in gaps:
            axes.plot(x, gap, **entry.line.options())
        axes.axhline(0.005, color=colour("bad"), linewidth=0.8, dashes=(2, 2))
        at_the_edge = axes.get_yaxis_transform()
        axes.text(0.99, 0.005, "0.5 %", color=colour("bad"), ha="right", va="bottom", transform=at_the_edge)
        axes.set(yscale="log", xlim=(0, None), ylim=(max(least, 1e-10), 0.1))
        axes.yaxis.set_major_formatter(lambda value, _: power_of_ten(value))
        caption = "What each ledger misses. The work is integrated along the path: the gap also holds the steps' size."
        return Panel.of(figure, key, f"Gap of the energy ledger against opening, {scene.name}", caption)
