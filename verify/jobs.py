"""Runs of a verification: each in a process of its own, some at a time, its result in a folder."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from queue import Queue
from threading import Event
from typing import TextIO

from verify.checks import OF_THE_ZONE
from verify.folder import read_result
from verify.methods import NotRun, require
from verify.progress import Progress
from verify.refusal import Refusal
from verify.result import Result
from verify.schema import Scene
from verify.verdict import Check

RUN_TIMEOUT_SECONDS = 3600
PROJECT = Path(__file__).resolve().parent.parent


@dataclass(frozen=True)
class Job:
    """One run to do. ``source`` is the scene as the user named it, ``variant`` the name of the run and its folder.

    ``fields`` are kept of a few steps for the figures.
    """

    source: str
    scene: Scene
    method: str
    variant: str
    overrides: tuple[str, ...] = ()
    fields: bool = True

    def command(self, out: Path) -> list[str]:
        """Arguments of ``debond`` that repeat the run."""
        sets = [word for override in self.overrides for word in ("--set", override)]
        fields = ["--fields"] if self.fields else []
        return ["solve", self.source, "--method", self.method, *sets, *fields, "--out", str(self.folder(out))]

    def meant_for(self, check: Check) -> bool:
        """On the coarse meshes of a sequence what rests on the J-integral measures the mesh and not the solver."""
        coarse = [override.partition("=")[0] for override in self.overrides] == ["discretization.dofs"]
        return not (coarse and check.name in OF_THE_ZONE)

    def folder(self, out: Path) -> Path:
        return out / self.scene.name / self.variant


@dataclass(frozen=True)
class Outcome:
    """What became of a job: a result, or why there is none; ``failed`` where that is nobody's choice."""

    job: Job
    result: Result | None
    left_out: str = ""
    failed: bool = False


def run_all(plan: Sequence[Job], out: Path, jobs: int) -> Iterator[Outcome]:
    """Do the jobs in a pool; every outcome as it comes.

    All DOLFINx runs are one lane, one after the other: they share a cache of compiled forms, and the second to compile
    the same form would wait for the first, and give up after ten seconds.
    """
    lanes = [[job for job in plan if job.method == "dolfinx"], *([job] for job in plan if job.method != "dolfinx")]
    done: Queue[Outcome] = Queue()
    running: set[subprocess.Popen] = set()
    stopped = Event()

    def travel(lane: list[Job]) -> None:
        for job in lane:
            if not stopped.is_set():
                done.put(run_job(job, out, running))

    pool = ThreadPoolExecutor(jobs)
    try:
        futures = [pool.submit(travel, lane) for lane in lanes]
        with Progress("verify", len(plan)) as progress:
            for count in range(1, len(plan) + 1):
                outcome = done.get()
                progress.line(f"{outcome.job.scene.name} {outcome.job.variant}: {_in_short(outcome)}")
                progress.advance(count)
                yield outcome
        for future in futures:
            future.result()
    finally:  # also on an interrupt
        stopped.set()
        pool.shutdown(wait=False, cancel_futures=True)
        for process in list(running):
            process.terminate()


def run_job(job: Job, out: Path, running: set[subprocess.Popen]) -> Outcome:
    """One run in a process of its own: a crash costs this run and no other."""
    try:
        require(job.scene, job.method)
    except (NotRun, Refusal) as error:
        text = str(error)
        return Outcome(job, None, text if text.startswith("not run") else f"not run: {text}")
    folder = job.folder(out)
    folder.mkdir(parents=True, exist_ok=True)
    for stale in ("result.json", "evidence.csv"):
        (folder / stale).unlink(missing_ok=True)
    with (folder / "log.txt").open("w+") as log:
        code = _call([sys.executable, "-P", "-m", "verify.cli", *job.command(out)], log, running)
        log.seek(0)
        said = log.read().strip().splitlines()
    if (folder / "result.json").exists():
        return Outcome(job, read_result(folder))
    why = f"signal {-code}" if code < 0 else f"exit {code}"
    return Outcome(job, None, f"failed: {said[-1] if said else why}", failed=True)


def _call(command: list[str], log: TextIO, running: set[subprocess.Popen]) -> int:
    paths = [str(PROJECT), *filter(None, [os.environ.get("PYTHONPATH")])]
    with subprocess.Popen(
        command, stdout=log, stderr=subprocess.STDOUT, env=os.environ | {"PYTHONPATH": os.pathsep.join(paths)}
    ) as process:
        running.add(process)
        try:
            return process.wait(RUN_TIMEOUT_SECONDS)
        except subprocess.TimeoutExpired:
            process.kill()
            return process.wait()
        finally:
            running.discard(process)


def _in_short(outcome: Outcome) -> str:
    result = outcome.result
    if result is None:
        return outcome.left_out
    seconds = (result.seconds or {}).get("total", 0.0)
    return f"{result.status}, peak load {result.load.max(initial=0.0):.5g}, {seconds:.1f} s"
