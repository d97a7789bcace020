"""Gauss-point-to-surface cohesion and contact in one formulation.

Every quadrature point of the slave meets the master on its own; the gap along the master's normal drives one traction
law for opening and closing (Dimitri, De Lorenzis, Zavarise 2013; De Lorenzis, Temizer, Wriggers, Zavarise 2011). An
interface is one of two kinds: a `SearchedInterface` projects its points on the master in every configuration, a
`SettledInterface` keeps the pairs and normals of the reference configuration, or those that it is given.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any

import numpy as np

from iga.interface.closest_point import Pairing, closest_points, nearest_samples
from iga.interface.contact import Contact, G, Rows, SlidingContact, Slip, along, dofs
from iga.interface.master_point import MasterPoints, master_points
from iga.interface.mean_frame import MeanContact, angle_between, in_mean_frame
from iga.interface.slip import slid, tangents
from iga.interface.surface import Surface, normal
from iga.laws.law import History, Law

#: Part of the model's size within which surfaces count as touching in the reference configuration.
FACES_TOUCH = 1e-9


@dataclass(frozen=True)
class Interface(ABC):
    """Points of the slave and the law that acts there. Subclasses say where the points meet the other surface.

    ``N_qa`` (n_q, n_a) slave functions at the points, on the control points ``conn_qa``; ``dN_qa`` and ``d2N_qa`` their
    derivatives by the reference arc length, in the walking direction of the surface; ``dA_q`` (n_q,) reference area
    (length x width) of each point; ``X_qi`` (n_q, 2) reference positions; ``P_AI`` reference control points of the
    whole model. ``bonded_q`` (n_q,) is False for points that only touch: they have no cohesion, whatever the law and
    the history. A slip is positive where the slave moves along ``forward_i`` (2,) in the reference configuration.
    """

    N_qa: np.ndarray
    dN_qa: np.ndarray
    d2N_qa: np.ndarray
    conn_qa: np.ndarray
    dA_q: np.ndarray
    X_qi: np.ndarray
    P_AI: np.ndarray
    law: Law
    bonded_q: np.ndarray
    forward_i: np.ndarray

    @property
    @abstractmethod
    def rest(self) -> Contact:
        """Contact in the reference configuration."""

    @property
    @abstractmethod
    def pairing(self) -> Pairing | None:
        """Where the points meet the master in the reference configuration; None for pairs without a search."""

    @abstractmethod
    def contact(self, u_d: np.ndarray, guess: Pairing | None) -> Contact:
        """Contact in the configuration u_d (2 n_A,); a search starts from the pairing ``guess``."""

    @property
    def points(self) -> int:
        return len(self.dA_q)

    def slopes(self, u_d: np.ndarray, contact: Contact) -> tuple[np.ndarray, ...] | None:
        """Derivatives (n_q,) of the jumps by the reference arc length of the slave, in the direction ``forward_i``.

        None where the kind of interface does not have them.
        """
        return None

    @cached_property
    def direction_q(self) -> np.ndarray:
        """1 where the walking direction of the slave is along ``forward_i``, else -1 (n_q,)."""
        tangent_qi = (self.dN_qa[:, None] @ self.local_AI.take(self.conn_qa, axis=0))[:, 0]
        return np.where(tangent_qi @ self.forward_i < 0.0, -1.0, 1.0)

    @cached_property
    def slides(self) -> bool:
        """Whether the law depends on the slip."""
        return self.law.slides

    @property
    def viscosity(self) -> float:
        """Relaxation time with which damage follows the jump; 0 without delay."""
        return self.law.viscosity if self.law.irreversible else 0.0

    def flat_slip(self, conn_qa: np.ndarray, D_qa: np.ndarray, t_qi: np.ndarray) -> Slip | None:
        """Zero slip along tangents t_qi (n_q, 2) that do not turn; None where the law does not depend on it."""
        if not self.slides:
            return None
        forward_q = np.where(t_qi @ self.forward_i < 0.0, -1.0, 1.0) / np.linalg.norm(t_qi, axis=1)
        return Slip(np.zeros(self.points), Rows(dofs(conn_qa), along(D_qa, forward_q[:, None] * t_qi)))

    @property
    def rest_slopes(self) -> tuple[Rows, ...]:
        """Rows of the derivatives of the jumps (see `slopes`) in the reference configuration: of the gap to a mirror
        image."""
        rest = self.rest
        return (Rows(rest.gap_rows.dof_qd, along(2.0 * self.direction_q[:, None] * self.dN_qa, rest.n_qi)),)

    @cached_property
    def line_q(self) -> np.ndarray:
        """Number (n_q,) of the line along a solid on which each point lies, from the middle of the width on."""
        Z_q = self.X_qi[:, 2]
        return np.unique(np.round(Z_q / np.ptp(self.P_AI[:, 2]), 9), return_inverse=True)[1]

    @cached_property
    def all_bonded(self) -> bool:
        return bool(self.bonded_q.all())

    @cached_property
    def local_AI(self) -> np.ndarray:
        """Control points relative to the first one, so that coordinates are no larger than the specimen."""
        return self.P_AI - self.P_AI[0]

    def start(self) -> History:
        """History before anything moves."""
        start = self.law.start(self.points)
        return start._replace(d=np.where(self.bonded_q, start.d, self.law.unbonded))

    def beside(self, X_mi: np.ndarray) -> np.ndarray:
        """The points (n_m,) nearest to some places (n_m, 2)."""
        return np.array([np.argmin(np.linalg.norm(self.X_qi - X_i, axis=1)) for X_i in X_mi])

    def at_slave(self, v_Ai: np.ndarray) -> np.ndarray:
        """A field of the control points (n_A, 2) at the slave points (n_q, 2)."""
        return (self.N_qa[:, None] @ v_Ai.take(self.conn_qa, axis=0))[:, 0]


@dataclass(frozen=True)
class SearchedInterface(Interface):
    """Every point meets the closest point of the ``master``, searched for in every configuration.

    ``near`` is where the points nearly meet it in the reference configuration, if that is known.
    """

    master: Surface
    near: Pairing | None = None

    @cached_property
    def pairing(self) -> Pairing:
        X_qi = self.at_slave(self.local_AI)
        start = self.near or nearest_samples(self.master, X_qi, self.local_AI)
        return closest_points(self.master, X_qi, self.local_AI, start)

    @cached_property
    def reference(self) -> MasterPoints:
        """The master at the closest points of the reference configuration."""
        return master_points(self.master, self.pairing, self.at_slave(self.local_AI), self.local_AI)

    @cached_property
    def origin_qi(self) -> np.ndarray:
        """The origin (n_q, 2) of each point: where it meets the master in the reference configuration, in local
        coordinates."""
        there = self.reference
        return (there.M_qb[:, None] @ self.local_AI[self.master.conn_ca[there.c_q]])[:, 0]

    @cached_property
    def apart_qi(self) -> np.ndarray:
        """Vectors (n_q, 2) from the origins to the slave points, exactly zero where the surfaces touch."""
        apart_qi = self.at_slave(self.local_AI) - self.origin_qi
        touching = np.linalg.norm(apart_qi, axis=1) < FACES_TOUCH * np.ptp(self.local_AI, axis=0).max()
        return np.where(touching[:, None], 0.0, apart_qi)

    @cached_property
    def rest(self) -> Contact:
        there = self.reference
        conn_qa, D_qa, n_qi = self._pairs(there)
        g_q, rows = np.sum(self.apart_qi * n_qi, -1), Rows(dofs(conn_qa), along(D_qa, n_qi))
        slip = self.flat_slip(conn_qa, D_qa, there.t_qi)
        return Contact(self.pairing, g_q, n_qi, there.share_q, rows, slip=slip)

    @cached_property
    def forward_q(self) -> np.ndarray:
        """1 where a positive slip leads to larger parameters of the master, else -1 (n_q,)."""
        return np.where(self.reference.t_qi @ self.forward_i < 0.0, -1.0, 1.0)

    def contact(self, u_d: np.ndarray, guess: Pairing | None) -> SlidingContact | MeanContact:
        u_Ai = u_d.reshape(-1, 2)
        y_AI = self.local_AI + u_Ai
        x_qi = self.at_slave(y_AI)
        pairing = closest_points(self.master, x_qi, y_AI, guess or self.pairing)
        there = master_points(self.master, pairing, x_qi, y_AI)
        conn_qa, D_qa, n_qi = self._pairs(there)
        apart_qi = self._slid(there) + _jump(D_qa, u_Ai.take(conn_qa, axis=0))
        g_q = np.sum(apart_qi * n_qi, -1)
        moving_qa = np.concatenate([np.zeros_like(self.N_qa), there.dM_qb], axis=1)
        V_qrd = np.stack([along(D_qa, there.t_qi), along(D_qa, n_qi), along(moving_qa, n_qi)], axis=1)
        m_q, kappa_q = np.sum(there.t_qi**2, -1), np.sum(n_qi * there.t_xi_qi, -1)
        rows = Rows(dofs(conn_qa), V_qrd[:, G])
        found = SlidingContact(pairing, g_q, n_qi, there.share_q, rows, V_qrd, m_q, kappa_q, there.fading_q)
        if not self.slides:
            return found
        way = slid(self.master, self.pairing, self.forward_q, found, there, apart_qi, y_AI)
        tangent_qi = self._along_slave(self.dN_qa, y_AI)
        angle_q = np.angle(angle_between(there.t_qi, tangent_qi) / self._angle_at_rest)
        # positive where the normal of the slave turns forward; points that only touch stay in the frame of the master
        turns_q = np.where(self.bonded_q, -self.master.outward * self.forward_q, 0.0)
        return in_mean_frame(found, way, self.master.outward, turns_q, angle_q, self.dN_qa, tangent_qi)

    def _along_slave(self, dN_qa: np.ndarray, v_AI: np.ndarray) -> np.ndarray:
        """Derivatives (n_q, 2) along the slave, by functions dN_qa, of a field of the control points (n_A, 2)."""
        return (dN_qa[:, None] @ v_AI.take(self.conn_qa, axis=0))[:, 0]

    @cached_property
    def _angle_at_rest(self) -> np.ndarray:
        """The complex number (n_q,) whose angle is that between both faces in the reference configuration."""
        return angle_between(self.reference.t_qi, self._along_slave(self.dN_qa, self.local_AI))

    @cached_property
    def rest_slopes(self) -> tuple[Rows, Rows]:
        there = self.reference
        conn_qa, _, n_qi = self._pairs(there)
        size_q = np.linalg.norm(there.t_qi, axis=1)
        forward_qi = (self.forward_q / size_q)[:, None] * there.t_qi
        by_length = (self.forward_q / size_q)[:, None] * there.dM_qb
        D_qa = np.concatenate([self.direction_q[:, None] * self.dN_qa, -by_length], axis=1)
        return Rows(dofs(conn_qa), along(D_qa, n_qi)), Rows(dofs(conn_qa), along(D_qa, forward_qi))

    def slopes(self, u_d: np.ndarray, contact: Contact) -> tuple[np.ndarray, ...]:
        """``dg = n.dx`` and ``ds = |t| dxi - |t_0| dxi_0`` with ``(m - g n.y'') dxi = t.dx`` along the master, in
        the mean frame."""
        y_AI, origin = self.local_AI + u_d.reshape(-1, 2), self.pairing
        dx_qi = self.direction_q[:, None] * self._along_slave(self.dN_qa, y_AI)
        dg_q = np.sum(contact.n_qi * dx_qi, -1)
        if not isinstance(contact, MeanContact):
            return (dg_q,)
        on, dxi_q = contact.on_master, self.rate_of_place(u_d, contact)
        stretch_q = np.linalg.norm(tangents(self.master, y_AI, origin.c_q, origin.xi_q), axis=1)
        stretch_q = stretch_q / np.linalg.norm(self.reference.t_qi, axis=1)
        ds_q = self.forward_q * on.m_q**0.5 * dxi_q - stretch_q
        bend_qi = self._along_slave(self.d2N_qa, y_AI)
        turn_q = self.direction_q * (dx_qi[:, 0] * bend_qi[:, 1] - dx_qi[:, 1] * bend_qi[:, 0]) / np.sum(dx_qi**2, -1)
        turn_q = turn_q + self.master.outward * on.kappa_q * dxi_q / on.m_q**0.5
        return contact.slopes(dg_q, ds_q, turn_q)

    def rate_of_place(self, u_d: np.ndarray, contact: MeanContact) -> np.ndarray:
        """``dxi`` (n_q,) of the closest point by the arc length of the slave (see `slopes`)."""
        assert contact.pairing is not None
        y_AI, on = self.local_AI + u_d.reshape(-1, 2), contact.on_master
        dx_qi = self.direction_q[:, None] * self._along_slave(self.dN_qa, y_AI)
        t_qi = tangents(self.master, y_AI, contact.pairing.c_q, contact.pairing.xi_q)
        return np.sum(t_qi * dx_qi, -1) / (on.m_q - on.g_q * on.kappa_q)

    def _pairs(self, there: MasterPoints) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Control points of both sides, their functions (n_q, n_a + n_b), slave minus master, and master normals."""
        conn_qa = np.concatenate([self.conn_qa, self.master.conn_ca.take(there.c_q, axis=0)], axis=1)
        D_qa = np.concatenate([self.N_qa, -there.M_qb], axis=1)
        return conn_qa, D_qa, normal(there.t_qi, self.master.outward)

    def _slid(self, there: MasterPoints) -> np.ndarray:
        """Reference position (n_q, 2) of the slave point minus that of the master point which it meets now.

        Free of rounding on the side of the origin: bodies that touch in the reference configuration have exactly zero
        gap.
        """
        start, X_qbi = self.reference, self.local_AI.take(self.master.conn_ca.take(there.c_q, axis=0), axis=0)
        last_qi, same_q1 = X_qbi[:, -1], (there.c_q == start.c_q)[:, None]
        change_qb = np.where(same_q1, start.M_qb - there.M_qb, -there.M_qb)
        moved_qi = (change_qb[:, None] @ (X_qbi - last_qi[:, None]))[:, 0]
        return moved_qi + np.where(same_q1, 0.0, self.origin_qi - last_qi) + self.apart_qi


@dataclass(frozen=True)
class SettledInterface(Interface):
    """Every point keeps its place on the master and the normal there, as is exact in linear kinematics.

    Gaps are those of the contact ``at_rest`` plus its rows times the displacements. ``by_length`` are the rows of the
    derivatives of gap and slip (see `slopes`), where the law depends on the slip; of solids along both directions.
    """

    at_rest: Contact
    by_length: tuple[Rows, ...] | None = None

    def slopes(self, u_d: np.ndarray, contact: Contact) -> tuple[np.ndarray, ...] | None:
        if self.by_length is None:
            return None
        dg, *ds = (rows.rates(u_d) for rows in self.by_length)
        return (dg, contact.slip_rate(ds)) if ds else (dg,)

    @property
    def rest(self) -> Contact:
        return self.at_rest

    @property
    def pairing(self) -> Pairing | None:
        return self.at_rest.pairing

    def contact(self, u_d: np.ndarray, guess: Pairing | None = None) -> Contact:
        return self.at_rest.moved(u_d)


def paired(both_qa: np.ndarray, D_qa: np.ndarray, n_qi: np.ndarray, **points: Any) -> SettledInterface:
    """An interface whose points face fixed control points and keep their normals n_qi (n_q, 2).

    The jump at a point is the sum of D_qa (n_q, n_a) times the displacements of the control points ``both_qa``: slave
    minus master, or twice the slave where it meets its mirror image. ``points`` are the fields of `Interface`.
    """
    rows, open_q = Rows(dofs(both_qa, n_qi.shape[1]), along(D_qa, n_qi)), np.zeros(len(n_qi))
    found = SettledInterface(**points, at_rest=Contact(None, open_q, n_qi, open_q + 1.0, rows))
    slip = found.flat_slip(both_qa, D_qa, np.stack([-n_qi[:, 1], n_qi[:, 0]], -1))
    return replace(found, at_rest=replace(found.at_rest, slip=slip))


def settled(interface: Interface) -> SettledInterface:
    """The same interface with the pairs and normals of the reference configuration."""
    common = {field.name: getattr(interface, field.name) for field in fields(Interface)}
    by_length = interface.rest_slopes if interface.slides and isinstance(interface, SearchedInterface) else None
    return SettledInterface(**common, at_rest=interface.rest, by_length=by_length)


def _jump(D_qa: np.ndarray, u_qai: np.ndarray) -> np.ndarray:
    """Jump of the displacements (n_q, 2), computed from differences between neighbours to reduce rounding.

    The penalty would multiply the rounding of whole displacements. The functions of a row, slave minus master, sum to
    zero, so that one displacement can be subtracted from all.
    """
    return (D_qa[:, None] @ (u_qai - u_qai[:, -1:]))[:, 0]
