"""Figures of the paper on the page: statements with verdicts, converged curves, figures, tables of all runs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from math import isfinite, nan

from verify.curves.of_run import peak_load
from verify.pages.style import METHOD_NAMES, Line, line
from verify.pages.text import Units, number, percent, quantity, seconds
from verify.report.studies.paper_figures import FigureGroup, figures
from verify.result import Result
from verify.studies.paper.plan import BEAMS, PAPER_LAWS, PAPER_PENALTY, Case
from verify.studies.paper.statement import Statement, counted
from verify.studies.paper.statements import identities, statements
from verify.studies.paper.study import Study, Trial

#: Measure -> heading of its table, for Figures 6 to 8.
TABLE_TITLES = {
    "error": "Curve distance to the converged curve",
    "oscillation": "Oscillation on the propagation branch",
}

#: Rows of the table of Figure 9.
_MEASURES = (
    "Curve distance",
    "Oscillation on the propagation branch",
    "Peak load",
    "Deviation of J once the tip of the bond is open",
    "Elements in the process zone",
    "Steps, and steps taken back",
    "Wall time",
)

#: Columns of the table of all runs of Figures 6 to 8.
_OF_A_RUN = (
    *("Curve distance", "Oscillation", "Excess variation", "Peak error"),
    *("Unknowns", "Steps", "Taken back", "Wall time", "Ended"),
)

_BEAMS = (
    "every basis with equal unknowns on the same double cantilever beam, Gauss points. A verdict is computed from the "
    "runs of this page; a run that stopped takes part in no comparison and keeps its row."
)
_STRIPS = (
    "a strip peeled off a substrate with bonds of several lengths, every basis with equal unknowns. The moduli are "
    "read as GPa. A verdict is computed from the runs of this page; a run that stopped takes part in no comparison and "
    "keeps its cells."
)
_BELOW_STRIPS = (
    "Curve distance and oscillation as in the tables above, against the converged curve; under “Converged”, of its "
    "coarser mesh against it."
)

#: The text where there is no value.
_NONE = "–"

#: Text of a cell, and whether its run stopped.
Cell = tuple[str, bool]


@dataclass(frozen=True)
class Head:
    """The heading of a column or a row, such as a basis with its line style; ``folder`` is that of a run."""

    name: str
    line: Line | None = None
    folder: str = ""


@dataclass(frozen=True)
class Row:
    head: Head
    cells: tuple[Cell, ...]


@dataclass(frozen=True)
class Table:
    """A table with groups of rows, named or not; the first of ``heads`` is above the headings of the rows."""

    heading: str
    caption: str
    heads: tuple[Head, ...]
    groups: tuple[tuple[str, tuple[Row, ...]], ...]
    note: str = ""


@dataclass(frozen=True)
class PaperSection:
    """The content of the template; only ``left_out`` where there is no run."""

    anchor: str
    title: str
    about: str
    left_out: str
    lead: str
    statements: tuple[Statement, ...]
    references: tuple[str, ...]
    stopped: tuple[str, ...]
    figures: tuple[FigureGroup, ...]
    tables: tuple[Table, ...]
    runs: Table | None
    example: str


def section(study: Study, anchor: str) -> PaperSection:
    """The section of a study."""
    found, stopped = statements(study), [trial for trial in study.trials if not trial.complete]
    beams, some = study.figures is BEAMS, bool(study.trials)
    return PaperSection(
        anchor,
        "Figures 6, 7 and 8" if beams else "Figure 9",
        _BEAMS if beams else _STRIPS,
        study.left_out,
        f"{counted(found)}; {len(study.trials) - len(stopped)} of {len(study.trials)} runs came to their end",
        found,
        tuple(_references(study)),
        tuple(f"{_name(study, trial.case)}: {trial.status}" for trial in stopped),
        figures(study, anchor) if some else (),
        tuple(_by_points(study) if beams else _by_bond(study)) if some else (),
        _all_runs(study) if beams and some else None,
        _command(study.trials[0].case) if beams and some else "",
    )


def _references(study: Study) -> Iterator[str]:
    """A sentence on the converged curve of every problem and its error."""
    for scene, penalty in dict.fromkeys(trial.case.problem for trial in study.trials):
        known = study.references.get((scene, penalty))
        name = f"{PAPER_LAWS[scene]}, penalty {number(penalty)}" if penalty else f"Bond {_bond(study, scene)}"
        if known is None:
            yield f"{name}: no converged curve, as one of its two fine runs did not come to its end"
        else:
            apart = f"{percent(known.error)} from it, oscillation {percent(known.oscillation)}"
            yield f"{name}: {known.label}; a coarser mesh is {apart}"


def _by_points(study: Study) -> Iterator[Table]:
    """A table per measure: a row per basis and penalty, a cell per number of points."""
    bases, points, penalties = (study.values(name) for name in ("basis", "points", "penalty"))
    heads = (Head("Basis"), Head("Penalty"), *(Head(f"{n} points") for n in points))
    for measure, title in TABLE_TITLES.items():
        groups = []
        for law, dofs in product(study.values("scene"), study.values("dofs")):
            rows = []
            for basis, penalty in product(bases, penalties):
                trials = (study.trial(Case(basis, law, dofs, n, penalty)) for n in points)
                cells = (_lost(trial) or (percent(getattr(trial, measure)), False) for trial in trials)
                rows.append(Row(Head(METHOD_NAMES[basis], line(basis)), ((number(penalty), False), *cells)))
            groups.append((f"{PAPER_LAWS[law]}, {dofs} unknowns", tuple(rows)))
        title = f"{title} by number of interface points"
        yield Table(title, title, heads, tuple(groups))


def _by_bond(study: Study) -> Iterator[Table]:
    """One table: a group of rows per measure, a row per bond, a cell per basis."""
    bases = study.values("basis")
    heads = (Head("Bond"), *(Head(METHOD_NAMES[basis], line(basis)) for basis in bases), Head("Converged"))
    columns = {bond: [*(_measured(study, Case(b, bond)) for b in bases), _fine(study, bond)] for bond in study.scenes}
    groups = tuple(
        (title, tuple(Row(Head(_bond(study, bond)), tuple(cells[i] for cells in of)) for bond, of in columns.items()))
        for i, title in enumerate(_MEASURES)
    )
    yield Table("By bond length and basis", "Measures by bond length and basis", heads, groups, _BELOW_STRIPS)


def _lost(trial: Trial | None) -> Cell | None:
    """The cell of a run that is missing or stopped; None for a complete run."""
    if trial is None:
        return _NONE, False
    return None if trial.complete else ("no curve" if trial.drawn is None else "stopped", True)


def _measured(study: Study, case: Case) -> tuple[Cell, ...]:
    """A cell for each of `_MEASURES`."""
    trial = study.trial(case)
    if trial is None or trial.result is None or not trial.complete:
        return (_lost(trial) or (_NONE, False),) * len(_MEASURES)
    return _cells(study, case.scene, trial.result, (trial.error, trial.oscillation, study.zones[case]))


def _fine(study: Study, bond: str) -> tuple[Cell, ...]:
    known = study.references.get((bond, None))
    if known is None:
        return ((_NONE, False),) * len(_MEASURES)
    return _cells(study, bond, known.result, (known.error, known.oscillation, nan))


def _cells(study: Study, bond: str, result: Result, own: tuple[float, float, float]) -> tuple[Cell, ...]:
    """``own``: curve distance, oscillation, elements in the process zone."""
    error, oscillation, elements = own
    texts = (
        _percent(error),
        _percent(oscillation),
        quantity(peak_load(result), Units.of(study.scenes[bond].units).force, 4),
        _percent(identities(study.scenes[bond], result)["j"]),
        number(elements, 2) if isfinite(elements) else _NONE,
        f"{max(result.load.size - 1, 0)}, {result.rejected_steps}",
        seconds((result.seconds or {}).get("total"), _NONE),
    )
    return tuple((text, False) for text in texts)


def _all_runs(study: Study) -> Table:
    """The table of all runs with all measures."""
    rows = []
    for trial in study.trials:
        head = Head(_name(study, trial.case), folder=f"{trial.case.scene}/{trial.case.variant}")
        rows.append(Row(head, (*((text, False) for text in _texts(trial)), (trial.status, True))))
    title = "All runs of the figures"
    return Table(title, title, tuple(map(Head, ("Run", *_OF_A_RUN))), (("", tuple(rows)),))


def _texts(trial: Trial) -> tuple[str, ...]:
    """Texts for all columns of `_OF_A_RUN` except the last."""
    measures = map(_percent, (trial.error, trial.oscillation, trial.variation, trial.peak))
    if (result := trial.result) is None:
        return (*measures, *(_NONE,) * 4)
    sizes = map(str, (result.dofs, max(result.load.size - 1, 0), result.rejected_steps))
    return (*measures, *sizes, seconds((result.seconds or {}).get("total"), _NONE))


def _name(study: Study, case: Case) -> str:
    if not case.dofs:
        return f"{METHOD_NAMES[case.basis]}, {_bond(study, case.scene)}"
    more = "" if case.penalty == PAPER_PENALTY else f", penalty {number(case.penalty)}"
    return f"{PAPER_LAWS[case.scene]}, {case.dofs} unknowns, {METHOD_NAMES[case.basis]}, {case.points} points{more}"


def _command(case: Case) -> str:
    sets = " ".join(f"--set {override}" for override in case.overrides)
    return f"debond solve {case.scene} --method {case.basis} {sets}"


def _bond(study: Study, bond: str) -> str:
    return quantity(study.bond(bond), Units.of(study.scenes[bond].units).length)


def _percent(value: float) -> str:
    return percent(value) if isfinite(value) else _NONE
