"""The discrete problem: bodies, interface, load and supports; its forces and their tangent in one configuration."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from iga.algebra.banded import Band, Skew, number
from iga.algebra.dense import Dense
from iga.algebra.factors import Inverse, held_inverse, inverse
from iga.elements.bulk import Solid, element_forces, element_stiffness, energy, full_matrices, gradient, relative
from iga.elements.kinematics import KINEMATICS
from iga.interface.interface import Contact, Interface, contact, dofs, forces, holding, stiffness, traction
from iga.interface.interface import rounding as interface_rounding
from iga.system.assembly import Pattern, element_sums, element_values, lower_half, pattern_of, skew_part, spring_entries
from iga.system.state import Energies, Response, State

#: Times the phases of a run ("mesh", "basis", "assembly", "factor", "solve"); whoever calls brings the clock.
Phase = Callable[[str], AbstractContextManager]


def untimed(_name: str) -> AbstractContextManager:
    return nullcontext()


@dataclass(frozen=True)
class Scales:
    """What forces are compared with.

    A residual is judged by the forces in play, at least by the part ``unloaded`` of the largest so far. Rounding leaves
    the part ``lost`` of a sum of forces of a condensed bulk, and Newton would see the part ``hidden`` of these at a
    relative residual of 5e-12. The spring that holds the opening while a tangent is factorised is ``hold`` times as
    stiff as the unloaded specimen: more than any load falls by, and little that rounding could take from what it is
    taken away from again. Points with less than the part ``still`` of the forces neither open nor close.
    """

    unloaded: float = 1e-3
    lost: float = 10.0 * float(np.finfo(float).eps)
    hidden: float = 10.0 * float(np.finfo(float).eps) / 5e-12
    hold: float = 100.0
    still: float = 1e-13


SCALES = Scales()


@dataclass(frozen=True)
class System:
    """All that stays the same during a run.

    ``load_d`` (n_dof,) is the load vector for a unit resultant and, being the mean over the loaded faces, at once the
    row that measures the opening. ``x_d`` (n_dof,) is the coordinate along the specimen, used for numbering.

    Rigid motions that nothing else resists are held by springs of stiffness ``spring_r`` (n_r,) on the displacements
    ``springs_rd @ u`` (n_r,), in any direction and of any group of points; where they are as many as the motions of the
    whole, balance itself says that they carry no force. ``free_d`` is False where a degree of freedom is fixed.

    A linear bulk may be given by its stiffness ``bulk_dd`` (n_dof, n_dof) in place of solids: the unknowns are then
    those that it has been condensed to (see `iga.path.condensation`).
    """

    solids: tuple[Solid, ...]
    interface: Interface
    kinematics: str
    load_d: np.ndarray
    free_d: np.ndarray
    x_d: np.ndarray
    springs_rd: np.ndarray
    spring_r: np.ndarray
    bulk_dd: np.ndarray | None = None

    @property
    def n_dof(self) -> int:
        return self.load_d.size

    @property
    def linear(self) -> bool:
        """Whether kinematics and bulk are linear."""
        return self.kinematics == "linear"

    def start(self) -> State:
        """The unloaded state."""
        n_q = self.interface.points
        return State(np.zeros(self.n_dof), 0.0, np.zeros(n_q), np.zeros(n_q, dtype=bool), self.interface.pairing)

    def spring_forces(self, u_d: np.ndarray) -> np.ndarray:
        """Forces (n_r,) that the springs exert on the bodies, along their own displacements."""
        return -self.spring_r * (self.springs_rd @ u_d)

    @property
    def connectivity(self) -> tuple[np.ndarray, ...]:
        """Control points (n_e, n_a) of the elements of each block."""
        return tuple(solid.basis.conn_ea for solid in self.solids)

    @cached_property
    def element_dofs(self) -> tuple[np.ndarray, ...]:
        """Degrees of freedom (n_e, 2 n_a) of the elements of each block."""
        return tuple(dofs(conn_ea) for conn_ea in self.connectivity)

    @cached_property
    def reference_dof_qd(self) -> np.ndarray:
        """Unknowns that each interface point touches before anything moves."""
        interface, master, pairing = self.interface, self.interface.master, self.interface.pairing
        if interface.at_rest is not None:
            return interface.at_rest.dof_qd
        if master is None or pairing is None:
            return dofs(interface.known_conn_qa)
        return dofs(np.concatenate([interface.conn_qa, master.conn_ca[pairing.c_q]], axis=1))

    @cached_property
    def loaded(self) -> np.ndarray:
        """Degrees of freedom that feel the load."""
        return np.flatnonzero(self.load_d)

    @cached_property
    def band(self) -> Band | Dense:
        """Numbering for bulk and interface before anything moves; what slides may ask for a wider band."""
        if self.bulk_dd is not None:
            return Dense(self.n_dof)
        springs = [np.flatnonzero(a_d)[None] for a_d in self.springs_rd]
        touching = self.reference_dof_qd
        return number([*self.element_dofs, touching, *springs, self.loaded[None]], self.x_d, self.free_d)

    @cached_property
    def unloaded_stiffness(self) -> list[np.ndarray]:
        """Element stiffness (n_e, n_a, 3, n_a) of each block before anything moves; linear: for good."""
        zero_Ai = np.zeros((self.n_dof // 2, 2))
        return _bulk_stiffness(self, [gradient(solid.basis, zero_Ai) for solid in self.solids])

    @cached_property
    def linear_matrices(self) -> tuple[np.ndarray, ...]:
        """The same as full matrices (n_e, 2 n_a, 2 n_a)."""
        return tuple(full_matrices(K) for K in self.unloaded_stiffness)

    @cached_property
    def stiffest(self) -> tuple[np.ndarray, ...]:
        """Largest entry (n_e,) of each element's stiffness."""
        return tuple(np.abs(K).max((1, 2, 3)) for K in self.unloaded_stiffness)

    @cached_property
    def linear_band(self) -> np.ndarray:
        """The stiffness of a linear bulk, lower half."""
        if self.bulk_dd is not None:
            return self.bulk_dd.ravel()
        return element_sums(self.connectivity, self.band) @ element_values(self.unloaded_stiffness)

    @cached_property
    def bulk_squares_d(self) -> np.ndarray:
        """Sums (n_dof,) of the squares of the columns of a condensed stiffness."""
        return np.sum(np.asarray(self.bulk_dd) ** 2, axis=0)

    @cached_property
    def spring_entries(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Rows, columns and values that the springs add to the lower half of the tangent."""
        return spring_entries(self.springs_rd, self.spring_r)

    @cached_property
    def loads_squared(self) -> np.ndarray:
        """Lower half of ``f f'`` over the degrees of freedom that feel the load."""
        row, column = lower_half(self.loaded)
        return self.load_d[row] * self.load_d[column]

    @cached_property
    def hold(self) -> float:
        """Stiffness of the spring that holds the opening while a tangent is factorised; 0 where none is known."""
        found = inverse(*tangent_matrix(self, respond(self, self.start(), decide=False)), self.load_d)
        compliance = 0.0 if found is None else abs(float(self.load_d @ found.under_load_d))
        return SCALES.hold / compliance if compliance > 0.0 else 0.0

    def pattern(self, dof_qd: np.ndarray) -> Pattern:
        """Where all entries go when the points touch dof_qd; wider than `band` where one has slid too far for it.

        The last answer is kept: the points change sides seldom.
        """
        kept = self.__dict__.get("_pattern")
        if kept is None or not (kept.dof_qd is dof_qd or np.array_equal(kept.dof_qd, dof_qd)):
            conns = () if self.linear else self.connectivity
            kept = pattern_of(self.band, dof_qd, self.spring_entries[:2], self.loaded, conns, kept)
            self.__dict__["_pattern"] = kept
        return kept


def respond(system: System, trial: State, decide: bool = True) -> Response:
    """Forces of a trial state, whose history is that of the last converged one.

    Unless asked to ``decide`` anew by the sign of the gap, every point stays in contact or out of it as it is in
    ``trial``.
    """
    bulk = _finite_bulk if not system.linear else _linear_bulk if system.bulk_dd is None else _condensed_bulk
    internal_d, scale, bulk_energy, gradients = bulk(system, trial.u_d)
    touch = contact(system.interface, trial.u_d, trial.pairing)
    scale = max(scale, SCALES.unloaded * trial.scale)
    closed_q = _closed(system, touch, trial, scale) if decide else trial.closed_q
    p_q, dp_q, k_q = traction(system.interface, touch, trial.k_q, closed_q)
    internal_d += forces(system.interface, touch, p_q, system.n_dof)
    internal_d -= system.spring_forces(trial.u_d) @ system.springs_rd
    return Response(internal_d, scale, bulk_energy, touch, p_q, dp_q, k_q, closed_q, gradients)


def _finite_bulk(system: System, u_d: np.ndarray) -> tuple[np.ndarray, float, float, tuple[np.ndarray, ...]]:
    internal_d, square, stored, gradients = np.zeros(system.n_dof), 0.0, 0.0, []
    for solid, d in zip(system.solids, system.element_dofs, strict=True):
        H = gradient(solid.basis, u_d.reshape(-1, 2))
        P, W = KINEMATICS[system.kinematics].stress(solid.D, H)
        f = element_forces(solid.basis, P)
        internal_d += np.bincount(d.ravel(), f.ravel(), system.n_dof)
        square += float(np.sum(f * f))
        stored += energy(solid.basis, W)
        gradients.append(H)
    return internal_d, square**0.5, stored, tuple(gradients)


def _linear_bulk(system: System, u_d: np.ndarray) -> tuple[np.ndarray, float, float, tuple[np.ndarray, ...]]:
    internal_d, square = np.zeros(system.n_dof), 0.0
    for K, solid, d in zip(system.linear_matrices, system.solids, system.element_dofs, strict=True):
        f = K @ relative(solid.basis.conn_ea, u_d.reshape(-1, 2)).reshape(len(d), -1, 1)
        internal_d += np.bincount(d.ravel(), f.ravel(), system.n_dof)
        square += float(np.sum(f * f))
    return internal_d, square**0.5, 0.5 * float(u_d @ internal_d), ()


def _condensed_bulk(system: System, u_d: np.ndarray) -> tuple[np.ndarray, float, float, tuple[np.ndarray, ...]]:
    """Forces below rounding count as zero: the scale is at least that at which these are below Newton's tolerance."""
    internal_d = system.bulk_dd @ u_d
    scale = max(float(internal_d @ internal_d) ** 0.5, SCALES.hidden * _held(system, u_d))
    return internal_d, scale, 0.5 * float(u_d @ internal_d), ()


def _held(system: System, u_d: np.ndarray) -> float:
    """Norm of the forces that the unknowns hold against each other."""
    return float(system.bulk_squares_d @ u_d**2) ** 0.5


def _closed(system: System, touch: Contact, trial: State, scale: float) -> np.ndarray:
    """Points with a negative gap; where the gap is worth no force, as they were: its sign is rounding."""
    interface = system.interface
    stiffest = max(interface.law.penalty, interface.law.stiffness)
    nothing_q = np.abs(touch.g_q) * stiffest * interface.dA_q <= SCALES.still * scale
    return np.where(nothing_q, trial.closed_q, touch.g_q < 0.0)


def energies(system: System, state: State, response: Response) -> Energies:
    """What is stored and dissipated at a state with its history."""
    interface, touch = system.interface, response.contact
    cohesive_q, contact_q, dissipated_q = interface.law.energies(touch.g_q, state.k_q)
    cohesive = float(interface.dA_q @ (np.where(holding(interface, touch), touch.share_q, 0.0) * cohesive_q))
    contact_energy = float(interface.dA_q @ (touch.share_q * contact_q))
    elastic = response.bulk_energy + 0.5 * float(system.spring_r @ (system.springs_rd @ state.u_d) ** 2)
    return Energies(elastic, cohesive, contact_energy, float(interface.dA_q @ dissipated_q) + state.slid)


def rounding(system: System, u_d: np.ndarray, response: Response) -> float:
    """Norm of what rounding of the displacements does to the forces.

    Long thin elements are stiff across, and so is contact.
    """
    if system.bulk_dd is not None:
        return SCALES.lost * _held(system, u_d)
    squares = (
        np.sum((size_e * np.abs(relative(solid.basis.conn_ea, u_d.reshape(-1, 2))).max((1, 2))) ** 2)
        for size_e, solid in zip(system.stiffest, system.solids, strict=True)
    )
    touching = interface_rounding(system.interface, u_d, np.abs(response.dp_q))
    return float(np.hypot(40.0 * np.finfo(float).eps * np.sqrt(sum(squares)), touching))


def tangent_matrix(system: System, response: Response) -> tuple[Band | Dense, np.ndarray, Skew | None]:
    """Derivative of the forces by the displacements: the band, the lower half (band.size,), and what is skew."""
    touch = response.contact
    if touch.full_qd is not None:
        weighted_qd = (response.dp_q * system.interface.dA_q)[:, None] * touch.full_qd
        return system.band, system.linear_band + (touch.full_qd.T @ weighted_qd).ravel(), None
    pattern = _pattern(system, response)
    K_qdd = stiffness(system.interface, touch, response.p_q, response.dp_q)
    half = pattern.half(K_qdd, system.spring_entries[2])
    if pattern.bulk is None:
        half += system.linear_band
    else:
        half += pattern.bulk @ element_values(_bulk_stiffness(system, response.gradients))
    return pattern.band, half, skew_part(touch, response.p_q, K_qdd)


def _pattern(system: System, response: Response) -> Pattern:
    """An open crack asks for no entries in the matrix, however far it has moved."""
    touched_qd, reference_qd = response.contact.dof_qd, system.reference_dof_qd
    if touched_qd is reference_qd:  # no point has moved along the master
        return system.pattern(reference_qd)
    carries_q = (response.p_q != 0.0) | (response.dp_q != 0.0)
    return system.pattern(np.where(carries_q[:, None], touched_qd, reference_qd))


def _bulk_stiffness(system: System, gradients: Sequence[np.ndarray]) -> list[np.ndarray]:
    """Element stiffness of the blocks with these gradients; no block of a bulk that is linear and assembled already."""
    moduli = KINEMATICS[system.kinematics].moduli
    return [
        element_stiffness(solid.basis, moduli(solid.D, H)) for solid, H in zip(system.solids, gradients, strict=False)
    ]


def factorise(system: System, response: Response, phase: Phase) -> Inverse | None:
    """Inverse of the tangent; None where it is exactly singular."""
    with phase("assembly"):
        band, half, skew = tangent_matrix(system, response)
    with phase("factor"):
        found = None
        if skew is None and system.hold > 0.0:
            held = half.copy()
            held[_pattern(system, response).held] += system.hold * system.loads_squared
            found = held_inverse(band, held, system.load_d, system.hold)
        return inverse(band, half, skew, system.load_d) if found is None else found
