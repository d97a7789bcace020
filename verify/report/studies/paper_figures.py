"""Figures 6, 7 and 8: load over opening by basis, law and mesh, and what the number of interface points changes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import NullLocator

from verify.curves.curve import PROPAGATION, envelope, load_at, peak
from verify.pages.style import HALF, METHOD_NAMES, THIRD, Line, Panel, colour, drawing, line, panel, to_svg
from verify.pages.text import Units, axis, percent
from verify.studies.paper.plan import LAWS, PAPER_PENALTY, Case
from verify.studies.paper.study import Reference, Study, Trial, curve


def deviation(axes: Axes, known: Reference, trials: Mapping[str, Trial | None]) -> None:
    """load / reference - 1 of the trial of every basis, and the band in which nothing is said."""
    reference = curve(known.result)
    openings = np.linspace(PROPAGATION * peak(reference)[0], float(np.max(reference[0])), 400)
    band = 100 * max(known.error, known.oscillation)
    axes.axhspan(-band, band, color=colour("muted"), alpha=0.3, linewidth=0)
    for basis, trial in trials.items():
        if trial is not None and trial.result is not None and trial.drawable:
            ratio = load_at(curve(trial.result), openings) / load_at(reference, openings) - 1.0
            axes.plot(openings, 100 * ratio, **line(basis).options(), label=METHOD_NAMES[basis])
    axes.set(ylabel="load / converged load − 1 (%)")
    low, high = axes.get_ylim()
    axes.set_ylim(low, high + 0.15 * (high - low))
    axes.legend(loc="upper right", ncols=3)


#: The converged curve, whoever computed it; the path of a run, and what displacement control would show of it.
REFERENCE = Line("muted", 3.4, (), 0.45, 2.0)
PATH_WIDTH, ENVELOPE_WIDTH = 0.6, 1.7


@dataclass(frozen=True)
class FigureGroup:
    """Panels under one heading."""

    title: str
    note: str
    panels: tuple[Panel, ...]


def figures(study: Study, key: str) -> tuple[FigureGroup, ...]:
    """Figures 6 and 7 for the coarse and the fine mesh, Figure 8 on the coarse one."""
    return tuple(_figures(study, key))


def _figures(study: Study, key: str) -> Iterator[FigureGroup]:
    meshes, points = sorted(study.values("dofs")), study.values("points")
    for n, dofs in enumerate(meshes):
        panels = [
            _load(study, Case(basis, law, dofs), f"{key}-{n}-{law}-{basis}")
            for law in study.scenes
            for basis in study.values("basis")
        ]
        title = f"Figure {6 + n}: load against opening with {dofs} unknowns"
        yield FigureGroup(title, _LOAD_NOTE, tuple(panels))
    known = [law for law in study.scenes if (law, PAPER_PENALTY) in study.references]
    apart = [_deviation(study, law, meshes[-1], f"{key}-deviation-{law}") for law in known]
    if apart:
        yield FigureGroup(f"Apart from the converged curve with {meshes[-1]} unknowns", _DEVIATION_NOTE, tuple(apart))
    if len(points) > 1:
        panels = [
            _sweep(study, Case(basis, law, meshes[0]), f"{key}-points-{law}-{basis}")
            for law in study.scenes
            for basis in study.values("basis")
        ]
        span = f"{min(points)} to {max(points)}"
        yield FigureGroup(f"Figure 8: {span} interface points, {meshes[0]} unknowns", _SWEEP_NOTE, tuple(panels))
        measures = [
            _against_points(study, law, measure, f"{key}-{law}-{measure}")
            for law in study.scenes
            for measure in _MEASURES
        ]
        yield FigureGroup("Error and oscillation against the number of points", _POINTS_NOTE, tuple(measures))


_LOAD_NOTE = (
    "Heavy: what a test in displacement control would show of the path. Thin: the path itself, through its snap-backs. "
    "Broad and grey: the converged curve. Dashed: LEFM, simple beam theory. A cross marks where a run stopped."
)
_DEVIATION_NOTE = (
    "Deviation of the load on the propagation branch. The band around zero is what a coarser mesh of the converged "
    "curve differs from it: below that nothing is said."
)
_SWEEP_NOTE = "Envelopes of the paths, stronger with more points, over the converged curve (broad and grey)."
_POINTS_NOTE = "Solid: the finer mesh. Dashed: the coarser one. A run that stopped leaves a gap."

#: Measure -> label of its axis.
_MEASURES = {"error": "curve distance (%)", "oscillation": "oscillation (%)"}


def _load(study: Study, case: Case, key: str) -> Panel:
    """One basis, one law, one mesh."""
    name = f"{METHOD_NAMES[case.basis]}, {LAWS[case.law]}"
    trial = study.trial(case)
    with drawing():
        figure, axes = panel(THIRD, 2.5)
        _background(study, case.law, axes)
        axes.plot(*study.limits[case.law], **line("lefm").options())
        draw_path(axes, trial, line(case.basis))
        _frame(study, case, axes)
        svg = to_svg(figure, key, f"Load against opening, {name}, {case.dofs} unknowns")
    return Panel(svg, f"{name}. {_told(trial)}", "third")


def _sweep(study: Study, case: Case, key: str) -> Panel:
    """One basis on one mesh with several numbers of points."""
    name = f"{METHOD_NAMES[case.basis]}, {LAWS[case.law]}"
    points = [p for p in study.values("points") if p % 2 == 0] or study.values("points")
    with drawing():
        figure, axes = panel(THIRD, 2.5)
        _background(study, case.law, axes)
        for p, strength in zip(points, np.linspace(0.3, 1.0, len(points)), strict=True):
            trial = study.trial(Case(case.basis, case.law, case.dofs, p))
            if trial is not None and trial.drawable:
                ink = colour(line(case.basis).colour)
                axes.plot(
                    *envelope(*curve(trial.result)), color=ink, alpha=strength, linewidth=1.1, label=f"{p} points"
                )
        axes.legend(loc="upper right")
        _frame(study, case, axes)
        svg = to_svg(figure, key, f"Load against opening by number of interface points, {name}")
    return Panel(svg, f"{name}.", "third")


def _deviation(study: Study, law: str, dofs: int, key: str) -> Panel:
    """load / reference - 1 of all bases."""
    with drawing():
        figure, axes = panel(HALF, 2.8)
        trials = {basis: study.trial(Case(basis, law, dofs)) for basis in study.values("basis")}
        deviation(axes, study.references[law, PAPER_PENALTY], trials)
        axes.set(xlabel=axis("opening", Units.of(study.scenes[law].units).length))
        svg = to_svg(figure, key, f"Deviation of the load from the converged curve, {LAWS[law]}, {dofs} unknowns")
    return Panel(svg, f"{LAWS[law]}.")


def _against_points(study: Study, law: str, measure: str, key: str) -> Panel:
    """One measure of every basis on both meshes."""
    meshes, points = sorted(study.values("dofs")), study.values("points")
    with drawing():
        figure, axes = panel(HALF, 2.8)
        for basis in study.values("basis"):
            for dofs, dashes in zip(meshes[::-1], ((), (4.0, 2.0)), strict=False):
                trials = [study.trial(Case(basis, law, dofs, p)) for p in points]
                style = line(basis).options() | {"linestyle": (0, dashes) if dashes else "solid"}
                values = [100 * getattr(trial, measure) if trial else np.nan for trial in trials]
                label = METHOD_NAMES[basis] if dofs == meshes[-1] else None
                axes.plot(points, values, marker="o", markersize=3, label=label, **style)
        axes.set(xlabel="interface points an element", ylabel=_MEASURES[measure], yscale="log")
        axes.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
        axes.yaxis.set_minor_locator(NullLocator())
        low, high = axes.get_ylim()
        axes.set_ylim(low, high * (high / low) ** 0.15)
        axes.legend(loc="upper right", ncols=3)
        svg = to_svg(figure, key, f"{_MEASURES[measure]} against the number of interface points, {LAWS[law]}")
    return Panel(svg, f"{LAWS[law]}.")


def _background(study: Study, law: str, axes: Axes) -> None:
    reference = study.references.get((law, PAPER_PENALTY))
    if reference is not None:
        axes.plot(*curve(reference.result), **REFERENCE.options())


def draw_path(axes: Axes, trial: Trial | None, style: Line) -> None:
    """The path of a run, its envelope, and a cross where it stopped."""
    if trial is None or not trial.drawable:
        return
    d, P = curve(trial.result)
    ink = colour(style.colour)
    axes.plot(d, P, color=ink, linewidth=PATH_WIDTH, alpha=0.75, zorder=3.5)
    axes.plot(*envelope(d, P), color=ink, linewidth=ENVELOPE_WIDTH, zorder=4)
    if not trial.complete:
        axes.plot(d[-1], P[-1], "x", color=ink, zorder=6)


def _frame(study: Study, case: Case, axes: Axes) -> None:
    """The same axes for all bases with one law on one mesh; LEFM is in them, with its peak."""
    units = Units.of(study.scenes[case.law].units)
    same = [t for t in study.trials if t.drawable and (t.case.law, t.case.dofs) == (case.law, case.dofs)]
    loads = [curve(t.result)[1] for t in same] + [load for _, load in study.limits.values()]
    top = max((float(np.max(load)) for load in loads), default=1.0)
    end = max(study.scenes[case.law].load.opening)
    axes.set(xlim=(0, end), ylim=(min(0.0, *(float(np.min(v)) for v in loads)), 1.06 * top))
    axes.set(xlabel=axis("opening", units.length), ylabel=axis("load", units.force))


def _told(trial: Trial | None) -> str:
    """The numbers under a panel."""
    if trial is None:
        return "Not run."
    if not trial.complete:
        return f"{trial.status[:1].upper()}{trial.status[1:]}."
    return f"{percent(trial.error)} from the converged curve, oscillation {percent(trial.oscillation)}."
