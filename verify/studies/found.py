"""Studies that other commands have written, found in folders and read for the report of a verification."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

from verify.runs.fingerprint import source
from verify.support.checked_files import Damaged, Shape, read_json, read_table
from verify.support.refusal import Refusal
from verify.support.say import say

#: Files by which a study is recognised, by command; the hard cases have a verdict for each case and basis.
STUDY_FILES: Mapping[str, tuple[str, ...]] = {
    "cost": ("cost.json", "cost.csv"),
    "effects": ("effects.json", "effects.csv"),
    "vary": ("vary.json", "vary.csv"),
    "hard": ("*/*/verdict.json",),
}

#: Layout of the entries that are read of the JSON file of any study, and of those of a command alone.
_SUMMARY: Shape = {"scene": {"name": str}, "left_out": [str], "source?": str}
_OWN_SUMMARY: Mapping[str, Shape] = {
    "cost": {"reference": {"sentence": str}},
    "effects": {},
    "vary": {"sentences": [str]},
}


@dataclass(frozen=True)
class Included:
    """A study that was read from its folder.

    command : the command that wrote it, a key of `STUDY_FILES`
    about : content of its JSON file; empty for the hard cases
    rows : the ``Row`` objects of its table; for the hard cases their verdicts
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
    """The studies in folders directly under ``out``; a damaged one is left out with a message."""
    studies = []
    for folder in sorted(path for path in out.glob("*") if path.is_dir() and not path.is_symlink()):
        try:
            studies += [_study(command, folder) for command in _commands(folder)]
        except Damaged as error:
            say(f"{error}; the study is left out of the report")
    return studies


def named(folders: Iterable[Path]) -> list[Included]:
    """The studies in the given folders.

    Raises
    ------
    Refusal : a folder holds no study, or a damaged one.
    """
    found = []
    for folder in folders:
        if not (commands := _commands(folder)):
            *first, last = STUDY_FILES
            what = f"must be a folder that debond {', '.join(first)} or {last} has written, with all of its files"
            raise Refusal(f"--include: {what}, got {str(folder)!r}")
        try:
            found += [_study(command, folder) for command in commands]
        except Damaged as error:
            raise Refusal(f"--include: {error}") from None
    return found


def _commands(folder: Path) -> list[str]:
    return [name for name, marks in STUDY_FILES.items() if all(next(folder.glob(m), None) for m in marks)]


def _study(command: str, folder: Path) -> Included:
    if command == "hard":
        from verify.studies.hard.cases import CASES
        from verify.studies.hard.one import read_verdict

        places = (path.parent for path in sorted(folder.glob("*/*/verdict.json")))
        verdicts = {place: read_verdict(place) for place in places if place.parent.name in CASES}
        for place, one in verdicts.items():
            if folder / one.folder != place:
                raise Damaged(place / "verdict.json", f"the verdict of {one.case} on {one.basis}")
        return Included(command, folder, {}, tuple(verdicts.values()))
    module = import_module("verify.studies.cost.row" if command == "cost" else "verify.studies.pairs")
    about = read_json(folder / f"{command}.json", {**_SUMMARY, **_OWN_SUMMARY[command]})
    rows = read_table(folder / f"{command}.csv", module.Row)
    if command == "cost":
        module.refuse_unknown(rows, folder / "cost.csv")
    return Included(command, folder, about, tuple(rows))
