"""A converged point of the path, and what can be read along the bond there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem_reference.model.assembled import owned
from fem_reference.model.model import BondEnergies, Model


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
        X_nI, across = (np.concatenate(model.comm.allgather(v)) for v in (model.X_nI[own], state.u_n[own]))
        along = np.delete(X_nI, 1, axis=1)[:, ::-1]  # X first, then Z
        sides.append(across[np.lexsort(np.rint(along.T / model.specimen.near))])
        first += owned(u)
    return sides[0] - (sides[1] if len(sides) > 1 else -sides[0])


def resultant(model: Model, force_n: np.ndarray, component: int) -> float:
    """Sum of nodal forces in one direction: their virtual work in a unit translation."""
    return model.comm.allreduce(float(np.sum(force_n[component :: model.specimen.dim])))


def moment(model: Model, state: State, force_n: np.ndarray) -> float:
    """Moment of nodal forces about the origin, anticlockwise.

    Equilibrium holds with current positions in finite kinematics and with reference positions in linear kinematics.
    """
    dim = model.specimen.dim
    x_nI, force_nI = model.X_nI[::dim], force_n.reshape(-1, dim)
    if model.problem.kinematics == "finite":
        x_nI = x_nI + state.u_n.reshape(-1, dim)
    return model.comm.allreduce(float(x_nI[:, 0] @ force_nI[:, 1] - x_nI[:, 1] @ force_nI[:, 0]))


def opening_at(model: Model, X: float) -> float:
    """Normal gap at a vertex of the interface, in the middle of a width, for the displacements that the forms read at
    present."""
    jump = 0.0
    for body, (u, sign) in enumerate(zip(model.displacement, (1.0, -1.0), strict=False)):
        own = model.across(body, model.problem.middle(X, 0.0))
        jump += sign * model.specimen.copies * float(np.sum(u.x.array[own]))
    return model.comm.allreduce(jump)


def foremost(model: Model, state: State, gap: float) -> float:
    """Distance from the loaded end to the foremost place whose history has reached ``gap``, its mean over the width."""
    s_l, weight_lp = front_line(model, state, gap), model.along(model.bond.weight_q)[1]
    return float(s_l @ (weight_lp.sum(1) / weight_lp.sum()))


def front_line(model: Model, state: State, gap: float) -> np.ndarray:
    """Distances (n_l,) from the loaded end to the foremost places whose history has reached ``gap``, on the lines of
    `Model.along`, linear between points."""
    s_lp, k_lp = model.along(model.law.held(state.k_q))
    tip, end = (float(model.specimen.distance(X)) for X in model.specimen.bond)

    def foremost_on(s_p: np.ndarray, k_p: np.ndarray) -> float:
        open_p = np.flatnonzero(k_p >= gap)
        if not open_p.size:
            return tip
        last = open_p[-1]
        if last == s_p.size - 1:
            return end
        share = (k_p[last] - gap) / (k_p[last] - k_p[last + 1])
        return float(s_p[last] + share * (s_p[last + 1] - s_p[last]))

    return np.array([foremost_on(*line) for line in zip(s_lp, k_lp, strict=True)])


def ordered_along(model: Model, *values_q: np.ndarray) -> list[np.ndarray]:
    """Distances (n,) of the points of the bond in the middle of the width, over all ranks, from the loaded end, rising;
    values in that order."""
    return [v_lp[0] for v_lp in model.along(*values_q)]
