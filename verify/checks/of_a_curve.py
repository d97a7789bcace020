"""Checks of a load curve of another code: as far as it goes, and as finely as it was written down.

What a curve does not contain is not covered. Its rounding and noise are found from the curve itself, and are no error;
where they are too large for a tolerance the check is unresolved.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from verify.checks import beam_error
from verify.checks.between_codes import (
    BEAM_RUN,
    CODE_TOLERANCE,
    beam_check,
    distance,
    no_beam,
    proven,
    published_load,
    published_meaning,
    published_names,
)
from verify.checks.certified import certified_checks
from verify.checks.proof import SEARCHING, TRUST, sampled
from verify.curves.completed import Completed, completed
from verify.curves.curve import Curve, envelope, peak
from verify.curves.leg_checks import OF_A_POINT, farthest_check, programme_checks, turns_check
from verify.curves.legs import TURN_TOLERANCE, path
from verify.curves.nearness import LEAST_LOAD
from verify.curves.scatter import SIGMAS, Scatter, scatter_of
from verify.methods.names import METHODS
from verify.result import Result
from verify.scene.magnitudes import SMALLEST_NUMBER
from verify.scene.schema import Scene
from verify.support.programme import only_opens, turns
from verify.verdict import Check, Kind

#: Methods that a curve is compared with, each with the tolerance that holds between these methods, too.
HELD_AGAINST: Mapping[str, float] = {
    name: CODE_TOLERANCE for name, one in METHODS.items() if one.has_mesh and not one.mesh_error
}

#: Load, over the peak load, below which a curve counts as that of a separated specimen.
BEARS_NO_LOAD = 0.01

#: First opening of a curve, over the first leg, above which its beginning is missing.
LATE = 0.01

SQRT_2 = 2.0**0.5

#: Dissipated energy, over the largest work, up to which a bond is undamaged: rounding is far below.
UNDAMAGED = 1e-6


@dataclass(frozen=True)
class Given:
    """A curve (n,) of another code along ``goals``, the part of the load ``programme`` that it goes through.

    ``loud``: a noise, over the largest load, that is too large to count as none.
    """

    name: str
    curve: Curve
    programme: tuple[float, ...]
    goals: tuple[float, ...]
    scatter: Scatter
    loud: float = 0.0

    @property
    def first(self) -> float:
        """Its first opening, in the sense of the first leg."""
        return max(float(np.asarray(self.curve[0])[0]) * float(np.sign(self.programme[0])), 0.0)

    @property
    def whole(self) -> bool:
        """Whether it ends where the programme does."""
        return self.goals == self.programme

    @property
    def missing(self) -> float:
        """Part of the way of the programme behind its end."""
        return max(0.0, 1.0 - _way(self.goals) / _way(self.programme))

    @property
    def share(self) -> float:
        """Part of the way of the programme that it goes, in percent."""
        return 100.0 * (_way(self.goals) - self.first) / _way(self.programme)

    @property
    def scattered(self) -> str:
        """What was found of rounding and noise; empty where it is too small to matter."""
        pairs = zip(("loads", "openings"), self.scatter.halves[::-1], strict=True)
        said = [f"{name} rounded to {2.0 * float(half.max()):.3g}" for name, half in pairs if half.max() > 0.0]
        noise = self.scatter.noise / float(np.max(np.abs(self.curve[1])))
        if self.scatter.seen and SIGMAS * noise > OF_A_POINT * CODE_TOLERANCE * LEAST_LOAD:
            said.append(f"noise of {100.0 * noise:.2g} % of the peak load")
        return " and ".join(said)

    def unless_outside(self, check: Check, at: float, what: str) -> Check:
        """The check, not covered where the curve does not contain an opening of the first or the last leg."""
        if self.first <= at * (1.0 + TURN_TOLERANCE) and at <= max(self.goals) * (1.0 + TURN_TOLERANCE):
            return check
        side = f"begins at {self.first:.4g}" if self.first > at else f"ends at {max(self.goals):.4g}"
        return not_covered(check, f"the curve {side}, {what} is at {at:.4g}")


def given(scene: Scene, name: str, curve: Result, results: Mapping[str, Result]) -> Given:
    """What a curve goes through of the programme, and its scatter.

    Parameters
    ----------
    results : the runs of the scene by name; where the programme only opens they show what no scatter is
    """
    programme = _programme(scene, curve, results.values())
    goals, rows = _gone_through(curve, programme), (curve.opening, curve.load)
    judge = _guide(results) if only_opens(programme) else None
    scatter = scatter_of(rows, None if judge is None else sampled(judge))
    noise = scatter.noise / max(float(np.max(np.abs(curve.load))), SMALLEST_NUMBER)
    if noise <= CODE_TOLERANCE * (1.0 + 3.5 / np.sqrt(curve.load.size)):  # three of its own standard deviations
        return Given(name, rows, programme, goals, scatter)
    counts = 0.0 if scatter.seen else scatter.noise * CODE_TOLERANCE / noise
    return Given(name, rows, programme, goals, replace(scatter, noise=counts), noise * scatter.seen)


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
            checks += [proven(scene, check, usable) for check in _pair(mine, method, usable[method], tolerance)]
    fine = beam_error.tolerance(scene)
    if BEAM_RUN in usable and fine is not None and not no_beam(scene):
        beside, beam = _completed(mine, usable[BEAM_RUN])
        if np.max(beam.opening) > mine.first:
            check = beam_check(scene, name, _result(beside), beam, fine, mine.first)
            checks.append(proven(scene, _as_read(mine, check, _of_curve(beside)), usable))
        checks += _farthest(mine, BEAM_RUN, beam, fine, "analytical")
    return (*checks, *_stated(scene, mine, usable))


def not_covered(check: Check, why: str) -> Check:
    """The check of what a curve does not contain."""
    return replace(check, unresolved=why, covered=False)


def remark(mine: Given, checks: Sequence[Check]) -> tuple[str, ...]:
    """A sentence on what was judged of a curve, if that is not all, or has scatter."""
    said = []
    if mine.first > LATE * abs(mine.programme[0]) or not mine.whole:
        said.append(
            f"judged from the opening {mine.first:.4g} to {mine.goals[-1]:.4g}, {mine.share:.3g} % of the programme"
        )
        absent = dict.fromkeys(check.name for check in checks if check.state == "not covered")
        said += [f"not covered: {', '.join(absent)}"] if absent else []
    said += [f"{mine.scattered}, which is taken for no error"] if mine.scattered else []
    loud = (
        f"{100.0 * mine.loud:.2g} % of the peak load is more than the {100.0 * CODE_TOLERANCE:g} % that a curve may be"
    )
    said += [f"a noise of {loud} off"] if mine.loud else []
    return (f"{mine.name}: {'; '.join(said)}",) if said else ()


def in_whole(mine: Given, results: Mapping[str, Result]) -> Result:
    """The curve, completed by a run of the scene if there is one."""
    judge = _guide(results)
    return (
        Result(mine.name, {"opening": mine.curve[0], "load": mine.curve[1]})
        if judge is None
        else _result(_completed(mine, judge)[0])
    )


def _guide(results: Mapping[str, Result]) -> Result | None:
    """The run that shows the shape of a curve between its rows."""
    names = (SEARCHING, *HELD_AGAINST, BEAM_RUN)
    return next((results[name] for name in names if name in results and results[name].load.size > 1), None)


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
    """What scatter leaves in a relative L2 distance: a root mean square needs no three deviations."""
    left, load = found.left[found.given], found.load[found.given]
    return float(np.sqrt(np.mean(left**2) / max(np.mean(load**2), SMALLEST_NUMBER))) / 3.0


def _as_read(mine: Given, check: Check, left: float) -> Check:
    """A check, unresolved where what scatter ``left`` in its value decides; as `verify.checks.proof.held_against`."""
    value, tolerance = abs(check.value), check.tolerance
    robust = left <= TRUST.certain * tolerance or value > tolerance + left
    if check.unresolved or robust or (value <= tolerance and left <= tolerance):
        return check
    what = (
        mine.scattered
        or f"noise of {100.0 * mine.scatter.noise / np.max(np.abs(mine.curve[1])):.2g} % of the peak load"
    )
    return replace(
        check, unresolved=f"the curve has {what}, which leaves up to {left:.2g}; more digits or rows resolve it"
    )


def _pair(mine: Given, method: str, judge: Result, tolerance: float) -> list[Check]:
    """A curve against a run, as `between_codes.pair_checks` two runs, where the curve contains what a check is about."""
    pair, (beside, right) = f"{mine.name} / {method}", _completed(mine, judge)
    shown, of_curve, checks = _result(beside), _of_curve(beside), []
    if (end := min(max(mine.goals), float(np.max(right.opening)))) > mine.first:
        error = distance(shown, right, end, mine.first)
        meaning = "Two codes that share nothing draw the same curve (relative L2 of the load over the opening)."
        checks.append(_as_read(mine, Check("curve", pair, error, tolerance, "cross-code", meaning), of_curve))
    if max(mine.programme) > 0.0:
        at, top = peak((right.opening, right.load))
        i = int(np.argmax(np.where(beside.given, beside.load, -np.inf)))
        meaning = "Two codes that share nothing find the same peak load (relative difference)."
        found = Check("peak", pair, float(beside.load[i]) / top - 1.0, tolerance, "cross-code", meaning)
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
    """The last opening, without its sign, before energy is dissipated; of a run that does not know that, at half of its
    largest load."""
    d, P, spent = np.abs(judge.opening), np.abs(judge.load), judge.steps.get("dissipated_energy", np.full(1, np.nan))
    if np.isfinite(spent).all():
        damaged = spent > UNDAMAGED * np.max(np.abs(judge.steps["external_work"]))
    else:
        damaged = P > 0.5 * float(np.max(P))
    first = int(np.argmax(damaged)) if damaged.any() else d.size
    return float(np.max(d[:first], initial=0.0))


def _stated(scene: Scene, mine: Given, results: Mapping[str, Result]) -> list[Check]:
    """Published and certified values, on the curve that a run of the scene completes."""
    shown = in_whole(mine, results)
    checks = []
    for name, known in zip(published_names(scene), scene.published, strict=True):
        value = known.deviation(published_load(known, shown, mine.goals))
        meaning = published_meaning(known)
        checks.append(Check(name, mine.name, value, known.tolerance, known.kind, meaning, at=known.opening))
    checks += certified_checks(scene, mine.name, shown, CODE_TOLERANCE)
    judge = _guide(results)
    return [_of_part(mine, check, judge) for check in checks]


def _of_part(mine: Given, check: Check, judge: Result | None) -> Check:
    """The check of one stated value of a curve: whether that contains it, and what its scatter leaves.

    The peak may be wherever two loads that are off by their scatter exchange their order. The work before the first row
    is known where the bond is not damaged there.
    """
    sound, place = LATE * abs(mine.programme[0]), (check.at, "it")
    if judge is not None:
        beside, right = _completed(mine, judge)
        at, top = peak((right.opening, right.load))
        left, sound = float(np.max(beside.left)) / top, max(sound, _undamaged(judge))
        if check.name == "certified-peak-opening":
            left = float(np.max(np.abs(right.opening[right.load >= (1.0 - SQRT_2 * left) * top] / at - 1.0)))
        check, place = _as_read(mine, check, left), (at, "the peak") if check.at is None else place
    if check.name == "certified-work" and mine.first > sound:
        return not_covered(check, f"the curve begins at {mine.first:.4g}, and the work before is not known")
    return check if place[0] is None else mine.unless_outside(check, *place)


def _way(goals: Sequence[float]) -> float:
    return float(np.sum(np.abs(np.diff((0.0, *goals)))))


def _gone_through(curve: Result, programme: tuple[float, ...]) -> tuple[float, ...]:
    """The programme up to the last opening of a curve that only ends before it; else the whole programme."""
    corners = turns(programme)
    found = path((curve.opening, curve.load), programme)
    last, k, size = found.legs[-1], len(found.legs), max(map(abs, corners))
    end, begin = float(last.opening[-1]), (0.0, *corners)[k - 1]
    rest = curve.opening[np.flatnonzero(curve.opening == end)[-1] :]
    back = max(float(np.max(leg.heading * (leg.begin - leg.opening))) for leg in found.legs)  # beyond its beginning
    short = not found.complete and last.heading * (corners[k - 1] - end) > 0.0
    if not short or max(np.ptp(rest), back) > TURN_TOLERANCE * size:
        return programme
    here = (end,) if last.heading * (end - begin) > TURN_TOLERANCE * size else ()
    return (*corners[: k - 1], *here) or programme


def _programme(scene: Scene, curve: Result, runs: Iterable[Result]) -> tuple[float, ...]:
    """The load programme up to the separation of the specimen in a built-in run.

    A foreign curve whose load has vanished is complete, too: its last opening may be the end of the programme.
    """
    programme = scene.load.opening
    apart = [float(run.opening.max()) for run in runs if run.separated]
    side = curve.opening * curve.opening[-1] >= 0.0  # of zero: pressed faces may bear a hundred times as much
    if apart and abs(curve.load[-1]) <= BEARS_NO_LOAD * np.max(np.abs(curve.load[side])):
        apart.append(float(curve.opening.max()))
    end = min(apart, default=np.inf)
    last = next((i for i, goal in enumerate(programme) if goal > end), None)
    return tuple(programme) if last is None else (*programme[:last], end)
