"""Runs of ``debond solve`` as tasks of a sweep, and their outcomes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import inf
from pathlib import Path

from verify.checks.identities import OF_THE_ZONE, run_checks
from verify.methods.given_meshes import OWN
from verify.methods.plugins import find
from verify.methods.solve import prepare, require
from verify.result import Result
from verify.runs.estimate import seconds
from verify.runs.fingerprint import fingerprint
from verify.runs.folder import read_result
from verify.runs.processes import pool
from verify.runs.sweep import OUTPUT_FOLDER, Done, Task, expected_seconds, listed, sweep
from verify.scene.parse import parse_scene
from verify.scene.schema import Scene
from verify.support.checked_files import Damaged
from verify.support.progress import duration
from verify.support.refusal import NotRun, Refusal
from verify.support.say import say
from verify.verdict import Check, Checks


@dataclass(frozen=True)
class Job:
    """One run to do. ``source`` is the scene as the user named it, ``variant`` the name of the run and its folder.

    ``fields``: store fields of a few steps for the figures. ``repeat`` distinguishes repetitions for timing.
    """

    source: str
    scene: Scene
    method: str
    variant: str
    overrides: tuple[str, ...] = ()
    fields: bool = True
    repeat: int = 0

    def command(self, out: Path) -> list[str]:
        """Arguments of ``debond`` that repeat the run."""
        return self._words(str(self.folder(out)))

    def _words(self, folder: str) -> list[str]:
        sets = [word for override in self.overrides for word in ("--set", override)]
        fields = ["--fields", "--frames", "0"] if self.fields else []
        return ["solve", self.source, "--method", self.method, *sets, *fields, "--out", folder]

    @property
    def place(self) -> str:
        """Name of the run, and its path in an output folder."""
        return f"{self.scene.name}/{self.variant}"

    @property
    def solved(self) -> Scene:
        """The scene with its overrides."""
        return parse_scene(self.scene.model_dump(), self.overrides) if self.overrides else self.scene

    def task(self) -> Task:
        """The run as a task of a sweep."""
        scene = self.solved
        return Task(
            self.place,
            fingerprint(scene, self.method, f"fields {self.fields}", f"repeat {self.repeat}"),
            ("verify", *self._words(OUTPUT_FOLDER)),
            "result.json",
            lane=find(self.method).lane,
            seconds=seconds(scene, self.method),
        )

    def meant_for(self, check: Check) -> bool:
        """Whether a check applies: on deliberately coarse meshes those of the J-integral measure the mesh alone."""
        keys = [override.partition("=")[0] for override in self.overrides if override != OWN]
        coarse = keys in (["discretization.dofs"], ["discretization.in_a_zone"]) or "dolfinx.layers" in keys
        return not (coarse and check.name in OF_THE_ZONE)

    def folder(self, out: Path) -> Path:
        return out / self.place


@dataclass(frozen=True)
class Outcome:
    """The outcome of a job: a result, or why it has none; ``failed`` if it should have one."""

    job: Job
    result: Result | None
    left_out: str = ""
    failed: bool = False

    @cached_property
    def checks(self) -> Checks:
        """The identities of the run that are meant for it, with the mesh that it was made on; none without a result."""
        if self.result is None:
            return Checks()
        found = run_checks(self.job.solved, self.result, self.job.variant)
        return Checks(check for check in found if self.job.meant_for(check))


def run_all(
    plan: Sequence[Job], out: Path, jobs: int, scheduler: str | None = None, budget: float = inf
) -> Iterator[Outcome]:
    """Yield the outcomes of all jobs as they end, ``jobs`` at a time or by the workers of a dask scheduler.

    Before the first one it is said where they are expected to take more than the ``budget`` (seconds).
    """
    of_task = {}
    for job in plan:
        if why := left_out(job):
            yield Outcome(job, None, why)
        else:
            of_task[job.task()] = job
    expected = expected_seconds(list(of_task), out, jobs)
    if expected > budget:
        more = f"about {duration(expected)}, more than the {duration(budget)} of --budget"
        say(f"the runs take {more}; --dry-run lists them, and a larger discretization.accuracy makes them shorter")
    with pool(jobs, scheduler) as workers:
        for done in sweep(
            list(of_task), out, workers, "runs", lambda done: _in_short(outcome(of_task[done.task], done))
        ):
            yield outcome(of_task[done.task], done)


def dry_run(plan: Sequence[Job], out: Path, jobs: int) -> list[str]:
    """One line per run with its expected time or the reason why it is left out; nothing is run."""
    able = [job for job in plan if not left_out(job)]
    return [
        *(f"{job.place:60} {left_out(job)}" for job in plan if job not in able),
        *listed([job.task() for job in able], out, jobs),
    ]


def left_out(job: Job) -> str:
    """Why a job cannot be done on this machine, or empty."""
    text = str(_obstacle(job) or "")
    return text if not text or text.startswith("not run") else f"not run: {text}"


def is_missing(job: Job) -> bool:
    """Whether a job is possible but this machine lacks its method."""
    return isinstance(_obstacle(job), NotRun)


def _obstacle(job: Job) -> NotRun | Refusal | None:
    try:
        require(prepare(job.solved, job.method))
    except (NotRun, Refusal) as error:
        return error
    return None


def outcome(job: Job, done: Done) -> Outcome:
    """The outcome of a job; a run that stopped has a result, whose status is the reason."""
    if not (done.folder / "result.json").exists():
        return Outcome(job, None, done.why, failed=True)
    try:
        return Outcome(job, read_result(done.folder))
    except Damaged as error:
        return Outcome(job, None, f"failed: {error}", failed=True)


def _in_short(outcome: Outcome) -> str:
    result = outcome.result
    if result is None:
        return outcome.left_out
    taken = (result.seconds or {}).get("total", 0.0)
    return f"{result.status}, peak load {result.load.max(initial=0.0):.5g}, {taken:.1f} s"
