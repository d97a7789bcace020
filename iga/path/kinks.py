"""Kinks of the law on the way of a step, and the slope where a step ends at one, so that few steps draw a smooth curve.

The load over the opening is a chain of short arcs, one for every quadrature point that breaks. The slope jumps between
arcs by as much as its own size, so that the exact slope somewhere on an arc says little of the curve. Steps that end
where a point breaks all end at the same place of their arc; so do steps that end a fixed part of the way to the next
break. Arcs are nearly parabolas: where one crosses its own mean (`AT_MEAN`) the load is that of the smooth curve, which
it is neither at the top nor at the foot of an arc.

Steps that pass over several arcs end there and have the slope of the parabola through the last three of them; those
that go along a single one end at the kink and have the mean of the exact slopes before and after.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from iga.interface.contact import Contact
from iga.interface.interface import Interface
from iga.interface.response import holding
from iga.system.state import Response, State
from iga.system.system import System


@dataclass(frozen=True)
class Distances:
    """How far beyond a kink a step ends: far enough for rounding, and near enough to count as on the kink.

    ``on``: relative to the gap of the kink, for a step that ends on the kink. ``past``: relative to the shortest branch
    of the law, for a step that passes the kink along the tangent, which is not exactly on the path.
    """

    on: float = 1e-9
    past: float = 1e-3


DISTANCES = Distances()

#: A step on which at least so many points break passes over several arcs.
SEVERAL = 2

#: Part of an arc after which a parabola over it crosses its own mean.
AT_MEAN = 0.5 - 12.0**-0.5

#: Opening and load.
Place = tuple[float, float]


@dataclass(frozen=True)
class Kink:
    """Point ``q`` of the interface and the ``gap`` (`Response.x_q`) at which the slope of its traction jumps."""

    q: int
    gap: float


@dataclass(frozen=True)
class StepEnd:
    """Where a step ends: with the gap ``target`` at the point of a ``kink``, ``on`` it or a part of an arc beyond."""

    kink: Kink
    target: float
    on: bool = True


def on_kink(kink: Kink) -> StepEnd:
    """A step that ends on a kink, just beyond it."""
    return StepEnd(kink, kink.gap * (1.0 + DISTANCES.on))


def first_kink(
    kinks: np.ndarray, g_q: np.ndarray, k_q: np.ndarray, change_q: np.ndarray, reloading: bool = True
) -> tuple[Kink, float] | None:
    """The first of the ``kinks`` of a law that a point reaches while the gaps g_q (n_q,) open by ``change_q``, and the
    part of the change that leads there (above 1: beyond the change).

    Points on the envelope have the next kink of the envelope ahead. With ``reloading`` points off the envelope have a
    kink where they return to it, at their history k_q (n_q,).
    """
    begins, ends = kinks[0], kinks[-1]
    kink_q = kinks[np.minimum(np.searchsorted(kinks, k_q, side="right"), kinks.size - 1)]
    if reloading:
        soft_q = (k_q > begins) & (g_q >= (1.0 - 1e-9) * k_q)
        kink_q = np.where(soft_q, kink_q, np.maximum(k_q, begins))
    coming_q = (k_q < ends) & (change_q > 0.0)
    if not np.any(coming_q):
        return None
    part_q = np.where(coming_q, (kink_q - g_q) / np.where(coming_q, change_q, 1.0), np.inf)
    q = int(np.argmin(part_q))
    return Kink(q, float(kink_q[q])), float(part_q[q])


def first_end(system: System, old: State, start: Response, touch: Contact, g_q: np.ndarray) -> StepEnd | None:
    """A step's end on the first kink of the envelope between the gaps at its ``start`` and g_q (n_q,), if there is one.

    ``old`` is the state before the step, and ``touch`` says which points face the master.
    """
    change_q = np.where(holding(system.interface, touch), g_q - start.x_q, 0.0)
    found = first_kink(np.array(system.interface.law.kinks), start.x_q, start.back_q, change_q, reloading=False)
    return on_kink(found[0]) if found is not None and found[1] <= 1.0 else None


def nearest_end(
    system: System, k_q: np.ndarray, touch: Contact, g_q: np.ndarray, follows_on: bool = False
) -> StepEnd | None:
    """A step's end at the kink nearest to the gaps g_q (n_q,): where a point breaks or, if none does, begins to soften.

    ``k_q`` (n_q,) is the history at the start; ``touch`` as for `first_end`. None where there is no such kink.
    ``follows_on``: points broke on the step before, too; a step over several arcs then ends where the next arc crosses
    its mean.
    """
    begins, *_, ends = system.interface.law.kinks
    g_q = np.where(holding(system.interface, touch), g_q, 0.0)
    broken = bool(np.any(g_q >= ends))
    gap = ends if broken else begins
    q = int(np.argmin(np.where(g_q > k_q, np.abs(g_q - gap), np.inf)))
    passed_q = (g_q >= g_q[q]) & (k_q < gap)
    ahead_q = g_q[g_q > g_q[q]]
    end = on_kink(Kink(q, gap))
    if follows_on and broken and np.count_nonzero(passed_q) >= SEVERAL and ahead_q.size > 0:
        end = StepEnd(end.kink, gap + AT_MEAN * (np.min(ahead_q) - g_q[q]), on=False)
    return end if np.any(g_q >= gap) and k_q[q] < gap and g_q[q] != end.target else None


@dataclass(frozen=True)
class Run:
    """How far a crack has run on: the places s_q (n_q,) of all points along the interface, and the distance.

    While a crack runs the profile of its gaps travels along the interface and changes little.
    """

    s_q: np.ndarray
    distance: float

    def travelled(
        self, v_q: np.ndarray, part: np.ndarray | float = 1.0, q: np.ndarray | slice = slice(None)
    ) -> np.ndarray:
        """Values v_q (n_q,) at the points q after they have travelled a part of the distance with the crack."""
        return np.interp(self.s_q[q] + part * self.distance, self.s_q[self.order], v_q[self.order])

    @cached_property
    def order(self) -> np.ndarray:
        """The points (n_q,) in their order along the interface."""
        return np.argsort(self.s_q)


def run_to(interface: Interface, g_q: np.ndarray, q: int, target: float) -> Run | None:
    """The crack running on until the gap at point q is the larger ``target``; None where no gap behind is as large."""
    s_q, apart = _along(interface, q)
    order = np.argsort(s_q)
    s, g = s_q[order], g_q[order]
    at = int(np.flatnonzero(order == q)[0])
    way = 1 if g[min(at + 1, g.size - 1)] > g[max(at - 1, 0)] else -1
    further = np.flatnonzero(g[at::way] >= target)
    if further.size == 0 or further[0] == 0:
        return None
    there = at + way * int(further[0])
    if abs(s[there] - s[at]) > 0.5 * apart:
        return None
    part = (target - g[there - way]) / (g[there] - g[there - way])
    return Run(s_q, float(s[there - way] + part * (s[there] - s[there - way])))


def _along(interface: Interface, q: int) -> tuple[np.ndarray, float]:
    """Places s_q (n_q,) of all points along the interface from point q on. Those of a solid stand line by line, each so
    far ``apart`` from the next that no profile travels from one to another."""
    X_qi = interface.X_qi - interface.X_qi[q]
    if X_qi.shape[1] == 2:
        return X_qi @ (interface.X_qi[-1] - interface.X_qi[0]), np.inf
    s_q, line_q = X_qi @ interface.forward_i, interface.line_q
    apart = 4.0 * float(np.ptp(s_q))
    return s_q + apart * (line_q - line_q[q]), apart


def broken_between(system: System, old: State, new: State) -> int:
    """How many points have broken from one state to another."""
    failed = system.interface.law.failed
    return int(np.count_nonzero((new.k_q >= failed) & (old.k_q < failed)))


def slope_over_arcs(first: Place, middle: Place, last: Place) -> float | None:
    """Slope at the last of three places (opening, load) of the parabola through them; None unless the opening grows.

    Its error for a smooth curve is ``h^2 / 3`` times the third derivative where the places are ``h`` apart.
    """
    (a, at_a), (b, at_b), (c, at_c) = first, middle, last
    if not a < b < c:
        return None
    early, late = (at_b - at_a) / (b - a), (at_c - at_b) / (c - b)
    return late + (late - early) * (c - b) / (c - a)
