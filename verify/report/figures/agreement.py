"""Distances of the curves of a scene to its reference curve."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from verify.curves.curve import PROPAGATION, SAMPLES, Curve, envelope, load_at, oscillation, peak
from verify.curves.leg_checks import worst_leg
from verify.curves.nearness import apart
from verify.curves.of_run import cubics
from verify.result import Result
from verify.verdict import Run, SceneReport


@dataclass(frozen=True)
class Agreement:
    """One run against the reference run of its scene."""

    error: float  # relative L2 of the load over the opening; where the programme turns, the largest one of its legs
    oscillation: float  # RMS of load / reference - 1 on the propagation branch, mean removed
    peak_load: float
    peak_opening: float
    end: float  # compared up to this opening


def usable(run: Run) -> bool:
    """Whether there is a curve to draw."""
    return run.result is not None and len(run.result.opening) > 1


def reference_run(report: SceneReport) -> Run | None:
    """The reference of the scene: DOLFINx, or else the cohesive beam; never LEFM, which is a limit."""
    for method in ("dolfinx", "beam"):
        runs = [run for run in report.runs if run.method == method and usable(run)]
        complete = [(run.result.dofs, run) for run in runs if run.result is not None and run.result.complete]
        if complete:
            return max(complete, key=lambda one: one[0])[1]
    return None


def path(result: Result) -> Curve:
    """Opening and load to draw: cubics between converged steps; LEFM is a polygon, as its path has a kink."""
    return (result.opening, result.load) if result.method == "lefm" else cubics(result, 6)


def branch(result: Result, reference: Result) -> tuple[np.ndarray, np.ndarray]:
    """Opening, and load / reference - 1, on the propagation branch of the reference; empty where there is none."""
    start = PROPAGATION * peak(envelope(*path(reference)))[0]
    end = min(float(reference.opening.max()), float(result.opening.max()))
    if not end > start:
        return np.zeros(0), np.zeros(0)
    openings = np.linspace(start, end, SAMPLES)
    return openings, load_at(path(result), openings) / load_at(path(reference), openings) - 1


def agreement(run: Run, reference: Run | None, programme: Sequence[float]) -> Agreement:
    """The measures of one run; distances are NaN without a reference, for the reference itself and for LEFM."""
    curve = _curve(run)
    (peak_opening, peak_load), end = peak(curve), float(np.max(curve[0]))
    if reference is None or run is reference or run.method == "lefm":
        return Agreement(math.nan, math.nan, peak_load, peak_opening, end)
    base = _curve(reference)
    end = min(end, float(np.max(base[0])))
    error = max(apart(curve, base, end), worst_leg(curve, base, programme))
    return Agreement(error, oscillation(curve, base, end)["rms"], peak_load, peak_opening, end)


def _curve(run: Run) -> Curve:
    assert run.result is not None, "usable runs alone have a curve"
    return run.result.opening, run.result.load
