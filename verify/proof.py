"""How far the DOLFINx reference can be trusted on a scene: the distance between its curves on two meshes.

The second mesh (`verify.reference_mesh`) is coarser along and finer through the thickness. The error of the reference is
taken to be no more than the whole distance to it, without an assumption on the order of convergence.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import inf

from verify.curve import Curve, curve_error, dense, peak
from verify.result import Result
from verify.verdict import Check

REFERENCE, SECOND = "dolfinx", "dolfinx-second"

#: A reference judges where its error is at most this part of the tolerance.
PROVEN = 0.5


@dataclass(frozen=True)
class Proof:
    """Error of the reference, relative: of the curve (L2 of the load over the opening) and of the peak load.

    Infinite where the reference has not come to the end of the programme on its second mesh; ``why`` says so.
    """

    curve: float
    peak: float
    why: str = ""


def proof(results: Mapping[str, Result], end: float) -> Proof:
    """The proof of the reference among the runs of a scene.

    Parameters
    ----------
    results : by name
    end : largest opening of the programme
    """
    if SECOND not in results:
        return Proof(inf, inf, "has not been solved on a second mesh")
    fine, second = results[REFERENCE], results[SECOND]
    if fine.complete and not second.complete:
        return Proof(inf, inf, "stopped on its second mesh")
    a, b = drawn(second), drawn(fine)
    end = min(end, float(max(a[0])), float(max(b[0])))
    return Proof(curve_error(a, b, end), abs(peak(a)[1] / peak(b)[1] - 1.0))


def drawn(result: Result) -> Curve:
    """The path of a run, between its steps too where their slopes are known."""
    steps = result.steps
    if {"load_slope", "heading"} <= set(steps):
        return dense(result.opening, result.load, steps["load_slope"], steps["heading"])
    return result.opening, result.load


def held_against(check: Check, uncertainty: float, why: str = "") -> Check:
    """The check with the error of the reference that its value rests on.

    The tolerance stays. Where the error is beyond `PROVEN` of it, the check is broken if the value is beyond both
    together, holds if value and error are within it, and is unresolved otherwise.
    """
    tolerance, value = check.tolerance, abs(check.value)
    found = replace(check, uncertainty=uncertainty if uncertainty < inf else 0.0)
    robust = uncertainty <= PROVEN * tolerance or value > tolerance + uncertainty
    if robust or value != value or (value <= tolerance and uncertainty <= tolerance):
        return found
    own = why or f"is off by up to {uncertainty:.2g} itself, as its second mesh shows, where {tolerance:g} is asked"
    remedy = "dolfinx.elements, dolfinx.layers or dolfinx.degree larger resolve it"
    return replace(found, unresolved=f"the DOLFINx reference {own}; {remedy}")
