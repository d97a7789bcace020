"""One run with viscosity against that without."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite, nan
from typing import Any

import numpy as np

from verify.curves.of_run import peak_load, work
from verify.result import Result, run_seconds
from verify.runs.jobs import Job, Outcome
from verify.studies.effects.row import apart
from verify.studies.frame import BUSY, failure, unmeasured


@dataclass(frozen=True)
class Row:
    """A line of ``viscosity.csv``; the first has no viscosity, and unknown values are NaN.

    viscosity : as a part of the duration of the programme
    curve_error : relative L2 distance of the load from that without viscosity, along the programme
    peak_error, work_error : peak load and external work over those without viscosity, minus 1
    steps, newton_iterations, rejected_steps : of the run
    seconds : least wall time of ``times`` runs, without imports and compilation
    time_ratio, steps_ratio, iterations_ratio : seconds, steps and iterations over those without viscosity
    time_spread : largest over least time of equal runs; well above 1 the machine was busy and the ratio is inaccurate
    """

    viscosity: float
    curve_error: float
    peak_error: float
    work_error: float
    steps: int
    newton_iterations: int
    rejected_steps: int
    seconds: float
    time_ratio: float
    steps_ratio: float
    iterations_ratio: float
    time_spread: float
    times: int
    status: str

    @property
    def complete(self) -> bool:
        return self.status == "complete"

    @property
    def sentence(self) -> str:
        """A line: viscosity 0.001: curve 0.16, peak +0.031, work +0.031; 397 steps, 431 iterations, 3.3 x time"""
        if not self.complete:
            return f"viscosity {self.viscosity:g}: {self.status}"
        errors = f"curve {self.curve_error:.2g}, peak {self.peak_error:+.2g}, work {self.work_error:+.2g}"
        busy = f" (equal runs differ by up to {self.time_spread:.2g} x)" if self.time_spread > BUSY else ""
        cost = f"{self.steps} steps, {self.newton_iterations} iterations, {self.time_ratio:.2g} x time{busy}"
        return f"viscosity {self.viscosity:g}: {errors}; {cost}"


def rows(jobs: Sequence[Job], first: dict[Job, Outcome], again: dict[Job, list[Outcome]]) -> tuple[Row, ...]:
    """The rows of all runs, of which the first has no viscosity; the times are those of the repetitions ``again``."""
    exact = first[jobs[0]].result
    took = [[run_seconds(one.result) for one in again[job] if one.result and one.result.seconds] for job in jobs]
    least = min(took[0], default=nan)
    found = []
    for job, seconds in zip(jobs, took, strict=True):
        one = first[job].result
        known: dict[str, Any] = {"viscosity": job.solved.interface.viscosity, "times": len(seconds)}
        why = failure(first[job]) or _without(failure(first[jobs[0]]))
        if why or one is None or exact is None:
            found.append(unmeasured(Row, known | {"status": why or "no result"}))
            continue
        quickest = min(seconds, default=nan)
        times: dict[str, Any] = {
            "seconds": quickest,
            "time_ratio": quickest / least,
            "time_spread": max(seconds, default=nan) / quickest,
        }
        found.append(Row(**known, **times, **against(one, exact, job.solved.load.opening), status="complete"))
    return tuple(found)


def _without(why: str) -> str:
    """What is wrong with the run that all others are held against."""
    return f"without viscosity: {why}" if why else ""


def against(one: Result, exact: Result, programme: Sequence[float]) -> dict[str, Any]:
    """Errors, steps and iterations of a run against one without viscosity."""
    iterations, known = (int(np.sum(run.steps["newton_iterations"])) for run in (one, exact))
    steps = one.opening.size - 1
    return {
        "curve_error": apart(one, exact, programme),
        "peak_error": peak_load(one) / peak_load(exact) - 1.0,
        "work_error": work(one) / work(exact) - 1.0,
        "steps": steps,
        "newton_iterations": iterations,
        "rejected_steps": one.rejected_steps,
        "steps_ratio": steps / (exact.opening.size - 1),
        "iterations_ratio": iterations / known,
    }


def cheapest(found: Sequence[Row]) -> str:
    """What viscosity saves at most, in a sentence: the smallest error with which any run takes less time."""
    viscous = [one for one in found[1:] if one.complete and isfinite(one.time_ratio)]
    faster = [one for one in viscous if one.time_ratio < 1.0]
    if not viscous:
        return "no run with viscosity was completed"
    if not faster:
        least = min(viscous, key=lambda one: one.time_ratio)
        fastest = f"the fastest, {least.viscosity:g}, takes {least.time_ratio:.2g} x that without"
        return f"no viscosity saves time: {fastest}"
    best = min(faster, key=lambda one: one.curve_error)
    return (
        f"viscosity saves time from {best.viscosity:g} on: {best.time_ratio:.2g} x the time, with a curve that is "
        f"{100 * best.curve_error:.2g} % off and a peak {100 * best.peak_error:+.2g} %"
    )
