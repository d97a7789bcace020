"""Studies that other commands have left in folders, for the report of a verification to show."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from verify.fingerprint import source
from verify.refusal import Refusal

#: What a folder holds that a command has written; the hard cases leave a verdict a case and basis.
MARKS: Mapping[str, tuple[str, ...]] = {
    "cost": ("cost.json", "cost.csv"),
    "effects": ("effects.json", "effects.csv"),
    "hard": ("*/*/verdict.json",),
}


@dataclass(frozen=True)
class Included:
    """A folder with a study; ``command`` is what made it: cost, effects or hard."""

    command: str
    folder: Path

    @property
    def about(self) -> Mapping[str, Any]:
        """What the study says of itself; nothing where it does not."""
        path = self.folder / f"{self.command}.json"
        try:
            return json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
        except ValueError as error:
            raise Refusal(f"{path}: must be as debond {self.command} has written it, got: {error}") from None

    @property
    def outdated(self) -> bool:
        """Whether the solvers have changed since."""
        return self.about.get("source", "") not in ("", source(("iga", "fem_reference")))


def found_in(out: Path) -> list[Included]:
    """The studies in folders directly under ``out``."""
    folders = sorted(path for path in out.glob("*") if path.is_dir() and not path.is_symlink())
    return [study for folder in folders for study in _studies(folder)]


def named(folders: Iterable[Path]) -> list[Included]:
    """The studies in some folders.

    Raises
    ------
    Refusal : one of them holds none.
    """
    found = []
    for folder in folders:
        if not (studies := _studies(folder)):
            what = "must be a folder that debond cost, effects or hard has written, with all of its files"
            raise Refusal(f"--include: {what}, got {str(folder)!r}")
        found += studies
    return found


def _studies(folder: Path) -> list[Included]:
    return [Included(name, folder) for name, marks in MARKS.items() if all(next(folder.glob(m), None) for m in marks)]
