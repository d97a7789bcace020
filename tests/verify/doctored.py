"""Right curves written down otherwise, and wrong ones: each from a right curve, as a list of legs (opening, load)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

Leg = tuple[np.ndarray, np.ndarray]
Legs = Sequence[Leg]
Doctor = Callable[[Legs], Legs]


def joined(legs: Legs) -> Leg:
    """One path of all legs, the turns once."""
    parts = [legs[0], *((d[1:], P[1:]) for d, P in legs[1:])]
    return np.concatenate([d for d, _ in parts]), np.concatenate([P for _, P in parts])


def changed(leg: int, change: Callable[[np.ndarray, np.ndarray], Leg]) -> Doctor:
    """One leg, counted from 1, otherwise."""
    return lambda legs: [change(*one) if i == leg else one for i, one in enumerate(legs, 1)]


def every(change: Callable[[np.ndarray, np.ndarray], Leg]) -> Doctor:
    return lambda legs: [change(d, P) for d, P in legs]


def spike(leg: int, at: float, part: float) -> Doctor:
    """One converged point of a leg with a load that is ``part`` off."""

    def change(d: np.ndarray, P: np.ndarray) -> Leg:
        i = int(np.clip(at * len(d), 1, len(d) - 2))
        return d, np.where(np.arange(len(d)) == i, (1.0 + part) * P, P)

    return changed(leg, change)


def noise(part: float) -> Doctor:
    return every(lambda d, P: (d, P * (1.0 + part * np.random.default_rng(len(P)).standard_normal(len(P)))))


def some(keep: float) -> Doctor:
    """A part of the points, by chance; turns and ends, and the surroundings of the peak, are kept."""

    def change(d: np.ndarray, P: np.ndarray) -> Leg:
        kept = np.random.default_rng(len(d)).random(len(d)) < keep
        kept[[0, -1]] = True
        kept |= np.abs(np.arange(len(d)) - np.argmax(P)) < 4
        return d[kept], P[kept]

    return every(change)


def cut(leg: Leg, end: float) -> Leg:
    """A leg on which the opening grows, up to an opening on it."""
    d, P = leg
    return np.append(d[d < end], end), np.append(P[d < end], np.interp(end, d, P))


def up_to(part: float) -> Doctor:
    """The last leg as far as a part of its end."""
    return lambda legs: [*legs[:-1], cut(legs[-1], part * legs[-1][0][-1])]


def turning_at(top: float) -> Doctor:
    """The first unloading from an opening a little before the right one."""

    def doctor(legs: Legs) -> Legs:
        first, (d, P) = cut(legs[0], top), legs[1]
        later = d < top
        return [first, (np.append(top, d[later]), np.append(first[1][-1], P[later])), *legs[2:]]

    return doctor


def from_(opening: float) -> Doctor:
    """Without the beginning."""
    return changed(1, lambda d, P: (d[d >= opening], P[d >= opening]))


def straight(d: np.ndarray, P: np.ndarray, end: float) -> Leg:
    """A line of the same openings from the first load to another last one."""
    return d, P[0] + (end - P[0]) * (d - d[0]) / (d[-1] - d[0])


def plastic(part: float) -> Doctor:
    """An unloading that aims at a part of the opening that it begins at, and the way back along it."""

    def doctor(legs: Legs) -> Legs:
        first, (d, P), (e, Q) = legs[:3]
        rest = part * d[0]
        line = lambda x: P[0] * (x - rest) / (d[0] - rest)  # noqa: E731
        return [first, (d, line(d)), (e, np.where(e <= d[0], line(e), Q)), *legs[3:]]

    return doctor


def slack(legs: Legs) -> Legs:
    """The way back of a loop, lower than the unloading by up to 4 % of its load."""
    d, P = legs[2]
    top = legs[1][0][0]
    x = np.clip((d - d[0]) / (top - d[0]), 0.0, 1.0)
    return [*legs[:2], (d, P * (1.0 - 0.16 * x * (1.0 - x)))]


def fatigue(legs: Legs) -> Legs:
    """The crack grows on the way back: 2 % less load from the turn on."""
    return [*legs[:2], (legs[2][0], 0.98 * legs[2][1])]


def overshoot(legs: Legs) -> Legs:
    """The reloading goes on along its line, 5 % beyond the opening at which the unloading began."""
    d, P = legs[2]
    top, load = legs[1][0][0], legs[1][1][0]
    beyond = (d > top) & (d < 1.05 * top)
    return [*legs[:2], (d, np.where(beyond, load * d / top, P))]


def kinked(legs: Legs) -> Legs:
    """An unloading that falls fast and then slowly, between the right ends."""
    d, P = legs[1]
    x = (d - d[0]) / (d[-1] - d[0])
    return [legs[0], (d, P - 0.05 * P[0] * np.sin(np.pi * x)), *legs[2:]]


def rounded(digits: int) -> Doctor:
    return every(lambda d, P: (np.round(d, digits), np.array([float(f"{p:.{digits}g}") for p in P])))


#: Wrong curves of a programme that unloads once, and a word of the check that must say so.
WRONG_LOOPS: Mapping[str, tuple[Doctor, str]] = {
    "healing": (changed(2, lambda d, P: (d, P * (1.0 + 3.0 * (1.0 - d / d[0])))), "slope-leg-2"),
    "no unloading": (lambda legs: [legs[0], tuple(v[legs[2][0] > legs[1][0][0]] for v in legs[2])], "legs"),
    "unloading x -5": (changed(2, lambda d, P: (d, np.where(d < d[0], -5.0 * P, P))), "curve-leg-2"),
    "steeper unloading": (changed(2, lambda d, P: straight(d, P, P[0] - 1.1 * (P[0] - P[-1]))), "slope-leg-2"),
    "flatter unloading": (changed(2, lambda d, P: straight(d, P, P[0] - 0.98 * (P[0] - P[-1]))), "slope-leg-2"),
    "residual opening of 5 %": (plastic(0.05), "residual-leg-2"),
    "residual opening of 2 %": (plastic(0.02), "residual-leg-2"),
    "unloading displaced": (changed(2, lambda d, P: (d, P - 0.02 * P[0] * (d < d[0]))), "curve-leg-2"),
    "unloading with a belly": (kinked, "curve-leg-2"),
    "reloading overshoots": (overshoot, "farthest-point"),
    "the way back sags": (slack, "loop-leg-2"),
    "damage while reloading": (fatigue, "curve-leg-3"),
    "legs exchanged": (lambda legs: [legs[0], legs[2], legs[1]], "legs"),
    "unloading to 0.3": (
        lambda legs: [legs[0], *(tuple(v[leg[0] >= 0.3] for v in leg) for leg in legs[1:])],
        "legs",
    ),
    "unloading from 1.6": (
        lambda legs: [
            joined([legs[0], tuple(v[(legs[2][0] > 1.5) & (legs[2][0] <= 1.6)] for v in legs[2])]),
            *legs[1:],
        ],
        "legs",
    ),
    "sign of the unloading": (changed(2, lambda d, P: (d, np.where(d < d[0], -P, P))), "curve-leg-2"),
    "spike in the unloading": (spike(2, 0.4, 0.08), "farthest-point"),
    "spike in the reloading": (spike(3, 0.25, 0.08), "farthest-point"),
    "dip behind the loop": (spike(3, 0.7, -0.08), "farthest-point"),
    "constant unloading": (changed(2, lambda d, P: (d, np.full_like(P, P[0]))), "curve-leg-2"),
}

#: Wrong curves of any programme.
WRONG: Mapping[str, tuple[Doctor, str]] = {
    "spike before the peak": (spike(1, 0.1, 0.08), "farthest-point"),
    "spike early": (spike(1, 0.03, 0.08), "farthest-point"),
    "spike behind the peak": (spike(1, 0.6, 0.08), "farthest-point"),
    "dip behind the peak": (spike(1, 0.8, -0.08), "farthest-point"),
    "load x 1.01": (every(lambda d, P: (d, 1.01 * P)), "curve"),
    "load x 0.99": (every(lambda d, P: (d, 0.99 * P)), "curve"),
    "opening x 1.01": (every(lambda d, P: (1.01 * d, P)), "curve"),
    "opening x 0.99": (every(lambda d, P: (0.99 * d, P)), "curve"),
    "peak cut off": (every(lambda d, P: (d, np.minimum(P, 0.97 * np.max(P)))), "peak"),
    "offset of 1 % of the peak": (lambda legs: [(d, P + 0.01 * np.max(legs[0][1])) for d, P in legs], "curve"),
    "noise of 2 %": (noise(0.02), "curve"),
    "sign": (every(lambda d, P: (d, -P)), "curve"),
    "half the load": (every(lambda d, P: (d, 0.5 * P)), "curve"),
}

#: Right curves that contain a part of a programme, and the checks of what they do not contain.
IN_PART: Mapping[str, tuple[Doctor, set[str]]] = {
    "ends at 99.6 %": (up_to(0.996), {"end"}),
    "ends at 90 %": (up_to(0.9), {"end"}),
    "ends at 55 %": (up_to(0.55), {"end"}),
    "begins at 0.3": (from_(0.3), {"stiffness"}),
    "begins at 0.9": (from_(0.9), {"stiffness", "peak"}),
}

#: The same of a programme that unloads once.
IN_PART_OF_LOOPS: Mapping[str, tuple[Doctor, set[str]]] = {
    "no last leg": (lambda legs: legs[:2], {"end"}),
    "the first leg alone": (lambda legs: legs[:1], {"end"}),
    "half of the unloading": (
        lambda legs: [legs[0], tuple(v[: len(v) // 2] for v in legs[1])],
        {"end"},
    ),
}

#: Right curves.
RIGHT: Mapping[str, Doctor] = {
    "as it is": lambda legs: legs,
    "every second point": every(lambda d, P: (np.append(d[:-1:2], d[-1]), np.append(P[:-1:2], P[-1]))),
    "half of the points": some(0.5),
    "a third of the points": some(0.33),
    "four times the points": every(
        lambda d, P: tuple(np.interp(np.linspace(0, len(d) - 1, 4 * len(d) - 3), np.arange(len(d)), v) for v in (d, P))
    ),
    "begins at 0.0067": from_(0.0067),
    "begins at 0.1": from_(0.1),
    "ends at 2.9999": up_to(2.9999 / 3.0),
    "ends at 3.2": lambda legs: [
        *legs[:-1],
        (np.append(legs[-1][0], 3.2), np.append(legs[-1][1], 0.97 * legs[-1][1][-1])),
    ],
    "repeated rows": every(lambda d, P: (np.repeat(d, 2), np.repeat(P, 2))),
    "noise of 0.05 %": noise(5e-4),
    "four digits": rounded(4),
}

#: Right curves of a programme that unloads once.
RIGHT_LOOPS: Mapping[str, Doctor] = {
    "turns at 1.499": turning_at(1.499),
    "turns at 1.5001": lambda legs: [
        (np.append(legs[0][0], 1.5001), np.append(legs[0][1], legs[0][1][-1])),
        *legs[1:],
    ],
    "turns written twice": lambda legs: [
        tuple(np.append(v, v[-1]) for v in leg) if i < len(legs) - 1 else leg for i, leg in enumerate(legs)
    ],
    "unloading of two points": changed(2, lambda d, P: (d[[0, -1]], P[[0, -1]])),
    "unloading of five points": changed(
        2, lambda d, P: tuple(v[np.linspace(0, len(v) - 1, 5).astype(int)] for v in (d, P))
    ),
}
