"""Criteria of every run of every hard case, and the measures that several cases share."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from verify.checks.identities import checks_of
from verify.checks.mechanics.columns import has
from verify.checks.mechanics.mixed import J_COLUMNS
from verify.curves.curve import curve_error
from verify.curves.of_run import cubics
from verify.methods.mesh_choice import spline_mesh
from verify.methods.solve import prepare
from verify.result import Result
from verify.scene.effects import simulated
from verify.studies.hard.case import Trial
from verify.verdict import Check

LEDGER_TOLERANCE = 0.01
#: Checks of a verification that every run has to meet besides its completion. Others take a process zone for granted
#: that the mesh resolves.
OF_J = ("j-integral", "j-loads", "moments")
#: Rounding, over the largest damage or energy.
ROUNDED = 1e-9


def common(trial: Trial, may_stop: bool = False) -> Iterator[Check]:
    """Completeness and J, as in a verification, finite numbers, the ledger over what is dissipated, and where the bond
    slides damage and energy that stay.

    A basis is allowed no error of its usual meshes: where the mesh explains a deviation, a check cannot judge.
    """
    steps, name, prepared = trial.result.steps, trial.name, prepare(trial.scene, trial.result.method)
    exact = replace(prepared, method=replace(prepared.method, mesh_error=0.0))
    for check in checks_of(exact, trial.result, name):
        if check.name in OF_J:
            yield check
        elif check.name == "completed" and not may_stop:  # one may also stop on its way where its programme ends
            ended = trial.result.complete or trial.result.separated
            yield replace(check, value=check.value or float(not ended))
    bad = sum(int(np.sum(~np.isfinite(column))) for key, column in steps.items() if key != "load_slope")
    yield Check("finite", name, bad, 0, "exact", "No number of the run is NaN or infinite.")
    if steps["opening"].size < 2:
        return
    meaning = "External work is stored or dissipated: error over the dissipated energy."
    yield Check("ledger", name, ledger(trial.result), LEDGER_TOLERANCE, "exact", meaning)
    if simulated(trial.scene)["shear"] and has(steps, *J_COLUMNS):
        yield from _never_back(trial)


def _never_back(trial: Trial) -> Iterator[Check]:
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
