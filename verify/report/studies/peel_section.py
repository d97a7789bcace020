"""The section of Figure 9: statements with verdicts, figures, and one table by bond length and basis."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from math import isfinite, nan

from verify.pages.style import METHOD_NAMES, Line, line
from verify.pages.text import Units, number, percent, quantity, seconds
from verify.report.studies.paper_figures import FigureGroup
from verify.report.studies.peel_figures import figures
from verify.result import Result
from verify.studies.paper.comparison import Statement, counted
from verify.studies.paper.peel import PeelCase, PeelStudy, identities
from verify.studies.paper.peel_statements import statements
from verify.studies.paper.study import Reference, Trial, peak_load

Cell = tuple[str, bool]  # the text, and whether the run stopped


@dataclass(frozen=True)
class Basis:
    """A column of the table."""

    name: str
    line: Line


@dataclass(frozen=True)
class PeelSection:
    """What the template prints; nothing but ``left_out`` where there is no run."""

    anchor: str
    left_out: str
    lead: str
    references: tuple[str, ...]
    statements: tuple[Statement, ...]
    figures: tuple[FigureGroup, ...]
    stopped: tuple[str, ...]
    bases: tuple[Basis, ...]
    tables: tuple[tuple[str, tuple[tuple[str, tuple[Cell, ...]], ...]], ...]


def section(study: PeelStudy, anchor: str) -> PeelSection:
    """Everything that the template prints of the study."""
    found, stopped = statements(study), [trial for trial in study.trials if not trial.complete]
    bases = study.values("basis")
    return PeelSection(
        anchor,
        study.left_out,
        f"{counted(found)}; {len(study.trials) - len(stopped)} of {len(study.trials)} runs came to their end",
        tuple(_references(study)),
        found,
        figures(study, anchor) if study.trials else (),
        tuple(f"{METHOD_NAMES[t.case.basis]}, {_bond(study, t.case.bond)}: {t.status}" for t in stopped),
        tuple(Basis(METHOD_NAMES[basis], line(basis)) for basis in bases),
        tuple(_tables(study, bases)) if study.trials else (),
    )


def _references(study: PeelStudy) -> Iterator[str]:
    """What the converged curve of every bond is, and how well it is known."""
    for bond in study.scenes:
        known, name = study.references.get(bond), f"Bond {_bond(study, bond)}"
        if known is None:
            yield f"{name}: no converged curve, as one of its two fine runs did not come to its end"
        else:
            apart = f"{percent(known.error)} from it, oscillation {percent(known.oscillation)}"
            yield f"{name}: {known.label}; a coarser mesh is {apart}"


def _tables(study: PeelStudy, bases: tuple[str, ...]) -> Iterator[tuple[str, tuple[tuple[str, tuple[Cell, ...]], ...]]]:
    """One group of rows a measure: its title, and a row for every bond with a cell for every basis."""
    columns = {
        bond: (
            *(_of_trial(study, study.trial(PeelCase(basis, bond))) for basis in bases),
            _of_reference(study, bond, study.references.get(bond)),
        )
        for bond in study.scenes
    }
    for i, title in enumerate(_MEASURES):
        yield title, tuple((_bond(study, bond), tuple(cells[i] for cells in columns[bond])) for bond in columns)


def _of_trial(study: PeelStudy, trial: Trial | None) -> tuple[Cell, ...]:
    """A cell for every measure."""
    if trial is None:
        return (("–", False),) * len(_MEASURES)
    if not trial.complete:
        return (("stopped" if trial.drawable else "no curve", True),) * len(_MEASURES)
    case = trial.case
    return _cells(study, case.bond, trial.result, (trial.error, trial.oscillation, study.zones[case.basis, case.bond]))


def _of_reference(study: PeelStudy, bond: str, known: Reference | None) -> tuple[Cell, ...]:
    if known is None:
        return (("–", False),) * len(_MEASURES)
    return _cells(study, bond, known.result, (known.error, known.oscillation, nan))


def _cells(study: PeelStudy, bond: str, result: Result, own: tuple[float, float, float]) -> tuple[Cell, ...]:
    """``own``: curve distance, oscillation, elements in the process zone."""
    error, oscillation, elements = own
    texts = (
        _known(percent, error),
        _known(percent, oscillation),
        quantity(peak_load(result), Units.of(study.scenes[bond].units).force, 4),
        _known(percent, identities(study.scenes[bond], result)["j"]),
        _known(partial(number, digits=2), elements),
        f"{max(result.load.size - 1, 0)}, {result.rejected_steps}",
        seconds((result.seconds or {}).get("total"), "–"),
    )
    return tuple((text, False) for text in texts)


def _bond(study: PeelStudy, bond: str) -> str:
    return quantity(study.length(bond), Units.of(study.scenes[bond].units).length)


def _known(form: Callable[[float], str], value: float) -> str:
    return form(value) if isfinite(value) else "–"


#: Titles of what `_cells` gives.
_MEASURES = (
    "Curve distance",
    "Oscillation on the propagation branch",
    "Peak load",
    "Deviation of J once the tip of the bond is open",
    "Elements in the process zone",
    "Steps, and steps taken back",
    "Wall time",
)
