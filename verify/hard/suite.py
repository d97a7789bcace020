"""All hard cases on all bases, each pair in a process of its own; the matrix."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path
from threading import Event

import numpy as np

from verify.hard.case import Case
from verify.hard.one import Verdict, read_verdict
from verify.progress import Progress
from verify.table import check_table

CELL_TIMEOUT_SECONDS = 1800
PROJECT = Path(__file__).resolve().parents[2]


@dataclass(frozen=True)
class Cell:
    """One case on one basis: a verdict, or why there is none."""

    case: Case
    basis: str
    verdict: Verdict | None
    why: str = ""

    @property
    def passed(self) -> bool:
        return self.verdict is not None and self.verdict.passed

    @property
    def folder(self) -> str:
        """Relative to the output of the suite."""
        return f"{self.case.name}/{self.basis}"


def hard(cases: Sequence[Case], out: Path, jobs: int) -> bool:
    """Run the cases, write ``out``/report.html, print the matrix; whether every row holds."""
    found = {(cell.case.name, cell.basis): cell for cell in run_all(cases, out, jobs)}
    cells = [found[case.name, basis] for case in cases for basis in case.bases]
    _write_page(cells, out)
    print("\n".join([*matrix(cells), "", *failures(cells)]))
    rows = [case for case in cases if all(cell.passed for cell in cells if cell.case is case)]
    print(f"{len(rows)} of {len(cases)} hard cases hold: {out / 'report.html'}")
    return len(rows) == len(cases)


def run_all(cases: Sequence[Case], out: Path, jobs: int) -> Iterator[Cell]:
    """Every case on every basis in a pool; the cells as they come."""
    running: set[subprocess.Popen] = set()
    stopped = Event()
    pool = ThreadPoolExecutor(jobs)
    try:
        pairs = [(case, basis) for case in cases for basis in case.bases]
        futures = [pool.submit(_cell, case, basis, out, running, stopped) for case, basis in pairs]
        with Progress("hard", len(futures)) as progress:
            for count, future in enumerate(as_completed(futures), 1):
                cell = future.result()
                progress.line(f"{cell.case.name} {cell.basis}: {_in_short(cell)}")
                progress.advance(count)
                yield cell
    finally:  # also on an interrupt
        stopped.set()
        pool.shutdown(wait=False, cancel_futures=True)
        for process in list(running):
            process.terminate()


def _cell(case: Case, basis: str, out: Path, running: set[subprocess.Popen], stopped: Event) -> Cell:
    """One process: a crash costs this cell and no other."""
    if stopped.is_set():
        return Cell(case, basis, None, "not run")
    folder = out / case.name / basis
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "verdict.json").unlink(missing_ok=True)
    paths = [str(PROJECT), *filter(None, [os.environ.get("PYTHONPATH")])]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(paths)}
    command = [sys.executable, "-P", "-m", "verify.hard.one", case.name, basis, str(out)]
    with (folder / "log.txt").open("w+") as log:
        with subprocess.Popen(command, stdout=log, stderr=subprocess.STDOUT, env=environment) as process:
            running.add(process)
            try:
                code = process.wait(CELL_TIMEOUT_SECONDS)
            except subprocess.TimeoutExpired:
                process.kill()
                code = process.wait()
            finally:
                running.discard(process)
        log.seek(0)
        said = log.read().strip().splitlines()
    if (folder / "verdict.json").exists():
        return Cell(case, basis, read_verdict(folder))
    why = f"signal {-code}" if code < 0 else f"exit {code}"
    return Cell(case, basis, None, f"{why}: {said[-1]}" if said else why)


def matrix(cells: Sequence[Cell]) -> list[str]:
    """One line a cell: verdict, runs completed, steps, steps taken back, worst ledger error, condition, time."""
    names = f"{'complete':>9} {'steps':>6} {'back':>5} {'ledger':>8} {'condition':>9} {'time':>8}"
    head = f"{'case':20} {'basis':9} {'':5} {names}"
    return [head, *(_row(cell) for cell in cells)]


def _row(cell: Cell) -> str:
    start = f"{cell.case.name:20} {cell.basis:9} {'ok   ' if cell.passed else 'FAIL '}"
    if cell.verdict is None:
        return f"{start} {cell.why}"
    total = totals(cell.verdict)
    return (
        f"{start} {total.completed:>9} {total.steps:6d} {total.rejected:5d} {total.ledger:8.1e} {total.condition:9.1e} "
        f"{total.seconds:6.1f} s"
    )


@dataclass(frozen=True)
class Totals:
    """A cell of the matrix in numbers: sums over the runs of a case, and the worst of them."""

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
    """What fails, in full."""
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


def _write_page(cells: Sequence[Cell], out: Path) -> None:
    """The page; without the packages that it needs the matrix is still worth printing."""
    try:
        from verify.hard.page import write
    except ImportError as error:
        print(f"debond: no report: {error.name} is missing; pip install 'debond[report]'", file=sys.stderr)
        return
    write(cells, out)
