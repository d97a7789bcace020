"""Steps that end at a kink of the law, and the slope they tell there, so that few of them draw a smooth curve.

The load over the opening is a chain of short arcs, one for every quadrature point that breaks, and the slope jumps
between them by as much as it is itself: the exact slope somewhere on an arc says little of the curve. A step that ends
where a point breaks is always at the same place of the chain, and so is one that ends half way to where the next one
does: there the load is neither at the top nor at the foot of an arc, and such steps lie on one curve.

Steps that pass over several arcs end half way and tell the slope of the parabola through the last three of them; those
that go along a single one end at the kink and tell the mean of the exact slopes before and after.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from iga.interface.interface import Contact, Interface, holding
from iga.interface.laws import TractionLaw
from iga.system.state import State
from iga.system.system import System

#: How far beyond the kink a step ends, in parts of its gap, and how many points break on one that passes over arcs.
BEYOND, SEVERAL = 1e-9, 2

#: Opening and load.
Place = tuple[float, float]


@dataclass(frozen=True)
class Kink:
    """Point ``q`` stands on a kink of its law: the slope of the traction has just changed by ``jump``."""

    q: int
    jump: float


@dataclass(frozen=True)
class Landing:
    """Where a step is to end: with the gap ``target`` at point ``q``, on a ``kink`` or, without one, half an arc on.

    ``least`` is the gap of the kink, below which it has not been reached.
    """

    q: int
    target: float
    least: float
    kink: Kink | None


def landing(system: System, old: State, touch: Contact, g_q: np.ndarray, follows_on: bool = False) -> Landing | None:
    """The kink nearest to the gaps g_q (n_q,): where a point breaks or, as long as none has, passes its strength.

    ``old`` is the state before the step, and ``touch`` tells which points face the master. None where there is no such
    kink. A step over several arcs that ``follows_on`` one on which points broke, too, ends half an arc on from there.
    """
    law = system.interface.law
    g_q = np.where(holding(system.interface, touch), g_q, 0.0)
    broken = bool(np.any(g_q >= law.g_u))
    gap = law.g_u if broken else law.g_max
    q = int(np.argmin(np.where(g_q > old.k_q, np.abs(g_q - gap), np.inf)))
    passed_q = (g_q >= g_q[q]) & (old.k_q < gap)
    ahead_q = g_q[g_q > g_q[q]]
    half = follows_on and broken and np.count_nonzero(passed_q) >= SEVERAL and ahead_q.size > 0
    target = gap + 0.5 * (np.min(ahead_q) - g_q[q]) if half else gap * (1.0 + BEYOND)
    if not np.any(g_q >= gap) or old.k_q[q] >= gap or g_q[q] == target:
        return None
    return Landing(q, target, gap, None if half else Kink(q, law.jump(gap)))


def next_kink(system: System, old: State, start: Contact, touch: Contact, g_q: np.ndarray) -> Landing | None:
    """The first kink of any kind on the way from the gaps at the ``start`` of a step to g_q (n_q,), if there is one."""
    law, g0_q = system.interface.law, start.g_q
    g_q = np.where(holding(system.interface, touch), g_q, 0.0)
    part_qk = np.full((g_q.size, len(law.kinks)), np.inf)
    for column, kink in enumerate(law.kinks):
        passes_q = (old.k_q < kink) & (g_q >= kink) & (g0_q < kink)
        part_qk[passes_q, column] = (kink - g0_q[passes_q]) / (g_q - g0_q)[passes_q]
    q, which = (int(i) for i in np.unravel_index(int(np.argmin(part_qk)), part_qk.shape))
    if not np.isfinite(part_qk[q, which]):
        return None
    kink = law.kinks[which]
    return Landing(q, kink * (1.0 + BEYOND), kink, Kink(q, law.jump(kink)))


def travelled(interface: Interface, g_q: np.ndarray, q: int, target: float) -> np.ndarray | None:
    """Gaps (n_q,) after the crack has run on, as far as it takes the one at point q to a larger ``target``.

    While a crack runs its gaps travel along the interface with it and change little. None where they are nowhere as
    large as the target.
    """
    s_q = (interface.X_qi - interface.X_qi[q]) @ (interface.X_qi[-1] - interface.X_qi[0])
    order = np.argsort(s_q)
    s, g = s_q[order], g_q[order]
    at = int(np.flatnonzero(order == q)[0])
    way = 1 if g[min(at + 1, g.size - 1)] > g[max(at - 1, 0)] else -1
    further = np.flatnonzero(g[at::way] >= target)
    if further.size == 0 or further[0] == 0:
        return None
    there = at + way * int(further[0])
    part = (target - g[there - way]) / (g[there] - g[there - way])
    moved = s[there - way] + part * (s[there] - s[there - way])
    return np.interp(s_q + moved, s, g)


def broken_between(system: System, old: State, new: State) -> int:
    """How many points have broken from one state to another."""
    g_u = system.interface.law.g_u
    return int(np.count_nonzero((new.k_q >= g_u) & (old.k_q < g_u)))


def slope_over_arcs(first: Place, middle: Place, last: Place) -> float | None:
    """Slope at the last of three places (opening, load) of the parabola through them; None unless the opening grows.

    It leaves a smooth curve by ``h^2 / 3`` times the third derivative where they are ``h`` apart.
    """
    (a, at_a), (b, at_b), (c, at_c) = first, middle, last
    if not a < b < c:
        return None
    early, late = (at_b - at_a) / (b - a), (at_c - at_b) / (c - b)
    return late + (late - early) * (c - b) / (c - a)


#: How far beyond a kink a step that ends at one goes, in parts of the shortest branch of the law.
HAIR = 1e-3


@dataclass(frozen=True)
class Event:
    """Point ``q`` reaches its next kink ``away`` lengths of the tangent on, and is just beyond it at ``beyond``."""

    q: int
    away: float
    beyond: float


def next_event(law: TractionLaw, g_q: np.ndarray, k_q: np.ndarray, rate_q: np.ndarray) -> Event | None:
    """The first kink on opening: at the strength, at the return to the envelope, on it, at the end of softening."""
    soft_q = (k_q > law.g_max) & (g_q >= (1.0 - 1e-9) * k_q)
    kinks = np.array(law.kinks)
    next_q = kinks[np.minimum(np.searchsorted(kinks, k_q, side="right"), kinks.size - 1)]
    kink_q = np.where(soft_q, next_q, np.maximum(k_q, law.g_max))
    coming_q = (k_q < law.g_u) & (rate_q > 0.0)
    if not np.any(coming_q):
        return None
    away_q = np.where(coming_q, (kink_q - g_q) / np.where(coming_q, rate_q, 1.0), np.inf)
    q = int(np.argmin(away_q))
    hair = HAIR * float(np.min(np.diff(kinks, prepend=0.0)))
    return Event(q, float(away_q[q]), float(away_q[q] + hair / rate_q[q]))
