"""The load curve of a run by cubics, and its distance from another one."""

from __future__ import annotations

import numpy as np

from verify.curves.curve import Curve, curve_error, dense, envelope, peak
from verify.result import Result

#: What the energy of a point is made of.
ENERGIES = frozenset({"stored_energy", "dissipated_energy"})

#: Points of a curve between two converged ones.
POINTS_PER_STEP = 20


def cubics(result: Result, per_step: int = POINTS_PER_STEP) -> Curve:
    """The path with points between the steps, on the cubics that their exact slopes give or straight (see `dense`)."""
    steps = result.steps
    if not {"load_slope", "heading"} <= set(steps) or result.opening.size < 2 or per_step == 1:
        return result.opening, result.load
    return dense(result.opening, result.load, steps["load_slope"], steps["heading"], per_step, energy=_energy(result))


def _energy(result: Result) -> np.ndarray | None:
    """Stored and dissipated (n,), where the run knows both."""
    steps = result.steps
    return steps["stored_energy"] + steps["dissipated_energy"] if ENERGIES <= set(steps) else None


def distance(curve: Curve, exact: Result) -> float:
    """Relative L2 distance of the load of a complete run to that of another; the load is zero after separation."""
    known = cubics(exact)
    end = max(float(envelope(*one)[0][-1]) for one in (curve, known))
    return curve_error(onward(curve, end), onward(known, end))


def onward(curve: Curve, end: float) -> Curve:
    """A curve that has ended before ``end`` goes on there without load; with its last one where rounding is between."""
    opening, load = (np.asarray(values, dtype=float) for values in curve)
    if float(np.max(opening)) >= end:
        return curve
    if float(np.max(opening)) >= end * (1.0 - 1e-9):
        return np.append(opening, end), np.append(load, load[-1])
    return np.append(opening, (opening[-1], end)), np.append(load, (0.0, 0.0))


def peak_load(result: Result) -> float:
    """Largest load of the path, between the steps too where their slopes are known."""
    return peak_point(result)[1]


def peak_point(result: Result) -> tuple[float, float]:
    """Opening and load at the peak load."""
    return peak((result.opening, result.load), result.steps.get("load_slope"), _energy(result))


def dissipated(result: Result) -> float:
    """At the end of the programme."""
    return float(result.steps["dissipated_energy"][-1])


def work(result: Result) -> float:
    """Of the load, at the end of the programme."""
    return float(result.steps["external_work"][-1])
