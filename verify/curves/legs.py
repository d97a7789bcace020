"""The legs of a load programme, and the turns of a curve between them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from verify.curves.curve import Curve, from_origin, load_at
from verify.support.programme import turns

#: Turns that differ by this part of the largest opening are the same, up to rounding.
SAME_TURN = 1e-6

#: Largest distance of turns and end of a curve from those of the programme, in parts of the largest opening: a fifth of
#: the tolerance between two codes.
#: The load of a branch ``P ~ opening^-1/2`` changes by half of it, the stiffness of an unloading by 3/2.
TURN_TOLERANCE = 1e-3

#: Without a programme: a curve unloads where its opening falls by this part of its largest one, unless its crack grows
#: and it comes back at smaller loads, by this part of the work.
DEEP, LOST = 0.05, 0.02

#: Rows of a fall that tell an unloading from a snap-back, in parts of the load at its beginning. At smaller loads a
#: residual opening makes the compliance of an unloading grow without bounds.
LOADED = 0.2

#: Growth of log C over the fall of log d from which a fall of the opening is a snap-back: an ENF specimen has 0.6 to 1
#: where its opening is least, an unloading that leaves a residual opening of 5 % has 0.13.
SNAPS = 0.25


@dataclass(frozen=True)
class Leg:
    """The path between two turns; ``begin`` and ``end`` are the openings of the programme."""

    begin: float
    end: float
    opening: np.ndarray  # (n,) from the turn that the path has made at the beginning to that at the end
    load: np.ndarray  # (n,)

    @property
    def heading(self) -> float:
        """1 where the opening grows, -1 where it falls."""
        return 1.0 if self.end > self.begin else -1.0

    @property
    def unloads(self) -> bool:
        """Whether the opening comes closer to zero."""
        return self.heading * self.begin < 0.0

    def above_zero(self, opening: np.ndarray) -> np.ndarray:
        """Whether openings (n,) of the leg are above zero; all of them, or none, of a leg that does not cross it."""
        return opening >= 0.0 if self.begin * self.end < 0.0 else np.full(opening.shape, self.begin + self.end > 0.0)

    @property
    def words(self) -> str:
        if self.heading < 0.0:
            what = "unloading" if self.begin > 0.0 else "closing"
        else:
            what = "loading" if self.begin == 0.0 else "reloading"
        return f"{what} from {self.begin:g} to {self.end:g}"

    @property
    def onward(self) -> tuple[np.ndarray, np.ndarray]:
        """The path over ``heading`` times the opening, in whose envelope that grows."""
        return self.heading * self.opening, self.load


@dataclass(frozen=True)
class Path:
    """A curve along a programme.

    ``legs`` end with the first that does not turn where the programme does; ``misfit`` is by how much, as part of the
    largest opening of the programme.
    """

    legs: tuple[Leg, ...]
    misfit: float

    @property
    def complete(self) -> bool:
        return self.misfit <= TURN_TOLERANCE

    @property
    def sizes(self) -> np.ndarray:
        """Largest opening and load (2, 2) of all legs, below zero and above; a side without any has those of the other.

        Faces that are pressed together may bear a hundred times what a bond does that opens.
        """
        sizes = np.zeros((2, 2))
        for leg in self.legs:
            above = leg.above_zero(leg.opening)
            for side, on in enumerate((~above & (leg.opening <= 0.0), above & (leg.opening >= 0.0))):
                most = [np.max(np.abs(values[on]), initial=0.0) for values in (leg.opening, leg.load)]
                sizes[side] = np.maximum(sizes[side], most)
        return np.where(sizes > 0.0, sizes, sizes[::-1])


def path(curve: Curve, programme: Sequence[float]) -> Path:
    """The legs of a curve along a programme.

    A leg ends where the path first comes to its goal, or is farthest as long as it stays there: before that the
    opening may fall, as at a snap-back. A curve that begins beyond 0 is joined to the origin by a straight line.

    Where the turns are not those of the programme to the last digits, all that lie within `TURN_TOLERANCE` of it count.
    """
    corners = turns(programme)
    d, P = from_origin(*curve, ahead=corners[0])
    exact = _split(d, P, corners, SAME_TURN)
    return exact if exact.misfit <= SAME_TURN else _split(d, P, corners, TURN_TOLERANCE)


def _split(d: np.ndarray, P: np.ndarray, corners: Sequence[float], near: float) -> Path:
    size, here, misfit = max(map(abs, corners)), 0, 0.0
    legs: list[Leg] = []
    for begin, end in zip((0.0, *corners[:-1]), corners, strict=True):
        heading = 1.0 if end > begin else -1.0
        ahead = heading * d[here:]
        there = ahead >= heading * end - near * size
        first = int(np.argmax(there)) if there.any() else 0
        stay = first + int(np.argmin(there[first:])) if there.any() and not there[first:].all() else len(ahead)
        last = here + first + int(np.argmax(ahead[first:stay]))
        beyond = heading * (d[last] - end) / size
        misfit = max(misfit, -beyond if len(legs) == len(corners) - 1 else abs(beyond))
        legs.append(Leg(begin, end, d[here : last + 1], P[here : last + 1]))
        if misfit > near:
            break
        here = last
    return Path(tuple(legs), float(misfit))


def programme_of(curve: Curve) -> tuple[float, ...]:
    """The programme that a curve itself shows: its turns and its last opening.

    A `DEEP` fall of the opening is an unloading, unless the crack grows on it (`unloads_alone`) and the path comes back
    at smaller loads: the loops of a test lose work, and leave an opening, without a growth of the crack. What is no
    unloading is a snap-back, or its image in converged steps.
    """
    d, P = from_origin(*curve)
    pivots = _pivots(d, DEEP * float(np.max(np.abs(d))))
    k = 1
    while k < len(pivots) - 1:
        high, low, *on = pivots[k : k + 3]
        if d[low] > d[high] or not _snaps_back(d, P, high, low, on[0] if on else low):
            k += 1
            continue
        again = bool(on) and d[on[0]] >= d[high]
        pivots = pivots[:k] + pivots[k + 2 :] if again else pivots[: k + 1] + pivots[k + 3 :]
        k = 1
    return tuple(float(d[i]) for i in pivots[1:])


def _pivots(d: np.ndarray, deep: float) -> list[int]:
    """The first point, the turns between which the opening changes by ``deep`` or more, and the farthest after them."""
    change = np.sign(np.diff(d))
    moving = np.flatnonzero(change)
    turning = moving[1:][change[moving[1:]] != change[moving[:-1]]]
    pivots, farthest = [0], 0
    for i in [*turning.tolist(), len(d) - 1]:
        heading = np.sign(d[farthest] - d[pivots[-1]]) or np.sign(d[i] - d[pivots[-1]])
        if heading * (d[i] - d[farthest]) >= 0.0:
            farthest = i
        elif abs(d[i] - d[farthest]) >= deep:
            pivots.append(farthest)
            farthest = i
    return [*pivots, farthest]


def _snaps_back(d: np.ndarray, P: np.ndarray, high: int, low: int, end: int) -> bool:
    """Whether a fall from the row ``high`` to ``low`` is a snap-back, after which the opening grows up to ``end``."""
    fall, rise = slice(high, low + 1), slice(low, end + 1)
    if unloads_alone(d[fall], P[fall]):
        return False
    if end == low:
        return True
    grid = np.linspace(d[low], min(d[high], d[end]), 101)
    down, up = load_at((-d[fall], P[fall]), -grid), load_at((d[rise], P[rise]), grid)
    return bool(np.nansum(down - up) > LOST * np.nansum(np.abs(down)))


def unloads_alone(d: np.ndarray, P: np.ndarray) -> bool:
    """Whether a specimen only unloads while its opening (n,) falls from the first row: its compliance stays nearly the
    same, so that no crack grows.

    Only rows that bear at least `LOADED` of the first load are compared; without such rows the specimen unloads.
    """
    loaded = np.flatnonzero(P >= LOADED * P[0])
    if not loaded.size:
        return True
    low = loaded[np.argmin(d[loaded])]
    with np.errstate(all="ignore"):
        growth = np.log((d[low] / P[low]) / (d[0] / P[0]))
        return bool(growth <= SNAPS * np.log(d[0] / d[low]))
