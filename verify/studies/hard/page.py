"""The matrix as a page: one self-contained HTML file, with a figure for every cell."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import quote

from iga.bases.names import BASES
from verify.curves.curve import Curve, envelope
from verify.curves.of_run import cubics
from verify.pages import table
from verify.pages.style import METHOD_NAMES, Line, Panel, drawing, line, panel, to_svg
from verify.pages.table import Table, of_state
from verify.pages.template import rendered
from verify.pages.text import number, seconds
from verify.result import Result
from verify.runs.folder import read_result
from verify.studies.hard.suite import Cell, totals

#: Approximate number of points of a curve; largest number of runs with a legend.
_POINTS, _NAMED = 600, 8
_COLOURS = ("nurbs", "lagrange", "dolfinx", "beam", "zone", "tspline", "accent", "bad")


@dataclass(frozen=True)
class Shown:
    """A cell on the page: a heading, its figure, why it has no verdict, or its criteria and runs."""

    title: str
    figure: Panel | None
    why: str
    tables: tuple[Table, ...]


def write(cells: Sequence[Cell], out: Path) -> None:
    """Write ``out``/report.html."""
    of_case: dict[str, list[Cell]] = {}
    for cell in cells:
        of_case.setdefault(cell.case.name, []).append(cell)
    page = rendered(
        "verify.studies.hard",
        "page.html.j2",
        {},
        matrix=matrix_of(cells),
        cases=[(some[0].case, all_hold(some), [_shown(cell, out) for cell in some]) for some in of_case.values()],
        held=sum(map(all_hold, of_case.values())),
    )
    (out / "report.html").write_text(page, encoding="utf-8")


def all_hold(cells: Sequence[Cell]) -> bool:
    return all(cell.passed for cell in cells)


def matrix_of(cells: Sequence[Cell], prefix: str = "") -> Table:
    """A row for each case and a column for each basis; ``prefix`` is the path from the page to the cases."""
    found = {(cell.case.name, cell.basis): cell for cell in cells}
    rows = [
        (
            table.Cell(case.name, case.hard, "" if prefix else f"#{case.name}"),
            *(_summary(found.get((case.name, basis)), prefix) for basis in BASES),
        )
        for case in {cell.case.name: cell.case for cell in cells}.values()
    ]
    titles = ("Case", *(METHOD_NAMES[basis] for basis in BASES))
    return Table.of(
        titles, rows, "Whether the criteria of every case hold, with steps and time", "overview told matrix"
    )


def _summary(cell: Cell | None, prefix: str) -> table.Cell | str:
    """State, sums and maxima of a cell, with a link to the curve of its first run."""
    if cell is None:
        return "–"
    if cell.verdict is None:
        return of_state("broken", cell.why)
    total = totals(cell.verdict)
    said = f"{total.completed} complete, {total.steps} steps, {total.rejected} taken back; ledger "
    said += f"{number(total.ledger, 2)}, condition {_condition(total.condition)}, {seconds(total.seconds)}"
    link = f"./{prefix}{_curve(cell, cell.verdict.runs[0].name)}"
    return of_state("holds" if cell.passed else "broken", cell.verdict.fault or said, link)


def _shown(cell: Cell, out: Path) -> Shown:
    name = METHOD_NAMES[cell.basis]
    if cell.verdict is None:
        return Shown(name, _figure(cell, out), cell.why, ())
    criteria: list[tuple[object, ...]] = [
        (table.Cell(c.name, c.meaning), c.subject, c.value, c.tolerance, c.kind, of_state(c.state))
        for c in sorted(cell.verdict.checks, key=lambda check: check.passed)
    ]
    criteria += [(table.Cell(n.name, n.meaning), n.subject, n.value, "–", "reported", "") for n in cell.verdict.numbers]
    runs = [
        (
            *(run.name, run.status, run.steps, run.rejected, number(run.ledger, 2), _condition(run.condition)),
            seconds(run.seconds),
            table.Cell("curve.csv", link=f"./{_curve(cell, run.name)}"),
        )
        for run in cell.verdict.runs
    ]
    where = f"of {cell.case.name} on {name}"
    titles = ("Run", "Ended", "Steps", "Taken back", "Ledger", "Condition", "Time", "Curve")
    judged = ("Criterion", "Run", "Value", "Tolerance", "Kind", "Verdict")
    tables = Table.of(judged, criteria, f"Criteria {where}"), Table.of(titles, runs, f"Runs {where}")
    return Shown(name, _figure(cell, out), "", tables)


def _condition(value: float) -> str:
    return number(value, 2) if value else "–"


def _curve(cell: Cell, run: str) -> str:
    return f"{quote(cell.folder)}/{quote(run)}/curve.csv"


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
