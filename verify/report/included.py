"""What other commands have found, on the page of a verification: cost, effects, hard cases."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import quote

from verify.cost.findings import LEVELS, cheapest, of_equal_steps
from verify.cost.page import Chart, Level, chart
from verify.cost.row import read_csv
from verify.folder import read_rows
from verify.hard.case import BASES
from verify.hard.cases import CASES
from verify.hard.one import read_verdict
from verify.hard.page import Row as HardRow
from verify.hard.suite import Cell
from verify.included import Included
from verify.report.style import METHOD_NAMES
from verify.switches.page import BARS
from verify.switches.row import Row as EffectRow

TITLES = {"cost": "What accuracy costs", "effects": "What each effect does", "hard": "Hard cases"}


@dataclass(frozen=True, eq=False)
class IncludedSection:
    """A study as the template prints it: of ``chart``, ``effects`` and ``hard`` what its command found.

    prefix : leads from the page to the folder of the study
    runs : and to the runs of its scene
    """

    anchor: str
    command: str
    title: str
    prefix: str
    runs: str
    lead: tuple[str, ...]
    outdated: bool
    has_page: bool
    chart: Chart | None = None
    levels: tuple[Level, ...] = ()
    effects: tuple[EffectRow, ...] = ()
    hard: tuple[HardRow, ...] = ()

    @property
    def bases(self) -> dict[str, str]:
        return {basis: METHOD_NAMES[basis] for basis in BASES}

    @property
    def columns(self) -> dict[str, tuple[str, str]]:
        """Of the table of effects."""
        return BARS


def section(study: Included, out: Path, anchor: str) -> IncludedSection:
    """Read one study."""
    about = study.about
    name = about.get("scene", {}).get("name", "")
    prefix = quote(Path(os.path.relpath(study.folder, out)).as_posix())
    head = {
        "anchor": anchor,
        "command": study.command,
        "title": f"{TITLES[study.command]}: {name}" if name else TITLES[study.command],
        "prefix": prefix,
        "runs": f"{prefix}/{quote(name)}",
        "outdated": study.outdated,
        "has_page": (study.folder / "report.html").exists(),
    }
    return {"cost": _cost, "effects": _effects, "hard": _hard}[study.command](study, about, head)


def _cost(study: Included, about: dict[str, Any], head: dict[str, Any]) -> IncludedSection:
    rows = tuple(read_csv(study.folder / "cost.csv"))
    equal = of_equal_steps(rows)
    levels = tuple(Level(name, cheapest(rows, name), cheapest(equal, name)) for name in LEVELS)
    lead = (*(level.sentence for level in levels), _reference(about["reference"]), *about["left_out"])
    return IncludedSection(**head, lead=lead, chart=chart(rows, head["anchor"]), levels=levels)


def _reference(known: dict[str, Any]) -> str:
    text = f"Reference: {known['label']}, {known['dofs']} unknowns, uncertainty {known['uncertainty']['curve']:.3%}"
    if known["other_code_apart"] is None:
        return f"{text}; no other code was at hand."
    return f"{text}; {known['other_code']} is {known['other_code_apart']:.3%} away."


def _effects(study: Included, about: dict[str, Any], head: dict[str, Any]) -> IncludedSection:
    rows = tuple(read_rows(study.folder / "effects.csv", EffectRow))
    return IncludedSection(**head, lead=tuple(about["left_out"]), effects=rows)


def _hard(study: Included, about: dict[str, Any], head: dict[str, Any]) -> IncludedSection:
    names = {path.parent.parent.name for path in study.folder.glob("*/*/verdict.json")}
    rows = tuple(_row(name, study.folder) for name in CASES if name in names)
    held = sum(row.passed for row in rows)
    return IncludedSection(**head, lead=(f"{held} of {len(rows)} hard cases hold.",), hard=rows)


def _row(name: str, folder: Path) -> HardRow:
    case = CASES[name]
    return HardRow(case, tuple((_cell(name, basis, folder), None) for basis in case.bases))


def _cell(name: str, basis: str, folder: Path) -> Cell:
    there = folder / name / basis
    if (there / "verdict.json").exists():
        return Cell(CASES[name], basis, read_verdict(there))
    return Cell(CASES[name], basis, None, "not run")


def sections(studies: Sequence[Included], out: Path) -> tuple[IncludedSection, ...]:
    """All of them, in the order in which they are given."""
    return tuple(section(study, out, f"study-{i + 1}") for i, study in enumerate(studies))
