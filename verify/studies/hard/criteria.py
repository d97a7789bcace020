"""What every run of every hard case must show, and the measures that several cases share."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from verify.checks.identities import end_cannot_judge
from verify.checks.mechanics.j_integral import J_TOLERANCE, j_deviation
from verify.checks.mechanics.unresolved import too_coarse
from verify.curves.curve import curve_error
from verify.curves.of_run import cubics
from verify.methods.solve import prepare
from verify.methods.zone_resolution import ENOUGH, expected, measured
from verify.result import Result
from verify.studies.hard.case import Finding, Number, Trial
from verify.verdict import Check

LEDGER_TOLERANCE = 0.01


def common(trial: Trial, may_stop: bool = False) -> Iterator[Finding]:
    """Completed, no NaN, ledger, and the J-integral: a check where the zone is resolved, a number elsewhere."""
    steps, name = trial.result.steps, trial.name
    if not may_stop:
        yield Check(
            "completed", name, missing(trial), 1e-9, "exact", "The programme was run, or the specimen came apart."
        )
    bad = sum(int(np.sum(~np.isfinite(column))) for key, column in steps.items() if key != "load_slope")
    yield Check("finite", name, bad, 0, "exact", "No number of the run is NaN or infinite.")
    if steps["opening"].size < 2:
        return
    error = ledger(trial.result)
    yield Check(
        "ledger", name, error, LEDGER_TOLERANCE, "exact", "Work is stored or dissipated: error over all dissipated."
    )
    deviation = j_deviation(trial.scene, steps)
    if deviation is None:
        return
    elements = zone_elements(trial)
    bends = trial.scene.discretization.degree > 1
    if elements >= ENOUGH and bends:
        meaning = "The J-integral is the area under the law, at every step."
        check = Check("j-integral", name, deviation, J_TOLERANCE, "exact", meaning)
        why = "" if check.passed else _cannot_judge(trial, check)
        yield Number("j-deviation", name, deviation, f"Deviation of the J-integral; {why}.") if why else check
    else:
        why = f"{elements:.2g} elements in the process zone" if bends else "of linear elements, which lock in bending"
        meaning = f"Deviation of the J-integral; it measures the mesh, {why}."
        yield Number("j-deviation", name, deviation, meaning)


def _cannot_judge(trial: Trial, check: Check) -> str:
    """Why the J-integral cannot judge the run: the far end or the mesh explains its deviation; else empty."""
    prepared = prepare(trial.scene, trial.result.method)
    return end_cannot_judge(prepared, trial.result, check) or too_coarse(prepared, trial.result, check)


def missing(trial: Trial) -> float:
    """Part of the programme that is left: 0 where it was run to its end or the specimen has separated."""
    result, programme = trial.result, np.array(trial.scene.load.opening)
    if result.complete and result.ending.startswith("separated"):
        return 0.0
    way = np.abs(np.diff([0.0, *programme]))
    if not result.opening.size:
        return 1.0
    left = abs(programme[-1] - result.opening[-1]) / np.sum(way)
    return float(left) if result.complete else max(float(left), 1e-6)


def ledger(result: Result) -> float:
    """Worst |external work - stored - dissipated| over what is dissipated in the end; without any, over the work."""
    steps = result.steps
    gap = np.abs(steps["external_work"] - steps["stored_energy"] - steps["dissipated_energy"]).max()
    lost = abs(float(steps["dissipated_energy"][-1]))
    whole = lost if lost > 0.0 else float(np.abs(steps["external_work"]).max())
    return float(gap / whole) if whole > 0.0 else 0.0


def zone_elements(trial: Trial) -> float:
    """Elements in the process zone as it was measured; NaN where no crack ran."""
    return measured(trial.result) / expected(trial.scene, trial.result.method).element


def distance(result: Result, reference: Result) -> float:
    """Relative L2 distance of the envelopes of two runs, on the cubics of their exact slopes."""
    return curve_error(cubics(result), cubics(reference))


def difference(result: Result, reference: Result, lengths: float = 1.0, forces: float = 1.0) -> float:
    """Largest relative difference of two paths, step by step; of their envelopes where they have other steps.

    ``lengths`` and ``forces`` are the sizes of the units of ``result`` in those of ``reference``.
    """
    opening, load = result.opening * lengths, result.load * forces
    if opening.size == reference.opening.size:
        pairs = ((opening, reference.opening), (load, reference.load))
        return max(float(np.max(np.abs(a - b)) / np.max(np.abs(b))) for a, b in pairs)
    slopes = {"opening": opening, "load": load, "load_slope": result.steps["load_slope"] * forces / lengths}
    return curve_error(cubics(Result(result.method, {**result.steps, **slopes})), cubics(reference))
