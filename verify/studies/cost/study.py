"""The study: reference, sequences of meshes of every family, other steps on the best meshes, repetitions."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from math import inf
from pathlib import Path
from time import monotonic
from typing import ClassVar

from verify.runs.jobs import Outcome, run_all
from verify.scene.schema import Scene
from verify.studies import frame
from verify.studies.cost.contenders import best, between, few_steps, other_models, other_steps
from verify.studies.cost.findings import LEVELS, growth, levels, orders, pareto, table
from verify.studies.cost.ladder import BASIS_METHODS, Family, Try, ladders
from verify.studies.cost.reference import Meshes, Reference, reference, reference_jobs
from verify.studies.cost.row import Row, row
from verify.studies.frame import one_thread
from verify.support.say import say


@dataclass(frozen=True)
class Limits:
    """When the study stops refining and repeating; larger values cost time and find cheaper runs more reliably.

    enough, patience, beaten, longest : a sequence of meshes ends at an error below ``enough`` times the finest level,
        at ``patience`` times the time of the cheapest run with the finest level, where another degree of the
        method is as accurate in 1 / ``beaten`` of the time, or at a time of ``longest`` seconds
    climb, vary, repeat : seconds after which no run of the sequences, with other steps, or for repetition is begun; a
        second call continues from the stored runs
    close, once, late, times : a run is timed ``times`` times if its time is at most ``close`` (``once`` if it was timed
        once) times that of the method's cheapest run for a level, plus ``late`` seconds. On a busy machine single times
        are off by half: 0.36 to 0.63 s were measured for equal runs
    """

    enough: float = 0.7
    patience: float = 6.0
    beaten: float = 1.5
    longest: float = 30.0
    climb: float = 1200.0
    vary: float = 1700.0
    repeat: float = 2000.0
    close: float = 1.25
    once: float = 1.5
    late: float = 0.03
    times: int = 3


LIMITS = Limits()


@dataclass(frozen=True)
class Study(frame.Study):
    """Results; ``against``: the reference; ``how``: overrides of the runs by name."""

    NAME: ClassVar[str] = "cost"
    ROW: ClassVar[type] = Row

    against: Reference
    how: Mapping[str, tuple[str, ...]] = field(default_factory=dict)

    @property
    def complete(self) -> bool:
        """Whether every run that was made gives a number, those of the other code for the reference included."""
        return not self.against.faults and not without_number(self.rows)

    def lines(self) -> list[str]:
        return [self.against.sentence, *self.left_out, *table(self.rows)]

    def about(self) -> dict[str, object]:
        found = levels(self.rows)
        return {
            "reference": self.against.summary(),
            "cheapest": {level.name: level.best.summary() for level in found},
            "cheapest_at_equal_steps": {level.name: level.equal.summary() for level in found},
            "pareto": [self._front(one) for one in pareto(self.rows)],
            "orders": orders(self.rows, 2.0 * self.against.uncertainty["curve"]),
            "growth": growth(self.rows),
        }

    def _front(self, one: Row) -> dict[str, object]:
        """A run of the Pareto front, with the overrides that repeat it."""
        keys = ("method", "degree", "dofs", "steps", "curve_error", "seconds", "run")
        how = {"solver": BASIS_METHODS.get(one.method, one.method), "overrides": list(self.how.get(one.run, ()))}
        return {key: getattr(one, key) for key in keys} | how


@dataclass(frozen=True)
class Runner:
    """Does the runs of a study, one at a time, and stores their outcomes."""

    source: str
    scene: Scene
    given: tuple[str, ...]
    out: Path
    against: Reference
    reference: tuple[Outcome, ...]
    start: float
    found: dict[Try, Outcome] = field(default_factory=dict)
    known: dict[tuple[Try, int], Row] = field(default_factory=dict)  # by run and times; its errors take a while

    def __call__(self, tries: Iterable[Try], seconds: float = inf) -> bool:
        """Do the runs that are missing. Returns whether all were begun within ``seconds`` after the start."""
        jobs = {one.job(self.source, self.scene, self.given): one for one in tries if one not in self.found}
        done: dict[Try, Outcome] = {}
        for outcome in run_all(list(jobs), self.out, 1):
            done[jobs[outcome.job]] = outcome
            if monotonic() - self.start > seconds:
                break
        self.found.update((one, done[one]) for one in jobs.values() if one in done)  # in the order of the plan
        return all(one in self.found for one in jobs.values())

    @property
    def rows(self) -> dict[Try, Row]:
        """The row of every first run, with the times of its repetitions."""
        return {one: self._row(one) for one in self.found if one.repeat == 0}

    def _row(self, one: Try) -> Row:
        runs = [outcome for same, outcome in self.found.items() if replace(same, repeat=0) == one]
        if (one, len(runs)) not in self.known:
            self.known[one, len(runs)] = row(one, runs, self.against)
        return self.known[one, len(runs)]

    @property
    def doubts(self) -> tuple[str, ...]:
        """What no check could judge, of the reference and of every first run."""
        first = (outcome for one, outcome in self.found.items() if one.repeat == 0)
        return frame.doubts((*self.reference, *first))

    @property
    def how(self) -> dict[str, tuple[str, ...]]:
        """Overrides of the runs by their names, without those of the whole study."""
        return {one.variant: one.job(self.source, self.scene).overrides for one in self.found}


def begun(
    source: str,
    scene: Scene,
    given: Sequence[str],
    out: Path,
    jobs: int,
    meshes: Meshes | None = None,
    other: Sequence[Outcome] = (),
) -> Runner | None:
    """What runs a study, after the reference has been run; None, with a message, without a converged one.

    Parameters
    ----------
    jobs : runs of the reference at a time
    meshes : of the reference; default: `MESHES`
    other : runs of the other code on two meshes, coarse to fine, besides those of ``meshes``
    """
    one_thread()
    own, others = reference_jobs(source, scene, given, meshes)
    outcomes = frame.run([*own, *others], out, jobs)
    against = reference([outcomes[job] for job in own], [*(outcomes[job] for job in others), *other])
    if against is None:
        why = frame.failures(outcomes[job] for job in own)
        say(f"no converged reference of {scene.name}, so that nothing can be measured: {why[0]}")
        return None
    return Runner(source, scene, tuple(given), out, against, tuple(outcomes.values()), monotonic())


def cost(source: str, scene: Scene, given: Sequence[str], out: Path, jobs: int) -> Study | None:
    """Run the study into ``out``: cost.csv, cost.json, report.html; None without a converged reference.

    Parameters
    ----------
    given : overrides that ``scene`` contains and every run repeats
    jobs : runs of the reference at a time; timed runs are done one at a time
    """
    rungs, reasons = ladders(source, scene, given)
    if (runner := begun(source, scene, given, out, jobs)) is None:
        return None
    print(runner.against.sentence, file=sys.stderr, flush=True)
    whole = [climb(rungs, partial(runner, seconds=LIMITS.climb), lambda: runner.rows)]
    for more in (between, few_steps, other_steps, other_models):
        whole.append(runner(more(runner.rows), LIMITS.vary))
    for repeat in range(1, LIMITS.times):
        again = best(runner.rows, LIMITS.close, LIMITS.once, LIMITS.late)
        whole.append(runner([replace(one, repeat=repeat) for one in again], LIMITS.repeat))
    if not all(whole):
        reasons.append("The time allowed for a study is over; the same command goes on from here.")
    rows = tuple(runner.rows.values())
    left_out = (*reasons, *without_number(rows))
    study = Study(scene, rows, left_out, runner.against, runner.how, unresolved=runner.doubts)
    study.write(out)
    return study


def without_number(rows: Iterable[Row]) -> tuple[str, ...]:
    """A sentence for every run that was made and gives no number."""
    return tuple(f"{one.run}: {one.status}" for one in rows if not (one.measured or one.status.startswith("not run")))


def climb(
    ladders: Mapping[Family, Sequence[Try]],
    run: Callable[[list[Try]], bool],
    rows: Callable[[], Mapping[Try, Row]],
    finest: float = min(LEVELS.values()),
) -> bool:
    """Run ever finer meshes of all families, until each is accurate enough, too slow, or at its end.

    Parameters
    ----------
    run : does runs; returns whether there was time for all
    rows : returns all rows so far
    finest : the smallest error that is asked for
    """
    left = {family: list(rungs) for family, rungs in ladders.items() if rungs}
    while left:
        if not run([rungs[0] for rungs in left.values()]):
            return False
        found = rows()
        for family, (done, *rest) in list(left.items()):
            left[family] = rest
            if not rest or _finished(found[done], list(found.values()), finest):
                del left[family]
    return True


def _finished(last: Row, rows: Sequence[Row], finest: float = min(LEVELS.values())) -> bool:
    others = [one for one in rows if one.measured and one.dofs]
    accurate = min((one.seconds for one in others if one.curve_error <= finest), default=LIMITS.longest)
    too_slow = last.measured and last.seconds > min(LIMITS.longest, LIMITS.patience * accurate)
    beaten = any(
        one.method == last.method
        and one.curve_error <= last.curve_error
        and LIMITS.beaten * one.seconds <= last.seconds
        for one in others
    )
    return too_slow or beaten or last.curve_error <= LIMITS.enough * finest


def would_run(source: str, scene: Scene, given: Sequence[str], out: Path, jobs: int) -> list[str]:
    """One line per run that may be made, with its expected time; nothing is run."""
    rungs, reasons = ladders(source, scene, given)
    own, others = reference_jobs(source, scene, given)
    plan = [*own, *others, *(one.job(source, scene, given) for ones in rungs.values() for one in ones)]
    note = (
        "ladders end where they are accurate enough; the best meshes run again with other steps, and what may win again"
    )
    return frame.would_run(plan, [note, *reasons], out, jobs)
