"""What must hold between runs of one scene: every code against the cohesive beam, the codes against each other, and
all of them against what others have published for it.

LEFM appears in no check: it is a limit that a cohesive zone approaches, not a target.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import inf

from verify.checks import beam_error, load_introduction
from verify.checks.proof import REFERENCE, RUNS, beside_models, difference_of_models, drawn, held_against, proof
from verify.curves.curve import curve_error, first_drop, from_origin, load_at
from verify.curves.leg_checks import farthest_check, programme_checks, stiffness_check
from verify.curves.legs import path
from verify.curves.of_run import peak_load
from verify.methods import through_thickness, zone_resolution
from verify.methods.solve import prepare
from verify.result import Result
from verify.scene.published import Published
from verify.scene.schema import Scene
from verify.verdict import Check

#: The judge that shares nothing with the codes.
BEAM_RUN = "beam"
#: Distance between the curves of two codes on fine meshes.
FINE = 0.005
#: Runs of codes that are held against the reference, with their tolerances: a coarser mesh has its own.
CROSS_CODE = {
    name: max(FINE, method.mesh_error) for name, method in RUNS.items() if method.code not in (REFERENCE, BEAM_RUN)
}
#: Largest distance between curves that elements longer than a third of the process zone explain: 17 % were measured.
COARSE = 0.2
#: Part of the peak load by which a load that falls at once is that of a specimen that comes apart.
APART = 0.1


def cross_checks(scene: Scene, results: Mapping[str, Result]) -> tuple[Check, ...]:
    """Checks of every pair that is there.

    Parameters
    ----------
    results : method, or its name among several runs of one method ("dolfinx-p3") -> run
    """
    usable = {method: result for method, result in results.items() if result.load.size > 1}
    fine = beam_error.tolerance(scene)
    checks: list[Check] = []
    if BEAM_RUN in usable and fine is not None and not no_beam(scene):
        for name in (name for name in RUNS if name in usable and name != BEAM_RUN):
            check = beam_check(scene, name, usable[name], usable[BEAM_RUN], max(fine, RUNS[name].mesh_error))
            checks.append(proven(scene, check, usable))
    for method, tolerance in CROSS_CODE.items():
        if method in usable and REFERENCE in usable:
            pair = pair_checks(scene, f"{method} / {REFERENCE}", usable[method], usable[REFERENCE], tolerance)
            checks += [proven(scene, check, usable) for check in pair]
    return (*checks, *published_checks(scene, usable))


def proven(scene: Scene, check: Check, results: Mapping[str, Result]) -> Check:
    """A check of two runs, unresolved where the mesh of one of them cannot judge.

    The reference has its own error by a second mesh. A run whose elements are too long for the process zone says so
    before any work; that explains a distance of up to `COARSE`.
    """
    pair, found = check.subject.split(" / "), check
    if pair[-1] == REFERENCE:
        found = held_against(check, proof(results, max(scene.load.opening)))
    if pair[-1] == BEAM_RUN:
        found = beside_models(check, difference_of_models(results, max(scene.load.opening)))
    if found.state != "broken" or not abs(found.value) <= COARSE:
        return found
    methods = dict.fromkeys(results[name].method for name in pair if name in results)
    coarse = [
        f"{method}: {text}"
        for method in methods
        for about in (zone_resolution, through_thickness)
        for text in about.warnings(prepare(scene, method))
    ]
    return replace(found, unresolved="; ".join(coarse))


def pair_checks(scene: Scene, pair: str, a: Result, b: Result, tolerance: float) -> tuple[Check, ...]:
    """Two codes that share nothing: curve, peak, the farthest point, and every leg of a programme that turns."""
    programme = scene.load.opening
    checks: list[Check] = []
    if max(programme) > 0.0:
        error = distance(a, b, max(programme))
        meaning = "Two codes that share nothing draw the same curve (relative L2 of the load over the opening)."
        checks.append(Check("curve", pair, error, tolerance, "cross-code", meaning))
        ratio = peak_load(a) / peak_load(b) - 1
        meaning = "Two codes that share nothing find the same peak load (relative difference)."
        checks.append(Check("peak", pair, ratio, tolerance, "cross-code", meaning))
    curves = (a.opening, a.load), (b.opening, b.load)
    checks += stiffness_check(pair, drawn(a), drawn(b), programme, tolerance)
    checks += farthest_check(pair, *curves, programme, tolerance)
    return (*checks, *programme_checks(pair, *curves, programme, tolerance))


def beam_check(scene: Scene, name: str, result: Result, beam: Result, tolerance: float) -> Check:
    """A curve against the beam's, with the error of the theory itself.

    Where the beam comes apart at once, as short bonds do, the curves are compared up to there: a drop that comes a
    percent earlier on a plane specimen, whose end squeezes and turns, would count by all of its height.
    """
    meaning = (
        "The load follows that of a shear-flexible beam on the same law (relative L2 over the opening): "
        f"{beam_error.meaning(scene)}."
    )
    drops = [first_drop((run.opening, run.load), APART) for run in (beam, result)]
    value = distance(result, beam, min([max(scene.load.opening), *(drops if drops[0] < inf else ())]))
    return Check(
        "beam-curve", f"{name} / {BEAM_RUN}", value, tolerance, "analytical", meaning, beam_error.theory_error(scene)
    )


def no_beam(scene: Scene) -> str:
    """Why a beam is no judge of a scene; empty where it is one."""
    if beam_error.tolerance(scene) is None:
        error = f"{100.0 * beam_error.theory_error(scene):.2g} %"
        return f"on arms as stocky as these, on this bond, no beam is nearer than {error}"
    if scene.load.at == "node" and load_introduction.matters(scene):
        return "the corner at which the load acts gives way and comes closer to the crack, and no beam has one"
    return ""


def remarks(scene: Scene, results: Mapping[str, Result]) -> tuple[str, ...]:
    """What is not judged, and why."""
    why = no_beam(scene)
    return (f"beam: held against no code: {why}",) if why and BEAM_RUN in results else ()


def published_checks(scene: Scene, results: Mapping[str, Result]) -> tuple[Check, ...]:
    """Every run against every value that the scene carries; a load that a run did not come to is NaN, and fails."""
    checks = []
    for name, known in zip(published_names(scene), scene.published, strict=True):
        for method in (name for name in RUNS if name in results):
            value = known.deviation(published_load(known, results[method], scene.load.opening))
            checks.append(Check(name, method, value, known.tolerance, known.kind, published_meaning(known)))
    return tuple(checks)


def published_names(scene: Scene) -> tuple[str, ...]:
    """One for every value: ``published-peak``, ``published-load-4.5``; numbered from the second of a kind on."""
    plain = [
        "published-peak"
        if known.quantity == "peak"
        else f"published-load-{known.opening:g}" + (f"-leg-{known.leg}" if known.leg else "")
        for known in scene.published
    ]
    return tuple(name + (f"-{plain[: i + 1].count(name)}" if name in plain[:i] else "") for i, name in enumerate(plain))


def published_load(known: Published, result: Result, programme: Sequence[float] = ()) -> float:
    """What a run has for a published value; NaN where it did not come so far.

    ``programme`` is that of the scene, of whose legs a value may be.
    """
    if known.quantity == "peak" or known.opening is None:
        return peak_load(result)
    curve = drawn(result)
    if known.leg is None:
        return float(load_at(curve, known.opening))
    legs = path(curve, programme).legs[known.leg - 1 : known.leg]
    return float(load_at(legs[0].onward, legs[0].heading * known.opening)) if legs else float("nan")


def published_meaning(known: Published) -> str:
    """One sentence with its source."""
    low, high = known.value
    value = f"{low:g}" if low == high else f"{low:g} to {high:g}"
    what = "The peak load" if known.quantity == "peak" else f"The load at opening {known.opening:g}"
    what += f" on leg {known.leg}" if known.leg else ""
    return f"{what} is what others published, {value}: {known.source}."


def distance(a: Result, b: Result, end: float) -> float:
    """Curve error of ``a`` against ``b``, of a run that stopped early up to where both have come."""
    end = min(end, float(a.opening.max()), float(b.opening.max()))
    return curve_error(from_origin(a.opening, a.load), from_origin(b.opening, b.load), end)
