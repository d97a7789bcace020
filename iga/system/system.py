"""The discrete problem: bulk, interface, load and supports; its forces and their tangent in one configuration."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from iga.algebra.banded import Band, Skew
from iga.algebra.dense import Dense
from iga.algebra.factors import Inverse, held_inverse, inverse
from iga.interface.contact import Contact
from iga.interface.interface import Interface
from iga.interface.response import forces, traction
from iga.laws.law import INSTANT, Law
from iga.system.assembly import Pattern, Springs, lower_half
from iga.system.bulk import Bulk
from iga.system.state import Energies, Response, State

#: Context manager of the caller that times a phase of a run ("mesh", "basis", "assembly", "factor", "solve").
Phase = Callable[[str], AbstractContextManager]


def untimed(_name: str) -> AbstractContextManager:
    return nullcontext()


@dataclass(frozen=True)
class Scales:
    """Reference values of forces and stiffness.

    - ``unloaded``: residuals are relative to the present forces, at least to this part of the largest so far.
    - ``hold``: stiffness of the spring that holds the opening while a tangent is factorised, over that of the unloaded
      specimen: stiff enough for any slope at which a load falls, soft enough to lose no digits when it is subtracted.
    - ``wider``: a band that sliding has made wider than this, in its own width, is numbered again.
    - ``still``: a gap whose force is less than this part of the forces neither opens nor closes.
    - ``coupled``: largest number of entries in the stiffness matrices of all points. A point depends on every side that
      it has slid over; only iterations that diverge slide over so many, and their tangent could fill the memory.
    """

    unloaded: float = 1e-3
    hold: float = 100.0
    wider: float = 1.1
    still: float = 1e-13
    coupled: float = 2e8


SCALES = Scales()


@dataclass(frozen=True)
class System:
    """All that stays the same during a run.

    ``load_d`` (n_dof,) is the load vector for a unit resultant and, since it averages over the loaded faces, also the
    row that measures the opening. ``x_d`` (n_dof,) is the coordinate along the specimen and ``ahead_d`` (n_dof,) the
    components of that direction, both used for numbering.

    Rigid motions that nothing else resists are held by springs of stiffness ``spring_r`` (n_r,) on the displacements
    ``springs_rd @ u`` (n_r,), in any direction and of any group of points. If there are only as many springs as rigid
    motions of the whole, they carry no force. ``free_d`` is False where a degree of freedom is fixed. ``hold_d``
    (n_dof,) is the part of ``load_d`` in one place, where a spring acts while a tangent is factorised.
    """

    bulk: Bulk
    interface: Interface
    load_d: np.ndarray
    free_d: np.ndarray
    x_d: np.ndarray
    ahead_d: np.ndarray
    springs_rd: np.ndarray
    spring_r: np.ndarray
    hold_d: np.ndarray

    @cached_property
    def n_dof(self) -> int:
        return self.load_d.size

    def with_law(self, law: Law) -> System:
        """The same with another law on the bond, whose tangent has the same pattern and the same spring."""
        other = replace(self, interface=replace(self.interface, law=law))
        other.__dict__.update({name: getattr(self, name) for name in ("band", "rest_pattern", "hold")})
        return other

    @property
    def linear(self) -> bool:
        """Whether kinematics and bulk are linear."""
        return self.bulk.kinematics.linear

    def start(self) -> State:
        """The unloaded state."""
        interface = self.interface
        past, open_q = interface.start(), np.zeros(interface.points, dtype=bool)
        return State(np.zeros(self.n_dof), 0.0, past.d, open_q, interface.pairing, slip_q=past.slip)

    def spring_forces(self, u_d: np.ndarray) -> np.ndarray:
        """Forces (n_r,) of the springs on the bodies, along their own displacements."""
        return -self.spring_r * (self.springs_rd @ u_d)

    @cached_property
    def springs(self) -> Springs:
        """Entries of the springs in the tangent."""
        return Springs.of(self.springs_rd, self.spring_r, np.flatnonzero(self.hold_d))

    @cached_property
    def loads_squared(self) -> np.ndarray:
        """Lower half of ``r r'`` with r = ``hold_d``, over its non-zero degrees of freedom."""
        row, column = lower_half(self.springs.loaded)
        return self.hold_d[row] * self.hold_d[column]

    @cached_property
    def band(self) -> Band | Dense:
        """Numbering for bulk and interface in the reference configuration; sliding may need a wider band."""
        return self.numbered(self.interface.rest.dof_qd, self.x_d)

    def numbered(self, dof_qd: np.ndarray, x_d: np.ndarray) -> Band | Dense:
        """Numbering along the coordinate x_d (n_dof,), while the points depend on the unknowns dof_qd (n_q, n_d)."""
        held = [np.flatnonzero(a_d)[None] for a_d in self.springs_rd]
        return self.bulk.numbering([dof_qd, *held, self.springs.loaded[None]], x_d, self.free_d)

    @cached_property
    def rest_pattern(self) -> Pattern:
        """The pattern of the tangent in the reference configuration."""
        return Pattern.of(self.band, self.interface.rest.dof_qd, self.springs, self.bulk.assembler, None)

    def pattern(self, response: Response, kept: Pattern | None = None) -> Pattern | None:
        """The pattern of the tangent at a response, None where the faces have slid too far for one; ``kept`` is the
        last pattern, which seldom changes.

        Points without a traction keep their places of the reference configuration: however far an open crack has moved,
        it does not widen the band. Once faces have slid too far for its numbering these points depend on nothing.
        """
        touched_qd, rest_qd = response.contact.dof_qd, self.interface.rest.dof_qd
        if touched_qd is rest_qd:  # no point has moved along the master
            return self.rest_pattern
        carries_q = (response.p_q != 0.0) | (response.dp_q != 0.0)
        shears_q = response.pull.shears_q
        touched_qd = response.contact.needed(carries_q, shears_q)
        if touched_qd.size * touched_qd.shape[1] > SCALES.coupled:
            return None
        carries_q = carries_q | shears_q
        if ways := touched_qd.shape[1] - rest_qd.shape[1]:  # ways over several sides
            rest_qd = np.pad(rest_qd, ((0, 0), (0, ways)), mode="edge")
        known = kept or self.rest_pattern
        numbering = known.numbering
        idle_qd = rest_qd if numbering is self.band else touched_qd[:, :1]
        dof_qd = np.where(carries_q[:, None], touched_qd, idle_qd)
        if np.array_equal(known.dof_qd, dof_qd):
            return known
        if isinstance(numbering, Band) and numbering.reach(dof_qd) > SCALES.wider * numbering.k:
            dof_qd = np.where(carries_q[:, None], touched_qd, touched_qd[:, :1])
            d = self.ahead_d.size // len(self.interface.P_AI)
            ahead_A = (self.ahead_d * response.u_d).reshape(-1, d).sum(axis=1)
            numbering = self.numbered(dof_qd, self.x_d + np.repeat(ahead_A, d))
        return Pattern.of(numbering, dof_qd, self.springs, self.bulk.assembler, known)

    @cached_property
    def hold(self) -> float:
        """Stiffness of the spring that holds the opening while a tangent is factorised; 0 for a singular system."""
        response = respond(self, self.start(), decide=False)
        pattern = self.pattern(response)
        assert pattern is not None
        half, skew = pattern.tangent(self.interface, response)
        definite = pattern.band.cholesky(half.copy()) if skew is None else None
        factors = pattern.band.lu(half, skew) if definite is None else definite
        held_d = None if factors is None else factors.solve(self.hold_d[:, None])[:, 0]
        compliance = 0.0 if held_d is None else abs(float(self.hold_d @ held_d))
        return SCALES.hold / compliance if compliance > 0.0 else 0.0


def respond(system: System, trial: State, decide: bool = True) -> Response:
    """Forces of a trial state, whose history is that of the last converged one.

    Contact is decided by the sign of the gap at every point, or, without ``decide``, stays as it is in ``trial``.
    """
    interface, bulk = system.interface, system.bulk.respond(trial.u_d)
    touch = interface.contact(trial.u_d, trial.pairing)
    scale = max(bulk.scale, SCALES.unloaded * trial.scale)
    closed_q = _closed(system, touch, trial, scale) if decide else trial.closed_q
    pull = traction(interface, touch, trial.past, closed_q, trial.dt or INSTANT)
    internal_d = bulk.internal_d + forces(interface, touch, pull, system.n_dof)
    internal_d -= system.spring_forces(trial.u_d) @ system.springs_rd
    return Response(trial.u_d, internal_d, scale, bulk.energy, touch, pull, closed_q, bulk.gradients)


def _closed(system: System, touch: Contact, trial: State, scale: float) -> np.ndarray:
    """Points in contact, by the sign of the gap; unchanged where the gap is rounding, with negligible force."""
    interface = system.interface
    nothing_q = np.abs(touch.g_q) * interface.law.stiffest * interface.dA_q <= SCALES.still * scale
    return np.where(nothing_q, trial.closed_q, touch.g_q < 0.0)


def energies(system: System, state: State, response: Response) -> Energies:
    """Stored and dissipated energies at a state with its history."""
    interface, touch = system.interface, response.contact
    elastic = response.bulk_energy + 0.5 * float(system.spring_r @ (system.springs_rd @ state.u_d) ** 2)
    found, facing_q = interface.law.stored(*touch.jump_qc.T.copy(), state.past), interface.dA_q * touch.share_q
    cohesive = float(facing_q @ (found.cohesion + found.friction))
    dissipated = float(np.sum(np.where(interface.bonded_q, interface.dA_q * found.dissipated, 0.0))) + state.lost
    return Energies(elastic, cohesive + state.kept, float(facing_q @ found.contact), dissipated)


def rounding(system: System, u_d: np.ndarray, response: Response) -> float:
    """Norm of the change of the forces, those of the stiff contact included, when the displacements change by
    rounding."""
    of_bond = response.contact.rounding(u_d, response.pull.slope_qcc * system.interface.dA_q[:, None, None])
    return float(np.hypot(system.bulk.rounding(u_d), of_bond))


def factorise(system: System, response: Response, pattern: Pattern, phase: Phase) -> Inverse | None:
    """Inverse of the tangent with this pattern; None where it is exactly singular."""
    with phase("assembly"):
        half, skew = pattern.tangent(system.interface, response)
    with phase("factor"):
        return inverse_of(system, pattern, half, skew)


def inverse_of(system: System, pattern: Pattern, half: np.ndarray, skew: Skew | None) -> Inverse | None:
    """Inverse of the matrix with this lower half and skew part; None where it is exactly singular."""
    found = None
    if skew is None and system.hold > 0.0:
        held = half.copy()
        held[pattern.held] += system.hold * system.loads_squared
        found = held_inverse(pattern.band, held, (system.load_d, system.hold_d), system.hold)
    return inverse(pattern.band, half, skew, system.load_d) if found is None else found
