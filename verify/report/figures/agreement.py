"""Distances of the curves of a scene to its reference curve."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from verify.curves.curve import PROPAGATION, SAMPLES, envelope, load_at, oscillation, peak
from verify.curves.leg_checks import worst_leg
from verify.curves.nearness import apart
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
        complete = [run for run in runs if run.result is not None and run.result.complete]
        if complete:
            return max(complete, key=lambda run: run.result.dofs if run.result is not None else 0)
    return None


def path(result: Result, refine: int = 6) -> tuple[np.ndarray, np.ndarray]:
    """Opening and load to draw: cubic Hermite arcs between converged steps where the slopes are known.

    Straight lines where an arc would be more than 1 % of the peak load away from its chord: there the path turns within
    the step, and the arc would overshoot. LEFM is a polygon, as its path has a kink.
    """
    x, y = np.asarray(result.opening, float), np.asarray(result.load, float)
    if "load_slope" not in result.steps or result.method == "lefm" or len(x) < 2:
        return x, y
    slope = np.asarray(result.steps["load_slope"], float)
    h, chord = np.diff(x), np.diff(y)
    m0, m1 = slope[:-1] * h, slope[1:] * h
    bulge = 4 / 27 * (np.abs(m0 - chord) + np.abs(m1 - chord))  # the cubic stays within this of its chord
    smooth = np.isfinite(bulge) & (bulge <= 0.01 * np.max(np.abs(y)))
    m0, m1 = np.where(smooth, m0, chord), np.where(smooth, m1, chord)
    t = np.linspace(0, 1, refine, endpoint=False)[None, :]
    load = (
        (1 + 2 * t) * (1 - t) ** 2 * y[:-1, None]
        + t * (1 - t) ** 2 * m0[:, None]
        + t**2 * (3 - 2 * t) * y[1:, None]
        + t**2 * (t - 1) * m1[:, None]
    )
    return np.append((x[:-1, None] + t * h[:, None]).ravel(), x[-1]), np.append(load.ravel(), y[-1])


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
    top, end = peak(curve), float(np.max(curve[0]))
    if reference is None or run is reference or run.method == "lefm":
        return Agreement(math.nan, math.nan, peak_load=top[1], peak_opening=top[0], end=end)
    base = _curve(reference)
    end = min(end, float(np.max(base[0])))
    return Agreement(
        error=max(apart(curve, base, end), worst_leg(curve, base, programme)),
        oscillation=oscillation(curve, base, end)["rms"],
        peak_load=top[1],
        peak_opening=top[0],
        end=end,
    )


def _curve(run: Run) -> tuple[np.ndarray, np.ndarray]:
    assert run.result is not None, "usable runs alone have a curve"
    return run.result.opening, run.result.load
