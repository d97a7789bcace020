"""The rates of the bases in plane elasticity on the page: a table and the errors over the unknowns."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from verify.pages.parts import plain
from verify.pages.style import HALF, Line, Panel, drawing, panel, to_svg
from verify.pages.text import number, power_of_ten
from verify.studies.plane.rates import Convergence, rate_checks
from verify.verdict import Check, Counts, counted


@dataclass(frozen=True)
class RatesSection:
    """The content of the template for all families."""

    anchor: str
    name: str
    sentence: str
    rows: tuple[tuple[Line, str, tuple[str, ...]], ...]
    panel: Panel
    checks: tuple[Check, ...]

    @property
    def counts(self) -> Counts:
        return counted(self.checks)


def section(found: tuple[Convergence, ...], anchor: str) -> RatesSection:
    """Compute and draw all families."""
    rows = tuple((_line(c), c.family.name, _cells(c)) for c in found)
    known = [c for c in found if c.family.order is not None]
    reduced = [c.rates[0] for c in found if c.family.order is None]
    words = [f"{c.family.name.split(',')[0]} {c.rates[0]:.2f}" for c in known]
    if reduced:
        words.append(f"around extraordinary points {min(reduced):.2f} to {max(reduced):.2f}")
    name = "rates of the bases"
    sentence = f"Rates in L2 of cubic bases in plane elasticity: {', '.join(words)}."
    return RatesSection(anchor, name, sentence, rows, _figure(found, f"{anchor}-errors"), rate_checks(found))


def _cells(c: Convergence) -> tuple[str, ...]:
    last, (rate, energy_rate) = c.errors[-1], c.rates
    expected = "–" if c.family.order is None else f"{c.family.order}"
    errors = (number(last.displacement), f"{rate:.2f}", expected, number(last.energy), f"{energy_rate:.2f}")
    return (number(c.unknowns[-1], 6), *errors)


def _line(c: Convergence) -> Line:
    return Line(c.family.ink, 1.2, (), 1.0, 3.0)


def _figure(found: tuple[Convergence, ...], key: str) -> Panel:
    with drawing():
        figure, axes = panel(HALF, 3.0)
        for c in found:
            error = [e.displacement for e in c.errors]
            axes.loglog(np.sqrt(c.unknowns), error, **_line(c).options(), marker="o", markersize=3)
        axes.set(xlabel="square root of the unknowns", ylabel="relative error of the displacement, L2")
        plain(axes.xaxis)
        axes.yaxis.set_major_formatter(lambda value, _: power_of_ten(value))
        axes.minorticks_off()
        svg = to_svg(figure, key, "Errors of the families over their unknowns")
    return Panel(svg, "Displacement in L2, less its rigid motion, of three meshes of each family.")
