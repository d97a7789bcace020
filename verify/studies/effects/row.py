"""Comparison of two runs that differ by one effect."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import isfinite, nan
from typing import Any

import numpy as np

from verify.curves.curve import Curve, load_at
from verify.curves.of_run import cubics, dissipated, distance, peak_load, work
from verify.result import Result, run_seconds
from verify.runs.jobs import Job, Outcome
from verify.studies.effects.plan import Pair
from verify.studies.frame import BUSY, failure, unmeasured

#: Value, over the work or the peak load, that counts as zero.
ZERO = 1e-9

#: Least condition number that is assumed of the matrices of two runs whose slopes are compared.
SLOPES_CONDITION = 1e7

#: Names of the changes in the table, by column.
CHANGES: Mapping[str, str] = {
    "peak_change": "peak load",
    "end_change": "load at the end",
    "dissipated_change": "dissipated energy",
    "work_change": "work",
}


@dataclass(frozen=True)
class Row:
    """A line of ``effects.csv``; unknown values are NaN.

    scene_has : whether the scene has the effect
    curve_change : relative L2 distance of the loads with and without the effect, along the programme
    peak_change, end_change, dissipated_change, work_change : value with the effect over value without it, minus 1, of
        the peak load and, at the end, of load, dissipated energy and external work; NaN for 0 without the effect
    seconds_with, seconds_without : least wall time of ``times`` runs, without imports and compilation
    time_ratio : time with the effect over time without it
    time_spread : largest over least time of equal runs; well above 1 the machine was busy and the ratio is inaccurate
    """

    effect: str
    key: str
    with_it: str
    without: str
    scene_has: bool
    curve_change: float
    peak_change: float
    end_change: float
    dissipated_change: float
    work_change: float
    seconds_with: float
    seconds_without: float
    time_ratio: float
    time_spread: float
    times: int
    status: str

    @property
    def complete(self) -> bool:
        return self.status == "complete"

    @property
    def sentence(self) -> str:
        """A line such as: finite kinematics: curve 0.69 %, +0.2 % peak load, +0.7 % load at the end, 3.1 x time"""
        if not self.complete:
            return f"{self.effect}: {self.status}"
        changes = [f"curve {signed(self.curve_change).lstrip('+')}"] if isfinite(self.curve_change) else []
        for key, name in CHANGES.items():
            value = getattr(self, key)
            changes.append(f"{signed(value)} {name}" if isfinite(value) else f"no {name} without it")
        return f"{self.effect}: {', '.join([*changes, self.time])}"

    @property
    def time(self) -> str:
        if not isfinite(self.time_ratio):
            return "no time"
        busy = f" (equal runs differ by up to {self.time_spread:.2g} x)" if self.time_spread > BUSY else ""
        return f"{self.time_ratio:.2g} x time{busy}"


def row(pair: Pair, first: Mapping[Job, Outcome], again: Mapping[Job, Sequence[Outcome]]) -> Row:
    """Compare the two runs of a pair; the times are those of the repetitions ``again``."""
    sides = {"with": pair.with_it, "without": pair.without}
    known: dict[str, Any] = {
        "effect": pair.switch.name,
        "key": pair.switch.key,
        "with_it": pair.switch.on,
        "without": pair.switch.off,
        "scene_has": len(pair.with_it.overrides) < len(pair.without.overrides),
    }
    ours, theirs = first[pair.with_it].result, first[pair.without].result
    wrong = [f"{side} it: {why}" for side, job in sides.items() if (why := failure(first[job]))]
    if not wrong and ours is not None and theirs is not None and pair.switch.of_damage:
        wrong = starts_otherwise(ours, theirs)
    if wrong or ours is None or theirs is None:
        return unmeasured(Row, known | {"status": "; ".join(wrong)})
    took = {side: _seconds(again[job]) for side, job in sides.items()}
    least = {side: min(seconds, default=nan) for side, seconds in took.items()}
    times: dict[str, Any] = {
        "seconds_with": least["with"],
        "seconds_without": least["without"],
        "time_ratio": least["with"] / least["without"],
        "time_spread": max(max(seconds, default=nan) / least[side] for side, seconds in took.items()),
        "times": min(len(again[job]) for job in sides.values()),
    }
    return Row(**known, **times, **changes(ours, theirs, pair.with_it.scene.load.opening), status="complete")


def starts_otherwise(with_it: Result, without: Result) -> list[str]:
    """A sentence where two runs that differ in damage alone have other slopes at rest, where there is none.

    Both are slopes of one matrix: they differ by rounding, which its condition number enlarges.
    """
    first, other = (float(run.steps.get("load_slope", np.full(1, nan))[0]) for run in (with_it, without))
    rounding = np.finfo(float).eps * max(with_it.condition, without.condition, SLOPES_CONDITION)
    off = first / other - 1.0 if other else 0.0
    if not abs(off) > rounding:
        return []
    return [f"one of both runs is wrong: at rest, without any damage, the stiffness with it is {signed(off)} off"]


def changes(with_it: Result, without: Result, programme: Sequence[float]) -> dict[str, Any]:
    """Changes of curve, peak, end and energies by one effect: value with it over value without it, minus 1."""
    top = max(abs(peak_load(with_it)), abs(peak_load(without)))
    most = max(abs(work(with_it)), abs(work(without)))
    return {
        "curve_change": apart(with_it, without, programme),
        "peak_change": change(peak_load(with_it), peak_load(without), top),
        "end_change": change(float(with_it.load[-1]), float(without.load[-1]), top),
        "dissipated_change": change(dissipated(with_it), dissipated(without), most),
        "work_change": change(work(with_it), work(without), most),
    }


def apart(with_it: Result, without: Result, programme: Sequence[float], n: int = 400) -> float:
    """Relative L2 distance of the loads: of the envelopes, or leg by leg for a programme with several legs.

    Envelopes do not contain unloading, which some effects change most.
    """
    ours, theirs = (legs(result, programme) for result in (with_it, without))
    if len(programme) == 1 or min(len(ours), len(theirs)) < len(programme):
        return distance(cubics(with_it), without)
    off = size = 0.0
    for mine, known, end, start in zip(ours, theirs, programme, (0.0, *programme), strict=False):
        at = abs(end - start) * (np.arange(1, n + 1) / n)
        wanted = load_at(known, at)
        off += abs(end - start) * float(np.sum((load_at(mine, at) - wanted) ** 2))
        size += abs(end - start) * float(np.sum(wanted**2))
    return (off / size) ** 0.5


def legs(result: Result, programme: Sequence[float]) -> list[Curve]:
    """Load over the distance from the start of the leg, for every completed leg of the programme."""
    found, at = [], 0
    for goal, start in zip(programme, (0.0, *programme), strict=False):
        there = np.flatnonzero(np.isclose(result.opening[at + 1 :], goal, rtol=0.0, atol=1e-9 * abs(goal - start)))
        if not there.size:
            break
        end = at + 1 + int(there[0])
        part = replace(result, steps={name: column[at : end + 1] for name, column in result.steps.items()})
        opening, load = cubics(part)
        found.append((np.sign(goal - start) * (np.asarray(opening) - start), load))
        at = end
    return found


def change(value: float, before: float, scale: float) -> float:
    """value / before - 1; 0 where both are negligible on the ``scale``, NaN where only ``before`` is."""
    if abs(before) <= ZERO * scale:
        return 0.0 if abs(value) <= ZERO * scale else nan
    return value / before - 1.0


def signed(fraction: float) -> str:
    """A percentage with sign, two significant digits and at most five decimals: +0.69 %."""
    per_cent = 100.0 * fraction
    return "0 %" if abs(per_cent) < 1e-5 else f"{float(f'{per_cent:.2g}'):+.6g} %"


def _seconds(outcomes: Sequence[Outcome]) -> list[float]:
    return [run_seconds(one.result) for one in outcomes if one.result is not None and one.result.seconds]
