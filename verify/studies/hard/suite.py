"""All hard cases with all bases, each pair in its own process, and the matrix of the results."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from verify.checks.table import check_table
from verify.runs.estimate import seconds
from verify.runs.fingerprint import digest, fingerprint, source
from verify.runs.processes import pool
from verify.runs.sweep import OUTPUT_FOLDER, Done, Task, listed, sweep
from verify.studies.hard.case import Case
from verify.studies.hard.one import Verdict, read_cell, read_verdict
from verify.support.say import write_page

#: The verdicts of cases by case and basis.
Verdicts = Mapping[tuple[str, str], Verdict]


def hard(cases: Sequence[Case], out: Path, jobs: int, scheduler: str | None = None) -> bool:
    """Run the cases, write ``out``/report.html, print the matrix. Returns whether every case holds with every basis."""
    found = {(one.case, one.basis): one for one in run_all(cases, out, jobs, scheduler)}
    verdicts = {(case.name, basis): found[case.name, basis] for case in cases for basis in case.bases}
    write_page("verify.studies.hard.page", cases, verdicts, out)
    print("\n".join([*matrix(verdicts), "", *failures(verdicts)]))
    held = sum(all_hold(case, verdicts) for case in cases)
    print(f"{held} of {len(cases)} hard cases hold: {out / 'report.html'}")
    return held == len(cases)


def all_hold(case: Case, verdicts: Verdicts) -> bool:
    """Whether a case holds with all of its bases."""
    return all(verdicts[case.name, basis].passed for basis in case.bases)


def run_all(cases: Sequence[Case], out: Path, jobs: int, scheduler: str | None = None) -> Iterator[Verdict]:
    """Yield the verdicts of cases and bases as they end, ``jobs`` at a time or by the workers of a dask scheduler."""
    with pool(jobs, scheduler) as workers:
        for done in sweep(_tasks(cases), out, workers, "hard", lambda done: _in_short(verdict_of(done))):
            yield verdict_of(done)


def dry_run(cases: Sequence[Case], out: Path, jobs: int) -> list[str]:
    """One line per case and basis with its expected time; nothing is run."""
    return listed(_tasks(cases), out, jobs)


def _tasks(cases: Sequence[Case]) -> list[Task]:
    return [task(case, basis) for case in cases for basis in case.bases]


def task(case: Case, basis: str) -> Task:
    """One case with one basis as a task of a sweep: all variants in one process."""
    scenes, own = case.scenes(), source(("verify/studies/hard",))
    return Task(
        f"{case.name}/{basis}",
        digest(case.name, own, [(name, fingerprint(scene, basis)) for name, scene in scenes.items()]),
        ("verify.studies.hard.one", case.name, basis, OUTPUT_FOLDER),
        "verdict.json",
        seconds=sum(seconds(scene, basis) for scene in scenes.values()),
        read=read_cell,
    )


def verdict_of(done: Done) -> Verdict:
    """The verdict that a task has left, or why there is none."""
    if (done.folder / "verdict.json").exists():
        return read_verdict(done.folder)
    case, basis = done.task.place.split("/")
    return Verdict(case, basis, why=done.why)


def matrix(verdicts: Verdicts) -> list[str]:
    """A line each: verdict, completed runs, steps, rejected steps, ledger error, condition number, time."""
    names = f"{'complete':>9} {'steps':>6} {'back':>5} {'ledger':>8} {'condition':>9} {'time':>8}"
    return [f"{'case':20} {'basis':9} {'':5} {names}", *map(_row, verdicts.values())]


def _row(one: Verdict) -> str:
    total = one.total
    numbers = f"{total.name:>9} {total.steps:6d} {total.rejected:5d} {total.ledger:8.1e} {total.condition:9.1e} "
    said = one.fault or numbers + f"{total.seconds:6.1f} s"
    return f"{one.case:20} {one.basis:9} {'ok   ' if one.passed else 'FAIL '} {said}"


def failures(verdicts: Verdicts) -> list[str]:
    """A line for each failed check and each incomplete run."""
    return [
        f"{one.case} {one.basis}: {line}"
        for one in verdicts.values()
        for line in (
            *check_table(one.broken),
            *(f"{run.name}: {run.status}" for run in one.runs if not run.status.startswith("complete")),
        )
    ]


def _in_short(one: Verdict) -> str:
    if one.why:
        return f"no verdict, {one.why}"
    holds = "holds" if one.passed else f"{len(one.broken)} of {len(one.checks)} criteria fail"
    return f"{holds}, {len(one.runs)} runs, {one.total.seconds:.1f} s"
