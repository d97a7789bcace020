"""Checks of a load curve of another code: as far as it goes, and as finely as it was written down.

What a curve does not contain is not covered. Its rounding and noise are found from the curve itself, and are no error;
where they are too large for a tolerance the check is unresolved.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from verify.checks import orders
from verify.checks.between_codes import (
    CODE_TOLERANCE,
    agreement,
    distance,
    proven,
    published_load,
    published_meaning,
    published_names,
)
from verify.checks.certified import certified_checks
from verify.checks.foreign.given import HELD_AGAINST, LATE, Given, given, guide, not_covered
from verify.checks.proof import CONFIRMING, SEARCHING, decides, distance_of, of_check, sampled
from verify.curves.curve import envelope, peak
from verify.curves.leg_checks import farthest_check, programme_checks, turns_check
from verify.curves.legs import TURN_TOLERANCE, path
from verify.curves.scatter import Completed, completed
from verify.result import Result
from verify.scene.magnitudes import SMALLEST_NUMBER
from verify.scene.schema import Scene
from verify.support.programme import only_opens
from verify.verdict import Check, Kind

SQRT_2 = 2.0**0.5


def checks_of(scene: Scene, name: str, curve: Result, results: Mapping[str, Result]) -> tuple[Check, ...]:
    """A foreign curve against the isogeometric codes, DOLFINx, the beam, published and certified values.

    Parameters
    ----------
    results : the runs of the scene by name
    """
    if curve.load.size < 2:
        return ()
    usable = {method: result for method, result in results.items() if result.load.size > 1}
    mine = given(scene, name, curve, usable)
    meaning = "The curve goes as far as the load programme does (missing part of its way)."
    end = Check("end", name, mine.missing, TURN_TOLERANCE, "cross-code", meaning)
    checks = [end if end.passed else not_covered(end, f"the curve ends at the opening {mine.goals[-1]:.6g}")]
    if not only_opens(mine.goals):
        checks.append(turns_check(name, path(mine.curve, mine.goals)))
    for method, tolerance in HELD_AGAINST.items():
        if method in usable:
            pair = (_beside_its_like(scene, check, usable) for check in _pair(mine, method, usable[method], tolerance))
            checks += [proven(scene, check, usable) for check in pair]
    for arms in orders.judges(scene, usable):
        beside, judge = _completed(mine, arms.result)
        if np.max(judge.opening) > mine.first:
            tolerance = CODE_TOLERANCE + arms.error
            value = distance(_result(beside), judge, max(scene.load.opening), mine.first)
            check = Check(arms.check, f"{name} / {arms.run}", value, tolerance, "analytical", arms.meaning, arms.error)
            checks.append(proven(scene, _as_read(mine, check, _of_curve(beside)), usable))
            checks += _farthest(mine, arms.run, judge, tolerance, "analytical")
    return (*checks, *_stated(scene, mine, usable))


def in_whole(mine: Given, results: Mapping[str, Result]) -> Result:
    """The curve, completed by a run of the scene if there is one."""
    judge = guide(results)
    return (
        Result(mine.name, {"opening": mine.curve[0], "load": mine.curve[1]})
        if judge is None
        else _result(_completed(mine, judge)[0])
    )


def _completed(mine: Given, judge: Result) -> tuple[Completed, Result]:
    """The curve completed by a judge, and the judge with the points between its steps."""
    d, P = (np.asarray(values) for values in sampled(judge))
    near = CODE_TOLERANCE * float(np.max(np.abs(P)))
    return completed(mine.curve, (d, P), mine.goals, mine.scatter, near), replace(
        judge, steps={"opening": d, "load": P}
    )


def _result(found: Completed) -> Result:
    return Result("", {"opening": found.opening, "load": found.load})


def _of_curve(found: Completed) -> float:
    """What scatter leaves in a relative L2 distance."""
    spread, load = found.spread[found.given], found.load[found.given]
    return float(np.sqrt(np.mean(spread**2) / max(np.mean(load**2), SMALLEST_NUMBER)))


def _as_read(mine: Given, check: Check, left: float) -> Check:
    """A check, unresolved where what scatter ``left`` in its value decides."""
    if check.unresolved or decides(check, left):
        return check
    what = mine.scattered or "a scatter of its rows"
    why = f"the curve has {what}, which leaves up to {left:.2g}; more digits or rows resolve it"
    return replace(check, unresolved=why)


def _beside_its_like(scene: Scene, check: Check, results: Mapping[str, Result]) -> Check:
    """A check against NURBS or T-splines, whose own error is not known: their distance from the other one, on another
    mesh, is its uncertainty."""
    method = check.subject.partition(" / ")[2]
    other = {SEARCHING: CONFIRMING, CONFIRMING: SEARCHING}.get(method, "")
    if check.state != "broken" or not {method, other} <= results.keys():
        return check
    apart = of_check(distance_of(results[other], results[method], scene.load.opening, check.at), check)
    why = f"{method} is {apart:.2g} from {other}, on another mesh; a larger discretization.dofs resolves it"
    return check if decides(check, apart) else replace(check, unresolved=why)


def _pair(mine: Given, method: str, judge: Result, tolerance: float) -> list[Check]:
    """A curve against a run, as `between_codes.pair_checks` two runs, as far as the curve goes."""
    pair, (beside, right) = f"{mine.name} / {method}", _completed(mine, judge)
    shown, of_curve, checks = _result(beside), _of_curve(beside), []
    if (end := min(max(mine.goals), float(np.max(right.opening)))) > mine.first:
        error = distance(shown, right, end, mine.first)
        checks.append(_as_read(mine, agreement("curve", pair, error, tolerance), of_curve))
    if max(mine.programme) > 0.0:
        at, top = peak((right.opening, right.load))
        i = int(np.argmax(np.where(beside.given, beside.load, -np.inf)))
        tops = [float(beside.load[i])]
        if not mine.scatter.noise:  # teeth of both would add up at the peak of a curve whose rows show its own
            tops.append(float(np.max(mine.curve[1])))
        found = agreement("peak", pair, min((found / top - 1.0 for found in tops), key=abs), tolerance)
        checks.append(mine.unless_outside(_as_read(mine, found, float(beside.left[i]) / top), at, "the peak"))
    checks += _stiffness(mine, pair, judge, tolerance)
    checks += _farthest(mine, method, right, tolerance)
    curves = (shown.opening, shown.load), (right.opening, right.load)
    single = 2.0 * float(np.max(beside.left)) / float(np.max(np.abs(right.load)))
    legs = programme_checks(pair, *curves, mine.goals, tolerance)
    return [*checks, *(_as_read(mine, leg, of_curve if leg.name.startswith("curve") else single) for leg in legs)]


def _farthest(
    mine: Given, method: str, judge: Result, tolerance: float, kind: Kind = "cross-code"
) -> tuple[Check, ...]:
    """Of the rows as they are."""
    right = (judge.opening, judge.load)
    return farthest_check(f"{mine.name} / {method}", mine.curve, right, mine.goals, tolerance, kind, mine.scatter)


def _stiffness(mine: Given, pair: str, judge: Result, tolerance: float) -> list[Check]:
    """The secant stiffness of the first leg up to half of the largest load: the factor of the judge's loads that leaves
    least squares. Not covered without a row before the first damage; nothing where the judge bears no load."""
    one, other = (path(curve, mine.goals).legs[0] for curve in (mine.curve, sampled(judge)))
    (d, P), (at, load) = one.onward, envelope(*other.onward)
    right, sound = other.heading * np.interp(d, at, load), _undamaged(judge)
    half_load = float(at[np.argmax(np.abs(load) >= 0.5 * np.max(np.abs(load)))])
    rows = (d > 0.0) & (d >= mine.first) & (d <= max(sound, half_load))
    meaning = "The secant stiffness up to half the largest load of the first leg (relative difference, least squares)."
    check = Check("stiffness", pair, np.nan, tolerance, "cross-code", meaning)
    if not (rows & (d <= sound)).any():
        why = f"no row of the curve is before the first damage, at the opening {sound:.4g}"
        return [not_covered(check, why)]
    d, P, right = d[rows], one.heading * P[rows], right[rows]
    if not (size := float(np.sum(right**2))) > 0.0:
        return []
    half = mine.scatter.half(d, P)
    spread = mine.scatter.noise**2 + (half[1] ** 2 + (right / d * half[0]) ** 2) / 3.0
    left = 3.0 * float(np.sqrt(np.sum(spread * right**2))) / size
    return [_as_read(mine, replace(check, value=float(np.sum(P * right)) / size - 1.0), left)]


def _undamaged(judge: Result) -> float:
    """The first opening, without its sign, at which `CODE_TOLERANCE` of the work is dissipated, as much as the secant
    stiffness falls. Of a run that does not know its energies, the opening at half of its largest load."""
    d, P = np.abs(judge.opening), np.abs(judge.load)
    spent, work = (judge.steps.get(name, np.full(1, np.nan)) for name in ("dissipated_energy", "external_work"))
    known = np.isfinite(spent).all() and np.isfinite(work).all()
    over = spent - CODE_TOLERANCE * work if known else P - 0.5 * np.max(P)
    if not np.any(over > 0.0):
        return float(np.max(d))
    i = max(int(np.argmax(over > 0.0)), 1)
    return float(d[i - 1] + (d[i] - d[i - 1]) * over[i - 1] / (over[i - 1] - over[i]))


def _stated(scene: Scene, mine: Given, results: Mapping[str, Result]) -> list[Check]:
    """Published and certified values, on the curve that a run of the scene completes."""
    shown = in_whole(mine, results)
    checks = []
    for name, known in zip(published_names(scene), scene.published, strict=True):
        value = known.deviation(published_load(known, shown, mine.goals))
        meaning = published_meaning(known)
        checks.append(Check(name, mine.name, value, known.tolerance, known.kind, meaning, at=known.opening))
    checks += certified_checks(scene, mine.name, shown, CODE_TOLERANCE)
    judge = guide(results)
    return [_of_part(mine, check, judge) for check in checks]


def _of_part(mine: Given, check: Check, judge: Result | None) -> Check:
    """The check of one stated value of a curve: whether that contains it, and what its scatter leaves.

    The peak may be wherever two loads that are off by their scatter exchange their order. The work before the first row
    is known where the bond is not damaged there.
    """
    sound, what, place = LATE * abs(mine.programme[0]), "it", check.at
    if judge is not None:
        beside, right = _completed(mine, judge)
        at, top = peak((right.opening, right.load))
        left, sound = float(np.max(beside.left)) / top, max(sound, _undamaged(judge))
        if check.name == "certified-peak-opening":
            left = float(np.max(np.abs(right.opening[right.load >= (1.0 - SQRT_2 * left) * top] / at - 1.0)))
        check = _as_read(mine, check, left)
        what, place = ("the peak", at) if place is None else (what, place)
    if check.name == "certified-work" and mine.first > sound:
        return not_covered(check, f"the curve begins at {mine.first:.4g}, and the work before is not known")
    return check if place is None else mine.unless_outside(check, place, what)
