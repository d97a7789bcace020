"""Load curves of other codes in a verification: each is checked against the runs of the built-in methods."""

from __future__ import annotations

import re
import shlex
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from verify.checks import load_introduction
from verify.checks.foreign.given import given, remark
from verify.checks.foreign.judged import checks_of, in_whole
from verify.checks.odd_one_out import ODD, odd_one_out
from verify.checks.proof import SEARCHING
from verify.curves.read import Reading, read_curve
from verify.methods.names import METHODS
from verify.methods.plugins import known_methods
from verify.result import Result
from verify.scene.magnitudes import LARGEST_NUMBER, SMALLEST_NUMBER
from verify.support.refusal import Refusal
from verify.verdict import Check, Run, SceneReport

_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]*")

#: Numbers below this part of the largest of their column count as zero: quotients with them overflow.
NO_NUMBER = 1e-30


@dataclass(frozen=True)
class Curve:
    """Opening and load of another code, as read from a file."""

    name: str
    path: Path
    reading: Reading
    result: Result

    def command(self, run: Path) -> str:
        """The shell command that compares the file with the folder of a run."""
        given = {
            "--opening-a": self.reading.opening,
            "--load-a": self.reading.load,
            "--opening-scale-a": _unless_one(self.reading.opening_scale),
            "--load-scale-a": _unless_one(self.reading.load_scale),
        }
        words = [word for name, value in given.items() if value is not None for word in (name, str(value))]
        return shlex.join(["debond", "compare", str(self.path), str(run), *words])


def read_curves(words: Sequence[str], reading: Reading) -> tuple[Curve, ...]:
    """The curves of ``FILE`` and ``NAME=FILE``; the default name is the stem of the file or the name of its folder.

    Raises
    ------
    Refusal : a file without a curve, or with numbers outside all units; a name with other characters, of a method, or
        given twice.
    """
    curves: list[Curve] = []
    taken = known_methods() if words else {}
    for word in words:
        if not word.rpartition("=")[2].strip():
            raise Refusal(f"--with: must be FILE or NAME=FILE, got {word!r}")
        name, path = _named(word)
        if not _NAME.fullmatch(name):
            raise Refusal(f"--with: a name must be of letters, digits, dots, dashes and underscores, got {name!r}")
        if name in taken or name.partition("-")[0] in METHODS or name in [curve.name for curve in curves]:
            whose = "another curve's" if name in [curve.name for curve in curves] else "a method's"
            raise Refusal(f"--with: a name must not be {whose}, got {name!r}; NAME={path} gives another")
        opening, load = read_curve(path, reading)
        _refuse_size(path, opening, load)
        opening, load = (np.where(np.abs(v) < NO_NUMBER * np.abs(v).max(), 0.0, v) for v in (opening, load))
        curves.append(Curve(name, path, reading, Result(name, {"opening": opening, "load": load})))
    return tuple(curves)


def joined(report: SceneReport, curves: Sequence[Curve], out: Path) -> SceneReport:
    """The report with the curves as additional runs, and with checks of all runs of plug-in methods and foreign codes.

    Each curve is also written to ``out``/SCENE/NAME/curve.csv.
    """
    for curve in curves:
        _keep(curve, out / report.scene.name / curve.name)
    against = next((run for run in report.runs if run.method == SEARCHING and run.result is not None), None)
    runs = [
        Run(
            curve.name,
            curve.name,
            curve.result,
            folder=f"{report.scene.name}/{curve.name}",
            command=curve.command(out / against.folder) if against else "",
        )
        for curve in curves
    ]
    results = {run.name: run.result for run in report.runs if run.result is not None}
    others = {run.method: run.result for run in (*report.runs, *runs) if run.method not in METHODS and run.result}
    others = {name: other for name, other in others.items() if other.load.size > 1}
    checks: list[Check] = []
    remarks: list[str] = []
    for name, other in others.items():
        found, mine = checks_of(report.scene, name, other, results), given(report.scene, name, other, results)
        others[name] = in_whole(mine, results)
        checks += found
        remarks += remark(mine, found)
    load = load_introduction.sentence(report.scene) if curves else ""
    remarks += [load] if load and load not in report.remarks else []
    whole = (*report.checks, *checks)
    odd = odd_one_out(report.scene, whole, results | others)
    earlier = [remark for remark in report.remarks if not remark.startswith(ODD)]  # decided anew among more runs
    return replace(report, runs=(*report.runs, *runs), checks=whole, remarks=(*earlier, *remarks, *odd))


def _keep(curve: Curve, folder: Path) -> None:
    """Write opening and load into a new folder; a link to the folder of a run is replaced, not followed."""
    if folder.is_symlink():
        folder.unlink()
    folder.mkdir(parents=True, exist_ok=True)
    rows = np.stack([curve.result.opening, curve.result.load], axis=1)
    np.savetxt(folder / "curve.csv", rows, "%.17g", ",", header="opening,load", comments="")


def _refuse_size(path: Path, opening: np.ndarray, load: np.ndarray) -> None:
    """Refuse numbers outside the range of scenes: squares overflow, and charts cannot be scaled to them."""
    largest = max(float(np.abs(opening).max()), float(np.abs(load).max()))
    if not (largest <= LARGEST_NUMBER and opening.max() >= SMALLEST_NUMBER):
        got = f"{largest:g}" if largest > LARGEST_NUMBER else f"openings up to {opening.max():g}"
        limits = f"numbers of a size <= {LARGEST_NUMBER:g}, and openings up to {SMALLEST_NUMBER:g} or more"
        raise Refusal(f"{path}: must hold {limits}, got {got}")


def _named(word: str) -> tuple[str, Path]:
    name, equals, file = word.partition("=")
    if equals and not Path(word).exists():
        return name, Path(file)
    path = Path(word)
    stem = path.resolve().name if path.is_dir() else path.stem
    return re.sub(r"[^A-Za-z0-9._-]+", "-", stem).lstrip("._-") or "curve", path


def _unless_one(scale: float) -> float | None:
    return None if scale == 1.0 else scale
