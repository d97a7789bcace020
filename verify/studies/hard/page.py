"""The matrix as a page: one self-contained HTML file, with a figure for every case and basis."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from urllib.parse import quote

from iga.bases.names import BASES
from verify.curves.curve import Curve, envelope
from verify.curves.of_run import cubics
from verify.pages.style import METHOD_NAMES, Line, Panel, drawing, line, panel
from verify.pages.table import Cell, Table, of_state
from verify.pages.text import number, seconds
from verify.result import Result
from verify.runs.folder import read_result
from verify.studies.hard.case import Case
from verify.studies.hard.one import Verdict
from verify.studies.hard.suite import Verdicts, all_hold
from verify.studies.page import write_template

#: Approximate number of points of a curve; largest number of runs with a legend.
_POINTS, _NAMED = 600, 8
_COLOURS = ("nurbs", "lagrange", "dolfinx", "beam", "zone", "tspline", "accent", "bad")
_ENVELOPE = Line("bad", 1.0, (4.0, 2.5), 1.0, 5.0)


def write(cases: Sequence[Case], verdicts: Verdicts, out: Path) -> None:
    """Write ``out``/report.html."""
    shown = [
        (case, all_hold(case, verdicts), [_shown(case, verdicts[case.name, basis], out) for basis in case.bases])
        for case in cases
    ]
    content = {"matrix": matrix_of(cases, verdicts), "cases": shown, "held": sum(holds for _, holds, _ in shown)}
    write_template("verify.studies.hard", out / "report.html", **content)


def matrix_of(cases: Sequence[Case], verdicts: Verdicts, prefix: str = "") -> Table:
    """A row for each case and a column for each basis; ``prefix`` is the path from the page to the cases."""
    rows = [
        (
            Cell(case.name, case.hard, "" if prefix else f"#{case.name}"),
            *(_summary(verdicts.get((case.name, basis)), prefix) for basis in BASES),
        )
        for case in cases
    ]
    titles = ("Case", *(METHOD_NAMES[basis] for basis in BASES))
    caption = "Whether the criteria of every case hold, with steps and time"
    return Table.of(titles, rows, caption, "overview told matrix")


def _summary(one: Verdict | None, prefix: str) -> Cell | str:
    """State, sums and maxima, with a link to the curve of the first run."""
    if one is None:
        return "–"
    if one.why:
        return of_state("broken", one.why)
    total = one.total
    said = f"{total.name} complete, {total.steps} steps, {total.rejected} taken back; ledger "
    said += f"{number(total.ledger, 2)}, condition {_condition(total.condition)}, {seconds(total.seconds)}"
    link = f"./{prefix}{_curve(one, one.runs[0].name)}"
    return of_state("holds" if one.passed else "broken", one.fault or said, link)


def _shown(case: Case, one: Verdict, out: Path) -> dict[str, object]:
    """What is shown of a case and a basis: a heading, its figure, why it has no verdict, or its criteria and runs."""
    name = METHOD_NAMES[one.basis]
    if one.why:
        return {"title": name, "figure": None, "why": one.why, "tables": ()}
    criteria: list[tuple[object, ...]] = [
        (Cell(c.name, c.meaning), c.subject, c.value, c.tolerance, c.kind, of_state(c.state, c.unresolved))
        for c in sorted(one.checks, key=lambda check: check.state != "broken")
    ]
    criteria += [(Cell(n.name, n.meaning), n.subject, n.value, "–", "reported", "") for n in one.numbers]
    runs = [
        (
            *(run.name, run.status, run.steps, run.rejected, number(run.ledger, 2), _condition(run.condition)),
            seconds(run.seconds),
            Cell("curve.csv", link=f"./{_curve(one, run.name)}"),
        )
        for run in one.runs
    ]
    where = f"of {one.case} on {name}"
    titles = ("Run", "Ended", "Steps", "Taken back", "Ledger", "Condition", "Time", "Curve")
    judged = ("Criterion", "Run", "Value", "Tolerance", "Kind", "Verdict")
    tables = Table.of(judged, criteria, f"Criteria {where}"), Table.of(titles, runs, f"Runs {where}")
    return {"title": name, "figure": _figure(case, one, out), "why": "", "tables": tables}


def _condition(value: float) -> str:
    return number(value, 2) if value else "–"


def _curve(one: Verdict, run: str) -> str:
    return f"{quote(one.folder)}/{quote(run)}/curve.csv"


def _figure(case: Case, one: Verdict, out: Path) -> Panel | None:
    """The curves of the runs that have the units of the first; None without a run."""
    units = {name: scene.units for name, scene in case.scenes().items()}
    names = [run.name for run in one.runs if run.steps > 0]
    names = [name for name in names if units.get(name) == units.get(names[0])]
    if not names:
        return None
    named = len(names) <= _NAMED
    with drawing():
        figure, axes = panel(4.6, 3.0)
        for i, name in enumerate(names):
            result, style = read_result(out / one.folder / name), _style(i, named).options()
            axes.plot(*_path(result), **style, label=name if named else None)
            if not result.complete:
                axes.plot(result.opening[-1], result.load[-1], "x", color=style["color"], zorder=6)
        if len(names) == 1:
            axes.plot(*envelope(*_path(result)), **_ENVELOPE.options(), label="displacement control")
        axes.set(xlabel="opening", ylabel="load")
        if named:
            axes.legend(loc="upper right")
        title = METHOD_NAMES[one.basis]
        caption = f"{title}: {_caption(len(names), len(one.runs))}"
        return Panel.of(figure, f"{one.case}-{one.basis}", f"Load against opening, {one.case}, {title}", caption)


def _caption(drawn: int, whole: int) -> str:
    if drawn == 1 == whole:
        return "the path, and dashed what a test in displacement control would show of it."
    others = f"; {whole - drawn} more in other units or without a step" if whole > drawn else ""
    return f"{drawn} runs{others}. A cross marks the end of a run that stopped."


def _style(i: int, named: bool) -> Line:
    if not named:
        return Line("accent", 0.7, (), 0.5, 3.0)
    dashes = ((), (5.0, 2.0), (1.5, 1.5))[i % 3]
    return Line(_COLOURS[i % len(_COLOURS)], line("nurbs").width, dashes, 0.9, 3.0 + 0.1 * i)


def _path(result: Result) -> Curve:
    return cubics(result, max(_POINTS // result.opening.size, 1))
