"""The displacement paths on which a law of opening and sliding is judged, scaled to the jumps of its bond."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from verify.theory.mixed_law import MixedBond

#: Path that goes straight from rest to failure -> its mode ratio by energy.
PATH_RATIOS = {"mode-I": 0.0, "mode-II": 1.0, "mixed-20": 0.2, "mixed-50": 0.5, "mixed-80": 0.8}
#: Path that slides to failure under a constant pressure -> that over the shear strength.
PRESSURES = {"compressed-shear-1": 0.01, "compressed-shear-2": 0.3, "compressed-shear-3": 1.0}
#: Path with the opposite sign of slip -> that which it is like.
OPPOSITES = {f"{name}-negative": name for name in ("mode-II", "mixed-50", "compressed-shear-2")}
#: Steps of a leg through damage, of one without any, and in either direction of the path that goes by turns.
LEG, SHORT_LEG, STAIRS = 40, 6, 12
#: Where paths end, over the jump at failure, more than sqrt(2); and over that where those end that go far beyond.
BEYOND_FAILURE, FAR_BEYOND = 1.5, 100.0
#: Exponents of exp(-x - y^2) of the exponential law: before the peak, behind it, and where 1e-12 is left.
MILESTONES = (0.5, 1.5, 27.6)
#: Steps closer than this part of a leg are merged.
SAME_STEP = 1e-9


@dataclass(frozen=True, eq=False)
class JumpPath:
    """Openings ``g`` (n,) and slips ``s`` (n,) [length] at every step; step 0 is the undamaged state.

    Time goes from 0 to 1 in equal steps.
    """

    name: str
    what: str  # one sentence for the reader of the page
    g: np.ndarray
    s: np.ndarray

    @property
    def jump(self) -> np.ndarray:
        """Opening and slip (2, n)."""
        return np.array([self.g, self.s])

    @property
    def time(self) -> np.ndarray:
        """Of each step (n,), 0 to 1."""
        return np.linspace(0.0, 1.0, self.g.size)

    @property
    def ratio(self) -> float | None:
        """The mode ratio by energy of a path that goes straight from rest to failure."""
        return PATH_RATIOS.get(self.name)


def paths(bond: MixedBond, shear: bool = True) -> tuple[JumpPath, ...]:
    """All paths of a bond; without ``shear`` those that only open and close.

    A rotation of the frame by 180 degrees about the normal changes the sign of the slip, which one path does on its
    way; swapping the two faces changes neither opening nor slip. Other rotations can only be tested on a mesh, as a law
    of two scalars does not depend on them.
    """
    found = {path.name: path for path in _along_legs(bond)}
    every = [*found.values(), *_turned(found), *_still_or_nearly_closed(bond)]
    return tuple(path for path in every if shear or not path.s.any())


@dataclass(frozen=True, eq=False)
class Ray:
    """Jumps (2,) at one mode ratio: where damage begins, half way to failure, and beyond failure.

    ``kinks`` are the sizes of jumps, in the energy norm lambda, at which the slope of the law changes suddenly.
    """

    onset: np.ndarray
    half: np.ndarray
    end: np.ndarray
    kinks: Sequence[float]


def _ray(bond: MixedBond, B: float, pressure: float = 0.0) -> Ray:
    """The ray of mode ratio ``B`` by energy; under ``pressure`` [stress] B is 1."""
    K, Ks = bond.slopes
    g, s = unit = np.sqrt([(1.0 - B) / K, B / Ks])  # the jump of size 1
    if bond.law == "exponential":
        x = g * np.e * bond.strength[0] / bond.toughness[0]
        y = s * bond.strength[1] / bond.toughness[1] * (np.e / 2.0) ** 0.5
        kinks, sizes = [], [2.0 * c / (x + (x * x + 4.0 * y * y * c) ** 0.5) for c in MILESTONES]
    else:
        kinks = [float(size) for size in bond.corners(B, pressure * bond.contact)]
        sizes = [kinks[0], 0.5 * (kinks[0] + kinks[-1]), kinks[-1]]
    onset, half, end = (size * unit for size in sizes)
    slips = bond.friction * pressure / Ks**0.5  # where friction reaches its limit
    return Ray(onset, half, BEYOND_FAILURE * end, [*kinks, slips])


def _along_legs(bond: MixedBond) -> Iterator[JumpPath]:
    """The table of the paths with straight legs: name, sentence, corners, steps of the legs, a ray with its kinks."""
    opened, slid, mixed = (_ray(bond, B) for B in (0.0, 1.0, 0.5))
    rest, press = np.zeros(2), np.array([-bond.strength[0] / bond.penalty, 0.0])
    rows: list[tuple[str, str, Sequence[np.ndarray], Sequence[int], Ray | None]] = []
    for name, B in PATH_RATIOS.items():
        what, ray = f"To failure at a constant ratio, {100.0 * B:g} % of the energy in sliding.", _ray(bond, B)
        rows += [(name, what, [ray.end], [LEG], ray)]
    for name, ray in (("I", opened), ("II", slid), ("50", mixed)):
        corners, steps = [ray.half, rest, ray.half, ray.end], [LEG, SHORT_LEG, SHORT_LEG, LEG]
        rows += [(f"unload-reload-{name}", "Unloaded and reloaded half way to failure.", corners, steps, ray)]
    what = "Opened half way, closed and pressed, opened to failure, closed and pressed again."
    corners = [opened.half, rest, press, rest, opened.end, rest, press]
    rows += [("contact", what, corners, [LEG, *[SHORT_LEG] * 3, LEG, *[SHORT_LEG] * 2], opened)]
    corners, steps = [opened.end, FAR_BEYOND * opened.end, rest], [LEG, SHORT_LEG, SHORT_LEG]
    rows += [("far-I", "Opened far beyond failure, and back to nothing.", corners, steps, opened)]
    corners = [mixed.end, FAR_BEYOND * mixed.end, rest, press, press + (0.0, mixed.end[1])]
    rows += [("far-50", "Far beyond failure and back; then pressed and slid.", corners, [LEG, *[SHORT_LEG] * 4], mixed)]
    for name, part in PRESSURES.items():
        q = part * bond.strength[1]
        ray, closed = _ray(bond, 1.0, q), np.array([-q / bond.penalty, 0.0])
        what = f"Closed under a pressure of {100 * part:g} % of the shear strength, then slid to failure."
        rows += [(name, what, [closed, closed + ray.end], [SHORT_LEG, LEG], ray)]
        if name == "compressed-shear-2":
            what = "Slid half way under pressure, back beyond the start, and to failure."
            corners = [closed, closed + ray.half, closed - 0.8 * ray.half, closed + ray.end]
            rows += [("compressed-cycle", what, corners, [SHORT_LEG, LEG, LEG, LEG], ray)]
    two, three, stairs = [LEG, 2 * LEG], [LEG, SHORT_LEG, 2 * LEG], np.arange(1, 2 * STAIRS + 1)
    half_I, end_I, half_II, end_II = opened.half, opened.end, slid.half, slid.end
    turns = np.stack([(stairs + 1) // 2, stairs // 2], axis=1) / STAIRS * (end_I + end_II)
    rows += [
        ("opening-then-shear", "Opened half way, held, then slid to failure.", [half_I, half_I + end_II], two, None),
        ("shear-then-opening", "Slid half way, held, then opened to failure.", [half_II, half_II + end_I], two, None),
        ("opening-closed-shear", "Opened half way, closed, then slid to failure.", [half_I, rest, end_II], three, None),
        ("shear-back-opening", "Slid half way, back, then opened to failure.", [half_II, rest, end_I], three, None),
        ("alternating", "Opening and sliding by turns.", [*turns], [4] * stairs.size, None),
    ]
    for name, what, ends, counts, at in rows:
        legs = zip([rest, *ends[:-1]], ends, counts, strict=True)
        jumps = [_leg(bond, a, b, n, at.kinks if at else ()) for a, b, n in legs]
        yield JumpPath(name, what, *np.concatenate([[rest], *jumps]).T)


def _leg(bond: MixedBond, a: np.ndarray, b: np.ndarray, n: int, kinks: Sequence[float]) -> np.ndarray:
    """Jumps (m, 2) from behind a to b: n equal steps, and the ``kinks`` [lambda] of a leg that does not turn back."""
    x, y = (np.maximum(jump, (0.0, -np.inf)) * np.sqrt(bond.slopes) for jump in (a, b))
    at, before, after = np.linspace(0.0, 1.0, n + 1), np.hypot(*x), np.hypot(*y)
    if before != after and x @ y >= 0.0:
        inner = (np.array(kinks) - before) / (after - before)
        at = np.sort(np.append(at, inner[(inner > 0.0) & (inner < 1.0)]))
        at = at[np.append(True, np.diff(at) > SAME_STEP)]
    part = at[1:, None]
    return np.where(part == 1.0, b, a + part * (b - a))


def _turned(known: Mapping[str, JumpPath]) -> Iterator[JumpPath]:
    """Paths with another sign of the slip than those that are ``known``."""
    for name, other in OPPOSITES.items():
        what = f"The path {other} with the opposite sign of slip."
        yield replace(known[other], name=name, what=what, s=-known[other].s)
    path, what = known["mixed-50"], "Both; the frame turns half way, and the slip changes its sign."
    sign = np.where(np.arange(path.s.size) < path.s.size // 2, 1.0, -1.0)
    yield replace(path, name="turned-frame", what=what, s=sign * path.s)


def _still_or_nearly_closed(bond: MixedBond) -> Iterator[JumpPath]:
    """Jumps of next to nothing; gaps of 0 and just above or below it at rising slips."""
    first, ray = _ray(bond, 0.0).onset[0], _ray(bond, 1.0)
    tiny = np.array([0.0, 0.0, 0.0, 1e-12 * first, 0.0, 0.0])
    yield JumpPath("zero", "Nothing moves; then jumps of 1e-12 of the onset.", tiny, np.zeros(6))
    gaps = np.array([0.0, 5e-324, -5e-324, *first * np.array([2.0**-52, -(2.0**-52), 1e-9, -1e-9])])
    onset, end = ray.onset[1], ray.end[1]
    slips = [0.5 * onset, *np.linspace(onset, end / BEYOND_FAILURE, 6)[1:-1], end]
    what = "Sliding, with the faces a last digit or 1e-9 of the onset open and closed."
    for name, order in (("closed-either-side", gaps), ("closed-other-side", np.roll(gaps, -2)[::-1])):
        g, s = np.append(0.0, np.tile(order, len(slips))), np.append(0.0, np.repeat(slips, order.size))
        yield JumpPath(name, what, g, s)
