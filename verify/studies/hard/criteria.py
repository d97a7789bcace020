"""Criteria of every run of every hard case, and the measures that several cases share."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from verify.checks.identities import end_cannot_judge
from verify.checks.mechanics import mixed
from verify.checks.mechanics.columns import Steps
from verify.checks.mechanics.j_integral import J_TOLERANCE, j_deviation
from verify.checks.mechanics.unresolved import too_coarse
from verify.curves.curve import curve_error
from verify.curves.of_run import cubics
from verify.methods.mesh_choice import spline_mesh
from verify.methods.solve import prepare
from verify.methods.zone_resolution import ENOUGH, expected, measured
from verify.result import Result
from verify.scene.effects import simulated
from verify.scene.schema import Scene
from verify.studies.hard.case import Finding, Number, Trial, Trials
from verify.verdict import Check, Kind

LEDGER_TOLERANCE = 0.01


def common(trial: Trial, may_stop: bool = False) -> Iterator[Finding]:
    """Completeness, finite numbers, energy ledger; the J-integral as a check on resolved zones, else as a number."""
    steps, name = trial.result.steps, trial.name
    if not may_stop:
        meaning = "The programme was completed, or the specimen separated."
        yield Check("completed", name, missing(trial), 1e-9, "exact", meaning)
    bad = sum(int(np.sum(~np.isfinite(column))) for key, column in steps.items() if key != "load_slope")
    yield Check("finite", name, bad, 0, "exact", "No number of the run is NaN or infinite.")
    if steps["opening"].size < 2:
        return
    meaning = "External work is stored or dissipated: error over the dissipated energy."
    yield Check("ledger", name, ledger(trial.result), LEDGER_TOLERANCE, "exact", meaning)
    slides = simulated(trial.scene)["shear"]
    deviation = _j_after_onset(trial.scene, steps) if slides else j_deviation(trial.scene, steps)
    if deviation is None:
        return
    meaning = "J of the loads is J of the bond, after the onset." if slides else "J is the area under the law."
    elements = zone_elements(trial)
    bends = trial.scene.discretization.degree > 1
    if elements >= ENOUGH and bends:
        check = Check("j-loads" if slides else "j-integral", name, deviation, J_TOLERANCE, "exact", meaning)
        why = "" if check.passed else _cannot_judge(trial, check)
        yield Number("j-deviation", name, deviation, f"Deviation of the J-integral; {why}.") if why else check
    else:
        why = f"{elements:.2g} elements in the process zone" if bends else "of linear elements, which lock in bending"
        meaning = f"Deviation of the J-integral; it measures the mesh, {why}."
        yield Number("j-deviation", name, deviation, meaning)


def _j_after_onset(scene: Scene, steps: Steps) -> float | None:
    """Deviation of the J-integral of a bond that slides, after damage has begun; None where it has not."""
    since = steps["dissipated_energy"] > 0.0
    return mixed.j_loads(scene, {name: column[since] for name, column in steps.items()}) if since.any() else None


def _cannot_judge(trial: Trial, check: Check) -> str:
    """Why the J-integral gives no verdict, as far end or mesh explain its deviation; empty where it gives one."""
    prepared = prepare(trial.scene, trial.result.method)
    return end_cannot_judge(prepared, trial.result, check) or too_coarse(prepared, trial.result, check)


def missing(trial: Trial) -> float:
    """Part of the programme that was not run; 0 where it was completed or the specimen separated."""
    result, programme = trial.result, np.array(trial.scene.load.opening)
    if result.separated:
        return 0.0
    way = np.abs(np.diff([0.0, *programme]))
    if not result.opening.size:
        return 1.0
    left = abs(programme[-1] - result.opening[-1]) / np.sum(way)
    return float(left) if result.complete else max(float(left), 1e-6)


def ledger(result: Result) -> float:
    """Largest |external work - stored - dissipated| over the energy dissipated at the end, or if that is 0 the work."""
    steps = result.steps
    gap = np.abs(steps["external_work"] - steps["stored_energy"] - steps["dissipated_energy"]).max()
    lost = abs(float(steps["dissipated_energy"][-1]))
    whole = lost if lost > 0.0 else float(np.abs(steps["external_work"]).max())
    return float(gap / whole) if whole > 0.0 else 0.0


def dissipated_by_damage(steps: Steps) -> np.ndarray:
    """Energy dissipated by damage (n_steps,): all dissipated energy less that of friction."""
    return np.asarray(steps["dissipated_energy"] - steps.get("friction_energy", 0.0))


def point_areas(trial: Trial) -> np.ndarray:
    """Areas (n_q,) of the interface points of the last snapshot, of elements with Gauss points."""
    snapshot = trial.result.snapshots[-1]
    nodes, weights = np.polynomial.legendre.leggauss(spline_mesh(trial.scene).points)
    length_e = np.ptp(snapshot.s_q.reshape(-1, nodes.size), axis=1) * 2.0 / np.ptp(nodes)
    return np.asarray(np.outer(length_e, weights / 2.0).ravel() * trial.scene.specimen.width)


def zone_elements(trial: Trial) -> float:
    """Elements in the process zone as measured in the run; NaN without a crack."""
    return measured(trial.result) / expected(trial.scene, trial.result.method).element


def distance(result: Result, reference: Result) -> float:
    """Relative L2 distance of the envelopes of two runs, with cubics between the steps."""
    return curve_error(cubics(result), cubics(reference))


def equal_curves(
    reference: str,
    measure: Callable[[Result, Result], float],
    tolerance: float,
    kind: Kind,
    meaning: str,
    name: str = "same-curve",
) -> Callable[[Trials], Iterator[Finding]]:
    """A judge that compares the curve of every run with that of the run named ``reference``."""

    def judge(trials: Trials) -> Iterator[Finding]:
        for other, trial in trials.items():
            if other != reference:
                yield Check(name, other, measure(trial.result, trials[reference].result), tolerance, kind, meaning)

    return judge


def difference(result: Result, reference: Result, lengths: float = 1.0, forces: float = 1.0) -> float:
    """Largest relative difference of two paths step by step; distance of the envelopes where their steps differ.

    ``lengths`` and ``forces`` convert the units of ``result`` to those of ``reference``.
    """
    opening, load = result.opening * lengths, result.load * forces
    if opening.size == reference.opening.size:
        pairs = ((opening, reference.opening), (load, reference.load))
        return max(float(np.max(np.abs(a - b)) / np.max(np.abs(b))) for a, b in pairs)
    slopes = {"opening": opening, "load": load, "load_slope": result.steps["load_slope"] * forces / lengths}
    return curve_error(cubics(Result(result.method, {**result.steps, **slopes})), cubics(reference))
