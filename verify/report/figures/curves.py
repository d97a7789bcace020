"""Figures over the opening: load, J-integral, energies."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from verify.curves.curve import envelope
from verify.pages.style import HALF, Panel, colour, drawing, panel, to_svg
from verify.pages.text import Units, axis, power_of_ten
from verify.report.figures.agreement import branch, path
from verify.report.figures.entry import Entry
from verify.result import Result

if TYPE_CHECKING:
    from verify.scene.schema import Scene


#: Columns of the ledger; curves of other codes may do without.
_LEDGER = {"external_work", "stored_energy", "dissipated_energy"}


def load_opening(scene: Scene, runs: Sequence[Entry], key: str) -> Panel:
    """Load over opening of all runs."""
    units = Units.of(scene.units)
    with drawing():
        figure, axes = _figure(axis("opening", units.length), axis("load", units.force))
        top = _top_load(runs)
        for entry in runs:
            axes.plot(*path(entry.result), **entry.line.options())
            if not entry.result.complete:
                end = entry.result.opening[-1], entry.result.load[-1]
                axes.plot(*end, "x", color=colour(entry.line.colour), zorder=6)
        ceiling = min(1.06 * max(float(np.nanmax(entry.result.load)) for entry in runs), 1.4 * top)
        _name_lefm(axes, runs, ceiling)
        lowest = min(float(np.nanmin(entry.result.load)) for entry in runs)
        axes.set(xlim=(0, None), ylim=(min(0.0, 1.05 * lowest), ceiling))
        svg = to_svg(figure, key, f"Load against opening, all methods, {scene.name}")
    return Panel(svg, "Load against opening. A cross marks the end of a run that stopped early.")


def peak(scene: Scene, runs: Sequence[Entry], key: str) -> Panel:
    """Load over opening near the peak, with the converged steps."""
    units = Units.of(scene.units)
    own = [entry for entry in runs if entry.method != "lefm"] or list(runs)
    tops = [_peak_point(entry.result) for entry in own]
    x, y = np.median([t[0] for t in tops]), np.median([t[1] for t in tops])
    with drawing():
        figure, axes = _figure(axis("opening", units.length), axis("load", units.force))
        for entry in runs:
            axes.plot(*path(entry.result), **entry.line.options())
            if entry.method not in ("lefm", "dolfinx"):
                ink, at = colour(entry.line.colour), entry.result.opening
                near = (at > 0.7 * x) & (at < 1.5 * x)
                axes.plot(at[near], entry.result.load[near], ".", markersize=4.5, color=ink, zorder=5)
        axes.set(xlim=(0.72 * x, 1.45 * x), ylim=(0.8 * y, 1.05 * max(t[1] for t in tops)))
        svg = to_svg(figure, key, f"Load against opening near the peak, {scene.name}")
    return Panel(svg, "The same near the peak; dots are converged steps.")


def oscillation(scene: Scene, runs: Sequence[Entry], reference: Entry, key: str) -> Panel:
    """Deviation from the reference on the propagation branch."""
    units = Units.of(scene.units)
    with drawing():
        figure, axes = _figure(axis("opening", units.length), f"load / {reference.name} − 1 (%)")
        axes.axhline(0, color=colour(reference.line.colour), linewidth=2.4, alpha=0.5)
        for entry in runs:
            if entry is reference or entry.method == "lefm":
                continue
            x, ratio = branch(entry.result, reference.result)
            axes.plot(x, 100 * ratio, **entry.line.options())
        svg = to_svg(figure, key, f"Oscillation of the load about {reference.label}, {scene.name}")
    return Panel(
        svg,
        f"Propagation branch: deviation of the load from {reference.label} (thick line at zero). "
        "A ripple with the spacing of the elements is discretisation, of either curve.",
    )


def j_integral(scene: Scene, result: Result) -> np.ndarray | None:
    """J / G_Ic at every step (n_steps,), from the end faces.

    J w = P (abs(s_top) + abs(s_bottom)) - w * face energy, after Rice 1968 on a contour along the end faces and
    the free surfaces; None for methods without these slopes.
    """
    steps = result.steps
    if not {"face_slope_top", "face_slope_bottom", "face_energy"} <= set(steps):
        return None
    slopes = np.abs(steps["face_slope_top"]) + np.abs(steps["face_slope_bottom"])
    return (steps["load"] * slopes / scene.specimen.width - steps["face_energy"]) / scene.interface.toughness


def j_figure(scene: Scene, runs: Sequence[Entry], key: str) -> Panel | None:
    """J / G_Ic over the opening, with an enlarged range around 1."""
    computed = [(entry, j_integral(scene, entry.result)) for entry in runs]
    known = [(entry, J) for entry, J in computed if J is not None and np.isfinite(J).any()]
    if not known:
        return None
    with drawing():
        figure, axes = _figure(axis("opening", Units.of(scene.units).length), "")
        axes.set_ylabel("$J / G_{Ic}$", parse_math=True)
        inset = axes.inset_axes((0.42, 0.16, 0.56, 0.5))
        for entry, values in known:
            for plot in (axes, inset):
                plot.plot(entry.result.opening, values, **entry.line.options())
        start, end = _plateau(known)
        settled = np.concatenate([v[(d.result.opening >= start) & np.isfinite(v)] for d, v in known])
        reach = min(max(0.006, 1.2 * float(np.max(np.abs(settled - 1), initial=0.0))), 0.2)
        inset.axhspan(0.995, 1.005, color=colour("muted"), alpha=0.15, linewidth=0)
        inset.set(xlim=(start, end), ylim=(1 - reach, 1 + 1.5 * reach))  # room for the title, clear of other curves
        inset.set_title("close-up; band ± 0.5 %", loc="center", fontsize=7, y=0.88, pad=0)
        inset.tick_params(labelsize=6.5)
        axes.axhline(1, color=colour("ink"), linewidth=0.6, zorder=1)
        axes.set(xlim=(0, None), ylim=(0, 1.12))
        svg = to_svg(figure, key, f"J-integral over toughness against opening, {scene.name}")
    return Panel(
        svg,
        "J-integral from the slopes of the loaded faces. Once the tip of the bond is fully open it must equal the "
        "toughness, whatever the shape of the traction law: an identity, not a comparison.",
    )


def energies(scene: Scene, entry: Entry, key: str) -> Panel | None:
    """Energies of one run over the opening, and the work of its load."""
    steps, units = entry.result.steps, Units.of(scene.units)
    keep = _monotone(entry.result.opening)
    x = entry.result.opening[keep]
    stored, lost, work = (steps[name][keep] for name in ("stored_energy", "dissipated_energy", "external_work"))
    if not (np.isfinite(stored) & np.isfinite(lost)).any():
        return None
    parts = [steps[name][keep] for name in ("cohesive_energy", "contact_energy") if name in steps]
    held = lost + sum(parts, np.zeros(len(x)))
    with drawing():
        figure, axes = _figure(axis("opening", units.length), axis("energy", units.energy))
        for low, high, ink, alpha, label in (
            (np.zeros(len(x)), lost, "phase-solve", 0.55, "dissipated"),
            (lost, held, "zone", 0.8, "stored in the interface"),
            (held, lost + stored, "phase-assembly", 0.45, "stored in the bodies"),
        ):
            axes.fill_between(x, low, high, color=colour(ink), alpha=alpha, linewidth=0, zorder=1, label=label)
        axes.plot(x, work, color=colour("ink"), linewidth=1.2, dashes=(5, 2), label="work of the load")
        axes.set(xlim=(0, x[-1]), ylim=(0, None))
        axes.legend(loc="upper left")
        svg = to_svg(figure, key, f"Energies against opening, {entry.label}, {scene.name}")
    return Panel(svg, f"Energy ledger of {entry.label}: the coloured parts must fill the area under the dashed line.")


def ledger_gap(scene: Scene, runs: Sequence[Entry], key: str) -> Panel | None:
    """Gap of the energy ledger of each run, relative to the work up to that step."""
    gaps = []
    for entry in (entry for entry in runs if _LEDGER <= set(entry.result.steps)):
        steps = entry.result.steps
        miss = np.abs(steps["external_work"] - steps["stored_energy"] - steps["dissipated_energy"])
        if entry.method != "lefm" and np.isfinite(miss).any():
            done = np.maximum.accumulate(np.abs(steps["external_work"]))
            gaps.append((entry, np.divide(miss, done, out=np.zeros_like(miss), where=done > 0)))
    if not gaps:
        return None
    with drawing():
        figure, axes = _figure(axis("opening", Units.of(scene.units).length), "|work − stored − dissipated| / work")
        for entry, gap in gaps:
            seen = gap > 0
            axes.plot(entry.result.opening[seen], gap[seen], **entry.line.options())
        axes.axhline(0.005, color=colour("bad"), linewidth=0.8, dashes=(2, 2))
        at_the_edge = axes.get_yaxis_transform()
        axes.text(0.99, 0.005, "0.5 %", color=colour("bad"), ha="right", va="bottom", transform=at_the_edge)
        least = min((float(np.nanmin(gap[gap > 0])) for _, gap in gaps if np.any(gap > 0)), default=1e-6)
        axes.set(yscale="log", xlim=(0, None), ylim=(max(least, 1e-10), 0.1))
        axes.yaxis.set_major_formatter(lambda value, _: power_of_ten(value))
        svg = to_svg(figure, key, f"Gap of the energy ledger against opening, {scene.name}")
    return Panel(
        svg, "What each ledger misses. The work is integrated along the path: the gap also holds the steps' size."
    )


def _figure(x_label: str, y_label: str) -> tuple[Figure, Axes]:
    figure, axes = panel(HALF, 3.0)
    axes.set(xlabel=x_label, ylabel=y_label)
    return figure, axes


def _peak_point(result: Result) -> tuple[float, float]:
    x, y = envelope(*path(result))
    return float(x[np.argmax(y)]), float(y.max())


def _top_load(runs: Sequence[Entry]) -> float:
    """Largest load of all curves except LEFM, which may exceed the axes."""
    own = [d for d in runs if d.method != "lefm"] or list(runs)
    return max(float(np.nanmax(d.result.load)) for d in own) or 1.0


def _name_lefm(axes: Axes, runs: Sequence[Entry], ceiling: float) -> None:
    for entry in runs:
        if entry.method == "lefm":
            x, y = path(entry.result)
            after = np.flatnonzero((np.arange(len(y)) > np.nanargmax(y)) & (y < 0.93 * ceiling))
            if len(after):
                at = after[0]
                axes.annotate("LEFM limit", (x[at], y[at]), (6, 4), textcoords="offset points", color=colour("lefm"))


def _plateau(known: Sequence[tuple[Entry, np.ndarray]]) -> tuple[float, float]:
    """Opening from which on J is constant in every run, and the largest opening."""
    ends = [float(d.result.opening.max()) for d, _ in known]
    first = [d.result.opening[np.argmax(v > 0.985)] for d, v in known if np.nanmax(v) > 0.985]
    return (min(1.12 * float(max(first, default=0.0)), 0.9 * max(ends)), max(ends))


def _monotone(x: np.ndarray) -> np.ndarray:
    """Indices of the points whose opening exceeds all earlier ones."""
    before = np.append(-np.inf, np.maximum.accumulate(x)[:-1])
    return np.flatnonzero(x > before)
