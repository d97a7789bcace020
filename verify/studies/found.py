"""Studies that other commands have left in folders, for the report of a verification to show."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from verify.runs.fingerprint import source
from verify.support.checked_files import ANY, NUMBER, Damaged, Shape, read_json, read_table
from verify.support.refusal import Refusal
from verify.support.say import say

#: What a folder holds that a command has written; the hard cases leave a verdict a case and basis.
MARKS: Mapping[str, tuple[str, ...]] = {
    "cost": ("cost.json", "cost.csv"),
    "effects": ("effects.json", "effects.csv"),
    "scaling": ("scaling.json", "scaling.csv"),
    "hard": ("*/*/verdict.json",),
}


@dataclass(frozen=True)
class Included:
    """A folder with a study, as it was read.

    command : what made it, a key of `MARKS`
    about : what the study says of itself; nothing where it does not
    rows : its lines, of the ``Row`` of the command; of the hard cases their verdicts
    """

    command: str
    folder: Path
    about: Mapping[str, Any]
    rows: tuple[Any, ...]

    @property
    def outdated(self) -> bool:
        """Whether the solvers have changed since."""
        return self.about.get("source", "") not in ("", source(("iga", "fem_reference")))


def found_in(out: Path) -> list[Included]:
    """The studies in folders directly under ``out``; of one that is damaged there is a word and no more."""
    studies = []
    for folder in sorted(path for path in out.glob("*") if path.is_dir() and not path.is_symlink()):
        for command in _commands(folder):
            try:
                studies.append(_study(command, folder))
            except Damaged as error:
                say(f"{error}; the study is left out of the report")
    return studies


def named(folders: Iterable[Path]) -> list[Included]:
    """The studies in some folders.

    Raises
    ------
    Refusal : one of them holds none, or one that is damaged.
    """
    found = []
    for folder in folders:
        if not (commands := _commands(folder)):
            *first, last = MARKS
            what = f"must be a folder that debond {', '.join(first)} or {last} has written, with all of its files"
            raise Refusal(f"--include: {what}, got {str(folder)!r}")
        try:
            found += [_study(command, folder) for command in commands]
        except Damaged as error:
            raise Refusal(f"--include: {error}") from None
    return found


def _commands(folder: Path) -> list[str]:
    return [name for name, marks in MARKS.items() if all(next(folder.glob(m), None) for m in marks)]


def _study(command: str, folder: Path) -> Included:
    about, rows = _READ[command](folder)
    return Included(command, folder, about, tuple(rows))


Content = tuple[Mapping[str, Any], Iterable[Any]]

_HEAD: Shape = {"scene": {"name": str}, "left_out": [str], "source?": str}


def _cost(folder: Path) -> Content:
    from verify.studies.cost.ladder import BEAM, FAMILIES
    from verify.studies.cost.row import read_csv

    reference = {
        "label": str,
        "dofs": int,
        "uncertainty": {"curve": NUMBER},
        "other_code": str,
        "other_code_apart": NUMBER,
    }
    rows = read_csv(folder / "cost.csv")
    known = {(family.method, family.degree) for family in (*FAMILIES, BEAM)}
    if strange := [row for row in rows if (row.method, row.degree) not in known]:
        raise Damaged(folder / "cost.csv", f"the method {strange[0].method[:30]!r} of degree {strange[0].degree}")
    return read_json(folder / "cost.json", {**_HEAD, "reference": reference}), rows


def _effects(folder: Path) -> Content:
    from verify.studies.effects.row import Row

    return read_json(folder / "effects.json", _HEAD), read_table(folder / "effects.csv", Row)


def _scaling(folder: Path) -> Content:
    from verify.studies.scaling.row import Row

    growth = {ANY: {ANY: {"exponent": NUMBER, "standard_error": NUMBER, "factor": NUMBER}}}
    shared = {"dofs": int, "ranks": int, "speed_up": {ANY: NUMBER}, "serial": {ANY: NUMBER}, "efficiency": NUMBER}
    shape = {**_HEAD, "growth": growth, "strong_scaling": [shared], "sentences": [str]}
    return read_json(folder / "scaling.json", shape), read_table(folder / "scaling.csv", Row)


def _hard(folder: Path) -> Content:
    from verify.studies.hard.cases import CASES
    from verify.studies.hard.one import read_verdict

    paths = [path for path in sorted(folder.glob("*/*/verdict.json")) if path.parent.parent.name in CASES]
    verdicts = [read_verdict(path.parent) for path in paths]
    for path, found in zip(paths, verdicts, strict=True):
        if (found.case, found.basis) != path.parts[-3:-1]:
            raise Damaged(path, f"the verdict of {found.case} on {found.basis}")
    return {}, verdicts


_READ: Mapping[str, Callable[[Path], Content]] = {
    "cost": _cost,
    "effects": _effects,
    "scaling": _scaling,
    "hard": _hard,
}
