"""Two curves along one load programme, leg by leg: differences and checks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from verify.curves.curve import SAMPLES, Curve, envelope, load_at
from verify.curves.legs import TURN_TOLERANCE, Leg, Path, path
from verify.curves.nearness import LEAST_LOAD, distances
from verify.curves.scatter.farthest import common_range, size_at, sizes_of
from verify.support.programme import only_opens
from verify.verdict import Check, Kind

#: Distance, in parts of the load, up to which the difference of the loads is taken for the distance of two points.
LOADS_ALONE = 1e-3

#: Part of its load by which a leg must unload before its slope is defined, and before its residual opening is.
TELLS_SLOPE, TELLS_RESIDUAL = 0.25, 0.5

#: Part of half the largest load above which a load defines the stiffness.
TELLS_STIFFNESS = 0.2

#: Part of the opening at its beginning above which an unloading is a straight line: below, faces begin to touch.
CLEAR = 0.2


@dataclass(frozen=True)
class LegDifference:
    """A leg of A against that of B; undefined values are NaN.

    ``error`` is relative L2, ``slope`` relative to that of B, ``residual`` relative to the opening at which the
    unloading begins, ``loop`` relative to the work that B gives back.
    """

    number: int
    words: str
    error: float
    slope: float
    residual: float
    loop: float  # of a leg that unloads and the next one


@np.errstate(all="ignore")  # numbers near the ends of the range end as inf or NaN, and so fail
def leg_differences(a: Path, b: Path) -> tuple[LegDifference, ...]:
    """Every leg that both have."""
    sizes = sizes_of(b)
    if not sizes[:, 1].min() > 0.0:
        return ()
    pairs = [pair for pair in zip(a.legs, b.legs, strict=False) if common_range(*pair) is not None]
    return tuple(
        LegDifference(
            i + 1,
            pair[1].words,
            _error(*pair, sizes),
            *_unloading(*pair, _least(pair[1], sizes)),
            _loop(pair, pairs[i + 1], _least(pair[1], sizes)) if pair[1].unloads and i + 1 < len(pairs) else np.nan,
        )
        for i, pair in enumerate(pairs)
    )


def worst_leg(a: Curve, b: Curve, programme: Sequence[float]) -> float:
    """Relative L2 distance of the leg that differs most; 0 where the opening only grows, as the envelope shows all."""
    legs = () if only_opens(programme) else leg_differences(path(a, programme), path(b, programme))
    return max((leg.error for leg in legs if not np.isnan(leg.error)), default=0.0)


@np.errstate(all="ignore")
def stiffness(a: Leg, b: Leg) -> float:
    """Secant stiffness of A over that of B, less one, where each first bears half the largest load of B in the sense of
    the leg, or the last load of A before that: the nearer one counts, see `_where`. NaN where B bears nothing, infinite
    where A does not.
    """
    half = 0.5 * float(np.max(b.heading * b.load))
    there = a.heading * a.load >= half
    if half <= 0.0 or not there.any():
        return np.nan if half <= 0.0 else np.inf
    before = a.heading * a.load[max(int(np.argmax(there)) - 1, 0)]
    loads = [load for load in (half, before) if load >= TELLS_STIFFNESS * half]
    found = [np.divide(_first_at(b, load), _first_at(a, load)) - 1.0 for load in loads]
    return float(min(found, key=abs))


def _first_at(leg: Leg, load: float) -> float:
    """The opening, times its heading, at which a path first bears a load that it comes to."""
    d, P = leg.onward[0], leg.heading * leg.load
    i = max(1, int(np.argmax(P >= load)))
    return float(d[i - 1] + (d[i] - d[i - 1]) * (load - P[i - 1]) / (P[i] - P[i - 1]))


def stiffness_check(
    subject: str, a: Curve, b: Curve, programme: Sequence[float], tolerance: float, kind: Kind = "cross-code"
) -> tuple[Check, ...]:
    """The secant stiffness of the first leg, see `stiffness`; nothing where B bears no load there."""
    value = stiffness(path(a, programme).legs[0], path(b, programme).legs[0])
    meaning = "The secant stiffness at half the largest load of the first leg (relative difference)."
    return () if np.isnan(value) else (Check("stiffness", subject, value, tolerance, kind, meaning),)


def programme_checks(
    subject: str, a: Curve, b: Curve, programme: Sequence[float], tolerance: float, kind: Kind = "cross-code"
) -> tuple[Check, ...]:
    """Every leg of a programme that turns, of A against B; nothing where the opening only grows."""
    if only_opens(programme):
        return ()
    return leg_checks(leg_differences(path(a, programme), path(b, programme)), subject, tolerance, kind)


def leg_checks(
    legs: Sequence[LegDifference], subject: str, tolerance: float, kind: Kind = "cross-code"
) -> tuple[Check, ...]:
    """The defined differences of every leg, each a check with the tolerance of the curve."""
    rows = [
        row
        for leg in legs
        for row in (
            (f"curve-leg-{leg.number}", leg.error, f"The load along leg {leg.number}, {leg.words} (relative L2)."),
            (
                f"slope-leg-{leg.number}",
                leg.slope,
                f"The secant stiffness of leg {leg.number}, {leg.words} (relative difference).",
            ),
            (
                f"residual-leg-{leg.number}",
                leg.residual,
                f"The opening without load of leg {leg.number}, {leg.words} (over the opening at its beginning).",
            ),
            (
                f"loop-leg-{leg.number}",
                leg.loop,
                f"The work that leg {leg.number}, {leg.words}, and the way back lose (over what the leg gives back).",
            ),
        )
    ]
    told = [row for row in rows if not np.isnan(row[1]) or row[0].startswith("curve")]
    return tuple(Check(name, subject, float(value), tolerance, kind, meaning) for name, value, meaning in told)


def turns_check(subject: str, curve: Path, kind: Kind = "cross-code") -> Check:
    """Whether a curve has every leg of the programme."""
    last = curve.legs[-1]
    lacks = "" if curve.complete else f"; the {last.words} is not there"
    meaning = f"The curve turns where the load programme does (distance over its largest opening){lacks}."
    return Check("legs", subject, curve.misfit, TURN_TOLERANCE, kind, meaning)


def _least(leg: Leg, sizes: np.ndarray) -> float:
    """The least load on the side on which a leg begins."""
    return LEAST_LOAD * float(sizes[int(leg.begin > 0.0), 1])


def _error(a: Leg, b: Leg, sizes: np.ndarray) -> float:
    """Relative L2 distance over the common openings, on the side of zero where it is larger.

    See `verify.curves.nearness.distances`: of a steep drop, which a little later would be as far off as it is high, the
    distance along the opening counts.
    """
    return min(_l2(a, b, at, sizes) for at in _where(a, common_range(a, b) or (0.0, 1.0)))


def _where(leg: Leg, ends: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Where a leg is compared: along its chords, and at its own points. The nearer one counts.

    A chord depends on the steps alone, as across the kink at which a reloading comes back to the envelope.
    """
    low, high = ends
    grid = np.minimum(low + (high - low) * (np.arange(SAMPLES + 1) / SAMPLES), high)
    own = np.unique(np.clip(envelope(*leg.onward)[0], low, high))
    return grid, own if len(own) < SAMPLES else grid


def _l2(a: Leg, b: Leg, at: np.ndarray, sizes: np.ndarray) -> float:
    mine, other, size = load_at(a.onward, at), load_at(b.onward, at), size_at(b, at, sizes)
    least, above = LEAST_LOAD * size[1], b.above_zero(b.heading * at)
    near = distances((at, mine), b.onward, size, LOADS_ALONE) * np.maximum(np.abs(mine), least)
    off = np.minimum(near, np.abs(mine - other))
    parts = [
        np.sqrt(_mean(off[on] ** 2, at[on])) / max(np.sqrt(_mean(other[on] ** 2, at[on])), least[on][0])
        for on in (above, ~above)
        if on.any()
    ]
    return float(np.max(parts))


def _mean(values: np.ndarray, at: np.ndarray) -> float:
    """By the trapezoidal rule; at a single place the value."""
    if at[-1] == at[0]:
        return float(np.mean(values))
    return float(np.sum((values[1:] + values[:-1]) * np.diff(at)) / (2.0 * (at[-1] - at[0])))


def _unloading(a: Leg, b: Leg, least: float) -> tuple[float, float]:
    """Slope and residual opening of A against B, of a leg that unloads; NaN where they are undefined.

    Both are those of the secant to the end of the leg, or to the last point of B before `CLEAR`, near which faces
    begin to touch.
    """
    ends = common_range(a, b)
    if ends is None or not b.unloads:
        return np.nan, np.nan
    own = b.onward[0]
    clear = ends[1] if ends[1] <= CLEAR * ends[0] else np.max(own[own <= CLEAR * ends[0]], initial=ends[0])
    at = np.array([ends[0], clear])
    (start_a, end_a), (start_b, end_b) = (load_at(leg.onward, at) for leg in (a, b))
    if not (at[1] > at[0] and abs(start_b) >= least and (start_b - end_b) / start_b >= TELLS_SLOPE):
        return np.nan, np.nan
    slope = (start_a - end_a) / (start_b - end_b) - 1.0
    if not (start_b - end_b) / start_b >= TELLS_RESIDUAL:
        return float(slope), np.nan
    with np.errstate(all="ignore"):
        unloaded = [
            at[1] - end * (at[1] - at[0]) / (end - start) for start, end in ((start_a, end_a), (start_b, end_b))
        ]
    return float(slope), float(np.nan_to_num(b.heading * (unloaded[0] - unloaded[1]) / abs(at[0]), nan=np.inf))


def _loop(there: tuple[Leg, Leg], back: tuple[Leg, Leg], least: float) -> float:
    """Work lost on the way there and back, of A less that of B, over what B gives back."""
    ways, returns = common_range(*there), common_range(*back)
    if ways is None or returns is None:
        return np.nan
    low, high = max(-ways[1], returns[0], 0.0), min(-ways[0], returns[1])  # on the side of zero where they begin
    if not high > low:
        return np.nan
    fall, rise = (
        [_mean(load_at(a.onward, at) - load_at(b.onward, at), at) for at in _where(a, ends)]
        for (a, b), ends in ((there, (-high, -low)), (back, (low, high)))
    )
    grid = _where(there[1], (-high, -low))[0]
    given = _mean(np.abs(load_at(there[1].onward, grid)), grid)
    return min((up - down for up in rise for down in fall), key=abs) / max(given, least)
