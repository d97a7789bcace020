"""The matrix as a page: one self-contained HTML file, with a figure for every cell."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from iga.bases.names import BASES
from verify.curves.curve import Curve, envelope
from verify.curves.of_run import cubics
from verify.pages.style import METHOD_NAMES, Line, Panel, drawing, line, panel, to_svg
from verify.pages.template import rendered
from verify.pages.text import seconds
from verify.result import Result
from verify.runs.folder import read_result
from verify.studies.hard.case import Case
from verify.studies.hard.suite import Cell, totals
from verify.verdict import Check

#: Approximate number of points of a curve; largest number of runs with a legend.
_POINTS, _NAMED = 600, 8
_COLOURS = ("nurbs", "lagrange", "dolfinx", "beam", "zone", "tspline", "accent", "bad")


@dataclass(frozen=True)
class Row:
    """One case: its cells, each with its figure or None where no run has a step."""

    case: Case
    cells: tuple[tuple[Cell, Panel | None], ...]

    @property
    def passed(self) -> bool:
        return all(cell.passed for cell, _ in self.cells)


def write(cells: Sequence[Cell], out: Path) -> None:
    """Write ``out``/report.html."""
    cases = list(dict.fromkeys(cell.case.name for cell in cells))
    rows = [_row([cell for cell in cells if cell.case.name == name], out) for name in cases]
    page = rendered(
        "verify.studies.hard",
        "page.html.j2",
        {"seconds": seconds, "worst": worst_first, "totals": totals},
        rows=rows,
        bases={basis: METHOD_NAMES[basis] for basis in BASES},
        held=sum(row.passed for row in rows),
    )
    (out / "report.html").write_text(page, encoding="utf-8")


def worst_first(checks: Sequence[Check]) -> list[Check]:
    """Failing criteria first."""
    return sorted(checks, key=lambda check: check.passed)


def _row(cells: Sequence[Cell], out: Path) -> Row:
    return Row(cells[0].case, tuple((cell, _figure(cell, out)) for cell in cells))


def _figure(cell: Cell, out: Path) -> Panel | None:
    """The curves of a cell's runs that have the units of the first; None without a run."""
    runs = _drawn(cell, out)
    if not runs:
        return None
    name = f"{cell.case.name}, {METHOD_NAMES[cell.basis]}"
    with drawing():
        figure, axes = panel(4.6, 3.0)
        for i, (label, result) in enumerate(runs):
            style = _style(i, len(runs))
            axes.plot(*_path(result), **style.options(), label=label if len(runs) <= _NAMED else None)
            if not result.complete:
                axes.plot(result.opening[-1], result.load[-1], "x", color=style.options()["color"], zorder=6)
        if len(runs) == 1:
            axes.plot(*envelope(*_path(runs[0][1])), **_ENVELOPE.options(), label="displacement control")
        axes.set(xlabel="opening", ylabel="load")
        if len(runs) <= _NAMED:
            axes.legend(loc="upper right")
        svg = to_svg(figure, f"{cell.case.name}-{cell.basis}", f"Load against opening, {name}")
    return Panel(svg, f"{METHOD_NAMES[cell.basis]}: {_caption(cell, len(runs))}")


def _caption(cell: Cell, drawn: int) -> str:
    whole = len(cell.verdict.runs) if cell.verdict else drawn
    if drawn == 1 == whole:
        return "the path, and dashed what a test in displacement control would show of it."
    others = f"; {whole - drawn} more in other units or without a step" if whole > drawn else ""
    return f"{drawn} runs{others}. A cross marks the end of a run that stopped."


_ENVELOPE = Line("bad", 1.0, (4.0, 2.5), 1.0, 5.0)


def _style(i: int, n: int) -> Line:
    if n > _NAMED:
        return Line("accent", 0.7, (), 0.5, 3.0)
    dashes = ((), (5.0, 2.0), (1.5, 1.5))[i % 3]
    return Line(_COLOURS[i % len(_COLOURS)], line("nurbs").width, dashes, 0.9, 3.0 + 0.1 * i)


def _drawn(cell: Cell, out: Path) -> list[tuple[str, Result]]:
    if cell.verdict is None:
        return []
    units = {variant.name: variant.scene.units for variant in cell.case.variants()}
    names = [run.name for run in cell.verdict.runs if run.steps > 0]
    names = [name for name in names if units.get(name) == units.get(names[0])]
    return [(name, read_result(out / cell.folder / name)) for name in names]


def _path(result: Result) -> Curve:
    return cubics(result, max(_POINTS // result.opening.size, 1))
