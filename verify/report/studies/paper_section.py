"""The section of Figures 6, 7 and 8: statements with verdicts, tables of error and oscillation, figures."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from math import isfinite

from verify.pages.style import METHOD_NAMES, Line, line
from verify.pages.text import number, percent, seconds
from verify.report.studies.paper_figures import FigureGroup, figures
from verify.studies.paper.comparison import Statement, counted
from verify.studies.paper.plan import LAWS, PAPER_PENALTY, Case
from verify.studies.paper.statements import statements
from verify.studies.paper.study import Study, Trial

#: Measure -> heading of its table.
TABLES = {
    "error": "Curve distance to the converged curve",
    "oscillation": "Oscillation on the propagation branch",
}


@dataclass(frozen=True)
class TableRow:
    """A basis at one penalty: a cell for every number of points, and whether that run stopped."""

    line: Line
    name: str
    penalty: str
    cells: tuple[tuple[str, bool], ...]


@dataclass(frozen=True)
class TableGroup:
    """One law at one number of unknowns."""

    name: str
    rows: tuple[TableRow, ...]


@dataclass(frozen=True)
class RunRow:
    """Everything about one run."""

    case: str
    folder: str
    cells: tuple[str, ...]
    status: str


@dataclass(frozen=True)
class PaperSection:
    """What the template prints; nothing but ``left_out`` where there is no run."""

    anchor: str
    left_out: str
    lead: str
    references: tuple[str, ...]
    statements: tuple[Statement, ...]
    points: tuple[int, ...]
    tables: tuple[tuple[str, tuple[TableGroup, ...]], ...]
    runs: tuple[RunRow, ...]
    stopped: tuple[str, ...]
    figures: tuple[FigureGroup, ...]
    example: str


def section(study: Study, anchor: str) -> PaperSection:
    """Everything that the template prints of the study."""
    found, stopped = statements(study), tuple(trial for trial in study.trials if not trial.complete)
    return PaperSection(
        anchor,
        study.left_out,
        f"{counted(found)}; {len(study.trials) - len(stopped)} of {len(study.trials)} runs came to their end",
        tuple(_references(study)),
        found,
        study.values("points"),
        tuple((title, tuple(_groups(study, measure))) for measure, title in TABLES.items()),
        tuple(_run(trial) for trial in study.trials),
        tuple(f"{_name(trial.case)}: {trial.status}" for trial in stopped),
        figures(study, anchor) if study.trials else (),
        _command(study.trials[0].case) if study.trials else "",
    )


def _references(study: Study) -> Iterator[str]:
    """What the converged curve of every problem is, and how well it is known."""
    for law, penalty in product(study.scenes, study.values("penalty")):
        known, name = study.references.get((law, penalty)), f"{LAWS[law]}, penalty {number(penalty)}"
        if known is None:
            yield f"{name}: no converged curve, as one of its two fine runs did not come to its end"
        else:
            apart = f"{percent(known.error)} from it, oscillation {percent(known.oscillation)}"
            yield f"{name}: {known.label}; a coarser mesh is {apart}"


def _groups(study: Study, measure: str) -> Iterator[TableGroup]:
    bases, points = study.values("basis"), study.values("points")
    for law, dofs in product(study.values("law"), study.values("dofs")):
        rows = [
            TableRow(
                line(basis),
                METHOD_NAMES[basis],
                number(penalty),
                tuple(_cell(study.trial(Case(basis, law, dofs, n, penalty)), measure) for n in points),
            )
            for basis, penalty in product(bases, study.values("penalty"))
        ]
        yield TableGroup(f"{LAWS[law]}, {dofs} unknowns", tuple(rows))


def _cell(trial: Trial | None, measure: str) -> tuple[str, bool]:
    if trial is None:
        return "–", False
    if trial.complete:
        return percent(getattr(trial, measure)), False
    return ("stopped" if trial.drawable else "no curve"), True


def _run(trial: Trial) -> RunRow:
    result = trial.result
    cells = (
        *(percent(v) if isfinite(v) else "–" for v in (trial.error, trial.oscillation, trial.variation, trial.peak)),
        *((str(result.dofs), str(max(result.load.size - 1, 0)), str(result.rejected_steps)) if result else "–––"),
        seconds(trial.seconds, "–"),
    )
    return RunRow(_name(trial.case), f"{trial.case.law}/{trial.case.variant}", cells, trial.status)


def _name(case: Case) -> str:
    more = "" if case.penalty == PAPER_PENALTY else f", penalty {number(case.penalty)}"
    return f"{LAWS[case.law]}, {case.dofs} unknowns, {METHOD_NAMES[case.basis]}, {case.points} points{more}"


def _command(case: Case) -> str:
    sets = " ".join(f"--set {override}" for override in case.overrides)
    return f"debond solve {case.law} --method {case.basis} {sets}"
