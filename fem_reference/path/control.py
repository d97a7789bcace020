"""What is prescribed of a step: one linear functional of the displacements, and which one is the best to prescribe.

The loop around it is this project's own. PETSc's arc-length type (SNESNEWTONAL) measures a step by the norm of all
displacements, which a crack hardly moves: with 28 quadratic elements, p_max = 10 and a reversible bond it had come to
opening 0.97 of 3 after 4000 iterations, where the front leads to the end in about 400; and it takes all increments in
one call, so that no history can be committed between them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem_reference.model.model import Model
from fem_reference.path.state import State

#: A point of the front opens by this part of g_u in one step, at most.
FRONT_STEP = 0.125
#: Damage is expected to grow where it would within this many steps.
LOOKAHEAD = 2.0

#: A point of the bond: the rank that owns it, and its index there.
Place = tuple[int, int]


@dataclass(frozen=True)
class Control:
    """The equation ``row_n @ u_n = value``, summed over the ranks."""

    row_n: np.ndarray
    value: float


def opening_control(model: Model, opening: float) -> Control:
    """The mean opening of the loaded faces is prescribed."""
    return Control(model.load_n, opening)


@dataclass(frozen=True)
class Front:
    """The most open point of the bond whose damage grows, or soon will.

    ``gap`` is what it has, ``missing`` what it needs before damage grows, ``rate`` its change over that of the opening.
    """

    place: Place
    gap: float
    missing: float
    rate: float

    def change(self, model: Model, reach: float, part: float) -> float:
        """Change of the gap for a step of ``reach`` in the opening, cut to ``part`` of the largest one of the front."""
        most = self.missing + part * FRONT_STEP * model.law.g_open
        return float(np.copysign(min(abs(self.rate) * reach, most), self.rate))

    def calm(self, model: Model, reach: float, part: float) -> bool:
        """Whether damage grows so slowly that the opening may be prescribed as well."""
        return self.missing == 0.0 and abs(self.rate) * reach < part * FRONT_STEP * model.law.g_open

    def control(self, model: Model, reach: float, part: float) -> Control:
        """The gap of the front is prescribed: it grows steadily even where the specimen has to close for it."""
        return Control(gap_row(model, self.place), self.gap + self.change(model, reach, part))


def front_of(model: Model, state: State, reach: float) -> Front | None:
    """The front when a step of ``reach`` in the opening is to follow; None where no damage is about to change.

    Where the bond is reversible, damage may also shrink.
    """
    law, g_q, k_q = model.law, state.g_q, state.k_q
    rate_q = state.heading * model.bond.gap(state.rate_n)
    missing_q = np.maximum(k_q, law.g_peak) - g_q
    grows_q = (k_q < law.g_open) & (rate_q * LOOKAHEAD * reach >= missing_q) & (rate_q > 0)
    heals_q = (g_q < law.g_open) & (g_q > law.g_peak) & (not law.irreversible)
    place = most_open(model, np.where((grows_q | heals_q) & model.bonded_q, g_q, -np.inf))
    return None if place is None else Front(place, *(at(model, place, a_q) for a_q in (g_q, missing_q, rate_q)))


def most_open(model: Model, g_q: np.ndarray) -> Place | None:
    """Where the largest value over all ranks is; None where there is none but -inf."""
    q = int(np.argmax(g_q)) if g_q.size else -1
    tops = model.comm.allgather((float(g_q[q]) if g_q.size else -np.inf, q))
    rank = int(np.argmax([value for value, _ in tops]))
    return (rank, tops[rank][1]) if tops[rank][0] > -np.inf else None


def at(model: Model, place: Place, a_q: np.ndarray) -> float:
    """Value at a point, on all ranks."""
    rank, q = place
    return model.comm.bcast(float(a_q[q]) if model.comm.rank == rank else None, root=rank)


def gap_row(model: Model, place: Place) -> np.ndarray:
    """The gap at a point as a functional (n,) of the displacements that this rank owns."""
    unit_q = np.zeros_like(model.X_q)
    if model.comm.rank == place[0]:
        unit_q[place[1]] = 1.0
    return model.bond.spread(unit_q)
