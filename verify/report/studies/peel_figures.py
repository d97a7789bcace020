"""Figure 9: load over displacement of four bond lengths by basis, and how far it is from the converged curve."""

from __future__ import annotations

from collections.abc import Iterator

from verify.curves.curve import peak
from verify.pages.style import HALF, METHOD_NAMES, THIRD, Panel, drawing, line, panel, to_svg
from verify.pages.text import Units, axis, percent, quantity, span
from verify.report.studies.paper_figures import REFERENCE, FigureGroup, deviation, draw_path
from verify.studies.paper.peel import PeelCase, PeelStudy
from verify.studies.paper.study import curve

_LOAD_NOTE = (
    "Coloured: the runs of one basis, named by the length of the bond. Broad and grey: the converged curves. Dashed: "
    "the plate limit of LEFM, a clamped strip on a rigid substrate. A cross marks where a run stopped."
)
_APART_NOTE = (
    "Deviation of the load from 30 % after the peak on. The band around zero is what a coarser mesh of the converged "
    "curve differs from it: below that nothing is said."
)


def figures(study: PeelStudy, key: str) -> tuple[FigureGroup, ...]:
    """The figure by basis, and the deviations by bond."""
    return tuple(_figures(study, key))


def _figures(study: PeelStudy, key: str) -> Iterator[FigureGroup]:
    panels = [_load(study, basis, f"{key}-{basis}") for basis in study.values("basis")]
    yield FigureGroup("Figure 9: load against displacement", _LOAD_NOTE, tuple(panels))
    apart = [_deviation(study, bond, f"{key}-apart-{bond}") for bond in study.references]
    if apart:
        yield FigureGroup("Apart from the converged curve", _APART_NOTE, tuple(apart))


def _load(study: PeelStudy, basis: str, key: str) -> Panel:
    """All bonds by one basis."""
    units = Units.of(next(iter(study.scenes.values())).units)
    trials = [study.trial(PeelCase(basis, bond)) for bond in study.scenes]
    with drawing():
        figure, axes = panel(THIRD, 2.8)
        for bond in study.scenes:
            axes.plot(*study.limits[bond], **line("lefm").options())
            if bond in study.references:
                axes.plot(*curve(study.references[bond].result), **REFERENCE.options())
        for trial in trials:
            draw_path(axes, trial, line(basis))
        tops = [(bond, *peak(curve(study.trial(PeelCase(basis, bond)).result))) for bond in _drawable(study, basis)]
        for bond, x, y in tops:
            name = quantity(study.length(bond), units.length)
            axes.annotate(name, (x, y), (4, 3), textcoords="offset points", fontsize=7.5, zorder=7)
        highest = max((peak(limit)[1] for limit in study.limits.values()), default=1.0)
        end = max(max(scene.load.opening) for scene in study.scenes.values())
        axes.set(xlim=(0, end), ylim=(0, 1.06 * max(highest, *(y for *_, y in tops), 0.0)))
        axes.set(xlabel=axis("displacement", units.length), ylabel=axis("load", units.force))
        svg = to_svg(figure, key, f"Load against displacement by bond length, {METHOD_NAMES[basis]}")
    return Panel(svg, f"{METHOD_NAMES[basis]}. {_told(trials)}", "third")


def _drawable(study: PeelStudy, basis: str) -> list[str]:
    return [b for b in study.scenes if (t := study.trial(PeelCase(basis, b))) is not None and t.drawable]


def _told(trials: list) -> str:
    """The numbers under a panel, over all bonds that came to their end."""
    done = [t for t in trials if t is not None and t.complete]
    if not done or any(t.error != t.error for t in done):
        return ""
    errors, waves = (span([getattr(t, name) for t in done], percent) for name in ("error", "oscillation"))
    return f"{errors} from the converged curves, oscillation {waves}."


def _deviation(study: PeelStudy, bond: str, key: str) -> Panel:
    """load / reference - 1 of all bases."""
    units = Units.of(study.scenes[bond].units)
    with drawing():
        figure, axes = panel(HALF, 2.4)
        trials = {basis: study.trial(PeelCase(basis, bond)) for basis in study.values("basis")}
        deviation(axes, study.references[bond], trials)
        axes.set(xlabel=axis("displacement", units.length))
        svg = to_svg(figure, key, f"Deviation of the load from the converged curve, {bond}")
    return Panel(svg, f"Bond {quantity(study.length(bond), units.length)}.")
