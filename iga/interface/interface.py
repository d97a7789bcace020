"""Gauss-point-to-surface cohesion and contact in one formulation.

Every quadrature point of the slave meets the master on its own; the gap along the master's normal drives one traction
law for opening and closing (Dimitri, De Lorenzis, Zavarise 2013; De Lorenzis, Temizer, Wriggers, Zavarise 2011). An
interface is one of three kinds: a `SearchedInterface` projects its points on the master in every configuration, a
`SettledInterface` keeps pairs and normals of the reference configuration, and the points of a `PairedInterface` meet
given control points.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, fields, replace
from functools import cached_property

import numpy as np

from iga.interface.closest_point import Pairing, closest_points, nearest_samples
from iga.interface.contact import Contact, Rows, SlidingContact
from iga.interface.master_point import MasterPoints, master_points
from iga.interface.surface import Surface, normal
from iga.interface.traction_law import TractionLaw

#: Part of the model's size within which surfaces count as touching in the reference configuration.
FACES_TOUCH = 1e-9


@dataclass(frozen=True)
class Interface(ABC):
    """Points of the slave and the law that acts there; its kind says where they meet the other surface.

    ``N_qa`` (n_q, n_a) slave functions at the points, on the control points ``conn_qa``; ``dA_q`` (n_q,) reference area
    (length x width) of each point; ``X_qi`` (n_q, 2) reference positions; ``P_AI`` reference control points of the
    whole model. ``bonded_q`` (n_q,) is False for points that only touch: they have no cohesion and no history.
    """

    N_qa: np.ndarray
    conn_qa: np.ndarray
    dA_q: np.ndarray
    X_qi: np.ndarray
    P_AI: np.ndarray
    law: TractionLaw
    bonded_q: np.ndarray

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

    @cached_property
    def all_bonded(self) -> bool:
        return bool(self.bonded_q.all())

    @cached_property
    def local_AI(self) -> np.ndarray:
        """Control points relative to the first one, so that coordinates are no larger than the specimen."""
        return self.P_AI - self.P_AI[0]

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
    def home_qi(self) -> np.ndarray:
        """The home (n_q, 2) of each point: where it meets the master then, in local coordinates."""
        there = self.reference
        return (there.M_qb[:, None] @ self.local_AI[self.master.conn_ca[there.c_q]])[:, 0]

    @cached_property
    def apart_qi(self) -> np.ndarray:
        """Vectors (n_q, 2) from the homes to the slave points, exactly zero where the surfaces touch."""
        apart_qi = self.at_slave(self.local_AI) - self.home_qi
        touching = np.linalg.norm(apart_qi, axis=1) < FACES_TOUCH * np.ptp(self.local_AI, axis=0).max()
        return np.where(touching[:, None], 0.0, apart_qi)

    @cached_property
    def rest(self) -> Contact:
        there = self.reference
        conn_qa, D_qa, n_qi = self._pairs(there)
        g_q, rows = np.sum(self.apart_qi * n_qi, -1), Rows(dofs(conn_qa), _along(D_qa, n_qi))
        return Contact(self.pairing, g_q, n_qi, there.share_q, rows)

    def contact(self, u_d: np.ndarray, guess: Pairing | None) -> SlidingContact:
        u_Ai = u_d.reshape(-1, 2)
        y_AI = self.local_AI + u_Ai
        x_qi = self.at_slave(y_AI)
        pairing = closest_points(self.master, x_qi, y_AI, guess or self.pairing)
        there = master_points(self.master, pairing, x_qi, y_AI)
        conn_qa, D_qa, n_qi = self._pairs(there)
        g_q = np.sum((self._slid(there) + _jump(D_qa, u_Ai.take(conn_qa, axis=0))) * n_qi, -1)
        moving_qa = np.concatenate([np.zeros_like(self.N_qa), there.dM_qb], axis=1)
        V_qrd = np.stack([_along(D_qa, n_qi), _along(D_qa, there.t_qi), _along(moving_qa, n_qi)], axis=1)
        m_q, kappa_q = np.sum(there.t_qi**2, -1), np.sum(n_qi * there.t_xi_qi, -1)
        rows = Rows(dofs(conn_qa), V_qrd[:, 0])
        return SlidingContact(pairing, g_q, n_qi, there.share_q, rows, V_qrd, m_q, kappa_q, there.fading_q)

    def _pairs(self, there: MasterPoints) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Control points of both sides, their functions (n_q, n_a + n_b), slave minus master, and master normals."""
        conn_qa = np.concatenate([self.conn_qa, self.master.conn_ca.take(there.c_q, axis=0)], axis=1)
        D_qa = np.concatenate([self.N_qa, -there.M_qb], axis=1)
        return conn_qa, D_qa, normal(there.t_qi, self.master.outward)

    def _slid(self, there: MasterPoints) -> np.ndarray:
        """Slave minus master (n_q, 2) in the reference configuration, as far as the projection has moved from its home.

        Exactly zero at home, free of rounding: bodies that touch in the reference configuration have no gap.
        """
        home, X_qbi = self.reference, self.local_AI.take(self.master.conn_ca.take(there.c_q, axis=0), axis=0)
        origin_qi, at_home_q1 = X_qbi[:, -1], (there.c_q == home.c_q)[:, None]
        change_qb = np.where(at_home_q1, home.M_qb - there.M_qb, -there.M_qb)
        moved_qi = (change_qb[:, None] @ (X_qbi - origin_qi[:, None]))[:, 0]
        return moved_qi + np.where(at_home_q1, 0.0, self.home_qi - origin_qi) + self.apart_qi


@dataclass(frozen=True)
class SettledInterface(Interface):
    """Every point keeps its place on the master and the normal there, as is exact in linear kinematics.

    Gaps change in proportion to the displacements, from the contact ``at_rest`` on and with its rows.
    """

    at_rest: Contact

    @property
    def rest(self) -> Contact:
        return self.at_rest

    @property
    def pairing(self) -> Pairing | None:
        return self.at_rest.pairing

    def contact(self, u_d: np.ndarray, guess: Pairing | None = None) -> Contact:
        return replace(self.at_rest, g_q=self.at_rest.g_q + self.at_rest.rates(u_d))


@dataclass(frozen=True)
class PairedInterface(Interface):
    """Every point keeps the control points that it meets, and a normal ``n_qi`` (n_q, 2); no surface is searched.

    The jump at a point is the sum of ``D_qa`` (n_q, n_c) times the displacements of the control points ``both_qa``:
    slave minus master, or twice the slave where it meets its mirror image.
    """

    both_qa: np.ndarray
    D_qa: np.ndarray
    n_qi: np.ndarray

    @cached_property
    def rest(self) -> Contact:
        n_q, rows = self.points, Rows(dofs(self.both_qa), _along(self.D_qa, self.n_qi))
        return Contact(None, np.zeros(n_q), self.n_qi, np.ones(n_q), rows)

    @property
    def pairing(self) -> None:
        return None

    def contact(self, u_d: np.ndarray, guess: Pairing | None = None) -> Contact:
        jump_qi = (self.D_qa[:, None] @ u_d.reshape(-1, 2)[self.both_qa])[:, 0]
        return replace(self.rest, g_q=np.sum(jump_qi * self.n_qi, -1))


def settled(interface: Interface) -> SettledInterface:
    """The same interface with the pairs and normals of the reference configuration."""
    common = {field.name: getattr(interface, field.name) for field in fields(Interface)}
    return SettledInterface(**common, at_rest=interface.rest)


def traction(
    interface: Interface, contact: Contact, k_q: np.ndarray, closed_q: np.ndarray, g_q: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Traction, its slope and the new history at all points; a point that has left the master is free.

    Traction and slope are those of the share of each point that faces the master, over its whole area. ``g_q`` are
    trial gaps in place of those of the contact.
    """
    p, dp, k_new = interface.law.traction(contact.g_q if g_q is None else g_q, k_q, closed_q)
    if interface.all_bonded and contact.whole:
        return p, dp, k_new
    holds_q, carries_q = holding(interface, contact), contact.share_q
    if not interface.all_bonded:
        carries_q = np.where(holds_q | (closed_q & interface.law.contact), carries_q, 0.0)
    return carries_q * p, carries_q * dp, np.where(holds_q, k_new, k_q)


def holding(interface: Interface, contact: Contact) -> np.ndarray:
    """Points (n_q,) with cohesion: bonded ones that face the master. They alone have kinks and damage."""
    return contact.on_q & interface.bonded_q


def forces(interface: Interface, contact: Contact, p_q: np.ndarray, n_dof: int) -> np.ndarray:
    """Residual ``R = int p dg/du dGamma`` (n_dof,)."""
    return contact.gap_rows.forces(p_q * interface.dA_q, n_dof)


def stiffness(interface: Interface, contact: Contact, p_q: np.ndarray, dp_q: np.ndarray) -> np.ndarray:
    """Complete tangent of each point (n_q, n_d, n_d), ``K = int p' G'G dGamma + int p D(dg) dGamma``."""
    return contact.stiffness(p_q * interface.dA_q, dp_q * interface.dA_q)


def dofs(conn_qa: np.ndarray) -> np.ndarray:
    """Degrees of freedom (..., 2 n_a) of control points (..., n_a), numbered 2A + i."""
    return np.stack([2 * conn_qa, 2 * conn_qa + 1], axis=-1).reshape(*conn_qa.shape[:-1], -1)


def _jump(D_qa: np.ndarray, u_qai: np.ndarray) -> np.ndarray:
    """Jump of the displacements (n_q, 2), rounded as the differences between neighbours and not as the displacements.

    A penalty multiplies every bit that is lost. The functions of a row, slave minus master, sum to zero.
    """
    return (D_qa[:, None] @ (u_qai - u_qai[:, -1:]))[:, 0]


def _along(N_qa: np.ndarray, v_qi: np.ndarray) -> np.ndarray:
    """Rows (n_q, 2 n_a) ``N_qa v_qi`` over the degrees of freedom."""
    rows_qai = np.empty((*N_qa.shape, 2))
    for i in range(2):  # a product over pairs would take four times as long
        np.multiply(N_qa, v_qi[:, i : i + 1], out=rows_qai[..., i])
    return rows_qai.reshape(len(N_qa), -1)
