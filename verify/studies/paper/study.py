"""Measures of the runs of the figures against the converged curves of the same problems."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import nan

import numpy as np

from verify.curves.curve import Curve, curve_error, oscillation
from verify.curves.of_run import peak_load
from verify.methods.solve import prepare
from verify.methods.zone_resolution import element_length, expected
from verify.methods.zone_resolution import measured as zone_length
from verify.result import Result
from verify.runs.jobs import Job, Outcome
from verify.scene.load import load_scene
from verify.scene.schema import Scene
from verify.studies.paper.plan import BEAMS, PRINTED, STRIPS, Case, Figures, Plan, Problem
from verify.theory import lefm


@dataclass(frozen=True, eq=False)
class Reference:
    """The finer of two runs on fine meshes; ``error`` and ``oscillation`` of the coarser one against it."""

    label: str
    result: Result
    error: float
    oscillation: float


@dataclass(frozen=True, eq=False)
class Trial:
    """One run of the figures; the measures of a run that stopped are NaN.

    error : relative L2 distance of the load to the reference
    oscillation : RMS of load / reference - 1 on the propagation branch, mean removed
    variation : excess of the total variation of the load there over that of a monotone curve, relative
    peak : peak load over that of the reference, minus 1
    """

    case: Case
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
    def drawn(self) -> Result | None:
        """The result if it has a curve."""
        return self.result if self.result is not None and self.result.opening.size > 1 else None


@dataclass(frozen=True, eq=False)
class Study:
    """All trials of a group of figures.

    scenes, limits : scenes and their LEFM curves by name
    references : converged curves by problem
    zones : elements in the process zone: estimated for beams, measured for strips
    printed : estimated elements in the zone for strips with the printed moduli, by basis
    """

    figures: Figures
    scenes: Mapping[str, Scene]
    trials: tuple[Trial, ...]
    references: Mapping[Problem, Reference]
    limits: Mapping[str, Curve]
    zones: Mapping[Case, float]
    printed: Mapping[str, float] = field(default_factory=dict)

    @property
    def left_out(self) -> str:
        """Why there are no trials; empty if there are some."""
        scenes = ", ".join(self.figures.scenes)
        return "" if self.trials else f"left out: none of its scenes ({scenes}) is among those given"

    def trial(self, case: Case) -> Trial | None:
        return self._by_case.get(case)

    def values(self, name: str) -> tuple:
        """The distinct values of a field of the cases: ``study.values("points")``."""
        return tuple(dict.fromkeys(getattr(trial.case, name) for trial in self.trials))

    def bond(self, scene: str) -> float:
        """Bond length of a strip; NaN for other specimens."""
        specimen = self.scenes[scene].specimen
        return specimen.tip if specimen.clamped else nan

    def complete_runs(self) -> Iterator[tuple[str, str, Result]]:
        """Basis, scene and result of every complete run, then those of the converged curves."""
        for one in self.trials:
            if one.result is not None and one.result.complete:
                yield one.case.basis, one.case.scene, one.result
        yield from (("converged", scene, known.result) for (scene, _), known in self.references.items())

    @cached_property
    def _by_case(self) -> dict[Case, Trial]:
        return {trial.case: trial for trial in self.trials}


def measured(plan: Plan, outcomes: Mapping[Job, Outcome]) -> Study:
    """The study of a plan whose jobs are done."""
    pairs = {problem: (outcomes[coarse], outcomes[fine]) for problem, coarse, fine in plan.references}
    found = {problem: reference(*pair, plan.figures.fine) for problem, pair in pairs.items()}
    known = {problem: one for problem, one in found.items() if one is not None}
    trials = tuple(trial(case, outcomes[job], known.get(case.problem)) for case, job in plan.cases)
    limits = {name: limit(scene) for name, scene in plan.scenes.items()}
    if plan.figures is BEAMS:
        zones = {case: expected(job.solved, case.basis).elements for case, job in plan.cases if case.of_the_paper}
        return Study(BEAMS, plan.scenes, trials, known, limits, zones)
    zones = {one.case: zone(plan.scenes[one.case.scene], one) for one in trials}
    bases = dict.fromkeys(case.basis for case, _ in plan.cases)
    printed = {basis: expected(load_scene(PRINTED), basis).elements for basis in bases}
    return Study(STRIPS, plan.scenes, trials, known, limits, zones, printed)


def reference(coarse: Outcome, fine: Outcome, names: Mapping[str, str]) -> Reference | None:
    """The converged curve from two runs on fine meshes; None where one of them is not complete."""
    before, result = coarse.result, fine.result
    if before is None or result is None or not (before.complete and result.complete):
        return None
    label, pair = f"{names[fine.job.method]}, {result.dofs} unknowns", (curve(before), curve(result))
    return Reference(label, result, curve_error(*pair), oscillation(*pair)["rms"])


def trial(case: Case, outcome: Outcome, against: Reference | None) -> Trial:
    """Measure one run; without a reference or an end of the programme it has its status alone."""
    result = outcome.result
    if result is None:
        return Trial(case, None, outcome.left_out)
    if against is None or not result.complete:
        return Trial(case, result, result.status)
    pair = (curve(result), curve(against.result))
    wave, peak = oscillation(*pair), peak_load(result) / peak_load(against.result) - 1.0
    return Trial(case, result, result.status, curve_error(*pair), wave["rms"], wave["excess_variation"], peak)


def zone(scene: Scene, found: Trial) -> float:
    """Measured elements in the process zone; NaN without one."""
    if found.result is None or not found.complete:
        return nan
    return zone_length(found.result) / element_length(scene, found.case.basis)


def curve(result: Result) -> Curve:
    """The converged points, without cubics between them.

    A step ends at any position of the front within an element, and the slope there contains the ripple of the passage
    through that element: cubics by these slopes would be less smooth than the points.
    """
    return result.opening, result.load


def limit(scene: Scene) -> Curve:
    """LEFM by simple beam theory, as in the figures of the paper."""
    rows = lefm.solve(replace(prepare(scene, "lefm").problem, theory="simple")).rows
    return np.array([row["opening"] for row in rows]), np.array([row["load"] for row in rows])


def apart(one: Trial | None, other: Trial | None) -> float:
    """Relative L2 distance of the curves of two trials; NaN where one of them is not complete."""
    if one is None or other is None or one.result is None or other.result is None:
        return nan
    return curve_error(curve(one.result), curve(other.result)) if one.complete and other.complete else nan
