"""All hard cases with all bases, each pair in its own process, and the matrix of the results."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from verify.checks.table import check_table
from verify.runs.estimate import seconds
from verify.runs.fingerprint import digest, fingerprint, source
from verify.runs.processes import pool
from verify.runs.sweep import OUTPUT_FOLDER, Done, Task, listed, sweep
from verify.studies.hard.case import Case
from verify.studies.hard.one import Verdict, read_cell, read_verdict
from verify.support.say import write_page


@dataclass(frozen=True)
class Cell:
    """One case with one basis: its verdict, or the reason why it has none."""

    case: Case
    basis: str
    verdict: Verdict | None
    why: str = ""

    @property
    def passed(self) -> bool:
        return self.verdict is not None and self.verdict.passed

    @property
    def folder(self) -> str:
        """Relative to the output folder."""
        return f"{self.case.name}/{self.basis}"


def hard(cases: Sequence[Case], out: Path, jobs: int, scheduler: str | None = None) -> bool:
    """Run the cases, write ``out``/report.html, print the matrix. Returns whether every case holds with every basis."""
    found = {(cell.case.name, cell.basis): cell for cell in run_all(cases, out, jobs, scheduler)}
    cells = [found[case.name, basis] for case in cases for basis in case.bases]
    write_page("verify.studies.hard.page", cells, out)
    print("\n".join([*matrix(cells), "", *failures(cells)]))
    rows = [case for case in cases if all(cell.passed for cell in cells if cell.case is case)]
    print(f"{len(rows)} of {len(cases)} hard cases hold: {out / 'report.html'}")
    return len(rows) == len(cases)


def run_all(cases: Sequence[Case], out: Path, jobs: int, scheduler: str | None = None) -> Iterator[Cell]:
    """Yield the cells of all cases and bases as they end, ``jobs`` at a time or by the workers of a dask scheduler."""
    pairs = {task(case, basis): (case, basis) for case in cases for basis in case.bases}
    with pool(jobs, scheduler) as workers:
        for done in sweep(list(pairs), out, workers, "hard", lambda done: _in_short(_cell(*pairs[done.task], done))):
            yield _cell(*pairs[done.task], done)


def dry_run(cases: Sequence[Case], out: Path, jobs: int) -> list[str]:
    """One line per cell with its expected time; nothing is run."""
    return listed([task(case, basis) for case in cases for basis in case.bases], out, jobs)


def task(case: Case, basis: str) -> Task:
    """One case with one basis as a task of a sweep: all variants in one process."""
    scenes = [(variant.name, variant.scene) for variant in case.variants()]
    own = source(("verify/studies/hard",))
    return Task(
        f"{case.name}/{basis}",
        digest(case.name, own, [(name, fingerprint(scene, basis)) for name, scene in scenes]),
        ("verify.studies.hard.one", case.name, basis, OUTPUT_FOLDER),
        "verdict.json",
        seconds=sum(seconds(scene, basis) for _, scene in scenes),
        read=read_cell,
    )


def _cell(case: Case, basis: str, done: Done) -> Cell:
    if (done.folder / "verdict.json").exists():
        return Cell(case, basis, read_verdict(done.folder))
    return Cell(case, basis, None, done.why)


def matrix(cells: Sequence[Cell]) -> list[str]:
    """One line per cell: verdict, completed runs, steps, rejected steps, ledger error, condition number, time."""
    names = f"{'complete':>9} {'steps':>6} {'back':>5} {'ledger':>8} {'condition':>9} {'time':>8}"
    head = f"{'case':20} {'basis':9} {'':5} {names}"
    return [head, *(_row(cell) for cell in cells)]


def _row(cell: Cell) -> str:
    start = f"{cell.case.name:20} {cell.basis:9} {'ok   ' if cell.passed else 'FAIL '}"
    if cell.verdict is None or cell.verdict.fault:
        return f"{start} {cell.verdict.fault if cell.verdict else cell.why}"
    total = totals(cell.verdict)
    return (
        f"{start} {total.completed:>9} {total.steps:6d} {total.rejected:5d} {total.ledger:8.1e} {total.condition:9.1e} "
        f"{total.seconds:6.1f} s"
    )


@dataclass(frozen=True)
class Totals:
    """The numbers of a cell: sums and maxima over the runs of a case."""

    completed: str
    steps: int
    rejected: int
    ledger: float
    condition: float
    seconds: float


def totals(verdict: Verdict) -> Totals:
    runs = verdict.runs
    return Totals(
        f"{verdict.completed} of {len(runs)}",
        sum(run.steps for run in runs),
        sum(run.rejected for run in runs),
        float(np.max([run.ledger for run in runs], initial=0.0)),  # NaN stays NaN
        max((run.condition for run in runs), default=0.0),
        sum(run.seconds for run in runs),
    )


def failures(cells: Sequence[Cell]) -> list[str]:
    """A line for each failed check and each incomplete run."""
    lines = []
    for cell in cells:
        if cell.verdict is not None:
            broken = [check for check in cell.verdict.checks if not check.passed]
            lines += [f"{cell.case.name} {cell.basis}: {line}" for line in check_table(broken)]
            lines += [
                f"{cell.case.name} {cell.basis}: {run.name}: {run.status}"
                for run in cell.verdict.runs
                if not run.status.startswith("complete")
            ]
    return lines


def _in_short(cell: Cell) -> str:
    if cell.verdict is None:
        return f"no verdict, {cell.why}"
    broken = sum(not check.passed for check in cell.verdict.checks)
    holds = "holds" if cell.passed else f"{broken} of {len(cell.verdict.checks)} criteria fail"
    return f"{holds}, {len(cell.verdict.runs)} runs, {totals(cell.verdict).seconds:.1f} s"
