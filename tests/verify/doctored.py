"""Right curves written down otherwise, and wrong ones: each from a right curve, as a list of legs (opening, load)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

Leg = tuple[np.ndarray, np.ndarray]
Legs = Sequence[Leg]
Doctor = Callable[[Legs], Legs]
Change = Callable[[np.ndarray, np.ndarray], Leg]


def joined(legs: Legs) -> Leg:
    """One path of all legs, the turns once."""
    parts = [legs[0], *((d[1:], P[1:]) for d, P in legs[1:])]
    return np.concatenate([d for d, _ in parts]), np.concatenate([P for _, P in parts])


def changed(change: Change, leg: int = 0) -> Doctor:
    """One leg, counted from 1, or all of them otherwise."""
    return lambda legs: [change(*one) if leg in (0, i) else one for i, one in enumerate(legs, 1)]


def loads(change: Callable[[np.ndarray, np.ndarray], np.ndarray], leg: int = 0) -> Doctor:
    return changed(lambda d, P: (d, change(d, P)), leg)


def rows(choice: Callable[[np.ndarray, np.ndarray], np.ndarray], leg: int = 0) -> Doctor:
    """Some rows alone, by index or mask."""
    return changed(lambda d, P: tuple(values[choice(d, P)] for values in (d, P)), leg)


def spike(leg: int, at: float, part: float) -> Doctor:
    """One converged point of a leg with a load that is ``part`` off."""
    return loads(lambda d, P: P * (1.0 + part * (np.arange(len(d)) == np.clip(int(at * len(d)), 1, len(d) - 2))), leg)


def noise(part: float) -> Doctor:
    return loads(lambda d, P: P * (1.0 + part * np.random.default_rng(len(P)).standard_normal(len(P))))


def some(keep: float) -> Doctor:
    """A part of the points, by chance; turns and ends, and the surroundings of the peak, are kept."""
    near = lambda d, P: (np.abs(np.arange(len(d)) - np.argmax(P)) < 4) | (d == d[0]) | (d == d[-1])  # noqa: E731
    return rows(lambda d, P: (np.random.default_rng(len(d)).random(len(d)) < keep) | near(d, P))


def cut(leg: Leg, end: float) -> Leg:
    """A leg on which the opening grows, up to an opening on it."""
    d, P = leg
    return np.append(d[d < end], end), np.append(P[d < end], np.interp(end, d, P))


def up_to(part: float) -> Doctor:
    """The last leg as far as a part of its end."""
    return lambda legs: [*legs[:-1], cut(legs[-1], part * legs[-1][0][-1])]


def from_(opening: float) -> Doctor:
    """Without the beginning."""
    return rows(lambda d, P: d >= opening, 1)


def appended(leg: int, opening: float, load: float) -> Doctor:
    """A leg with one more point, whose load is a part of its last one."""
    return lambda legs: [
        (np.append(d, opening), np.append(P, load * P[-1])) if i == leg % len(legs) else (d, P)
        for i, (d, P) in enumerate(legs)
    ]


def turning_at(top: float) -> Doctor:
    """The first unloading from an opening a little before the right one."""

    def doctor(legs: Legs) -> Legs:
        first, (d, P) = cut(legs[0], top), legs[1]
        return [first, (np.append(top, d[d < top]), np.append(first[1][-1], P[d < top])), *legs[2:]]

    return doctor


def steeper(part: float) -> Doctor:
    """An unloading along a line, with ``part`` times the fall of the load."""
    return loads(lambda d, P: P[0] - part * (P[0] - P[-1]) * (d - d[0]) / (d[-1] - d[0]), 2)


def plastic(part: float) -> Doctor:
    """An unloading that aims at a part of the opening that it begins at, and the way back along it."""

    def doctor(legs: Legs) -> Legs:
        first, (d, P), (e, Q) = legs[:3]
        line = lambda x: P[0] * (x - part * d[0]) / (d[0] - part * d[0])  # noqa: E731
        return [first, (d, line(d)), (e, np.where(e <= d[0], line(e), Q)), *legs[3:]]

    return doctor


def back(change: Callable[[np.ndarray, np.ndarray, float, float], np.ndarray]) -> Doctor:
    """The way back of a loop otherwise, by its openings and loads and by those at which the unloading began."""
    return lambda legs: [*legs[:2], (legs[2][0], change(*legs[2], legs[1][0][0], legs[1][1][0]))]


def sag(d: np.ndarray, P: np.ndarray, top: float, load: float) -> np.ndarray:
    """Lower than the unloading by up to 4 % of its load."""
    x = np.clip((d - d[0]) / (top - d[0]), 0.0, 1.0)
    return P * (1.0 - 0.16 * x * (1.0 - x))


#: Wrong curves of any programme, and a check that must say so.
WRONG: Mapping[str, tuple[Doctor, str]] = {
    "spike before the peak": (spike(1, 0.1, 0.08), "farthest-point"),
    "spike early": (spike(1, 0.03, 0.08), "farthest-point"),
    "spike behind the peak": (spike(1, 0.6, 0.08), "farthest-point"),
    "dip behind the peak": (spike(1, 0.8, -0.08), "farthest-point"),
    "load x 1.01": (loads(lambda d, P: 1.01 * P), "curve"),
    "load x 0.99": (loads(lambda d, P: 0.99 * P), "curve"),
    "opening x 1.01": (changed(lambda d, P: (1.01 * d, P)), "curve"),
    "opening x 0.99": (changed(lambda d, P: (0.99 * d, P)), "curve"),
    "peak cut off": (loads(lambda d, P: np.minimum(P, 0.97 * np.max(P))), "peak"),
    "offset of 1 % of the peak": (lambda legs: [(d, P + 0.01 * np.max(legs[0][1])) for d, P in legs], "curve"),
    "noise of 2 %": (noise(0.02), "curve"),
    "sign": (loads(lambda d, P: -P), "curve"),
    "half the load": (loads(lambda d, P: 0.5 * P), "curve"),
}

#: The same of a programme that unloads once.
WRONG_LOOPS: Mapping[str, tuple[Doctor, str]] = {
    "healing": (loads(lambda d, P: P * (1.0 + 3.0 * (1.0 - d / d[0])), 2), "slope-leg-2"),
    "no unloading": (lambda legs: [legs[0], tuple(v[legs[2][0] > legs[1][0][0]] for v in legs[2])], "legs"),
    "unloading x -5": (loads(lambda d, P: np.where(d < d[0], -5.0 * P, P), 2), "curve-leg-2"),
    "steeper unloading": (steeper(1.1), "slope-leg-2"),
    "flatter unloading": (steeper(0.98), "slope-leg-2"),
    "residual opening of 5 %": (plastic(0.05), "residual-leg-2"),
    "residual opening of 2 %": (plastic(0.02), "residual-leg-2"),
    "unloading displaced": (loads(lambda d, P: P - 0.02 * P[0] * (d < d[0]), 2), "curve-leg-2"),
    "unloading with a belly": (
        loads(lambda d, P: P - 0.05 * P[0] * np.sin(np.pi * (d - d[0]) / (d[-1] - d[0])), 2),
        "curve-leg-2",
    ),
    "reloading overshoots": (
        back(lambda d, P, top, load: np.where((d > top) & (d < 1.05 * top), load * d / top, P)),
        "farthest-point",
    ),
    "the way back sags": (back(sag), "loop-leg-2"),
    "damage while reloading": (back(lambda d, P, top, load: 0.98 * P), "curve-leg-3"),
    "legs exchanged": (lambda legs: [legs[0], legs[2], legs[1]], "legs"),
    "unloading to 0.3": (lambda legs: [legs[0], *rows(lambda d, P: d >= 0.3)(legs[1:])], "legs"),
    "unloading from 1.6": (
        lambda legs: [joined([legs[0], *rows(lambda d, P: (d > 1.5) & (d <= 1.6))(legs[2:])]), *legs[1:]],
        "legs",
    ),
    "sign of the unloading": (loads(lambda d, P: np.where(d < d[0], -P, P), 2), "curve-leg-2"),
    "spike in the unloading": (spike(2, 0.4, 0.08), "farthest-point"),
    "spike in the reloading": (spike(3, 0.25, 0.08), "farthest-point"),
    "dip behind the loop": (spike(3, 0.7, -0.08), "farthest-point"),
    "constant unloading": (loads(lambda d, P: np.full_like(P, P[0]), 2), "curve-leg-2"),
}

#: Right curves of any programme, and the checks of what they do not contain.
RIGHT: Mapping[str, tuple[Doctor, set[str]]] = {
    "as it is": (lambda legs: legs, set()),
    "every second point": (rows(lambda d, P: np.append(np.arange(0, len(d) - 1, 2), len(d) - 1)), set()),
    "half of the points": (some(0.5), set()),
    "a third of the points": (some(0.33), set()),
    "four times the points": (
        changed(lambda *leg: tuple(np.interp(np.arange(4 * len(v) - 3) / 4, np.arange(len(v)), v) for v in leg)),
        set(),
    ),
    "begins at 0.0067": (from_(0.0067), set()),
    "begins at 0.1": (from_(0.1), set()),
    "ends at 2.9999": (up_to(2.9999 / 3.0), set()),
    "ends at 3.2": (appended(-1, 3.2, 0.97), set()),
    "repeated rows": (rows(lambda d, P: np.repeat(np.arange(len(d)), 2)), set()),
    "noise of 0.05 %": (noise(5e-4), set()),
    "four digits": (changed(lambda d, P: (np.round(d, 4), np.array([float(f"{p:.4g}") for p in P]))), set()),
    "ends at 99.6 %": (up_to(0.996), {"end"}),
    "ends at 90 %": (up_to(0.9), {"end"}),
    "ends at 55 %": (up_to(0.55), {"end"}),
    "begins at 0.3": (from_(0.3), {"stiffness"}),
    "begins at 0.9": (from_(0.9), {"stiffness", "peak"}),
}

#: The same of a programme that unloads once.
RIGHT_LOOPS: Mapping[str, tuple[Doctor, set[str]]] = {
    "turns at 1.499": (turning_at(1.499), set()),
    "turns at 1.5001": (appended(0, 1.5001, 1.0), set()),
    "turns written twice": (
        lambda legs: [*rows(lambda d, P: np.append(np.arange(len(d)), -1))(legs[:-1]), legs[-1]],
        set(),
    ),
    "unloading of two points": (rows(lambda d, P: np.array([0, -1]), 2), set()),
    "unloading of five points": (rows(lambda d, P: np.linspace(0, len(d) - 1, 5).astype(int), 2), set()),
    "no last leg": (lambda legs: legs[:2], {"end"}),
    "the first leg alone": (lambda legs: legs[:1], {"end"}),
    "half of the unloading": (lambda legs: rows(lambda d, P: np.arange(len(d) // 2), 2)(legs[:2]), {"end"}),
}
