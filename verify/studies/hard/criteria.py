"""Criteria of every run of every hard case, and the measures that several cases share."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from verify.checks.identities import IDENTITIES, end_cannot_judge
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
from verify.scene.schema import Scene
from verify.studies.hard.case import Finding, Number, Trial
from verify.verdict import Check

LEDGER_TOLERANCE = 0.01
#: Rounding, over the largest damage or energy.
ROUNDED = 1e-9


def common(trial: Trial, may_stop: bool = False) -> Iterator[Finding]:
    """Completeness, finite numbers, energy ledger, J, and where the bond slides damage and energy that stay."""
    steps, name, completed = trial.result.steps, trial.name, IDENTITIES["completed"]
    if not may_stop:
        yield Check("completed", name, missing(trial), 1e-9, "exact", str(completed.meaning))
    bad = sum(int(np.sum(~np.isfinite(column))) for key, column in steps.items() if key != "load_slope")
    yield Check("finite", name, bad, 0, "exact", "No number of the run is NaN or infinite.")
    if steps["opening"].size < 2:
        return
    meaning = "External work is stored or dissipated: error over the dissipated energy."
    yield Check("ledger", name, ledger(trial.result), LEDGER_TOLERANCE, "exact", meaning)
    slides = mixed.sliding(trial.scene, steps)
    yield from _j(trial, slides)
    if slides:
        yield from _never_back(trial)


def _j(trial: Trial, slides: bool) -> Iterator[Finding]:
    """J of the loads, where the bond slides after the onset: a check on resolved zones, else a number."""
    scene, steps, name = trial.scene, trial.result.steps, trial.name
    deviation = _j_after_onset(scene, steps) if slides else j_deviation(scene, steps)
    if deviation is None:
        return
    elements, bends = zone_elements(trial), scene.discretization.degree > 1
    meaning = "J of the loads is J of the bond, after the onset." if slides else "J is the area under the law."
    check = Check("j-loads" if slides else "j-integral", name, deviation, J_TOLERANCE, "exact", meaning)
    if not bends:
        why = "it measures the mesh, of linear elements, which lock in bending"
    elif not elements >= ENOUGH:
        why = f"it measures the mesh, {elements:.2g} elements in the process zone"
    else:
        why = "" if check.passed else _cannot_judge(trial, check)
    yield Number("j-deviation", name, deviation, f"Deviation of the J-integral; {why}.") if why else check


def _j_after_onset(scene: Scene, steps: Steps) -> float | None:
    """Deviation of the J-integral of a bond that slides, after damage has begun; None where it has not."""
    since = steps["dissipated_energy"] > 0.0
    return mixed.j_loads(scene, {name: column[since] for name, column in steps.items()}) if since.any() else None


def _cannot_judge(trial: Trial, check: Check) -> str:
    """Why the J-integral gives no verdict, as far end or mesh explain its deviation; empty where it gives one."""
    prepared = prepare(trial.scene, trial.result.method)
    return end_cannot_judge(prepared, trial.result, check) or too_coarse(prepared, trial.result, check)


def _never_back(trial: Trial) -> Iterator[Finding]:
    """Damage of every point never falls from one snapshot to the next, nor dissipated energy from step to step.

    The part of damage alone is not checked: with friction it may fall, as the springs of friction store more while
    damage grows.
    """
    steps, taken = trial.result.steps, trial.result.snapshots
    if len(taken) > 1:
        back = max(float(np.max(a.damage_q - b.damage_q)) for a, b in zip(taken[:-1], taken[1:], strict=True))
        yield Check("no-healing", trial.name, max(back, 0.0), ROUNDED, "exact", "The damage of no point ever falls.")
    whole = float(np.max(np.abs(steps["external_work"])))
    for name in ("dissipated_energy", "friction_energy"):
        back = max(0.0, -float(np.min(np.diff(steps[name])))) / whole
        meaning = "It never comes back: largest fall from step to step, over the external work."
        yield Check(name.replace("_", "-"), trial.name, back, ROUNDED, "exact", meaning)


def missing(trial: Trial) -> float:
    """Distance of the last opening from the end of the programme, over the largest opening; 1 for a run that stopped
    there on its way, 0 where the specimen separated."""
    if trial.result.separated:
        return 0.0
    return IDENTITIES["completed"].value(trial.scene, trial.result.steps) or float(not trial.result.complete)


def ledger(result: Result) -> float:
    """Largest |external work - stored - dissipated| over the energy dissipated at the end, or if that is 0 the work."""
    steps = result.steps
    gap = np.abs(steps["external_work"] - steps["stored_energy"] - steps["dissipated_energy"]).max()
    lost = abs(float(steps["dissipated_energy"][-1]))
    whole = lost if lost > 0.0 else float(np.abs(steps["external_work"]).max())
    return float(gap / whole) if whole > 0.0 else 0.0


def point_areas(trial: Trial) -> np.ndarray:
    """Areas (n_q,) of the interface points of the last snapshot, of elements with Gauss points."""
    snapshot = trial.result.snapshots[-1]
    nodes, weights = np.polynomial.legendre.leggauss(spline_mesh(trial.scene).points)
    length_e = np.ptp(snapshot.s_q.reshape(-1, nodes.size), axis=1) * 2.0 / np.ptp(nodes)
    return np.asarray(np.outer(length_e, weights / 2.0).ravel() * trial.scene.specimen.width)


def cost_of_damage(areas: np.ndarray, damage: np.ndarray, toughness: float, ductility: float) -> float:
    """Energy that a bilinear law takes at points (n_q,) of damage d: ``G (k - k0) / (ku - k0)``, ``k = k0 ku / (ku - d
    (ku - k0))``, with the jumps k0 and ku = ``ductility`` k0 of onset and failure; a part of G while d < 1."""
    return toughness * float(areas @ (damage / (ductility - damage * (ductility - 1.0))))


def zone_elements(trial: Trial) -> float:
    """Elements in the process zone as measured in the run; NaN without a crack."""
    return measured(trial.result) / expected(trial.scene, trial.result.method).element


def distance(result: Result, reference: Result) -> float:
    """Relative L2 distance of the envelopes of two runs, with cubics between the steps."""
    return curve_error(cubics(result), cubics(reference))


def difference(result: Result, reference: Result, lengths: float = 1.0, forces: float = 1.0) -> float:
    """Largest relative difference of two paths step by step; distance of the envelopes where their steps differ.

    ``lengths`` and ``forces`` convert the units of ``result`` to those of ``reference``.
    """
    opening, load = result.opening * lengths, result.load * forces
    if opening.size == reference.opening.size:
        pairs = ((opening, reference.opening), (load, reference.load))
        return max(float(np.max(np.abs(a - b)) / np.max(np.abs(b))) for a, b in pairs)
    slopes = {"opening": opening, "load": load, "load_slope": result.steps["load_slope"] * forces / lengths}
    return distance(Result(result.method, {**result.steps, **slopes}), reference)
