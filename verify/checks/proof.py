"""Accuracy of runs on a scene: their discretisation errors, and the difference between the models.

An error is estimated by the distance of the curves on two meshes, envelope by envelope and leg by leg, as the checks
judge them. The DOLFINx reference has a second mesh on every scene, coarser along the specimen and finer through the
thickness; no order of convergence is assumed. NURBS have one where faces are pressed together, finer through the
thickness (`verify.methods.second_meshes`); the error of one layer of theirs is that of T-splines, too.

The reference keeps the initial pairs of interface points and measures gaps along the undeformed normal. Codes that
project points onto the deformed face use another model. The two models differ where the arms rotate notably over a
process zone. Their difference is taken from two runs with NURBS on a DCB, one with each model.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import inf, isnan

import numpy as np

from verify.curves.curve import Curve, curve_error, peak
from verify.curves.leg_checks import farthest, programme_checks, stiffness
from verify.curves.legs import path
from verify.curves.of_run import cubics
from verify.methods.names import METHODS
from verify.methods.second_meshes import FIRST_ORDER, SECONDS, SINGLE, remedy
from verify.result import Result
from verify.scene.effects import NEGLIGIBLE
from verify.scene.schema import Scene
from verify.verdict import Check

#: Names of runs: the reference, the reference on its second mesh, NURBS with projection, NURBS with fixed pairs.
REFERENCE, SECOND, SEARCHING, MATCHED = "dolfinx", SECONDS["dolfinx"], "nurbs", "nurbs-matched"

#: Further runs of a method on meshes that are fine enough for checks between codes.
VARIANTS = {"tspline-adaptive": "tspline", MATCHED: SEARCHING, "dolfinx-p3": REFERENCE, "beam-3": "beam"}
#: The method of every run that takes part in checks between codes, by the name of the run.
RUNS = {
    name: method
    for method in METHODS.values()
    for name in (method.name, *(variant for variant, of in VARIANTS.items() if of == method.name))
    if not method.is_limit
}

#: Methods that are limits and take part in no check between codes.
LIMIT_METHODS = {name for name, method in METHODS.items() if method.is_limit}

#: Said of a run whose error is infinite: it completed its programme, or bears too little load there.
BEARS_LITTLE = "bears too little load on its second mesh to be compared with itself"

#: Checks against arms (`verify.checks.orders`), of the envelope and of every leg.
BY_ARMS = ("plane-curve", "beam-curve")
#: The basis that confirms the NURBS with projection.
CONFIRMING = "tspline"


@dataclass(frozen=True)
class Trust:
    """When an uncertainty of the reference may excuse a distance.

    Larger ``confirmed`` and ``models`` excuse more faults of the projection; with a larger ``certain`` a less accurate
    reference may decide more checks.

    confirmed : distance within which T-splines confirm the NURBS with projection
    models : largest plausible difference of the models: 0.0 to 0.7 % were measured on most of 60 random scenes, 2.0 %
        on stocky arms with a soft bond whose ends rotate by 23 degrees
    certain : uncertainty of the reference, over the tolerance of a check, up to which it does not change a verdict
    around : openings near that of a point, over the largest one, on which the error at the point is looked for: teeth
        of two meshes have their tips at other openings
    """

    confirmed: float = 0.005
    models: float = 0.03
    certain: float = 0.5
    around: float = 0.025


TRUST = Trust()


#: Relative distances of two curves by the name of the check that measures them: L2 of the load over the opening, peak,
#: stiffness before the peak, each leg of a programme that turns, and the farthest point near the opening of a check.
#: Other checks have the distance of the ``curve``.
Distance = Mapping[str, float]
NOTHING: Distance = {"curve": 0.0}
NOT_PROVEN: Distance = {"curve": inf}


def of_check(distance: Distance, check: Check) -> float:
    """The distance that a check is about."""
    return distance.get(check.name, distance["curve"])


@dataclass(frozen=True)
class Proof:
    """Discretisation error of the reference, and difference of the models, which is 0 where they coincide.

    The error is infinite where the reference was not run, or did not complete its programme, on the second mesh, as
    ``why`` says, or where it bears too little load there. ``others`` are the errors of further methods that have a
    second mesh, by the name of the method.
    """

    error: Distance
    models: Distance
    why: str = ""
    others: Mapping[str, Distance] = field(default_factory=dict)

    def errors(self, pair: Sequence[str], check: Check) -> dict[str, float]:
        """Errors of the runs of a pair that are known, in what a check is about, by the name of the method."""
        known = {REFERENCE: self.error, **self.others}
        methods = dict.fromkeys(RUNS[name].name for name in pair if name in RUNS)
        return {method: of_check(known[method], check) for method in methods if method in known}


def proof(results: Mapping[str, Result], programme: Sequence[float], at: float | None = None) -> Proof:
    """The accuracy of the runs of a scene.

    Parameters
    ----------
    results : by name
    programme : openings at which the load turns, and the last one
    at : opening near which points are compared as well
    """
    models = difference_of_models(results, programme, at)
    finer = results.get(SECONDS[SEARCHING])  # through the thickness, of NURBS, for T-splines as well
    meshes = {SEARCHING: results.get(SEARCHING), CONFIRMING: results.get(SINGLE, results.get(SEARCHING))}
    others = {
        method: {name: FIRST_ORDER * far for name, far in distance_of(finer, run, programme, at).items()}
        if finer.complete
        else NOT_PROVEN
        for method, run in meshes.items()
        if finer is not None and run is not None
    }
    if SECOND not in results or REFERENCE not in results:
        return Proof(NOT_PROVEN, models, "has not been solved on a second mesh", others)
    if results[REFERENCE].complete and not results[SECOND].complete:
        return Proof(NOT_PROVEN, models, "stopped on its second mesh", others)
    return Proof(distance_of(results[SECOND], results[REFERENCE], programme, at), models, "", others)


def difference_of_models(
    results: Mapping[str, Result], programme: Sequence[float], at: float | None = None
) -> Distance:
    """Distance between NURBS with fixed pairs and with projection; 0 where it is implausible or not confirmed.

    A fault of the projection must not pass for a difference of the models: where T-splines were run, they must have the
    same curve.
    """
    if MATCHED not in results or SEARCHING not in results:
        return NOTHING
    found = distance_of(results[MATCHED], results[SEARCHING], programme, at)
    there = CONFIRMING in results
    confirmed = distance_of(results[CONFIRMING], results[SEARCHING], programme)["curve"] if there else 0.0
    return found if found["curve"] <= TRUST.models and confirmed <= TRUST.confirmed else NOTHING


def sampled(result: Result) -> Curve:
    """The curve of a run, with points between its steps where the slopes are known."""
    return cubics(result, 10)


def decides(check: Check, uncertainty: float) -> bool:
    """Whether a check gives its verdict in spite of an uncertainty."""
    value, tolerance = abs(check.value), check.tolerance
    robust = uncertainty <= TRUST.certain * tolerance or value > tolerance + uncertainty
    return robust or max(value, uncertainty) <= tolerance


def held_against(scene: Scene, check: Check, proven: Proof) -> Check:
    """A check of a pair of runs; its uncertainty is the sum of their errors, plus the difference of models.

    The tolerance is not changed. Where the uncertainty exceeds ``TRUST.certain`` times the tolerance, the check is
    broken if the value exceeds tolerance plus uncertainty, holds if value and uncertainty are within the tolerance, and
    is unresolved otherwise.
    """
    pair = check.subject.split(" / ")
    errors = proven.errors(pair, check)
    models = of_check(proven.models, check) if REFERENCE in pair and MATCHED not in pair else 0.0
    tolerance, uncertainty = check.tolerance, sum(errors.values()) + models
    found = replace(check, uncertainty=uncertainty if uncertainty < inf else 0.0)
    if isnan(check.value) or decides(check, uncertainty):
        return found
    worst = max(errors, key=lambda method: errors[method])
    if models > errors[worst]:
        own = f"keeps its pairs of points, which changes the curve by {models:.2g}; with effects.search = false all do"
        return replace(found, unresolved=f"the DOLFINx reference {own}")
    who = "the DOLFINx reference" if worst == REFERENCE else METHODS[worst].label
    shown = "more layers of NURBS show" if worst == CONFIRMING else "its second mesh shows"
    size = f"has an error of up to {errors[worst]:.2g}, as {shown}, where {tolerance:g} is required"
    own = proven.why * (worst == REFERENCE) or (size if errors[worst] < inf else BEARS_LITTLE)
    along = worst == REFERENCE and "-leg-" not in check.name  # then it may be the mesh along the specimen
    larger = inf if along else errors[worst] / (TRUST.certain * tolerance)
    return replace(found, unresolved=f"{who} {own}; {remedy(scene, worst, larger)}")


def beside_models(check: Check, models: Distance) -> Check:
    """A check against the beam; unresolved where the difference of the two models, neither of which the beam has, could
    explain the deviation."""
    apart = of_check(models, check)
    if check.state != "broken" or not abs(check.value) <= check.tolerance + apart:
        return check
    why = f"NURBS with and without a search of the other face differ by {apart:.2g}, and the beam has neither"
    return replace(check, unresolved=f'{why}; effects.kinematics = "linear" has no such difference')


def distance_of(a: Result, b: Result, programme: Sequence[float], at: float | None = None) -> Distance:
    """Of the envelopes up to the largest opening, of the first leg, as the check of the stiffness, of every leg, and of
    the points near an opening, as the check of the farthest one.

    A programme that never opens the specimen has no envelope, and no peak.
    """
    one, other = sampled(a), sampled(b)
    end = min(max(programme), float(np.max(one[0])), float(np.max(other[0])))
    paths = path(one, programme), path(other, programme)
    softer = stiffness(*(found.legs[0] for found in paths))
    found = {"curve": 0.0, "peak": 0.0, "stiffness": 0.0 if isnan(softer) else abs(softer), "farthest-point": 0.0}
    if end > 0.0:
        found |= {"curve": curve_error(one, other, end, drops=True), "peak": abs(peak(one)[1] / peak(other)[1] - 1.0)}
    found |= {leg.name: abs(leg.value) for leg in programme_checks("", one, other, programme, NEGLIGIBLE)}
    whole = max(far for name, far in found.items() if name == "curve" or "-leg-" in name)
    found |= dict.fromkeys(BY_ARMS, whole)
    if at is not None:
        around = TRUST.around * max(map(abs, programme))
        worst = farthest(*paths, inf, every_point=False, near=(at - around, at + around))
        found["farthest-point"] = 0.0 if worst is None else worst.value
    return found
