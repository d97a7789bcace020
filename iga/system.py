"""The discrete problem: bodies, interface, load and supports; its residual and tangent in one configuration."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.sparse import coo_array

from iga.banded import Band, BandLU, factor, number
from iga.basis import BlockBasis
from iga.bulk import element_forces, element_stiffness, energy, gradient
from iga.interface import Contact, Interface, contact, forces, pair, stiffness, traction
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

    ``closed_q`` (n_q,) and ``pairing``, which points were in contact and where the interface met, are where the next search
    starts, not history.
    """

    u_d: np.ndarray
    load: float
    k_q: np.ndarray
    closed_q: np.ndarray
    pairing: Pairing | None


@dataclass(frozen=True)
class Response:
    """What a configuration answers.

    ``internal_d`` (n_dof,) forces of bulk and interface; ``scale`` the norm of the forces that the elements hold against each
    other, by which a residual is judged; ``bulk_energy``; the interface with traction p_q, slope dp_q and new history k_q.
    """

    internal_d: np.ndarray
    scale: float
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

    ``load_d`` (n_dof,) is the load vector for a unit resultant and, being the mean over the loaded faces, at once the row that
    measures the opening. ``x_d`` (n_dof,) is the coordinate along the specimen, used for numbering. ``width`` is that of the
    bulk; where a mirror image is not modelled it counts twice, so that forces and energies are those of the whole.

    An interface without friction lets two bodies turn together about their supports. A spring of stiffness ``stay`` on the
    displacement ``stay_d . u`` takes that freedom. It measures how far the two loaded faces are out of line, so that the
    balance of moments itself says that it carries no force.
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

    @property
    def n_dof(self) -> int:
        return self.load_d.size

    def start(self) -> State:
        """The unloaded state."""
        n_q = self.interface.points
        return State(np.zeros(self.n_dof), 0.0, np.zeros(n_q), np.zeros(n_q, dtype=bool), pair(self.interface))

    @cached_property
    def element_dofs(self) -> tuple[np.ndarray, ...]:
        """Degrees of freedom (n_e, 2 n_a) of every block."""
        return tuple(_dofs(solid.basis.conn_ea) for solid in self.solids)

    @cached_property
    def band(self) -> Band:
        row, column = zip(*(_pairs(dofs) for dofs in self.element_dofs), strict=True)
        for more in (stiffness_pattern(self), self.stay_pairs):
            row, column = (*row, more[0]), (*column, more[1])
        row, column = np.concatenate(row), np.concatenate(column)
        return number(row, column, self.x_d, self.free_d)

    @cached_property
    def stay_pairs(self) -> tuple[np.ndarray, np.ndarray]:
        held = np.flatnonzero(self.stay_d) if self.stay_d is not None else np.zeros(0, dtype=int)
        return _pairs(held[None, :])

    @cached_property
    def bulk_positions(self) -> np.ndarray:
        """Where each entry of each element matrix goes in the band array."""
        return np.concatenate([self.band.positions(*_pairs(dofs)) for dofs in self.element_dofs])

    @cached_property
    def linear_bulk(self) -> tuple[tuple[np.ndarray, ...], np.ndarray]:
        """Stiffness of the bulk once and for all (linear kinematics): of the elements, and as a band array."""
        K = tuple(_element_matrices(self, solid, np.zeros((self.n_dof // 2, 2))) for solid in self.solids)
        values = np.concatenate([k.ravel() for k in K])
        return K, np.bincount(self.bulk_positions, weights=values, minlength=self.band.size)


def respond(system: System, trial: State) -> Response:
    """Residual and tangent of a trial state, whose history is that of the last converged one."""
    bulk = _linear_bulk if system.kinematics == "linear" else _finite_bulk
    internal_d, scale, bulk_energy, tangent = bulk(system, trial.u_d)
    touch = contact(system.interface, trial.u_d, trial.pairing)
    closed_q = system.interface.law.closed(touch.g_q, trial.closed_q)
    p_q, dp_q, k_q = traction(system.interface, touch, trial.k_q, closed_q)
    f_d = forces(system.interface, touch, p_q)
    K = stiffness(system.interface, touch, p_q, dp_q).tocoo()
    band, tangent = _add(system, tangent, K)
    if system.stay_d is not None:
        f_d = f_d + system.stay * (system.stay_d @ trial.u_d) * system.stay_d
        row, column = system.stay_pairs
        np.add.at(tangent, band.positions(row, column), system.stay * system.stay_d[row] * system.stay_d[column])
    return Response(internal_d + f_d, scale, bulk_energy, touch, p_q, dp_q, k_q, closed_q, tangent, band)


def factorise(response: Response) -> BandLU | None:
    return factor(response.band, response.tangent)


def stiffness_pattern(system: System) -> tuple[np.ndarray, np.ndarray]:
    """Entries of the interface tangent, with room for every point to move one side on in either direction."""
    interface, pairing = system.interface, pair(system.interface)
    if pairing is None:
        touches = (contact(interface, np.zeros(system.n_dof), None),)
    else:
        last = interface.master.sides - 1
        shifted = (replace(pairing, c_q=np.clip(pairing.c_q + s, 0, last), xi_q=np.full_like(pairing.xi_q, 0.5)) for s in (-1, 0, 1))
        still = replace(interface, frozen=True)
        touches = tuple(contact(still, np.zeros(system.n_dof), p) for p in shifted)
    K = [(abs(touch.G_qd).T @ abs(touch.G_qd)).tocoo() for touch in touches]
    return np.concatenate([k.row for k in K]), np.concatenate([k.col for k in K])


def _linear_bulk(system: System, u_d: np.ndarray) -> tuple[np.ndarray, float, float, np.ndarray]:
    matrices, band_values = system.linear_bulk
    internal_d, square = np.zeros(system.n_dof), 0.0
    for K, dofs in zip(matrices, system.element_dofs, strict=True):
        f = K @ u_d[dofs][..., None]
        internal_d += np.bincount(dofs.ravel(), weights=f.ravel(), minlength=system.n_dof)
        square += float(np.sum(f * f))
    return internal_d, square**0.5, 0.5 * float(u_d @ internal_d), band_values.copy()


def _finite_bulk(system: System, u_d: np.ndarray) -> tuple[np.ndarray, float, float, np.ndarray]:
    u_Ai = u_d.reshape(-1, 2)
    internal_d, matrices, square, stored = np.zeros(system.n_dof), [], 0.0, 0.0
    for solid, dofs in zip(system.solids, system.element_dofs, strict=True):
        P, A, W = KINEMATICS[system.kinematics](solid.D, gradient(solid.basis, u_Ai))
        f = element_forces(solid.basis, P, system.width)
        internal_d += np.bincount(dofs.ravel(), weights=f.ravel(), minlength=system.n_dof)
        matrices.append(element_stiffness(solid.basis, A, system.width).ravel())
        square += float(np.sum(f * f))
        stored += energy(solid.basis, W, system.width)
    K = matrices[0] if len(matrices) == 1 else np.concatenate(matrices)
    tangent = np.bincount(system.bulk_positions, weights=K, minlength=system.band.size)
    return internal_d, square**0.5, stored, tangent


def _element_matrices(system: System, solid: Solid, u_Ai: np.ndarray) -> np.ndarray:
    _, A, _ = KINEMATICS[system.kinematics](solid.D, gradient(solid.basis, u_Ai))
    return element_stiffness(solid.basis, A, system.width)


def _add(system: System, tangent: np.ndarray, K: coo_array) -> tuple[Band, np.ndarray]:
    """Add the interface to the band array; widen the band where a point has slid further than it has room for."""
    band = system.band
    need = band.reach(K.row, K.col)
    if need > band.k:
        wide = replace(band, k=need)
        values = np.zeros(wide.size)
        old = tangent[:-1].reshape(band.n, 3 * band.k + 1)
        values[:-1].reshape(band.n, 3 * need + 1)[:, 2 * need - 2 * band.k : 2 * need + band.k + 1] = old
        band, tangent = wide, values
    np.add.at(tangent, band.positions(K.row, K.col), K.data)
    return band, tangent


def _dofs(conn_ea: np.ndarray) -> np.ndarray:
    return (2 * conn_ea[..., None] + np.arange(2)).reshape(len(conn_ea), -1)


def _pairs(dofs_ed: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    n_e, n = dofs_ed.shape
    return np.repeat(dofs_ed, n, axis=1).ravel(), np.tile(dofs_ed, (1, n)).ravel()
