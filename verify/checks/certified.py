"""Every run against the certified values of its scene (`verify.scene.stated.certified`)."""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot, isfinite, nan

import numpy as np

from verify.checks.proof import MATCHED, RUNS, sampled
from verify.curves.curve import SAMPLES, envelope, from_origin, load_at
from verify.curves.of_run import peak_load, peak_point
from verify.result import Result
from verify.scene.schema import Scene
from verify.scene.stated.certified import Certified, CertifiedKind, certified
from verify.verdict import Check


@dataclass(frozen=True)
class CertifiedRule:
    """Definition of certified quantities, and how near a run must be.

    whole : a curve that ends before an opening is used for it if it has reached this part of it
    gone : a load up to this part of the peak load counts as none: the work of such a run is complete wherever it ends
    zone : part of the programme after which the length of the process zone is averaged: its length at one opening
        depends on the few points where the front is
    peak_opening, zone_length : tolerance relative to that of a load curve. A peak is flat: 0.5 % of its load are 5 %
        and more of its opening. The ends of a zone are known to a part of an element only
    """

    whole: float = 0.999
    gone: float = 0.01
    zone: float = 0.5
    peak_opening: float = 4.0
    zone_length: float = 10.0

    def wider(self, kind: CertifiedKind) -> float:
        """Tolerance of a quantity relative to that of a load curve."""
        return {"peak_opening": self.peak_opening, "zone": self.zone_length}.get(kind, 1.0)


CERTIFIED_RULE = CertifiedRule()

#: Columns of a run that knows its process zone.
OF_THE_FRONT = {"crack_length", "damage_front"}


def measured(result: Result, kind: CertifiedKind, opening: float | None = None) -> float:
    """The quantity of a run in the units of the scene; NaN where it has none.

    peak : largest load; peak_opening : opening at the largest load
    load_at : load when the opening is reached for the first time
    work : work of the load up to an opening, along the curve that a test under displacement control shows
    zone : length between damage_front and crack_length, mean over the last half of the programme
    """
    if result.load.size < 2:
        return nan
    if kind == "peak":
        return peak_load(result)
    if kind == "peak_opening":
        return peak_point(result)[0]
    assert opening is not None
    if kind == "load_at":
        return _load(result, opening)
    return _work(result, opening) if kind == "work" else _zone(result, opening)


def _load(result: Result, opening: float) -> float:
    """Load at an opening, or at the last opening of a curve that ends just before it."""
    d, P = from_origin(*sampled(result))
    last = float(np.max(d))
    return float(load_at((d, P), last if CERTIFIED_RULE.whole * opening <= last < opening else opening))


def _work(result: Result, end: float) -> float:
    d, P = envelope(*from_origin(*sampled(result)))
    bears = abs(result.load[-1]) > CERTIFIED_RULE.gone * float(np.max(np.abs(result.load)))
    if bears and d[-1] < CERTIFIED_RULE.whole * end:
        return nan
    kept = d < end
    last = [load_at((d, P), end)] if d[-1] >= end else []
    return float(np.trapezoid(np.append(P[kept], last), np.append(d[kept], end if last else [])))


def _zone(result: Result, end: float) -> float:
    """Mean length of the process zone in the window; NaN where the crack has not grown before the window, or where the
    front stands still in it, as it does at the far end."""
    steps, d = result.steps, result.opening
    if not steps.keys() >= OF_THE_FRONT or d[-1] < CERTIFIED_RULE.whole * end:
        return nan
    tip, front = steps["crack_length"], steps["damage_front"]
    within = d >= CERTIFIED_RULE.zone * end
    if tip[within][0] <= tip[1] or np.any(np.diff(front[within]) <= 0.0):
        return nan
    window = np.linspace(CERTIFIED_RULE.zone * end, end, SAMPLES)
    return float(np.mean(np.interp(window, d, front - tip)))


def certified_checks(
    scene: Scene, name: str, result: Result, tolerance: float, second: Result | None = None
) -> tuple[Check, ...]:
    """One run against every certified value of its scene that it has.

    Parameters
    ----------
    name : name of a run of a built-in method, or of another code
    tolerance : tolerance of the load curve of the run; the uncertainty of the value is added. For loads of a theory it
        is relative to the largest load: it was found for whole curves, and a theory is least accurate before the crack
        grows
    second : the run of the next higher order of a theory. The tolerance of the work is wider by the difference of both:
        where the load drops suddenly, a drop at a slightly larger opening changes the work more than the curve
    """
    able = [one for one in certified(scene) if one.kind in _quantities_of(name, result)]
    pairs, largest = keeps_pairs(scene, name), peak_load(result) if _is_theory(name) else 0.0

    def allowed(one: Certified) -> float:
        if one.kind == "load_at":
            return tolerance * max(largest / one.value, 1.0)
        if one.kind != "work" or second is None:
            return tolerance
        apart = abs(measured(result, "work", one.opening) / measured(second, "work", one.opening) - 1.0)
        return tolerance + (apart if isfinite(apart) else 0.0)

    return tuple(certified_check(name, result, one, allowed(one), pairs) for one in able)


def certified_check(name: str, result: Result, known: Certified, tolerance: float, pairs_kept: bool | None) -> Check:
    """One run against one value: the relative deviation, within tolerance and uncertainty together.

    Parameters
    ----------
    pairs_kept : whether the run keeps its initial pairs of points; None if unknown: the values of both are accepted
    """
    change = known.matched or 0.0
    shift = {True: change, False: 0.0, None: 0.5 * change}[pairs_kept]
    reference = known.value + shift
    uncertainty = (known.uncertainty + (0.5 * abs(change) if pairs_kept is None else 0.0)) / abs(reference)
    deviation = measured(result, known.kind, known.opening) / reference - 1.0
    step = 0.0
    if known.kind == "peak_opening" and "load_slope" not in result.steps:
        # without slopes the peak may lie anywhere in both steps next to the largest load
        i = int(np.argmax(result.load))
        step = float(np.max(np.abs(np.diff(result.opening[max(i - 1, 0) : i + 2])), initial=0.0)) / abs(reference)
    allowed = hypot(CERTIFIED_RULE.wider(known.kind) * tolerance, uncertainty, step)
    source = f"that of two codes on three meshes each, {known.value:.6g} ± {known.uncertainty:.2g} (95 %)"
    label = {"peak_opening": "peak-opening", "load_at": f"load-{known.opening or 0.0:g}"}.get(known.kind, known.kind)
    meaning = f"{known.quantity[:1].upper()}{known.quantity[1:]}: {source}."
    return Check(f"certified-{label}", name, deviation, allowed, "certified", meaning, uncertainty, at=known.opening)


def keeps_pairs(scene: Scene, name: str) -> bool | None:
    """Whether a run keeps its initial pairs of points; None for a beam, which has none, and for other codes."""
    method = RUNS.get(name)
    if method is None or not method.has_mesh:
        return None
    return name == MATCHED or "search" in method.fixed(scene)


def _is_theory(name: str) -> bool:
    return name in RUNS and not RUNS[name].has_mesh


def _quantities_of(name: str, result: Result) -> tuple[CertifiedKind, ...]:
    """Quantities that a run can be compared in: a theory has no opening at the peak and no zone; a curve alone, or a
    run whose front stands still for a step on a coarse mesh, has no zone."""
    if _is_theory(name):
        return "peak", "load_at", "work"
    zone: tuple[CertifiedKind, ...] = ("zone",) if isfinite(measured(result, "zone", float(result.opening[-1]))) else ()
    return "peak", "peak_opening", "load_at", "work", *zone
