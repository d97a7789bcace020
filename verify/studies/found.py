"""Studies that other commands have left in folders, for the report of a verification to show."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

from verify.runs.fingerprint import source
from verify.support.checked_files import Damaged, Shape, read_json
from verify.support.refusal import Refusal
from verify.support.say import say

#: What a folder holds that a command has written; the hard cases leave a verdict a case and basis.
MARKS: Mapping[str, tuple[str, ...]] = {
    "cost": ("cost.json", "cost.csv"),
    "effects": ("effects.json", "effects.csv"),
    "scaling": ("scaling.json", "scaling.csv"),
    "hard": ("*/*/verdict.json",),
}

#: What is read of the JSON file of every study, beside ``ABOUT`` of its rows.
_HEAD: Shape = {"scene": {"name": str}, "left_out": [str], "source?": str}


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
    if command == "hard":
        return Included(command, folder, {}, tuple(_verdicts(folder)))
    of_rows = import_module(f"verify.studies.{command}.row")
    about = read_json(folder / f"{command}.json", {**_HEAD, **of_rows.ABOUT})
    return Included(command, folder, about, tuple(of_rows.read_csv(folder / f"{command}.csv")))


def _verdicts(folder: Path) -> Iterator[Any]:
    from verify.studies.hard.cases import CASES
    from verify.studies.hard.one import read_verdict

    for path in sorted(folder.glob("*/*/verdict.json")):
        if path.parent.parent.name in CASES:
            found = read_verdict(path.parent)
            if (found.case, found.basis) != path.parts[-3:-1]:
                raise Damaged(path, f"the verdict of {found.case} on {found.basis}")
            yield found
