"""Checks between the runs of one scene: codes against the cohesive beam, codes against each other, and all runs
against published and certified values.

LEFM appears in no check: it is a limit that a cohesive zone approaches, not a target.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import inf

import numpy as np

from verify.checks import orders
from verify.checks.certified import certified_checks
from verify.checks.mechanics.unresolved import far_end_beside_beam, too_coarse_for_a_curve
from verify.checks.orders import BEAM_RUN
from verify.checks.proof import (
    BY_ARMS,
    REFERENCE,
    RUNS,
    Proof,
    beside_models,
    difference_of_models,
    held_against,
    proof,
    sampled,
)
from verify.curves.curve import curve_error, from_origin, load_at
from verify.curves.leg_checks import farthest_check, programme_checks, stiffness_check
from verify.curves.legs import path
from verify.curves.of_run import onward, peak_load
from verify.methods.solve import prepare
from verify.result import Result
from verify.scene.schema import Scene, bend
from verify.scene.stated.published import Published
from verify.verdict import Check

#: Tolerance for the distance between the curves of two codes on fine meshes.
CODE_TOLERANCE = 0.005
#: Tolerance of every run that is compared with the DOLFINx reference; runs on coarse meshes have a larger one.
CROSS_CODE = {
    name: max(CODE_TOLERANCE, method.mesh_error)
    for name, method in RUNS.items()
    if method.code not in (REFERENCE, BEAM_RUN)
}
#: Allowed of the reference beside the error that it knows, and the same over the error that a scene allows its steps.
A_THOUSANDTH, OF_BEND = 0.001, 0.2


def cross_checks(scene: Scene, results: Mapping[str, Result]) -> tuple[Check, ...]:
    """Checks of all pairs of runs.

    Parameters
    ----------
    results : runs by name: the method, or a name such as "dolfinx-p3" where a method has several runs
    """
    usable = {method: result for method, result in results.items() if result.load.size > 1}
    checks: list[Check] = []
    known = proof(usable, scene.load.opening)
    for judge in orders.judges(scene, usable):
        for name in (name for name in RUNS if name in usable and RUNS[name].code != BEAM_RUN):
            check = orders.held(judge, name, usable[name], allowed(name, known, scene), scene.load.opening)
            checks.append(proven(scene, check, usable, known))
    for method, tolerance in CROSS_CODE.items():
        if method in usable and REFERENCE in usable:
            pair = pair_checks(scene, f"{method} / {REFERENCE}", usable[method], usable[REFERENCE], tolerance)
            checks += [proven(scene, check, usable, known) for check in pair]
    return (*checks, *published_checks(scene, usable), *_certified(scene, usable))


def allowed(name: str, known: Proof, scene: Scene) -> float:
    """Distance of a right run from the right curve: of the reference the error that its second mesh shows, with what
    its steps may be off; at most, and of other runs, what two codes are asked for."""
    if name != REFERENCE:
        return CROSS_CODE.get(name, CODE_TOLERANCE)
    of_steps = max(A_THOUSANDTH, OF_BEND * bend(scene))
    return min(of_steps + known.error.get(BY_ARMS[0], known.error["curve"]), CODE_TOLERANCE)


def _certified(scene: Scene, results: Mapping[str, Result]) -> tuple[Check, ...]:
    """Every run against the certified values, each with the tolerance that its curve has against the other codes."""
    allowed = {REFERENCE: CODE_TOLERANCE, **CROSS_CODE}
    allowed |= {judge.run: CODE_TOLERANCE + judge.error for judge in orders.judges(scene, results)}
    found = [
        one
        for name, run in results.items()
        if name in allowed
        for one in certified_checks(scene, name, run, allowed[name], results.get(orders.NEXT_ORDER.get(name, "")))
    ]
    return tuple(proven(scene, one, results) for one in found)


def proven(scene: Scene, check: Check, results: Mapping[str, Result], known: Proof | None = None) -> Check:
    """The check of one run or of a pair, marked unresolved where a mesh is too coarse for a verdict.

    The errors of the runs of a pair are known from their second meshes (``known``), that of a far end which takes part
    from the beam (see `unresolved.far_end_beside_beam`). Elements that are too long for the process zone, or too few
    through the thickness, which every run warns of, explain as much as `unresolved.too_coarse_for_a_curve` says.
    """
    pair, found = check.subject.split(" / "), check
    judged_by_arms = pair[1:] in ([BEAM_RUN], [orders.ARMS])
    if len(pair) == 2 and pair[1] in RUNS and not judged_by_arms:
        there = known if known and check.at is None else proof(results, scene.load.opening, check.at)
        found = held_against(scene, check, there)
    if judged_by_arms:
        found = beside_models(check, difference_of_models(results, scene.load.opening, check.at))
        asked = scene.discretization.accuracy
        if known and found.state == "broken" and max(known.errors(pair, check).values(), default=inf) <= asked:
            found = held_against(scene, found, known)  # its mesh was chosen for an error as large
        if found.state == "broken" and pair[0] in results:  # unless the mesh at the far end explains the distance
            prepared = prepare(scene, results[pair[0]].method)
            found = replace(found, unresolved=far_end_beside_beam(prepared, results[pair[1]], check))
    if found.state != "broken":
        return found
    methods = dict.fromkeys(results[name].method for name in pair if name in results)
    return replace(found, unresolved=too_coarse_for_a_curve([prepare(scene, method) for method in methods], found))


def agreement(name: str, pair: str, value: float, tolerance: float) -> Check:
    """The check of two curves as a whole."""
    what = {
        "curve": "draw the same curve (relative L2 of the load over the opening)",
        "peak": "find the same peak load (relative difference)",
    }
    return Check(name, pair, value, tolerance, "cross-code", f"Two codes that share nothing {what[name]}.")


def pair_checks(scene: Scene, pair: str, a: Result, b: Result, tolerance: float) -> tuple[Check, ...]:
    """Two codes against each other: curve, peak load, largest distance, and each leg of a programme with reversals."""
    programme = scene.load.opening
    checks: list[Check] = []
    if max(programme) > 0.0:
        error = distance(a, b, max(programme))
        checks.append(agreement("curve", pair, error, tolerance))
        ratio = peak_load(a) / peak_load(b) - 1
        checks.append(agreement("peak", pair, ratio, tolerance))
    curves = sampled(a), sampled(b)
    checks += stiffness_check(pair, *curves, programme, tolerance)
    checks += farthest_check(pair, *curves, programme, tolerance)
    return (*checks, *programme_checks(pair, *curves, programme, tolerance))


def published_checks(scene: Scene, results: Mapping[str, Result]) -> tuple[Check, ...]:
    """Every run against every published value of the scene; NaN, which fails, where a run ended before that opening.

    The tolerance is that of the value, and at least the discretisation error of the method. A mesh that does not
    resolve the process zone gives no verdict (see `proven`).
    """
    checks = []
    for name, known in zip(published_names(scene), scene.published, strict=True):
        for method in (name for name in RUNS if name in results):
            value = known.deviation(published_load(known, results[method], scene.load.opening))
            allowed = max(known.tolerance, RUNS[method].mesh_error)
            check = Check(name, method, value, allowed, known.kind, published_meaning(known))
            checks.append(proven(scene, check, results))
    return tuple(checks)


def published_names(scene: Scene) -> tuple[str, ...]:
    """Names of the checks: ``published-peak``, ``published-load-4.5``; a second value of one name gets a number."""
    plain = [
        "published-peak"
        if known.quantity == "peak"
        else f"published-load-{known.opening:g}" + (f"-leg-{known.leg}" if known.leg else "")
        for known in scene.published
    ]
    return tuple(name + (f"-{plain[: i + 1].count(name)}" if name in plain[:i] else "") for i, name in enumerate(plain))


def published_load(known: Published, result: Result, programme: Sequence[float] = ()) -> float:
    """The load of a run that a published value is compared with; NaN where the run ended before.

    ``programme`` is the load programme of the scene; a value may belong to one of its legs.
    """
    if known.quantity == "peak" or known.opening is None:
        return peak_load(result)
    curve = sampled(result)
    if known.leg is None:
        return float(load_at(curve, known.opening))
    legs = path(curve, programme).legs[known.leg - 1 : known.leg]
    return float(load_at(legs[0].onward, legs[0].heading * known.opening)) if legs else float("nan")


def published_meaning(known: Published) -> str:
    """The published value and its source in a sentence."""
    low, high = known.value
    value = f"{low:g}" if low == high else f"{low:g} to {high:g}"
    what = "The peak load" if known.quantity == "peak" else f"The load at opening {known.opening:g}"
    what += f" on leg {known.leg}" if known.leg else ""
    return f"{what} is what others published, {value}: {known.source}."


def distance(a: Result, b: Result, end: float, begin: float = 0.0) -> float:
    """Distance of the curve of ``a`` from that of ``b``, from the opening ``begin`` up to the largest opening that both
    runs reached; a specimen that has separated bears no load up to the end."""
    one, other = (onward(sampled(run), end if run.separated else 0.0) for run in (a, b))
    end = min(end, float(np.max(one[0])), float(np.max(other[0])))
    return curve_error(from_origin(*one), from_origin(*other), end, begin, drops=True)
