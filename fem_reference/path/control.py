"""The control equation of a step: one linear functional of the displacements is prescribed; its choice.

The path is not followed by PETSc's arc-length solver (SNESNEWTONAL). That measures a step by the norm of all
displacements, which a growing crack hardly changes: with 28 quadratic elements, p_max = 10 and a reversible bond it
reached opening 0.97 of 3 after 4000 iterations, while control by the front reaches 3 in about 400. It also takes all
increments in one call, so that no history can be committed between them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem_reference.model.model import Model
from fem_reference.path.state import State, ordered_along
from fem_reference.path.stride import Stride

#: A point counts as having growing damage if its damage would grow within this many steps.
LOOKAHEAD = 2.0

#: A step that ends at the onset of damage ends before it by this distance, in units of the front's measure: more than
#: rounding.
LANDING = 1e-7

#: A point of the bond: the rank that owns it, and its index there.
PointOfBond = tuple[int, int]


@dataclass(frozen=True)
class Control:
    """The equation ``row_n @ u_n = value``, summed over the ranks."""

    row_n: np.ndarray
    value: float


def opening_control(model: Model, opening: float) -> Control:
    """Control by the mean opening of the loaded faces."""
    return Control(model.load_n, opening)


@dataclass(frozen=True)
class Front:
    """The most open point of the bond whose damage grows, or soon will.

    ``gap`` is its gap, or with shear its scaled jump; ``missing`` the increase of the gap before damage grows; ``rate``
    d gap / d opening. ``row_n`` is the change of the gap as a functional of the displacements, ``level`` the present
    value of this functional.
    """

    place: PointOfBond
    gap: float
    missing: float
    rate: float
    row_n: np.ndarray
    level: float

    def change(self, model: Model, stride: Stride) -> float:
        """Change of the gap in a step: at most the front's largest step, or up to where damage begins to grow."""
        most = self.missing + stride.front * model.law.unit
        if stride.lands and self.missing > 4 * LANDING * model.law.unit:
            most = self.missing - LANDING * model.law.unit
        return float(np.copysign(min(abs(self.rate) * stride.reach, most), self.rate))

    def calm(self, model: Model, stride: Stride) -> bool:
        """Whether damage grows so slowly that the opening can be prescribed instead."""
        return self.missing == 0.0 and abs(self.rate) * stride.reach < stride.front * model.law.unit

    def within(self, model: Model, stride: Stride, left: float) -> bool:
        """Whether the distance ``left`` in the opening can be covered in one step."""
        return left <= stride.reach and abs(self.rate) * left <= self.missing + stride.front * model.law.unit

    def control(self, model: Model, stride: Stride) -> Control:
        """Control by the gap of the front, which grows steadily even where the opening has to decrease (snap-back)."""
        return Control(self.row_n, self.level + self.change(model, stride))


def front_of(model: Model, state: State, reach: float) -> Front | None:
    """The front for a step of ``reach`` in the opening; None if no damage is about to change.

    In a reversible bond, damage may also decrease.
    """
    gap_q, held_q = model.measure(state.g_q), model.law.held(state.k_q)
    rate_q = state.heading * model.rates(state.u_n, state.rate_n)
    missing_q = np.maximum(held_q, model.law.begun) - gap_q
    grows_q = (held_q < model.law.failed) & (rate_q * LOOKAHEAD * reach >= missing_q) & (rate_q > 0)
    heals_q = (gap_q < model.law.failed) & (gap_q > model.law.begun) & (not model.law.irreversible)
    place = most_open(model, np.where((grows_q | heals_q) & model.bonded_q, gap_q, -np.inf))
    if place is None:
        return None
    gap, missing, rate = (at(model, place, a_q) for a_q in (gap_q, missing_q, rate_q))
    row_n = front_row(model, place, state.u_n)
    return Front(place, gap, missing, rate, row_n, model.dot(row_n, state.u_n))


def most_open(model: Model, g_q: np.ndarray) -> PointOfBond | None:
    """The point of the largest value over all ranks; None if all values are -inf."""
    q = int(np.argmax(g_q)) if g_q.size else -1
    tops = model.comm.allgather((float(g_q[q]) if g_q.size else -np.inf, q))
    rank = int(np.argmax([value for value, _ in tops]))
    return (rank, tops[rank][1]) if tops[rank][0] > -np.inf else None


def at(model: Model, place: PointOfBond, a_q: np.ndarray) -> float:
    """Value at a point, known on all ranks."""
    rank, q = place
    return model.comm.bcast(float(a_q[q]) if model.comm.rank == rank else None, root=rank)


def front_row(model: Model, place: PointOfBond, u_n: np.ndarray) -> np.ndarray:
    """The change of the gap or scaled jump at a point as a functional (n,) of the displacements of this rank.

    With shear it is linearised at the displacements ``u_n``: the control needs a quantity that grows along the step,
    not the exact scaled jump.
    """
    unit_q = np.zeros_like(model.X_q)
    if model.comm.rank == place[0]:
        unit_q[place[1]] = 1.0
    return model.measure_row(u_n, unit_q)


def edge_control(model: Model, state: State, front: Front, stride: Stride) -> Control | None:
    """Control that opens the bond up to the last edge between two elements that one step can reach; None if none is,
    or if a reversible bond closes.

    The slope of a path jumps wherever a point breaks, and on a long step many points break. An edge lies between the
    two closest points, so that steps always end at the same place between two jumps, where the slope is near the mean.
    """
    s_p, gap_p, bonded_p = ordered_along(model, model.measure(state.g_q), model.bonded_q.astype(float))
    first = int(np.argmax((bonded_p > 0.0) & (gap_p < model.law.failed)))
    second = min(first + 2, s_p.size - 1)
    if front.rate < 0.0 or front.missing > 0.0 or not gap_p[first] > gap_p[second]:
        return None
    flat = (s_p[second] - s_p[first]) / (gap_p[first] - gap_p[second])
    end = s_p[first] + (gap_p[first] - model.law.failed + abs(front.change(model, stride))) * flat
    between_i = np.pad(np.diff(s_p), 1, constant_values=np.inf)
    s_i, gap_i = (0.5 * (a_p[1:] + a_p[:-1]) for a_p in (s_p, gap_p))
    edge_i = (
        (between_i[1:-1] < between_i[:-2]) & (between_i[1:-1] < between_i[2:]) & (bonded_p[1:] * bonded_p[:-1] > 0.0)
    )
    within_i = np.flatnonzero(edge_i & (gap_i < model.law.failed) & (s_i > s_p[first]) & (s_i <= end))
    if not within_i.size:
        return None
    i = within_i[-1]
    chosen_q = np.isin(model.specimen.distance(model.X_q), s_p[i : i + 2]) & model.middle_q
    row_n = model.measure_row(state.u_n, 0.5 * chosen_q)
    gap = float(gap_i[i])
    return Control(row_n, model.dot(row_n, state.u_n) + model.law.failed - gap)
