"""Two curves along one load programme, leg by leg: what each leg shows, and the checks that it makes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from verify.curve import Curve, envelope, load_at
from verify.legs import NEAR, Leg, Path, only_opens, path
from verify.nearness import distances
from verify.verdict import Check, Kind

#: Samples of a leg.
SAMPLES = 400

#: The load that an error is relative to is at least this part of the largest load of the reference: on a leg whose
#: loads go through zero there is no other measure.
LEAST_LOAD = 0.1

#: Part of its load that a leg gives up before its slope can be told, and before its residual opening can.
TELLS_SLOPE, TELLS_RESIDUAL = 0.25, 0.5

#: Part of the opening at its beginning above which an unloading is a straight line: below, faces begin to touch.
CLEAR = 0.2

#: A single point may be farther off than a whole curve, by the tolerance of the curve times this.
OF_A_POINT = 4.0


@dataclass(frozen=True)
class LegDifference:
    """A leg of A against that of B; what cannot be told is NaN.

    ``error`` is relative L2, ``slope`` relative to that of B, ``residual`` relative to the opening at which the
    unloading begins, ``loop`` relative to the work that B gives back.
    """

    number: int
    words: str
    error: float
    slope: float
    residual: float
    loop: float  # of a leg that unloads and the next one


@dataclass(frozen=True)
class Farthest:
    """The point of A that is farthest from B, in parts of its own opening and load."""

    value: float
    number: int  # of its leg
    opening: float
    load: float


def leg_differences(a: Path, b: Path) -> tuple[LegDifference, ...]:
    """Every leg that both have."""
    top = max((float(np.max(np.abs(leg.load))) for leg in b.legs), default=0.0)
    pairs = [pair for pair in zip(a.legs, b.legs, strict=False) if _range(*pair) is not None]
    return tuple(
        LegDifference(
            i + 1,
            pair[1].words,
            _error(*pair, LEAST_LOAD * top),
            *_unloading(*pair, LEAST_LOAD * top),
            _loop(pair, pairs[i + 1], LEAST_LOAD * top) if pair[1].unloads and i + 1 < len(pairs) else np.nan,
        )
        for i, pair in enumerate(pairs)
    )


def farthest(a: Path, b: Path, enough: float, snap_backs: bool = True) -> Farthest | None:
    """The point of A that is farthest from B, leg by leg, as far as B goes; see `verify.nearness.distances`.

    Without ``snap_backs`` only the envelope of A counts, as where B may show vertical drops.
    """
    size = tuple(max(float(np.max(np.abs(getattr(leg, of)))) for leg in b.legs) for of in ("opening", "load"))
    found = []
    for i, (mine, other) in enumerate(zip(a.legs, b.legs, strict=False), 1):
        if _range(mine, other) is None:
            continue
        d, P = mine.onward if snap_backs else envelope(*mine.onward)
        graph = other.onward
        there = d <= np.max(graph[0])
        off = distances((d[there], P[there]), graph, size, enough)
        worst = int(np.argmax(off))
        found.append(Farthest(float(off[worst]), i, float(mine.heading * d[there][worst]), float(P[there][worst])))
    return max(found, key=lambda one: one.value, default=None)


def along_the_programme(
    subject: str, a: Curve, b: Curve, programme: Sequence[float], tolerance: float, kind: Kind = "cross-code"
) -> tuple[Check, ...]:
    """Checks of A against B besides the L2 distance of their envelopes: the farthest point and, where the programme
    turns, every leg.

    Parameters
    ----------
    tolerance : that of the curve
    """
    of_a, of_b = path(a, programme), path(b, programme)
    worst = farthest(of_a, of_b, OF_A_POINT * tolerance)
    checks = []
    if worst is not None:
        meaning = (
            "No point is farther from the other curve, in parts of its own opening and load: the farthest is at "
            f"opening {worst.opening:.6g}, load {worst.load:.6g}, on leg {worst.number}."
        )
        checks.append(Check("farthest-point", subject, worst.value, OF_A_POINT * tolerance, kind, meaning))
    if not only_opens(programme):
        checks += leg_checks(leg_differences(of_a, of_b), subject, tolerance, kind)
    return tuple(checks)


def leg_checks(
    legs: Sequence[LegDifference], subject: str, tolerance: float, kind: Kind = "cross-code"
) -> tuple[Check, ...]:
    """What can be told of every leg, each a check with the tolerance of the curve."""
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
    return Check("legs", subject, curve.misfit, NEAR, kind, meaning)


def _range(*legs: Leg) -> tuple[float, float] | None:
    """The openings, times their heading, that all of some legs of one heading pass through."""
    low = max(float(leg.onward[0][0]) for leg in legs)
    high = min(float(np.max(leg.onward[0])) for leg in legs)
    return (low, high) if high > low else None


def _error(a: Leg, b: Leg, least: float) -> float:
    """Relative L2 distance over the common openings: along the chords of A, or at its own points, whichever is less.

    A chord across the kink at which a reloading comes back to the envelope says something of the steps alone.
    """
    low, high = _range(a, b) or (0.0, 1.0)
    grid = np.minimum(low + (high - low) * (np.arange(SAMPLES + 1) / SAMPLES), high)
    own = np.unique(np.clip(envelope(*a.onward)[0], low, high))
    return min(_l2(a, b, at, least) for at in (grid, own))


def _l2(a: Leg, b: Leg, at: np.ndarray, least: float) -> float:
    width = np.diff(at)
    weight = np.append(width, 0.0) + np.append(0.0, width)
    mine, other = load_at(a.onward, at), load_at(b.onward, at)
    off, size = (np.sqrt(np.sum(weight * load**2) / np.sum(weight)) for load in (mine - other, other))
    return float(off / max(size, least))


def _unloading(a: Leg, b: Leg, least: float) -> tuple[float, float]:
    """Slope and residual opening of A against B, of a leg that unloads; NaN where they cannot be told.

    Both are those of the secant to the end of the leg, or to the last point of B before `CLEAR`, near which faces
    begin to touch.
    """
    ends = _range(a, b)
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
    return float(slope), float(np.nan_to_num((unloaded[0] - unloaded[1]) / abs(at[0]), nan=np.inf))


def _loop(there: tuple[Leg, Leg], back: tuple[Leg, Leg], least: float) -> float:
    """Work lost on the way there and back, of A less that of B, over what B gives back."""
    ways, returns = _range(*there), _range(*back)
    if ways is None or returns is None:
        return np.nan
    low, high = max(-ways[1], returns[0]), min(-ways[0], returns[1])
    if not high > low:
        return np.nan
    grid = np.linspace(low, high, SAMPLES + 1)
    lost = []
    for out, home in zip(there, back, strict=True):
        fall, rise = load_at(out.onward, np.maximum(-grid, ways[0])), load_at(home.onward, grid)
        lost.append(float(np.mean(rise - fall)))
    given = float(np.mean(np.abs(load_at(there[1].onward, np.maximum(-grid, ways[0])))))
    return (lost[0] - lost[1]) / max(given, least)
