"""How far the DOLFINx reference can be trusted on a scene: its error, and the difference between its model and others.

The error is that between its curves on two meshes. The second mesh (`verify.methods.reference_mesh`) is coarser along
and finer through the thickness; the error is taken to be the whole distance, without an assumption on the order of
convergence.

The reference keeps the pairs of points that faced each other at first, and measures gaps along the first normal. Codes
that look for the other face differ where arms turn much over a process zone. NURBS on a dcb are solved in both ways.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import inf

import numpy as np

from verify.curves.curve import Curve, curve_error, dense, peak
from verify.curves.leg_checks import stiffness
from verify.curves.legs import path
from verify.methods.names import METHODS
from verify.result import Result
from verify.verdict import Check

#: Names of runs: the reference, the same on its second mesh, NURBS, and NURBS with the pairs of points kept.
REFERENCE, SECOND, SEARCHING, MATCHED = "dolfinx", "dolfinx-second", "nurbs", "nurbs-matched"

#: Runs on meshes as fine as a method's own, by the method. Coarser runs are held against none.
VARIANTS = {"tspline-adaptive": "tspline", MATCHED: SEARCHING, "dolfinx-p3": REFERENCE}
#: The methods of all runs that are held against others, by the names of the runs.
RUNS = {
    name: method
    for method in METHODS.values()
    for name in (method.name, *(variant for variant, of in VARIANTS.items() if of == method.name))
    if not method.is_limit
}

#: Runs that are held against none.
LIMIT_METHODS = {name for name, method in METHODS.items() if method.is_limit}

#: Another basis that searches, and the distance to NURBS within which it confirms these.
CONFIRMING, CONFIRMED = "tspline", 0.005
#: Largest difference of models that is taken for one: 0.0 to 0.7 % were measured on most of 60 random scenes, 2.0 % on
#: stocky arms with a soft bond whose ends turn by 23 degrees.
MOST_OF_MODELS = 0.03

#: A reference judges where its error is at most this part of the tolerance.
PROVEN = 0.5


@dataclass(frozen=True)
class Distance:
    """Of two curves, relative: L2 of the load over the opening, of the peak loads, of the stiffness before the peak."""

    curve: float
    peak: float
    stiffness: float

    def of(self, check: Check) -> float:
        """The one that a check is about."""
        return {"peak": self.peak, "stiffness": self.stiffness}.get(check.name, self.curve)


@dataclass(frozen=True)
class Proof:
    """Error of the reference, and difference of the models; zero where both models are one.

    The error is infinite where the reference has not come to the end on its second mesh; ``why`` says so.
    """

    error: Distance
    models: Distance
    why: str = ""


def proof(results: Mapping[str, Result], end: float) -> Proof:
    """The proof of the reference among the runs of a scene.

    Parameters
    ----------
    results : by name
    end : largest opening of the programme
    """
    models = difference_of_models(results, end)
    if SECOND not in results:
        return Proof(Distance(inf, inf, inf), models, "has not been solved on a second mesh")
    if results[REFERENCE].complete and not results[SECOND].complete:
        return Proof(Distance(inf, inf, inf), models, "stopped on its second mesh")
    return Proof(_apart(results[SECOND], results[REFERENCE], end), models)


def difference_of_models(results: Mapping[str, Result], end: float) -> Distance:
    """What the search changes in NURBS; nothing where another basis does not confirm it, or it is beyond all reason.

    A difference of models must not excuse a fault of the search: T-splines, where they are there, find the same curve.
    """
    same = Distance(0.0, 0.0, 0.0)
    if MATCHED not in results or SEARCHING not in results:
        return same
    found = _apart(results[MATCHED], results[SEARCHING], end)
    if CONFIRMING in results and _apart(results[CONFIRMING], results[SEARCHING], end).curve > CONFIRMED:
        return same
    return found if found.curve <= MOST_OF_MODELS else same


def drawn(result: Result) -> Curve:
    """The path of a run, between its steps too where their slopes are known."""
    steps = result.steps
    if {"load_slope", "heading"} <= set(steps):
        return dense(result.opening, result.load, steps["load_slope"], steps["heading"])
    return result.opening, result.load


def held_against(check: Check, known: Proof) -> Check:
    """A check against the reference, with the error of that and the difference of models as its uncertainty.

    The tolerance stays. Where the uncertainty is beyond `PROVEN` of it, the check is broken if the value is beyond both
    together, holds if value and uncertainty are within it, and is unresolved otherwise.
    """
    matched = check.subject.startswith(MATCHED)
    error, models = known.error.of(check), 0.0 if matched else known.models.of(check)
    tolerance, value, uncertainty = check.tolerance, abs(check.value), error + models
    found = replace(check, uncertainty=uncertainty if uncertainty < inf else 0.0)
    robust = uncertainty <= PROVEN * tolerance or value > tolerance + uncertainty
    if robust or value != value or (value <= tolerance and uncertainty <= tolerance):
        return found
    if models > error:
        own = f"keeps its pairs of points: a difference of models of {models:.2g}; effects.search = false has the same"
        return replace(found, unresolved=f"the DOLFINx reference {own}")
    own = known.why or f"is off by up to {error:.2g} itself, as its second mesh shows, where {tolerance:g} is asked"
    remedy = "dolfinx.elements, dolfinx.layers or dolfinx.degree larger resolve it"
    return replace(found, unresolved=f"the DOLFINx reference {own}; {remedy}")


def beside_models(check: Check, models: Distance) -> Check:
    """A check against the beam, which knows one normal of the bond: unresolved as far as another choice explains it."""
    apart = models.of(check)
    if check.state != "broken" or not abs(check.value) <= check.tolerance + apart:
        return check
    why = f"NURBS with a search of the other face and without differ by {apart:.2g}, and the beam has neither model"
    return replace(check, unresolved=f'{why}; effects.kinematics = "linear" has no such difference')


def _apart(a: Result, b: Result, end: float) -> Distance:
    one, other = drawn(a), drawn(b)
    end = min(end, float(np.max(one[0])), float(np.max(other[0])))
    softer = stiffness(*(path(curve, (end,)).legs[0] for curve in (one, other)))
    return Distance(curve_error(one, other, end), abs(peak(one)[1] / peak(other)[1] - 1.0), abs(np.nan_to_num(softer)))
