"""The point of a curve that is farthest from another one along one load programme."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from verify.curves.curve import Curve, envelope
from verify.curves.legs import Leg, Path, path
from verify.curves.nearness import LEAST_LOAD, LEAST_OPENING, distances
from verify.curves.scatter.found import NO_SCATTER, SIGMAS, Scatter
from verify.verdict import Check, Kind

#: Fall of the opening on a leg, in parts of its largest one, from which it is a snap-back and no noise.
GOES_BACK = 0.01

#: Part of a tolerance up to which the difference of the loads is taken for the distance of a point.
NO_MATTER = 0.25

#: A single point may be farther off than a whole curve, by the tolerance of the curve times this.
OF_A_POINT = 4.0


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
    judged: bool = True,
    near: tuple[float, float] = (-np.inf, np.inf),
    scatter: Scatter = NO_SCATTER,
) -> Farthest | None:
    """The point of A that is farthest from B, leg by leg, as far as B goes; see `verify.curves.nearness.distances`.

    With ``judged`` every point of A counts. Without, the points of a snap-back of A count only where B has a snap-back:
    under control of the opening, as in a test, the load of B drops vertically there. Points at openings outside
    ``near`` do not count.

    With ``scatter`` of A a point may lie anywhere within half of its quanta, and no load is smaller than that of which
    ``enough`` is `SIGMAS` times the noise.
    """
    sizes = sizes_of(b)
    found: list[Farthest] = []
    if not sizes.min() > 0.0:
        return None
    for i, (mine, other) in enumerate(zip(a.legs, b.legs, strict=False), 1):
        if common_range(mine, other) is None:
            continue
        graph = other.onward
        d, P = mine.onward if judged or _goes_back(other) else envelope(*mine.onward)
        there = (d <= np.max(graph[0])) & (mine.heading * d >= near[0]) & (mine.heading * d <= near[1])
        if not there.any():
            continue
        size = size_at(other, d[there], sizes)
        d, P = d[there], P[there]
        noise = SIGMAS * scatter.noise / enough if scatter.noise else 0.0
        least = np.maximum(LEAST_LOAD, noise / size[1])
        scale = np.maximum(np.abs(d), LEAST_OPENING * size[0]), np.maximum(np.abs(P), least * size[1])
        loose = np.sum(scatter.half(d, P) / scale, axis=0)
        off = distances((d, P), graph, size, NO_MATTER * enough, enough + np.max(loose), least)
        off = np.maximum(off - loose, 0.0)
        worst = int(np.argmax(off))
        found.append(Farthest(float(off[worst]), i, float(mine.heading * d[worst]), float(P[worst])))
    return max(found, key=lambda one: one.value, default=None)


def _goes_back(leg: Leg) -> bool:
    """Whether the opening falls on a leg by more than its rounding or noise."""
    d = leg.onward[0]
    return bool(np.max(np.maximum.accumulate(d) - d) > GOES_BACK * np.max(np.abs(d)))


def farthest_check(
    subject: str,
    a: Curve,
    b: Curve,
    programme: Sequence[float],
    tolerance: float,
    kind: Kind = "cross-code",
    scatter: Scatter = NO_SCATTER,
) -> tuple[Check, ...]:
    """The point of A that is farthest from B; nothing where they have no opening in common.

    Parameters
    ----------
    tolerance : that of the curve
    scatter : of A
    """
    worst = farthest(path(a, programme), path(b, programme), OF_A_POINT * tolerance, scatter=scatter)
    if worst is None:
        return ()
    meaning = (
        "No point is farther from the other curve, in parts of its own opening and load: the farthest is at "
        f"opening {worst.opening:.6g}, load {worst.load:.6g}, on leg {worst.number}."
    )
    return (Check("farthest-point", subject, worst.value, OF_A_POINT * tolerance, kind, meaning, at=worst.opening),)


def sizes_of(path: Path) -> np.ndarray:
    """Largest opening and load (2, 2) of all legs, below zero and above; a side without any has those of the other.

    Faces that are pressed together may bear a hundred times what a bond does that opens.
    """
    sizes = np.zeros((2, 2))
    for leg in path.legs:
        above = leg.above_zero(leg.opening)
        for side, on in enumerate((~above & (leg.opening <= 0.0), above & (leg.opening >= 0.0))):
            most = [np.max(np.abs(values[on]), initial=0.0) for values in (leg.opening, leg.load)]
            sizes[side] = np.maximum(sizes[side], most)
    return np.where(sizes > 0.0, sizes, sizes[::-1])


def size_at(leg: Leg, onward: np.ndarray, sizes: np.ndarray) -> np.ndarray:
    """The sizes (2, n) on the side of zero of openings (n,) of a leg, times its heading."""
    return sizes[leg.above_zero(leg.heading * onward).astype(int)].T


def common_range(*legs: Leg) -> tuple[float, float] | None:
    """The openings, times their heading, that all of some legs of one heading pass through."""
    low = max(float(leg.onward[0][0]) for leg in legs)
    high = min(float(np.max(leg.onward[0])) for leg in legs)
    return (low, high) if high > low else None
