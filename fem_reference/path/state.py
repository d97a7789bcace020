"""A converged point of the path, and what can be read along the bond there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem_reference.model.assembled import owned
from fem_reference.model.model import BondEnergies, Model
from fem_reference.problem.specimen import point


@dataclass(frozen=True)
class Largest:
    """The largest load so far on one side of zero, without its sign, and the opening there.

    Faces that are pressed together may bear a hundred times what a bond does that opens: each side has its own.
    """

    load: float = 0.0
    opening: float = 0.0

    def with_point(self, load: float, opening: float) -> Largest:
        return Largest(abs(load), abs(opening)) if abs(load) > self.load else self


@dataclass(frozen=True)
class State:
    """A converged point of the path, its history committed.

    ``k_q`` and ``g_q`` are histories (n_q, n_h) and jumps (n_q, n_j) at the points of the interface; ``rate_n`` =
    du/d(opening) and ``slope`` = d load/d(opening) of the path that arrives here, ``heading`` the sign of the change of
    the opening on it; ``peak`` is the largest load so far on this side of zero, ``work`` the external work, ``bulk``
    the strain energy of the bodies, and ``bond`` the energies of the bond.
    """

    u_n: np.ndarray
    load: float
    opening: float
    k_q: np.ndarray
    g_q: np.ndarray
    rate_n: np.ndarray
    slope: float
    heading: float
    peak: Largest
    work: float
    bulk: float
    bond: BondEnergies
    iterations: int

    @property
    def energy(self) -> float:
        """All energy, stored and dissipated, into which external work has been converted."""
        return self.bulk + self.bond.total


def face_gaps(model: Model, state: State) -> np.ndarray:
    """Gaps (n,) at all nodes of the surfaces that are opposite each other, bonded or not, in the order of X."""
    sides, first = [], 0
    place = (min(model.specimen.facing), max(model.specimen.facing)), (0.0, 0.0)
    for body, u in enumerate(model.displacement):
        own = first + model.across(body, place)
        X, across = (np.concatenate(model.comm.allgather(v)) for v in (model.X_nI[own, 0], state.u_n[own]))
        sides.append(across[np.argsort(X)])
        first += owned(u)
    return sides[0] - sides[1]


def resultant(model: Model, force_n: np.ndarray, component: int) -> float:
    """Sum of nodal forces in one direction: their virtual work in a unit translation."""
    return model.comm.allreduce(float(np.sum(force_n[component::2])))


def moment(model: Model, state: State, force_n: np.ndarray) -> float:
    """Moment of nodal forces about the origin, anticlockwise.

    Equilibrium holds with current positions in finite kinematics and with reference positions in linear kinematics.
    """
    x_nI = model.X_nI.copy()
    if model.problem.kinematics == "finite":
        x_nI[::2] += state.u_n.reshape(-1, 2)
    return model.comm.allreduce(float(x_nI[::2, 0] @ force_n[1::2] - x_nI[::2, 1] @ force_n[::2]))


def opening_at(model: Model, X: float) -> float:
    """Normal gap at a vertex of the interface, for the displacements that the forms read at present."""
    jump = 0.0
    for body, sign in enumerate((1.0, -1.0)):
        own = model.across(body, point(X, 0.0))
        jump += sign * float(np.sum(model.displacement[body].x.array[own]))
    return model.comm.allreduce(jump)


def foremost(model: Model, state: State, gap: float) -> float:
    """Distance from the loaded end to the foremost place whose history has reached ``gap``, linear between points."""
    s_q, k_q = ordered_along(model, model.law.held(state.k_q))
    tip, end = (float(model.specimen.distance(X)) for X in model.specimen.bond)
    open_q = np.flatnonzero(k_q >= gap)
    if not open_q.size:
        return tip
    last = open_q[-1]
    if last == s_q.size - 1:
        return end
    share = (k_q[last] - gap) / (k_q[last] - k_q[last + 1])
    return float(s_q[last] + share * (s_q[last + 1] - s_q[last]))


def ordered_along(model: Model, *values_q: np.ndarray) -> list[np.ndarray]:
    """Distances (n,) of all points of the bond, over all ranks, from the loaded end, rising; values in that order."""
    s_q = model.specimen.distance(model.X_q)
    gathered = [np.concatenate(model.comm.allgather(v_q)) for v_q in (s_q, *values_q)]
    order = np.argsort(gathered[0])
    return [v_q[order] for v_q in gathered]
