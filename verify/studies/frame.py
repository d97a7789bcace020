"""Common parts of the studies of one scene: runs, rows and files.

A study plans its jobs, runs them (`run`), makes a row of each run and its repetitions, and writes its `Study`. Runs of
an earlier call are read from its folder (`verify.runs.sweep`); `would_run` lists the missing ones.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, fields
from math import nan
from pathlib import Path
from typing import Any, ClassVar, TypeVar, cast

import numpy as np

from verify.runs.environment import ALL_PACKAGES, THREADS, machine, versions
from verify.runs.fingerprint import source
from verify.runs.folder import write_csv, write_json
from verify.runs.jobs import Job, Outcome, dry_run, run_all
from verify.scene.schema import Scene
from verify.support.say import write_page
from verify.verdict import Check

J = TypeVar("J", bound=Job)

#: Ratio of the times of equal runs above which the machine counts as busy.
BUSY = 1.2


@dataclass(frozen=True)
class Study:
    """Results for a scene: ``rows``, a sentence for everything that is ``left_out``, and those of `doubts`.

    A run that `failure` names gives no number, no finding and no statement: its row has the reason, and the command
    exits with 1.
    """

    #: Name of the command and its files, its page, type of the rows, and packages whose source the rows depend on.
    NAME: ClassVar[str]
    PAGE: ClassVar[str] = ""
    ROW: ClassVar[type]
    PACKAGES: ClassVar[tuple[str, ...]] = ALL_PACKAGES

    scene: Scene
    rows: tuple[Any, ...]
    left_out: tuple[str, ...]
    unresolved: tuple[str, ...] = field(default=(), kw_only=True)

    def about(self) -> dict[str, object]:
        """Entries of ``NAME.json`` that only this study has."""
        raise NotImplementedError

    def lines(self) -> list[str]:
        """The printed lines."""
        raise NotImplementedError

    def summary(self) -> dict[str, object]:
        """The content of ``NAME.json``."""
        return {
            "scene": self.scene.model_dump(),
            **self.about(),
            "left_out": list(self.left_out),
            "unresolved": list(self.unresolved),
            "source": source(self.PACKAGES),
            "versions": versions(),
            "machine": machine(),
            "threads": 1,
        }

    def write(self, out: Path) -> None:
        """Write ``NAME.csv``, ``NAME.json`` and report.html, and print `lines`."""
        table = out / f"{self.NAME}.csv"
        write_csv(table, self.ROW, self.rows)
        write_json(out / f"{self.NAME}.json", self.summary())
        write_page(self.PAGE or f"verify.studies.{self.NAME}.page", self, out / "report.html")
        print("\n".join([*self.lines(), *self.unresolved, f"written: {table}"]))


def one_thread() -> None:
    """Restrict BLAS and OpenMP to one thread, for comparable times."""
    os.environ.update(dict.fromkeys(THREADS, "1"))


def run(plan: Sequence[J], out: Path, jobs: int = 1, scheduler: str | None = None) -> dict[J, Outcome]:
    """Run all jobs, ``jobs`` at a time or by the workers of a dask ``scheduler``."""
    return {cast(J, outcome.job): outcome for outcome in run_all(plan, out, jobs, scheduler)}


def would_run(plan: Sequence[Job], left_out: Iterable[str], out: Path, jobs: int = 1) -> list[str]:
    """One line per run with its expected time, and the sentences ``left_out``; nothing is run."""
    return [*dry_run(plan, out, jobs), *left_out]


def failure(outcome: Outcome) -> str:
    """Why a run gives no number: it is missing, it stopped, or checks of its own are broken; empty where it gives one.

    Checks that cannot judge the run do not count: see `doubts`.
    """
    if outcome.result is None:
        return outcome.left_out
    return outcome.checks.fault if outcome.result.complete else outcome.result.status


def failures(outcomes: Iterable[Outcome]) -> tuple[str, ...]:
    """A sentence for every run that gives no number."""
    return tuple(f"{outcome.job.variant}: {why}" for outcome in outcomes if (why := failure(outcome)))


def doubts(outcomes: Iterable[Outcome]) -> tuple[str, ...]:
    """A sentence for each check that cannot judge runs, with the run on which it is furthest beyond its tolerance."""
    found: dict[str, list[Check]] = {}
    for check in (check for outcome in outcomes for check in outcome.checks if check.unresolved):
        found.setdefault(check.name, []).append(check)
    return tuple(_doubt(name, checks) for name, checks in found.items())


def _doubt(name: str, checks: Sequence[Check]) -> str:
    worst = max(checks, key=lambda check: abs(check.value) / check.tolerance)
    more = f" and {len(checks) - 1} more runs" if len(checks) > 1 else ""
    amount = f"{abs(worst.value):.2g} of {worst.tolerance:.2g}"
    return f"{worst.subject}{more}: {name} unresolved, {amount}: {worst.unresolved}"


def unmeasured(kind: type, known: dict[str, Any]) -> Any:
    """A row with the ``known`` fields; the other numbers are NaN, the other counts 0."""
    return kind(**{one.name: nan if one.type == "float" else 0 for one in fields(kind)} | known)


def power(n: Sequence[float], value: Sequence[float]) -> tuple[float, float]:
    """Exponent of ``value = c n^exponent`` by least squares on logarithms, and its standard error; NaN for less than
    three different positive points."""
    x, y = np.asarray(n, float), np.asarray(value, float)
    there = (x > 0.0) & (y > 0.0) & np.isfinite(y)
    if np.unique(x[there]).size < 3:
        return nan, nan
    (exponent, _), covariance = np.polyfit(np.log(x[there]), np.log(y[there]), 1, cov=True)
    return float(exponent), float(covariance[0, 0] ** 0.5)


def corners(opening: np.ndarray, programme: Sequence[float]) -> list[int]:
    """The steps at which a run reaches the openings of its programme one after the other, as far as it came."""
    found, at = list[int](), 0
    for goal, before in zip(programme, (0.0, *programme), strict=False):
        there = np.flatnonzero(np.abs(opening[at + 1 :] - goal) <= 1e-9 * abs(goal - before))
        if not there.size:
            break
        at += 1 + int(there[0])
        found.append(at)
    return found
