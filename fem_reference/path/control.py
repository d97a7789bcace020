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

    step : largest change of that gap in one step, in units of g_u, or of the scaled jump itself: smaller steps take
        longer, larger ones pass kinks of more points at once.
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

    ``gap`` is its gap, or with shear its scaled jump, ``missing`` the increase of it before damage grows, ``rate``
    d gap / d opening. ``row_n`` is its change as a functional of the displacements, whose present value is ``level``.
    """

    place: PointOfBond
    gap: float
    missing: float
    rate: float
    row_n: np.ndarray
    level: float

    def change(self, model: Model, reach: float, part: float) -> float:
        """Change of the gap in a step of ``reach`` in the opening; at most ``part`` of the front's largest step."""
        most = self.missing + part * REFERENCE_FRONT.step * model.unit
        return float(np.copysign(min(abs(self.rate) * reach, most), self.rate))

    def calm(self, model: Model, reach: float, part: float) -> bool:
        """Whether damage grows so slowly that the opening can be prescribed instead."""
        return self.missing == 0.0 and abs(self.rate) * reach < part * REFERENCE_FRONT.step * model.unit

    def control(self, model: Model, reach: float, part: float) -> Control:
        """Control by the gap of the front, which grows steadily even where the opening has to decrease (snap-back)."""
        return Control(self.row_n, self.level + self.change(model, reach, part))


def front_of(model: Model, state: State, reach: float) -> Front | None:
    """The front for a step of ``reach`` in the opening; None if no damage is about to change.

    In a reversible bond, damage may also decrease.
    """
    gap_q, held_q = model.measure(state.g_q), model.held(state.k_q)
    rate_q = state.heading * model.rates(state.u_n, state.rate_n)
    missing_q = np.maximum(held_q, model.onset) - gap_q
    grows_q = (held_q < model.failure) & (rate_q * REFERENCE_FRONT.lookahead * reach >= missing_q) & (rate_q > 0)
    heals_q = (gap_q < model.failure) & (gap_q > model.onset) & (not model.law.irreversible)
    place = most_open(model, np.where((grows_q | heals_q) & model.bonded_q, gap_q, -np.inf))
    if place is None:
        return None
    gap, missing, rate = (at(model, place, a_q) for a_q in (gap_q, missing_q, rate_q))
    row_n = front_row(model, place, state.u_n)
    return Front(place, gap, missing, rate, row_n, model.level(gap, row_n, state.u_n))


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

    With shear it is that at the displacements ``u_n``: a step needs a quantity that grows along it, no exact one.
    """
    unit_q = np.zeros_like(model.X_q)
    if model.comm.rank == place[0]:
        unit_q[place[1]] = 1.0
    return model.measure_row(u_n, unit_q)
