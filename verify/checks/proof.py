"""Accuracy of the DOLFINx reference on a scene: its discretisation error, and the difference between the models.

The error is estimated by the distance of its curves on two meshes. The second mesh (`verify.methods.reference_mesh`) is
coarser along the specimen and finer through the thickness; no order of convergence is assumed.

The reference keeps the initial pairs of interface points and measures gaps along the undeformed normal. Codes that
project points onto the deformed face use another model. The two models differ where the arms rotate notably over a
process zone. Their difference is taken from two runs with NURBS on a DCB, one with each model.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf, isnan

import numpy as np

from verify.curves.curve import Curve, peak
from verify.curves.leg_checks import stiffness
from verify.curves.legs import path
from verify.curves.nearness import apart
from verify.curves.of_run import cubics
from verify.curves.scatter.farthest import farthest
from verify.methods.names import METHODS
from verify.result import Result
from verify.verdict import Check

#: Names of runs: the reference, the reference on its second mesh, NURBS with projection, NURBS with fixed pairs.
REFERENCE, SECOND, SEARCHING, MATCHED = "dolfinx", "dolfinx-second", "nurbs", "nurbs-matched"

#: Further runs of a method on meshes that are fine enough for checks between codes.
VARIANTS = {"tspline-adaptive": "tspline", MATCHED: SEARCHING, "dolfinx-p3": REFERENCE}
#: The method of every run that takes part in checks between codes, by the name of the run.
RUNS = {
    name: method
    for method in METHODS.values()
    for name in (method.name, *(variant for variant, of in VARIANTS.items() if of == method.name))
    if not method.is_limit
}

#: Methods that are limits and take part in no check between codes.
LIMIT_METHODS = {name for name, method in METHODS.items() if method.is_limit}

#: Said of the reference where its error is infinite though it completed its programme.
BEARS_LITTLE = "bears too little load on its second mesh to be compared with itself"

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


@dataclass(frozen=True)
class Distance:
    """Relative distances of two curves: L2 of the load over the opening, peak load, stiffness before the peak, and the
    farthest point near the opening of a check."""

    curve: float
    peak: float
    stiffness: float
    point: float = 0.0

    def of(self, check: Check) -> float:
        """The distance that a check is about."""
        known = {"peak": self.peak, "stiffness": self.stiffness, "farthest-point": self.point}
        return known.get(check.name, self.curve)


@dataclass(frozen=True)
class Proof:
    """Discretisation error of the reference, and difference of the models, which is 0 where they coincide.

    The error is infinite where the reference was not run, or did not complete its programme, on the second mesh, as
    ``why`` says, or where it bears too little load there.
    """

    error: Distance
    models: Distance
    why: str = ""


def proof(results: Mapping[str, Result], programme: Sequence[float], at: float | None = None) -> Proof:
    """The accuracy of the reference from the runs of a scene.

    Parameters
    ----------
    results : by name
    programme : openings at which the load turns, and the last one
    at : opening near which points are compared as well
    """
    models, unknown = difference_of_models(results, programme, at), Distance(inf, inf, inf, inf)
    if SECOND not in results:
        return Proof(unknown, models, "has not been solved on a second mesh")
    if results[REFERENCE].complete and not results[SECOND].complete:
        return Proof(unknown, models, "stopped on its second mesh")
    return Proof(distance_of(results[SECOND], results[REFERENCE], programme, at), models)


def difference_of_models(
    results: Mapping[str, Result], programme: Sequence[float], at: float | None = None
) -> Distance:
    """Distance between NURBS with fixed pairs and with projection; 0 where it is implausible or not confirmed.

    A fault of the projection must not pass for a difference of the models: where T-splines were run, they must have the
    same curve.
    """
    same = Distance(0.0, 0.0, 0.0)
    if MATCHED not in results or SEARCHING not in results:
        return same
    found = distance_of(results[MATCHED], results[SEARCHING], programme, at)
    if (
        CONFIRMING in results
        and distance_of(results[CONFIRMING], results[SEARCHING], programme).curve > TRUST.confirmed
    ):
        return same
    return found if found.curve <= TRUST.models else same


def sampled(result: Result) -> Curve:
    """The curve of a run, with points between its steps where the slopes are known."""
    return cubics(result, 10)


def held_against(check: Check, known: Proof) -> Check:
    """A check against the reference; its uncertainty is the error of the reference plus the difference of models.

    The tolerance is not changed. Where the uncertainty exceeds ``TRUST.certain`` times the tolerance, the check is
    broken if the value exceeds tolerance plus uncertainty, holds if value and uncertainty are within the tolerance, and
    is unresolved otherwise.
    """
    matched = check.subject.startswith(MATCHED)
    error, models = known.error.of(check), 0.0 if matched else known.models.of(check)
    tolerance, value, uncertainty = check.tolerance, abs(check.value), error + models
    found = replace(check, uncertainty=uncertainty if uncertainty < inf else 0.0)
    robust = uncertainty <= TRUST.certain * tolerance or value > tolerance + uncertainty
    if robust or value != value or (value <= tolerance and uncertainty <= tolerance):
        return found
    if models > error:
        own = f"keeps its pairs of points, which changes the curve by {models:.2g}; with effects.search = false all do"
        return replace(found, unresolved=f"the DOLFINx reference {own}")
    size = f"has an error of up to {error:.2g}, as its second mesh shows, where {tolerance:g} is required"
    own = known.why or (size if error < inf else BEARS_LITTLE)
    remedy = "larger dolfinx.elements, dolfinx.layers or dolfinx.degree resolve it"
    return replace(found, unresolved=f"the DOLFINx reference {own}; {remedy}")


def beside_models(check: Check, models: Distance) -> Check:
    """A check against the beam; unresolved where the difference of the two models, neither of which the beam has, could
    explain the deviation."""
    apart = models.of(check)
    if check.state != "broken" or not abs(check.value) <= check.tolerance + apart:
        return check
    why = f"NURBS with and without a search of the other face differ by {apart:.2g}, and the beam has neither"
    return replace(check, unresolved=f'{why}; effects.kinematics = "linear" has no such difference')


def distance_of(a: Result, b: Result, programme: Sequence[float], at: float | None = None) -> Distance:
    """Of the envelopes up to the largest opening, of the first leg, as the check of the stiffness, and of the points
    near an opening, as the check of the farthest one."""
    one, other = sampled(a), sampled(b)
    end = min(max(programme), float(np.max(one[0])), float(np.max(other[0])))
    paths = path(one, programme), path(other, programme)
    softer = stiffness(*(found.legs[0] for found in paths))
    distance = apart(one, other, end), abs(peak(one)[1] / peak(other)[1] - 1.0)
    around = TRUST.around * max(map(abs, programme))
    worst = None if at is None else farthest(*paths, inf, judged=False, near=(at - around, at + around))
    return Distance(*distance, 0.0 if isnan(softer) else abs(softer), 0.0 if worst is None else worst.value)
