"""The load curve of a run by cubics, and its distance from another one."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from verify.curves.curve import Curve, curve_error, dense, envelope, peak
from verify.result import CURVE_COLUMNS, SLIDING_COLUMNS, Result

#: What the energy of a point is made of; what the cubic of a step is drawn by; the work of a ledger.
ENERGIES = "stored_energy", "dissipated_energy"
OF_CUBICS, WORK_COLUMN = ("opening", "load", "load_slope", "heading"), "external_work"

#: Points of a curve between two converged ones.
POINTS_PER_STEP = 20

#: Parts of a step over which its work is added up; an even number.
WORK_PARTS = 16


def cubics(result: Result, per_step: int = POINTS_PER_STEP) -> Curve:
    """The path with points between the steps, on the cubics that their exact slopes give or straight (see `dense`)."""
    steps = result.steps
    if not {"load_slope", "heading"} <= set(steps) or result.opening.size < 2 or per_step == 1:
        return result.opening, result.load
    return dense(result.opening, result.load, steps["load_slope"], steps["heading"], per_step, energy=_energy(result))


def _energy(result: Result) -> np.ndarray | None:
    """Stored and dissipated (n,), where the run knows both."""
    steps = result.steps
    return steps["stored_energy"] + steps["dissipated_energy"] if set(ENERGIES) <= set(steps) else None


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
    return float(result.steps[WORK_COLUMN][-1])


class Midpoints:
    """The midpoint of every step of a path, as its rows come: straight lines between rows draw a curve of few steps."""

    def __init__(self) -> None:
        self._before: Mapping[str, float] | None = None
        self._size = np.zeros(2)

    def __call__(self, row: Mapping[str, float]) -> dict[str, float] | None:
        """The columns of the curve between the row before and this one; None for the first one, and without slopes.

        Opening and load are on the cubic of the step (`dense`), the work is that along it, and the crack, what is
        dissipated and the J-integrals have gone half way, which leaves to be stored what keeps the ledger as it is at
        both ends. ``newton_iterations`` is 0, as nothing has been solved.
        """
        before, self._before = self._before, row
        self._size = np.maximum(self._size, np.abs([row["opening"], row["load"]]))
        if before is None or not {*OF_CUBICS, *ENERGIES, WORK_COLUMN} <= row.keys():
            return None
        d, P, slope, heading = (np.array([before[name], row[name]]) for name in OF_CUBICS)
        energy = [sum(one[name] for name in ENERGIES) for one in (before, row)]
        d, P = dense(d, P, slope, heading, WORK_PARTS, self._size, energy)
        half = WORK_PARTS // 2
        mean = {name: 0.5 * (before[name] + row[name]) for name in (*CURVE_COLUMNS, *SLIDING_COLUMNS) if name in row}
        more = float(np.trapezoid(P[: half + 1], d[: half + 1]) - 0.5 * np.trapezoid(P, d))
        by_cubic = {"opening": float(d[half]), "load": float(P[half]), "newton_iterations": 0.0}
        return mean | by_cubic | {name: mean[name] + more for name in ("stored_energy", WORK_COLUMN)}
