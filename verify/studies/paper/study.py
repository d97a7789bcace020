"""What came of the runs behind the figures, measured against a converged curve of the same problem."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from math import isfinite, nan
from typing import Protocol

import numpy as np

from verify.curves.curve import Curve, curve_error, oscillation, peak
from verify.methods.solve import prepare
from verify.methods.zone_resolution import expected
from verify.result import Result
from verify.runs.jobs import Job, Outcome
from verify.scene.load import load_scene
from verify.scene.schema import Scene
from verify.studies.paper.plan import LAWS, Plan
from verify.theory import lefm


class AnyCase(Protocol):
    """What a run is meant to show: hashable, with the problem that it solves."""

    @property
    def basis(self) -> str: ...

    @property
    def problem(self) -> Hashable: ...


@dataclass(frozen=True, eq=False)
class Reference:
    """The finer of two fine runs; ``error`` and ``oscillation`` are those of the coarser one against it."""

    label: str
    result: Result
    error: float
    oscillation: float


@dataclass(frozen=True, eq=False)
class Trial:
    """One run of the figures; what cannot be measured, as of a run that stopped, is NaN.

    error : relative L2 distance of the load to the reference
    oscillation : RMS of load / reference - 1 on the propagation branch, mean removed
    variation : total variation of the load there beyond that of a monotone curve, relative to it
    peak : largest load over that of the reference, minus 1
    """

    case: AnyCase
    result: Result | None
    status: str
    error: float = nan
    oscillation: float = nan
    variation: float = nan
    peak: float = nan

    @property
    def complete(self) -> bool:
        return self.result is not None and self.result.complete

    @property
    def drawable(self) -> bool:
        return self.result is not None and self.result.opening.size > 1

    @property
    def seconds(self) -> float:
        return float(((self.result and self.result.seconds) or {}).get("total", nan))

    @property
    def peak_load(self) -> float:
        return peak_load(self.result) if self.drawable else nan


@dataclass(frozen=True, eq=False)
class Trials:
    """All trials of a figure, with what they are held against.

    scenes : by name
    references : by problem, those that are known
    limits : LEFM by scene
    """

    scenes: Mapping[str, Scene]
    trials: tuple[Trial, ...]
    references: Mapping[Hashable, Reference]
    limits: Mapping[str, Curve]

    def trial(self, case: AnyCase) -> Trial | None:
        return self._by_case.get(case)

    def values(self, name: str) -> tuple:
        """The different values of a field of the cases: ``study.values("points")``."""
        return tuple(dict.fromkeys(getattr(trial.case, name) for trial in self.trials))

    @cached_property
    def _by_case(self) -> dict[AnyCase, Trial]:
        return {trial.case: trial for trial in self.trials}


@dataclass(frozen=True, eq=False)
class Study(Trials):
    """Those of Figures 6, 7 and 8; ``zones``: how many elements span the process zone, by basis, law and unknowns."""

    zones: Mapping[tuple[str, str, int], float]

    @property
    def left_out(self) -> str:
        """Why there is nothing in it, where there is nothing."""
        return left_out(self, LAWS)


def left_out(study: Trials, scenes: Iterable[str]) -> str:
    """Why there is nothing in a study, where there is nothing."""
    return "" if study.trials else f"left out: none of its scenes ({', '.join(scenes)}) is among those given"


def measured(plan: Plan, outcomes: Mapping[Job, Outcome]) -> Study:
    """The study of a plan whose jobs are done."""
    scenes = dict(plan.scenes)
    names = {"dolfinx": "cubic DOLFINx elements", "nurbs": "NURBS on one arm"}
    found = {problem: reference(outcomes[coarse], outcomes[fine], names) for problem, coarse, fine in plan.references}
    references = {problem: one for problem, one in found.items() if one is not None}
    zones = {
        (case.basis, case.law, case.dofs): expected(load_scene(case.law, case.overrides), case.basis).elements
        for case, _ in plan.cases
        if case.of_the_paper
    }
    trials = tuple(trial(case, outcomes[job], references.get(case.problem)) for case, job in plan.cases)
    return Study(scenes, trials, references, {law: limit(scene) for law, scene in scenes.items()}, zones)


def reference(coarse: Outcome, fine: Outcome, names: Mapping[str, str]) -> Reference | None:
    """What the two fine runs of a problem give; nothing where one of them did not come to its end.

    ``names`` says what their mesh is, by method.
    """
    before, result = coarse.result, fine.result
    if before is None or result is None or not (before.complete and result.complete):
        return None
    return Reference(
        f"{names[fine.job.method]}, {result.dofs} unknowns",
        result,
        curve_error(curve(before), curve(result)),
        oscillation(curve(before), curve(result))["rms"],
    )


def trial(case: AnyCase, outcome: Outcome, against: Reference | None) -> Trial:
    """Measure one run; one that stopped, or that has nothing to be held against, only keeps its status."""
    result = outcome.result
    if result is None:
        return Trial(case, None, outcome.left_out)
    if against is None or not result.complete:
        return Trial(case, result, result.status)
    wave = oscillation(curve(result), curve(against.result))
    return Trial(
        case,
        result,
        result.status,
        error=curve_error(curve(result), curve(against.result)),
        oscillation=wave["rms"],
        variation=wave["excess_variation"],
        peak=peak_load(result) / peak_load(against.result) - 1.0,
    )


def curve(result: Result) -> Curve:
    """The converged points as they are.

    Between them the exact slopes would tell no more: a step ends anywhere in the passage of the front through an
    element, and the slope there has the ripple of that passage, which a step of the load does not show.
    """
    return result.opening, result.load


def limit(scene: Scene) -> Curve:
    """LEFM by simple beam theory, the curve that the paper draws."""
    rows = lefm.solve(replace(prepare(scene, "lefm").problem, theory="simple")).rows
    return tuple(np.array([row[name] for row in rows]) for name in ("opening", "load"))


def distance(one: Trial | None, other: Trial | None) -> float:
    """Relative L2 distance of the curves of two trials; NaN where one of them did not come to its end."""
    if one is None or other is None or not (one.complete and other.complete):
        return nan
    return curve_error(curve(one.result), curve(other.result))


def peak_load(result: Result) -> float:
    """Largest load, between the steps too where their slopes are known."""
    slope = result.steps.get("load_slope")
    usable = slope is not None and all(isfinite(value) for value in slope)
    return peak(curve(result), slope if usable else None)[1]
