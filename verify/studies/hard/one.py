"""One case with one basis: run all variants, apply the criteria, write a verdict."""

from __future__ import annotations

import sys
import traceback
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np

from verify.methods.names import Unsuitable
from verify.methods.solve import prepare, solve
from verify.result import Result, steps_from_rows
from verify.runs.folder import read_result, write_json
from verify.runs.run import Solver, run
from verify.scene.schema import Scene
from verify.studies.hard.case import Case, Finding, Number, Trial, Trials
from verify.studies.hard.cases import CASES
from verify.studies.hard.criteria import common, ledger
from verify.support.checked_files import read_json, shape_of
from verify.verdict import Check, Checks

#: Name of the check that stands for the criteria of a case where these cannot be applied.
NOT_JUDGED = "judged"


@dataclass(frozen=True)
class Line:
    """One run in a verdict, or sums and maxima over all of its runs."""

    name: str
    status: str
    steps: int
    rejected: int
    ledger: float
    condition: float
    seconds: float


@dataclass(frozen=True)
class Verdict:
    """The result of a case with one basis, or the reason ``why`` there is none."""

    case: str
    basis: str
    runs: tuple[Line, ...] = ()
    checks: tuple[Check, ...] = ()
    numbers: tuple[Number, ...] = ()
    why: str = ""

    @property
    def passed(self) -> bool:
        return bool(self.checks) and not self.broken

    @property
    def broken(self) -> list[Check]:
        """The criteria that are not met; one that cannot judge, as a mesh is too coarse for it, is none."""
        return [check for check in self.checks if check.state == "broken"]

    @property
    def fault(self) -> str:
        """Why the runs were not judged; empty where they were."""
        return self.why or next((check.meaning for check in self.checks if check.name == NOT_JUDGED), "")

    @property
    def folder(self) -> str:
        """Relative to the output folder."""
        return f"{self.case}/{self.basis}"

    @property
    def total(self) -> Line:
        """Sums and maxima over the runs; its name says how many are complete."""
        runs, complete = self.runs, sum(run.status.startswith("complete") for run in self.runs)
        return Line(
            f"{complete} of {len(runs)}",
            "",
            sum(run.steps for run in runs),
            sum(run.rejected for run in runs),
            float(np.max([run.ledger for run in runs], initial=0.0)),  # NaN stays NaN
            max((run.condition for run in runs), default=0.0),
            sum(run.seconds for run in runs),
        )


def run_case(case: Case, basis: str, folder: Path, solver: Solver = solve) -> Verdict:
    """Run every variant of a case into its own folder in ``folder``, and write ``verdict.json`` beside these."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "verdict.json").unlink(missing_ok=True)
    trials = {}
    for name, scene in case.scenes().items():
        trials[name] = Trial(name, scene, _run(scene, basis, folder / name, solver))
        print(f"{case.name} {basis} {name}: {_ending(trials[name].result)}", flush=True)
    found = list(judged(case, trials))
    checks = tuple(one for one in found if isinstance(one, Check))
    numbers = tuple(one for one in found if isinstance(one, Number))
    verdict = Verdict(case.name, basis, tuple(map(_line, trials.values())), checks, numbers)
    write_json(folder / "verdict.json", asdict(verdict))
    return verdict


def judged(case: Case, trials: Trials) -> Iterator[Finding]:
    """All findings; a criterion whose computation fails is a failed check.

    Where a criterion that every run has to meet is broken, the runs are not held against each other.
    """
    of_each = {name: list(common(trial, case.may_stop)) for name, trial in trials.items()}
    yield from (check for found in of_each.values() for check in found)
    if why := "; ".join(f"{name} {fault}" for name, found in of_each.items() if (fault := Checks(found).fault)):
        yield Check(NOT_JUDGED, "all", float("nan"), 0.0, "exact", f"Not judged: {why}")
        return
    try:
        yield from list(case.judge(trials))
    except Exception as error:
        traceback.print_exc()
        yield Check(NOT_JUDGED, "all", float("nan"), 0.0, "exact", f"Cannot be judged: {type(error).__name__}: {error}")


def read_verdict(folder: Path) -> Verdict:
    """The verdict in the folder of a case and a basis.

    Raises
    ------
    Damaged : the file is not as `run_case` wrote it.
    """
    kinds = {"runs": Line, "checks": Check, "numbers": Number}
    shape = {"case": str, "basis": str, **{key: [shape_of(kind)] for key, kind in kinds.items()}}
    known = read_json(folder / "verdict.json", shape)

    def read(key: str, kind: type) -> tuple[Any, ...]:
        missing = {field.name: np.nan if field.type == "float" else None for field in fields(kind)}
        return tuple(
            kind(**{n: none if record[n] is None else record[n] for n, none in missing.items()})
            for record in known[key]
        )

    runs, checks, numbers = (read(key, kind) for key, kind in kinds.items())
    return Verdict(known["case"], known["basis"], runs, checks, numbers)


def read_cell(folder: Path) -> Verdict:
    """The verdict, after the files of its runs have been read, too."""
    verdict = read_verdict(folder)
    for line in verdict.runs:
        if line.steps > 0:
            read_result(folder / line.name)
    return verdict


def _run(scene: Scene, basis: str, folder: Path, solver: Solver) -> Result:
    """Solve; a scene that the method refuses, such as a mesh that is too coarse, gives a result without steps."""
    try:
        return run(prepare(scene, basis), folder, solver=solver)[0]
    except Unsuitable as error:
        return Result(basis, steps_from_rows([]), f"stopped: {error}")


def _line(trial: Trial) -> Line:
    result = trial.result
    return Line(
        trial.name,
        _ending(result),
        max(result.load.size - 1, 0),
        result.rejected_steps,
        ledger(result) if result.load.size > 1 else float("nan"),
        result.condition,
        (result.seconds or {}).get("total", 0.0),
    )


def _ending(result: Result) -> str:
    return ", ".join(filter(None, (result.status, result.ending)))


def main(arguments: Sequence[str]) -> int:
    """``python -m verify.studies.hard.one CASE BASIS DIR``."""
    name, basis, folder = arguments
    return 0 if run_case(CASES[name], basis, Path(folder)).passed else 1


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
