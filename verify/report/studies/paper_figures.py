"""Figures 6 to 9: load over opening, deviation from the converged curve, influence of the interface points."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from math import isfinite

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import NullLocator

from verify.curves.curve import PROPAGATION, envelope, load_at, peak
from verify.pages.style import HALF, METHOD_NAMES, THIRD, Line, Panel, colour, drawing, line, panel, to_svg
from verify.pages.text import Units, axis, percent, quantity, span
from verify.studies.paper.plan import BEAMS, PAPER_LAWS, Case
from verify.studies.paper.study import Reference, Study, Trial, curve

#: Line of the converged curve; line widths of the path of a run and of its envelope.
CONVERGED_LINE = Line("muted", 3.4, (), 0.45, 2.0)
PATH_WIDTH, ENVELOPE_WIDTH = 0.6, 1.7

_LOAD_NOTE = (
    "Heavy: what a test in displacement control would show of the path. Thin: the path itself, through its snap-backs. "
    "Broad and grey: the converged curve. Dashed: LEFM, simple beam theory. A cross marks where a run stopped."
)
_DEVIATION_NOTE = (
    "Deviation of the load on the propagation branch. The band around zero is what a coarser mesh of the converged "
    "curve differs from it; smaller deviations are not significant."
)
_SWEEP_NOTE = "Envelopes of the paths, stronger with more points, over the converged curve (broad and grey)."
_POINTS_NOTE = "Solid: the finer mesh. Dashed: the coarser one. A run that stopped leaves a gap."
_STRIPS_NOTE = (
    "Coloured: the runs of one basis, named by the length of the bond. Broad and grey: the converged curves. Dashed: "
    "the plate limit of LEFM, a clamped strip on a rigid substrate. A cross marks where a run stopped."
)
_STRIPS_APART_NOTE = (
    "Deviation of the load from 30 % after the peak on. The band around zero is what a coarser mesh of the converged "
    "curve differs from it; smaller deviations are not significant."
)

#: Measure -> label of its axis.
_LABELS = {"error": "curve distance (%)", "oscillation": "oscillation (%)"}


@dataclass(frozen=True)
class FigureGroup:
    """Panels under one heading."""

    title: str
    note: str
    panels: tuple[Panel, ...]


def figures(study: Study, key: str) -> tuple[FigureGroup, ...]:
    """All groups with at least one panel."""
    groups = _of_beams(study, key) if study.figures is BEAMS else _of_strips(study, key)
    return tuple(group for group in groups if group.panels)


def _of_beams(study: Study, key: str) -> Iterator[FigureGroup]:
    """Figures 6 and 7 for the coarse and the fine mesh, Figure 8 on the coarse one."""
    meshes, points = sorted(study.values("dofs")), study.values("points")
    each = [(law, basis) for law, basis in product(study.scenes, study.values("basis"))]
    for n, dofs in enumerate(meshes):
        loads = [_load(study, Case(basis, law, dofs), f"{key}-{n}-{law}-{basis}") for law, basis in each]
        yield FigureGroup(f"Figure {6 + n}: load against opening with {dofs} unknowns", _LOAD_NOTE, tuple(loads))
    off = [
        _deviation(study, Case("", law, meshes[-1]), f"{key}-deviation-{law}")
        for law in study.scenes
        if Case("", law, meshes[-1]).problem in study.references
    ]
    yield FigureGroup(f"Apart from the converged curve with {meshes[-1]} unknowns", _DEVIATION_NOTE, tuple(off))
    if len(points) > 1:
        sweeps = [_sweep(study, Case(basis, law, meshes[0]), f"{key}-points-{law}-{basis}") for law, basis in each]
        title = f"Figure 8: {min(points)} to {max(points)} interface points, {meshes[0]} unknowns"
        yield FigureGroup(title, _SWEEP_NOTE, tuple(sweeps))
        over = [
            _against_points(study, law, measure, f"{key}-{law}-{measure}")
            for law, measure in product(study.scenes, _LABELS)
        ]
        yield FigureGroup("Error and oscillation against the number of points", _POINTS_NOTE, tuple(over))


def _of_strips(study: Study, key: str) -> Iterator[FigureGroup]:
    """The figure by basis, and the deviations by bond."""
    loads = [_loads(study, basis, f"{key}-{basis}") for basis in study.values("basis")]
    yield FigureGroup("Figure 9: load against displacement", _STRIPS_NOTE, tuple(loads))
    off = [_deviation(study, Case("", bond), f"{key}-apart-{bond}") for bond, _ in study.references]
    yield FigureGroup("Apart from the converged curve", _STRIPS_APART_NOTE, tuple(off))


def _load(study: Study, case: Case, key: str) -> Panel:
    """One basis, one law, one mesh."""
    name, trial = f"{METHOD_NAMES[case.basis]}, {PAPER_LAWS[case.scene]}", study.trial(case)
    with drawing():
        figure, axes = panel(THIRD, 2.5)
        _converged(axes, study, case)
        axes.plot(*study.limits[case.scene], **line("lefm").options())
        _path(axes, trial)
        _frame(study, case, axes)
        svg = to_svg(figure, key, f"Load against opening, {name}, {case.dofs} unknowns")
    return Panel(svg, f"{name}. {_below(trial)}", "third")


def _loads(study: Study, basis: str, key: str) -> Panel:
    """All bonds by one basis, each named at its peak."""
    units = Units.of(next(iter(study.scenes.values())).units)
    trials = [trial for bond in study.scenes if (trial := study.trial(Case(basis, bond))) is not None]
    with drawing():
        figure, axes = panel(THIRD, 2.8)
        for bond in study.scenes:
            axes.plot(*study.limits[bond], **line("lefm").options())
            _converged(axes, study, Case(basis, bond))
        tops = [peak(limit)[1] for limit in study.limits.values()]
        for trial in trials:
            _path(axes, trial)
            if trial.drawn is not None:
                x, y = peak(curve(trial.drawn))
                name = quantity(study.bond(trial.case.scene), units.length)
                axes.annotate(name, (x, y), (4, 3), textcoords="offset points", fontsize=7.5, zorder=7)
                tops.append(y)
        end = max(max(scene.load.opening) for scene in study.scenes.values())
        axes.set(xlim=(0, end), ylim=(0, 1.06 * max(tops, default=1.0)))
        axes.set(xlabel=axis("displacement", units.length), ylabel=axis("load", units.force))
        svg = to_svg(figure, key, f"Load against displacement by bond length, {METHOD_NAMES[basis]}")
    return Panel(svg, f"{METHOD_NAMES[basis]}. {_below_all(trials)}", "third")


def _sweep(study: Study, case: Case, key: str) -> Panel:
    """One basis on one mesh with several numbers of points."""
    name, ink = f"{METHOD_NAMES[case.basis]}, {PAPER_LAWS[case.scene]}", colour(line(case.basis).colour)
    points = [p for p in study.values("points") if p % 2 == 0] or study.values("points")
    with drawing():
        figure, axes = panel(THIRD, 2.5)
        _converged(axes, study, case)
        for p, strength in zip(points, np.linspace(0.3, 1.0, len(points)), strict=True):
            trial = study.trial(Case(case.basis, case.scene, case.dofs, p))
            if trial is not None and trial.drawn is not None:
                shown = envelope(*curve(trial.drawn))
                axes.plot(*shown, color=ink, alpha=strength, linewidth=1.1, label=f"{p} points")
        axes.legend(loc="upper right")
        _frame(study, case, axes)
        svg = to_svg(figure, key, f"Load against opening by number of interface points, {name}")
    return Panel(svg, f"{name}.", "third")


def _deviation(study: Study, case: Case, key: str) -> Panel:
    """load / reference - 1 of all bases, and the band of the error of the reference."""
    units, beam = Units.of(study.scenes[case.scene].units), study.figures is BEAMS
    known = study.references[case.problem]
    trials = {basis: study.trial(Case(basis, case.scene, case.dofs)) for basis in study.values("basis")}
    with drawing():
        figure, axes = panel(HALF, 2.8 if beam else 2.4)
        _ratios(axes, known, trials)
        axes.set(xlabel=axis("opening" if beam else "displacement", units.length))
        what = f"{PAPER_LAWS[case.scene]}, {case.dofs} unknowns" if beam else case.scene
        svg = to_svg(figure, key, f"Deviation of the load from the converged curve, {what}")
    caption = PAPER_LAWS[case.scene] if beam else f"Bond {quantity(study.bond(case.scene), units.length)}"
    return Panel(svg, f"{caption}.")


def _ratios(axes: Axes, known: Reference, trials: Mapping[str, Trial | None]) -> None:
    reference = curve(known.result)
    openings = np.linspace(PROPAGATION * peak(reference)[0], float(np.max(reference[0])), 400)
    band = 100 * max(known.error, known.oscillation)
    axes.axhspan(-band, band, color=colour("muted"), alpha=0.3, linewidth=0)
    for basis, trial in trials.items():
        if trial is not None and trial.drawn is not None:
            ratio = load_at(curve(trial.drawn), openings) / load_at(reference, openings) - 1.0
            axes.plot(openings, 100 * ratio, **line(basis).options(), label=METHOD_NAMES[basis])
    axes.set(ylabel="load / converged load − 1 (%)")
    low, high = axes.get_ylim()
    axes.set_ylim(low, high + 0.15 * (high - low))
    axes.legend(loc="upper right", ncols=3)


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
        axes.set(xlabel="interface points an element", ylabel=_LABELS[measure], yscale="log")
        axes.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
        axes.yaxis.set_minor_locator(NullLocator())
        low, high = axes.get_ylim()
        axes.set_ylim(low, high * (high / low) ** 0.15)
        axes.legend(loc="upper right", ncols=3)
        svg = to_svg(figure, key, f"{_LABELS[measure]} against the number of interface points, {PAPER_LAWS[law]}")
    return Panel(svg, f"{PAPER_LAWS[law]}.")


def _converged(axes: Axes, study: Study, case: Case) -> None:
    known = study.references.get(case.problem)
    if known is not None:
        axes.plot(*curve(known.result), **CONVERGED_LINE.options())


def _path(axes: Axes, trial: Trial | None) -> None:
    """The path of a run, its envelope, and a cross where it stopped."""
    if trial is None or trial.drawn is None:
        return
    d, P = trial.drawn.opening, trial.drawn.load
    ink = colour(line(trial.case.basis).colour)
    axes.plot(d, P, color=ink, linewidth=PATH_WIDTH, alpha=0.75, zorder=3.5)
    axes.plot(*envelope(d, P), color=ink, linewidth=ENVELOPE_WIDTH, zorder=4)
    if not trial.complete:
        axes.plot(d[-1], P[-1], "x", color=ink, zorder=6)


def _frame(study: Study, case: Case, axes: Axes) -> None:
    """Set the axes, which are equal for all bases with one law on one mesh and contain LEFM with its peak."""
    units = Units.of(study.scenes[case.scene].units)
    same = [t for t in study.trials if (t.case.scene, t.case.dofs) == (case.scene, case.dofs)]
    loads = [t.drawn.load for t in same if t.drawn is not None] + [load for _, load in study.limits.values()]
    top = max((float(np.max(load)) for load in loads), default=1.0)
    end = max(study.scenes[case.scene].load.opening)
    axes.set(xlim=(0, end), ylim=(min(0.0, *(float(np.min(v)) for v in loads)), 1.06 * top))
    axes.set(xlabel=axis("opening", units.length), ylabel=axis("load", units.force))


def _below(trial: Trial | None) -> str:
    """The numbers under a panel."""
    if trial is None:
        return "Not run."
    if not trial.complete:
        return f"{trial.status[:1].upper()}{trial.status[1:]}."
    return f"{percent(trial.error)} from the converged curve, oscillation {percent(trial.oscillation)}."


def _below_all(trials: Sequence[Trial]) -> str:
    """The numbers under a panel of all bonds, from the complete runs."""
    done = [t for t in trials if t.complete]
    if not done or not all(isfinite(t.error) for t in done):
        return ""
    errors, waves = (span([getattr(t, name) for t in done], percent) for name in ("error", "oscillation"))
    return f"{errors} from the converged curves, oscillation {waves}."
