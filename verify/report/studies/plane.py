"""A plane problem on the page: table of errors and rates, the stress with its elements, its error, the convergence."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from verify.pages.paint import Limits, paint
from verify.pages.parts import plain
from verify.pages.style import STRESS_MAP, THIRD, Panel, colour, drawing, panel, to_svg
from verify.pages.text import number, power_of_ten
from verify.studies.plane.study import PlaneStudy, settled
from verify.verdict import Check, Counts, counted

#: Inches: highest picture, margins, and the strip of the colour scale below.
_HIGHEST, _MARGIN, _STRIP = 3.4, 0.05, 0.5


@dataclass(frozen=True)
class Row:
    """One mesh of the sequence."""

    name: str
    cells: tuple[str, ...]


@dataclass(frozen=True)
class PlaneSection:
    """The content of the template for one file."""

    anchor: str
    name: str
    problem: str
    sentence: str
    rows: tuple[Row, ...]
    note: str
    panels: tuple[Panel, ...]
    checks: tuple[Check, ...]

    @property
    def counts(self) -> Counts:
        return counted(self.checks)


def section(study: PlaneStudy, anchor: str) -> PlaneSection:
    """Compute and draw one file."""
    rows = tuple(
        Row(
            level.name,
            (
                number(level.elements, 6),
                number(level.unknowns, 6),
                number(level.errors.displacement),
                _rate(level.rate),
                number(level.errors.energy),
                _rate(level.energy_rate),
                number(level.errors.stress),
            ),
        )
        for level in study.levels
    )
    return PlaneSection(
        anchor,
        study.name,
        study.problem[0].upper() + study.problem[1:],
        _sentence(study),
        rows,
        _note(study),
        (_stress(study, f"{anchor}-stress"), _error(study, f"{anchor}-error"), _convergence(study, f"{anchor}-rates")),
        study.checks,
    )


def _sentence(study: PlaneStudy) -> str:
    first, last = study.levels[0], study.levels[-1]
    patch = number(max(study.patch.displacement, study.patch.stress), 2)
    known = np.isfinite(last.rate)
    rate = f", rate {last.rate:.2f}{'' if settled(study.levels) else ', not settled'}" if known else ""
    return (
        f"{study.name}: patch test to {patch}; displacement within {number(first.errors.displacement, 2)} of the exact "
        f"field on the file, {number(last.errors.displacement, 2)} refined{rate}."
    )


def _note(study: PlaneStudy) -> str:
    judged = "it is judged" if settled(study.levels) else "it is still changing, and not judged"
    return (
        f"Relative errors: displacement in L2 less its rigid motion, stress in energy, largest stress. Halved elements "
        f"should give the rates {study.order} and {study.order - 1}; the last rate in L2 is checked where it has "
        f"settled ({judged}). The first mesh has the functions of the file, the next one its Bezier elements joined "
        f"C0, of equal size: between these two there is no rate. Isotropic, plane stress, tractions of the exact "
        f"field on the whole boundary."
    )


def _rate(value: float) -> str:
    return "–" if np.isnan(value) else f"{value:.2f}"


def _stress(study: PlaneStudy, key: str) -> Panel:
    limit = float(np.nanpercentile(np.abs(study.found_euv), 99.9))
    svg = _picture(study, study.found_euv, limit, "stress xx", key, f"Stress on the elements of {study.name}")
    return Panel(
        svg, "Stress along x on the mesh of the file, its Bezier elements drawn, not averaged between them.", "third"
    )


def _error(study: PlaneStudy, key: str) -> Panel:
    miss = study.found_euv - study.exact_euv
    limit = float(np.nanpercentile(np.abs(miss), 99.5)) or 1.0
    svg = _picture(study, miss, limit, "stress xx less the exact one", key, f"Error of the stress of {study.name}")
    return Panel(svg, f"Its error on the same mesh, to ± {number(limit, 2)}.", "third")


def _picture(study: PlaneStudy, value_euv: np.ndarray, limit: float, label: str, key: str, title: str) -> str:
    x, y = _frame(study.X_euvi)
    width = THIRD - 2 * _MARGIN
    height = min(width * (y[1] - y[0]) / (x[1] - x[0]), _HIGHEST)
    width = height * (x[1] - x[0]) / (y[1] - y[0])
    total = height + 2 * _MARGIN + _STRIP
    with drawing():
        figure = Figure(figsize=(THIRD, total))
        left, bottom = 0.5 * (THIRD - width), _MARGIN + _STRIP
        axes = figure.add_axes((left / THIRD, bottom / total, width / THIRD, height / total))
        paint(axes, study.X_euvi, value_euv, limit, (x, y))
        axes.set_axis_off()
        place = figure.add_axes((0.1, 0.4 / total, 0.8, 0.08 / total))
        bar = figure.colorbar(ScalarMappable(Normalize(-limit, limit), STRESS_MAP), cax=place, orientation="horizontal")
        bar.set_label(label)
        bar.outline.set_visible(False)
        bar.ax.locator_params(nbins=5)
        return to_svg(figure, key, title, dpi=170)


def _frame(X_euvi: np.ndarray) -> tuple[Limits, Limits]:
    low, high = X_euvi.min((0, 1, 2)), X_euvi.max((0, 1, 2))
    pad = 0.01 * float(np.max(high - low))
    return (low[0] - pad, high[0] + pad), (low[1] - pad, high[1] + pad)


def _convergence(study: PlaneStudy, key: str) -> Panel:
    """Errors over the square root of the unknowns, with the expected slopes."""
    h = np.array([level.unknowns for level in study.levels]) ** -0.5
    L2, energy = np.array([(v.errors.displacement, v.errors.energy) for v in study.levels]).T
    with drawing():
        figure, axes = panel(THIRD, 3.3)
        lines = (
            (L2, study.order, "nurbs", "displacement, L2"),
            (energy, study.order - 1, "lagrange", "stress, energy"),
        )
        for error, order, ink, label in lines:
            axes.loglog(1 / h, error, color=colour(ink), marker="o", markersize=3.5, linewidth=1.1, label=label)
            if h.size > 1:  # a file that is large enough is the only mesh
                slope = error[-1] * (h[1:] / h[-1]) ** order
                axes.loglog(1 / h[1:], slope, color=colour("muted"), linewidth=0.8, linestyle=(0, (4, 3)))
                axes.annotate(f"{order}", (1 / h[1], slope[0]), xytext=(-2, 4), textcoords="offset points", ha="right")
        axes.set(xlabel="square root of the unknowns", ylabel="relative error")
        plain(axes.xaxis)
        axes.yaxis.set_major_formatter(lambda value, place: power_of_ten(value))
        axes.minorticks_off()
        axes.legend(loc="lower left")
        svg = to_svg(figure, key, f"Convergence on {study.name}")
    return Panel(svg, "Errors of the meshes, the file first; dashed: the expected rates of halved elements.", "third")
