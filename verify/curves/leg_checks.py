"""Two curves along one load programme: the differences of every leg, the farthest point, and their checks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from verify.curves.curve import LEAST_LOAD, LEAST_OPENING, SAMPLES, Curve, envelope, load_at, point_distances
from verify.curves.legs import TURN_TOLERANCE, Leg, Path, path
from verify.curves.scatter import NO_SCATTER, SIGMAS, Scatter
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

#: Fall of the opening on a leg, in parts of its largest one, from which it is a snap-back and no noise.
GOES_BACK = 0.01

#: Part of a tolerance up to which the difference of the loads is taken for the distance of a point.
NO_MATTER = 0.25

#: A single point may be farther off than a whole curve, by the tolerance of the curve times this.
OF_A_POINT = 4.0

#: Name of a check, the difference that it is about, and its meaning for a numbered leg.
LEG_CHECKS = (
    ("curve-leg", "error", "The load along leg {0}, {1} (relative L2)."),
    ("slope-leg", "slope", "The secant stiffness of leg {0}, {1} (relative difference)."),
    ("residual-leg", "residual", "The opening without load of leg {0}, {1} (over the opening at its beginning)."),
    ("loop-leg", "loop", "The work that leg {0}, {1}, and the way back lose (over what the leg gives back)."),
)


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
    sizes = b.sizes
    if not sizes[:, 1].min() > 0.0:
        return ()
    pairs = [pair for pair in zip(a.legs, b.legs, strict=False) if _common(*pair) is not None]
    found = []
    for i, (mine, other) in enumerate(pairs):
        least = LEAST_LOAD * float(sizes[int(other.begin > 0.0), 1])  # on the side on which the leg begins
        loop = _loop(pairs[i], pairs[i + 1], least) if other.unloads and i + 1 < len(pairs) else np.nan
        error = min(_l2(mine, other, at, sizes) for at in _where(mine, _common(mine, other) or (0.0, 1.0)))
        found.append(LegDifference(i + 1, other.words, error, *_unloading(mine, other, least), loop))
    return tuple(found)


def worst_leg(a: Curve, b: Curve, programme: Sequence[float]) -> float:
    """Relative L2 distance of the leg that differs most; 0 where the opening only grows, as the envelope shows all."""
    legs = () if only_opens(programme) else leg_differences(path(a, programme), path(b, programme))
    return max((leg.error for leg in legs if not np.isnan(leg.error)), default=0.0)


def programme_checks(
    subject: str, a: Curve, b: Curve, programme: Sequence[float], tolerance: float
) -> tuple[Check, ...]:
    """Every leg of a programme that turns, of A against B; nothing where the opening only grows."""
    if only_opens(programme):
        return ()
    return leg_checks(leg_differences(path(a, programme), path(b, programme)), subject, tolerance)


def leg_checks(legs: Sequence[LegDifference], subject: str, tolerance: float) -> tuple[Check, ...]:
    """The defined differences of every leg, each a check with the tolerance of the curve."""
    rows = [
        (f"{name}-{leg.number}", float(getattr(leg, key)), meaning.format(leg.number, leg.words))
        for leg in legs
        for name, key, meaning in LEG_CHECKS
        if key == "error" or not np.isnan(getattr(leg, key))
    ]
    return tuple(Check(name, subject, value, tolerance, "cross-code", meaning) for name, value, meaning in rows)


def turns_check(subject: str, curve: Path) -> Check:
    """Whether a curve has every leg of the programme."""
    lacks = "" if curve.complete else f"; the {curve.legs[-1].words} is not there"
    meaning = f"The curve turns where the load programme does (distance over its largest opening){lacks}."
    return Check("legs", subject, curve.misfit, TURN_TOLERANCE, "cross-code", meaning)


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

    def first_at(leg: Leg, load: float) -> float:
        """The opening, times its heading, at which a path first bears a load that it comes to."""
        d, P = leg.onward[0], leg.heading * leg.load
        i = max(1, int(np.argmax(P >= load)))
        return float(d[i - 1] + (d[i] - d[i - 1]) * (load - P[i - 1]) / (P[i] - P[i - 1]))

    before = a.heading * a.load[max(int(np.argmax(there)) - 1, 0)]
    loads = [load for load in (half, before) if load >= TELLS_STIFFNESS * half]
    return float(min((np.divide(first_at(b, load), first_at(a, load)) - 1.0 for load in loads), key=abs))


def stiffness_check(
    subject: str, a: Curve, b: Curve, programme: Sequence[float], tolerance: float
) -> tuple[Check, ...]:
    """The secant stiffness of the first leg, see `stiffness`; nothing where B bears no load there."""
    value = stiffness(path(a, programme).legs[0], path(b, programme).legs[0])
    meaning = "The secant stiffness at half the largest load of the first leg (relative difference)."
    return () if np.isnan(value) else (Check("stiffness", subject, value, tolerance, "cross-code", meaning),)


@dataclass(frozen=True)
class Farthest:
    """The point of A that is farthest from B, in parts of its own opening and load."""

    value: float
    number: int  # of its leg
    opening: float
    load: float


@np.errstate(all="ignore")
def farthest(
    a: Path,
    b: Path,
    enough: float,
    every_point: bool = True,
    near: tuple[float, float] = (-np.inf, np.inf),
    scatter: Scatter = NO_SCATTER,
) -> Farthest | None:
    """The point of A that is farthest from B, leg by leg, as far as B goes; see `verify.curves.curve.point_distances`.

    Without ``every_point`` those of a snap-back of A count only where B has a snap-back: under control of the opening,
    as in a test, the load of B drops vertically there. Points at openings outside ``near`` do not count.

    With ``scatter`` of A a point may lie anywhere within half of its quanta, and no load is smaller than that of which
    ``enough`` is `SIGMAS` times the noise.
    """
    sizes, found = b.sizes, []
    if not sizes.min() > 0.0:
        return None
    for i, (mine, other) in enumerate(zip(a.legs, b.legs, strict=False), 1):
        if _common(mine, other) is None:
            continue
        graph = other.onward
        goes_back = np.max(np.maximum.accumulate(graph[0]) - graph[0]) > GOES_BACK * np.max(np.abs(graph[0]))
        d, P = mine.onward if every_point or goes_back else envelope(*mine.onward)
        there = (d <= np.max(graph[0])) & (mine.heading * d >= near[0]) & (mine.heading * d <= near[1])
        if not there.any():
            continue
        d, P, size = d[there], P[there], _size_at(other, d[there], sizes)
        least = np.maximum(LEAST_LOAD, (SIGMAS * scatter.noise / enough if scatter.noise else 0.0) / size[1])
        scale = np.maximum(np.abs(d), LEAST_OPENING * size[0]), np.maximum(np.abs(P), least * size[1])
        loose = np.sum(scatter.half(d, P) / scale, axis=0)
        near_load = NO_MATTER * enough if np.isfinite(enough) else 0.0
        off = point_distances((d, P), graph, size, near_load, enough + np.max(loose), least) - loose
        worst = int(np.argmax(off))
        found.append(Farthest(max(float(off[worst]), 0.0), i, float(mine.heading * d[worst]), float(P[worst])))
    return max(found, key=lambda one: one.value, default=None)


def farthest_check(
    subject: str,
    a: Curve,
    b: Curve,
    programme: Sequence[float],
    tolerance: float,
    kind: Kind = "cross-code",
    scatter: Scatter = NO_SCATTER,
) -> tuple[Check, ...]:
    """The point of A, with its ``scatter``, that is farthest from B, by the ``tolerance`` of the curve; nothing where
    they have no opening in common."""
    worst = farthest(path(a, programme), path(b, programme), OF_A_POINT * tolerance, scatter=scatter)
    if worst is None:
        return ()
    meaning = (
        "No point is farther from the other curve, in parts of its own opening and load: the farthest is at "
        f"opening {worst.opening:.6g}, load {worst.load:.6g}, on leg {worst.number}."
    )
    return (Check("farthest-point", subject, worst.value, OF_A_POINT * tolerance, kind, meaning, at=worst.opening),)


def _size_at(leg: Leg, onward: np.ndarray, sizes: np.ndarray) -> np.ndarray:
    """The sizes (2, n) on the side of zero of openings (n,) of a leg, times its heading."""
    return sizes[leg.above_zero(leg.heading * onward).astype(int)].T


def _common(*legs: Leg) -> tuple[float, float] | None:
    """The openings, times their heading, that all of some legs of one heading pass through."""
    low = max(float(leg.onward[0][0]) for leg in legs)
    high = min(float(np.max(leg.onward[0])) for leg in legs)
    return (low, high) if high > low else None


def _where(leg: Leg, ends: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Where a leg is compared: along its chords, and at its own points. The nearer one counts.

    A chord depends on the steps alone, as across the kink at which a reloading comes back to the envelope.
    """
    low, high = ends
    grid = np.minimum(low + (high - low) * (np.arange(SAMPLES + 1) / SAMPLES), high)
    own = np.unique(np.clip(envelope(*leg.onward)[0], low, high))
    return grid, own if len(own) < SAMPLES else grid


def _l2(a: Leg, b: Leg, at: np.ndarray, sizes: np.ndarray) -> float:
    """Relative L2 distance at openings (n,), on the side of zero where it is larger.

    See `verify.curves.curve.point_distances`: of a steep drop, which a little later would be as far off as it is high,
    the distance along the opening counts.
    """
    mine, other, size = load_at(a.onward, at), load_at(b.onward, at), _size_at(b, at, sizes)
    least, above = LEAST_LOAD * size[1], b.above_zero(b.heading * at)
    near = point_distances((at, mine), b.onward, size, LOADS_ALONE) * np.maximum(np.abs(mine), least)
    off = np.minimum(near, np.abs(mine - other))
    parts = [
        np.sqrt(_mean(off[on] ** 2, at[on])) / max(np.sqrt(_mean(other[on] ** 2, at[on])), least[on][0])
        for on in (above, ~above)
        if on.any()
    ]
    return float(np.max(parts))


def _mean(values: np.ndarray, at: np.ndarray) -> float:
    """By the trapezoidal rule; at a single place the value."""
    return float(np.mean(values) if at[-1] == at[0] else np.trapezoid(values, at) / (at[-1] - at[0]))


def _unloading(a: Leg, b: Leg, least: float) -> tuple[float, float]:
    """Slope and residual opening of A against B, of a leg that unloads; NaN where they are undefined.

    Both are those of the secant to the end of the leg, or to the last point of B before `CLEAR`, near which faces
    begin to touch.
    """
    ends = _common(a, b)
    if ends is None or not b.unloads:
        return np.nan, np.nan
    own = b.onward[0]
    clear = ends[1] if ends[1] <= CLEAR * ends[0] else np.max(own[own <= CLEAR * ends[0]], initial=ends[0])
    at = np.array([ends[0], clear])
    start, end = np.transpose([load_at(leg.onward, at) for leg in (a, b)])  # (2,) of A and B
    part = (start[1] - end[1]) / start[1]
    if not (at[1] > at[0] and abs(start[1]) >= least and part >= TELLS_SLOPE):
        return np.nan, np.nan
    slope = float((start[0] - end[0]) / (start[1] - end[1]) - 1.0)
    if not part >= TELLS_RESIDUAL:
        return slope, np.nan
    unloaded = at[1] - end * (at[1] - at[0]) / (end - start)
    return slope, float(np.nan_to_num(b.heading * (unloaded[0] - unloaded[1]) / abs(at[0]), nan=np.inf))


def _loop(there: tuple[Leg, Leg], back: tuple[Leg, Leg], least: float) -> float:
    """Work lost on the way there and back, of A less that of B, over what B gives back."""
    ways, returns = _common(*there), _common(*back)
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
