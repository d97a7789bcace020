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
from fem_reference.path.state import State


@dataclass(frozen=True)
class FrontSettings:
    """Steps that are controlled by the gap of one point.

    step : largest change of that gap in one step, in units of g_u: smaller steps take longer, larger ones pass kinks of
        more points at once.
    lookahead : damage counts as growing at a point that would reach it within this many steps.
    """

    step: float = 0.125
    lookahead: float = 2.0


REFERENCE_FRONT = FrontSettings()

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

    ``gap`` is its gap, ``missing`` the increase of it before damage grows, ``rate`` d gap / d opening.
    """

    place: PointOfBond
    gap: float
    missing: float
    rate: float

    def change(self, model: Model, reach: float, part: float) -> float:
        """Change of the gap in a step of ``reach`` in the opening; at most ``part`` of the front's largest step."""
        most = self.missing + part * REFERENCE_FRONT.step * model.law.g_open
        return float(np.copysign(min(abs(self.rate) * reach, most), self.rate))

    def calm(self, model: Model, reach: float, part: float) -> bool:
        """Whether damage grows so slowly that the opening can be prescribed instead."""
        return self.missing == 0.0 and abs(self.rate) * reach < part * REFERENCE_FRONT.step * model.law.g_open

    def control(self, model: Model, reach: float, part: float) -> Control:
        """Control by the gap of the front, which grows steadily even where the opening has to decrease (snap-back)."""
        return Control(gap_row(model, self.place), self.gap + self.change(model, reach, part))


def front_of(model: Model, state: State, reach: float) -> Front | None:
    """The front for a step of ``reach`` in the opening; None if no damage is about to change.

    In a reversible bond, damage may also decrease.
    """
    law, g_q, k_q = model.law, state.g_q, state.k_q
    rate_q = state.heading * model.bond.gap(state.rate_n)
    missing_q = np.maximum(k_q, law.g_peak) - g_q
    grows_q = (k_q < law.g_open) & (rate_q * REFERENCE_FRONT.lookahead * reach >= missing_q) & (rate_q > 0)
    heals_q = (g_q < law.g_open) & (g_q > law.g_peak) & (not law.irreversible)
    place = most_open(model, np.where((grows_q | heals_q) & model.bonded_q, g_q, -np.inf))
    return None if place is None else Front(place, *(at(model, place, a_q) for a_q in (g_q, missing_q, rate_q)))


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


def gap_row(model: Model, place: PointOfBond) -> np.ndarray:
    """The gap at a point as a functional (n,) of the displacements that this rank owns."""
    unit_q = np.zeros_like(model.X_q)
    if model.comm.rank == place[0]:
        unit_q[place[1]] = 1.0
    return model.bond.spread(unit_q)
