"""The discrete problem: bodies, interface, load and supports; its residual and tangent in one configuration."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, fields, replace
from functools import cached_property

import numpy as np

from iga.banded import Band, BandLU, factor, number
from iga.basis import BlockBasis
from iga.bulk import all_entries, element_forces, element_stiffness, energy, full_matrices, gradient, stiffness_entries
from iga.interface import Contact, Interface, contact, dofs, forces, pair, stiffness, traction
from iga.kinematics import KINEMATICS
from iga.projection import Pairing

#: Times the phases of a run ("mesh", "basis", "assembly", "factor", "solve"); whoever calls brings the clock.
Phase = Callable[[str], AbstractContextManager]


def untimed(_name: str) -> AbstractContextManager:
    return nullcontext()


@dataclass(frozen=True)
class Solid:
    """One block of elements with one material: basis at the quadrature points and elasticity matrix D (3, 3)."""

    basis: BlockBasis
    D: np.ndarray


@dataclass(frozen=True)
class State:
    """A configuration: displacements u_d (n_dof,), load, history k_q (n_q,).

    ``closed_q`` (n_q,) and ``pairing``, which points were in contact and where the interface met, are where the next
    search starts, not history.
    """

    u_d: np.ndarray
    load: float
    k_q: np.ndarray
    closed_q: np.ndarray
    pairing: Pairing | None


@dataclass(frozen=True)
class Response:
    """What a configuration answers.

    ``internal_d`` (n_dof,) forces of bulk and interface; ``scale`` the norm of the forces that the elements hold
    against each other, by which a residual is judged, and ``rounding`` the norm below which it is noise;
    ``bulk_energy``; the interface with traction p_q, slope dp_q and new history k_q.
    """

    internal_d: np.ndarray
    scale: float
    rounding: float
    bulk_energy: float
    contact: Contact
    p_q: np.ndarray
    dp_q: np.ndarray
    k_q: np.ndarray
    closed_q: np.ndarray
    tangent: np.ndarray
    band: Band


@dataclass(frozen=True)
class System:
    """All that stays the same during a run.

    ``load_d`` (n_dof,) is the load vector for a unit resultant and, being the mean over the loaded faces, at once the
    row that measures the opening. ``x_d`` (n_dof,) is the coordinate along the specimen, used for numbering. ``width``
    is that of the bulk; where a mirror image is not modelled it counts twice, so that forces and energies are those of
    the whole.

    An interface without friction lets two bodies turn together about their supports. A spring of stiffness ``stay`` on
    the displacement ``stay_d . u`` takes that freedom. It measures how far the two loaded faces are out of line, so
    that the balance of moments itself says that it carries no force.
    """

    solids: tuple[Solid, ...]
    interface: Interface
    kinematics: str
    width: float
    load_d: np.ndarray
    free_d: np.ndarray
    x_d: np.ndarray
    stay_d: np.ndarray | None = None
    stay: float = 0.0
    _touching: tuple | None = None

    @property
    def n_dof(self) -> int:
        return self.load_d.size

    def start(self) -> State:
        """The unloaded state."""
        n_q = self.interface.points
        return State(np.zeros(self.n_dof), 0.0, np.zeros(n_q), np.zeros(n_q, dtype=bool), pair(self.interface))

    @cached_property
    def band(self) -> Band:
        """Numbering for bulk and interface, with room for every point to move one side on in either direction."""
        entries = [*self.bulk_entries]
        entries += [_square(conn_qa) for conn_qa in _reachable(self.interface)]
        row, column = (np.concatenate([entry[i].ravel() for entry in entries]) for i in range(2))
        return number(row, column, self.x_d, self.free_d)

    @cached_property
    def stay_entries(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Rows, columns and values that the spring adds to the tangent."""
        if self.stay_d is None:
            return np.zeros(0, dtype=int), np.zeros(0, dtype=int), np.zeros(0)
        held = np.flatnonzero(self.stay_d)
        row, column = np.repeat(held, held.size), np.tile(held, held.size)
        return row, column, self.stay * self.stay_d[row] * self.stay_d[column]

    @property
    def bulk_entries(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """Rows and columns of the element matrices."""
        return [stiffness_entries(solid.basis.conn_ea) for solid in self.solids]

    @cached_property
    def bulk_positions(self) -> np.ndarray:
        """Where each entry of each element matrix goes in the band array."""
        return _positions(self.band, self.bulk_entries)

    @cached_property
    def linear_bulk(self) -> tuple[tuple[np.ndarray, ...], np.ndarray]:
        """Stiffness of the linear bulk: element matrices (n_e, 2 n_a, 2 n_a), and the band array."""
        zero_Ai = np.zeros((self.n_dof // 2, 2))
        parts = [element_stiffness(solid.basis, _bulk(self, solid, zero_Ai)[1], self.width) for solid in self.solids]
        values = np.concatenate([all_entries(K).ravel() for K in parts])
        return tuple(full_matrices(K) for K in parts), np.bincount(self.bulk_positions, values, self.band.size)

    @cached_property
    def stiffest(self) -> tuple[np.ndarray, ...]:
        """Largest entry (n_e,) of each element's stiffness when unloaded."""
        zero_Ai = np.zeros((self.n_dof // 2, 2))
        parts = (element_stiffness(solid.basis, _bulk(self, solid, zero_Ai)[1], self.width) for solid in self.solids)
        return tuple(np.abs(K).max((1, 2, 3)) for K in parts)

    def touching_positions(self, conn_qa: np.ndarray) -> np.ndarray | None:
        """Where the interface tangent goes in the band array, None where too far. The last answer is kept."""
        if self._touching is None or not np.array_equal(self._touching[0], conn_qa):
            row, column = _square(conn_qa)
            fits = self.band.reach(row, column) <= self.band.k
            positions = _positions(self.band, [(row, column), self.stay_entries[:2]]) if fits else None
            object.__setattr__(self, "_touching", (conn_qa, positions))
        return self._touching[1]


def respond(system: System, trial: State, decide: bool = True) -> Response:
    """Residual and tangent of a trial state, whose history is that of the last converged one.

    Unless asked to ``decide`` anew by the sign of the gap, every point stays in contact or out of it as it is in
    ``trial``.
    """
    linear = system.kinematics == "linear"
    internal_d, scale, bulk_energy, parts = (_linear_bulk if linear else _finite_bulk)(system, trial.u_d)
    touch = contact(system.interface, trial.u_d, trial.pairing)
    closed_q = touch.g_q < 0.0 if decide else trial.closed_q
    p_q, dp_q, k_q = traction(system.interface, touch, trial.k_q, closed_q)
    internal_d += forces(system.interface, touch, p_q, system.n_dof)
    if system.stay_d is not None:
        internal_d += system.stay * (system.stay_d @ trial.u_d) * system.stay_d
    K_qdd = stiffness(system.interface, touch, p_q, dp_q)
    band, tangent = _assemble(system, parts, touch.conn_qa, K_qdd)
    return Response(
        internal_d, scale, _rounding(system, trial.u_d), bulk_energy, touch, p_q, dp_q, k_q, closed_q, tangent, band
    )


def factorise(response: Response) -> BandLU | None:
    """LU of the tangent, which it overwrites; None where the tangent is exactly singular."""
    return factor(response.band, response.tangent)


def joined(solids: list[Solid]) -> tuple[Solid, ...]:
    """Blocks of one shape and one material taken together: fewer and longer array operations."""
    groups: dict[tuple, list[Solid]] = {}
    for solid in solids:
        groups.setdefault((solid.basis.N_eqa.shape[1:], solid.D.tobytes()), []).append(solid)
    return tuple(
        Solid(
            BlockBasis(*(np.concatenate([getattr(s.basis, f.name) for s in group]) for f in fields(BlockBasis))),
            group[0].D,
        )
        for group in groups.values()
    )


def _rounding(system: System, u_d: np.ndarray) -> float:
    """Norm of what one rounding of the displacements does to the forces: long thin elements are stiff across."""
    squares = (
        np.sum((size_e * np.abs(u_d[dofs(solid.basis.conn_ea)]).max(1)) ** 2)
        for size_e, solid in zip(system.stiffest, system.solids, strict=True)
    )
    return float(np.finfo(float).eps * np.sqrt(sum(squares)))


def _linear_bulk(system: System, u_d: np.ndarray) -> tuple[np.ndarray, float, float, np.ndarray]:
    matrices, band_values = system.linear_bulk
    internal_d, square = np.zeros(system.n_dof), 0.0
    for K, solid in zip(matrices, system.solids, strict=True):
        d = dofs(solid.basis.conn_ea)
        f = K @ u_d[d][..., None]
        internal_d += np.bincount(d.ravel(), f.ravel(), system.n_dof)
        square += float(np.sum(f * f))
    return internal_d, square**0.5, 0.5 * float(u_d @ internal_d), band_values


def _finite_bulk(system: System, u_d: np.ndarray) -> tuple[np.ndarray, float, float, list[np.ndarray]]:
    internal_d, square, stored, parts = np.zeros(system.n_dof), 0.0, 0.0, []
    for solid in system.solids:
        P, A, W = _bulk(system, solid, u_d.reshape(-1, 2))
        f = element_forces(solid.basis, P, system.width)
        internal_d += np.bincount(dofs(solid.basis.conn_ea).ravel(), f.ravel(), system.n_dof)
        square += float(np.sum(f * f))
        stored += energy(solid.basis, W, system.width)
        parts.append(all_entries(element_stiffness(solid.basis, A, system.width)).ravel())
    return internal_d, square**0.5, stored, parts


def _bulk(system: System, solid: Solid, u_Ai: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    return KINEMATICS[system.kinematics](solid.D, gradient(solid.basis, u_Ai))


def _assemble(
    system: System, bulk: np.ndarray | list[np.ndarray], conn_qa: np.ndarray, K_qdd: np.ndarray
) -> tuple[Band, np.ndarray]:
    """Band array of bulk (entries of the elements, or a band array already), interface and spring.

    Where a point has slid further than the band has room for, everything is placed anew in a wider one.
    """
    band, positions = system.band, system.touching_positions(conn_qa)
    touching = np.concatenate([K_qdd.ravel(), system.stay_entries[2]])
    if positions is None:
        entries = [*system.bulk_entries, _square(conn_qa), system.stay_entries[:2]]
        band = replace(band, k=band.reach(*entries[-2]))
        return band, np.bincount(_positions(band, entries), np.concatenate([*bulk, touching]), band.size)
    if isinstance(bulk, np.ndarray):
        return band, bulk + np.bincount(positions, touching, band.size)
    return band, np.bincount(
        np.concatenate([system.bulk_positions, positions]), np.concatenate([*bulk, touching]), band.size
    )


def _reachable(interface: Interface) -> list[np.ndarray]:
    """Control points that a point touches where it is now and one side on either way."""
    pairing = pair(interface)
    if pairing is None:
        return [interface.conn_qa]
    neighbours = (np.clip(pairing.c_q + step, 0, interface.master.sides - 1) for step in (-1, 0, 1))
    return [np.concatenate([interface.conn_qa, interface.master.conn_ca[c_q]], axis=1) for c_q in neighbours]


def _square(conn_qa: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rows and columns (n_q, 2 n_a, 2 n_a) of the matrices of all points."""
    d = dofs(conn_qa)
    return np.broadcast_arrays(d[:, :, None], d[:, None, :])


def _positions(band: Band, entries: list[tuple[np.ndarray, np.ndarray]]) -> np.ndarray:
    return np.concatenate([band.positions(row.ravel(), column.ravel()) for row, column in entries])
