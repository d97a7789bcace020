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
from typing import NamedTuple

import numpy as np

from iga.interface.closest_point import Pairing, closest_points, nearest_samples
from iga.interface.contact import Contact, Rows, SlidingContact, Slip, along, dofs
from iga.interface.master_point import MasterPoints, master_points
from iga.interface.mixed_laws import History, MixedLaw, Scaled
from iga.interface.slip import Home, home_of, slid_slip, walked
from iga.interface.surface import Surface, normal
from iga.interface.traction_law import TractionLaw

#: Difference of the mixed slopes of both tractions, in parts of their sum, from which on a tangent is unsymmetric.
UNSYMMETRIC = 1e-12

#: Part of the model's size within which surfaces count as touching in the reference configuration.
FACES_TOUCH = 1e-9


@dataclass(frozen=True)
class Interface(ABC):
    """Points of the slave and the law that acts there; its kind says where they meet the other surface.

    ``N_qa`` (n_q, n_a) slave functions at the points, ``dN_qa`` their derivatives by the length of the surface as it is
    walked, on the control points ``conn_qa``; ``dA_q`` (n_q,) reference area
    (length x width) of each point; ``X_qi`` (n_q, 2) reference positions; ``P_AI`` reference control points of the
    whole model. ``bonded_q`` (n_q,) is False for points that only touch: they have no cohesion and no history. A slip
    is positive where the slave moves along ``forward_i`` (2,) in the reference configuration.
    """

    N_qa: np.ndarray
    dN_qa: np.ndarray
    conn_qa: np.ndarray
    dA_q: np.ndarray
    X_qi: np.ndarray
    P_AI: np.ndarray
    law: TractionLaw | MixedLaw
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

    def slopes(self, u_d: np.ndarray, contact: Contact) -> tuple[np.ndarray, np.ndarray] | None:
        """Derivatives (n_q,) of gap and slip along the slave, by its reference length along ``forward_i``.

        None where the points have no surface to be walked along.
        """
        return None

    @cached_property
    def walked_q(self) -> np.ndarray:
        """1 where the slave is walked along ``forward_i``, else -1 (n_q,)."""
        tangent_qi = (self.dN_qa[:, None] @ self.local_AI.take(self.conn_qa, axis=0))[:, 0]
        return np.where(tangent_qi @ self.forward_i < 0.0, -1.0, 1.0)

    @cached_property
    def rubs_q(self) -> np.ndarray:
        """Points (n_q,) with a traction along the surface, where the law has one: bonded ones, or all with friction."""
        return self.bonded_q | (isinstance(self.law, MixedLaw) and self.law.friction > 0.0)

    @property
    def slides(self) -> bool:
        """Whether the law asks for the slip."""
        return isinstance(self.law, MixedLaw)

    @property
    def viscosity(self) -> float:
        """Time in which damage follows, 0 where it does so at once."""
        return self.law.viscosity if isinstance(self.law, MixedLaw) and self.law.irreversible else 0.0

    def flat_slip(self, conn_qa: np.ndarray, D_qa: np.ndarray, t_qi: np.ndarray) -> Slip | None:
        """No slip yet, along tangents t_qi (n_q, 2) that stay; None where the law does not ask for it."""
        if not self.slides:
            return None
        forward_q = np.where(t_qi @ self.forward_i < 0.0, -1.0, 1.0) / np.linalg.norm(t_qi, axis=1)
        return Slip(np.zeros(self.points), Rows(dofs(conn_qa), along(D_qa, forward_q[:, None] * t_qi)))

    @cached_property
    def all_bonded(self) -> bool:
        return bool(self.bonded_q.all())

    @cached_property
    def local_AI(self) -> np.ndarray:
        """Control points relative to the first one, so that coordinates are no larger than the specimen."""
        return self.P_AI - self.P_AI[0]

    def start(self) -> Histories:
        """The points before anything moves; of a law that slides those without cohesion have failed already."""
        if not isinstance(self.law, MixedLaw):
            return Histories(np.zeros(self.points))
        d_q, slip_q = self.law.start(self.points)
        return Histories(np.where(self.bonded_q, d_q, 1.0), slip_q)

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
        g_q, rows = np.sum(self.apart_qi * n_qi, -1), Rows(dofs(conn_qa), along(D_qa, n_qi))
        slip = self.flat_slip(conn_qa, D_qa, there.t_qi)
        return Contact(self.pairing, g_q, n_qi, there.share_q, rows, slip=slip)

    @cached_property
    def home(self) -> Home:
        """Where the points met the master before anything moved."""
        return home_of(self.master, self.pairing, self.local_AI, self.forward_i)

    def contact(self, u_d: np.ndarray, guess: Pairing | None) -> SlidingContact:
        u_Ai = u_d.reshape(-1, 2)
        y_AI = self.local_AI + u_Ai
        x_qi = self.at_slave(y_AI)
        pairing = closest_points(self.master, x_qi, y_AI, guess or self.pairing)
        there = master_points(self.master, pairing, x_qi, y_AI)
        conn_qa, D_qa, n_qi = self._pairs(there)
        apart_qi = self._slid(there) + _jump(D_qa, u_Ai.take(conn_qa, axis=0))
        g_q = np.sum(apart_qi * n_qi, -1)
        moving_qa = np.concatenate([np.zeros_like(self.N_qa), there.dM_qb], axis=1)
        V_qrd = np.stack([along(D_qa, n_qi), along(D_qa, there.t_qi), along(moving_qa, n_qi)], axis=1)
        m_q, kappa_q = np.sum(there.t_qi**2, -1), np.sum(n_qi * there.t_xi_qi, -1)
        rows = Rows(dofs(conn_qa), V_qrd[:, 0])
        found = SlidingContact(pairing, g_q, n_qi, there.share_q, rows, V_qrd, m_q, kappa_q, there.fading_q)
        if not self.slides:
            return found
        return replace(found, slip=slid_slip(self.master, self.home, found, there, apart_qi, y_AI))

    @cached_property
    def rest_slopes(self) -> tuple[Rows, Rows]:
        """Rows of the derivatives of gap and slip (see `slopes`) in the reference configuration."""
        there = self.reference
        conn_qa, _, n_qi = self._pairs(there)
        size_q = np.linalg.norm(there.t_qi, axis=1)
        forward_qi = (self.home.forward_q / size_q)[:, None] * there.t_qi
        by_length = (self.home.forward_q / size_q)[:, None] * there.dM_qb
        D_qa = np.concatenate([self.walked_q[:, None] * self.dN_qa, -by_length], axis=1)
        return Rows(dofs(conn_qa), along(D_qa, n_qi)), Rows(dofs(conn_qa), along(D_qa, forward_qi))

    def slopes(self, u_d: np.ndarray, contact: Contact) -> tuple[np.ndarray, np.ndarray]:
        """``dg = n.dx`` and ``ds = |t| dxi - |t_home| dxi_home`` with ``(m - g n.y'') dxi = t.dx``."""
        assert contact.pairing is not None and isinstance(contact, SlidingContact)
        y_AI, home = self.local_AI + u_d.reshape(-1, 2), self.home
        dx_qi = self.walked_q[:, None] * (self.dN_qa[:, None] @ y_AI.take(self.conn_qa, axis=0))[:, 0]
        t_qi = walked(self.master, y_AI, contact.pairing.c_q, contact.pairing.xi_q)
        stretch_q = np.linalg.norm(walked(self.master, y_AI, home.c_q, home.xi_q), axis=1)
        stretch_q = stretch_q / np.linalg.norm(self.reference.t_qi, axis=1)
        along_q = np.sum(t_qi * dx_qi, -1) / (contact.m_q - contact.g_q * contact.kappa_q)
        ds_q = home.forward_q * contact.m_q**0.5 * along_q - stretch_q
        return np.sum(contact.n_qi * dx_qi, -1), ds_q

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

    Gaps change in proportion to the displacements, from the contact ``at_rest`` on and with its rows; ``by_length`` are
    the rows of their derivatives, where the law asks for slip.
    """

    at_rest: Contact
    by_length: tuple[Rows, Rows] | None = None

    def slopes(self, u_d: np.ndarray, contact: Contact) -> tuple[np.ndarray, np.ndarray] | None:
        if self.by_length is None:
            return None
        dg, ds = (rows.rates(u_d) for rows in self.by_length)
        return dg, ds

    @property
    def rest(self) -> Contact:
        return self.at_rest

    @property
    def pairing(self) -> Pairing | None:
        return self.at_rest.pairing

    def contact(self, u_d: np.ndarray, guess: Pairing | None = None) -> Contact:
        rest = self.at_rest
        slip = None if rest.slip is None else replace(rest.slip, s_q=rest.slip.rows.rates(u_d))
        return replace(rest, g_q=rest.g_q + rest.rates(u_d), slip=slip)


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
        n_q, rows = self.points, Rows(dofs(self.both_qa), along(self.D_qa, self.n_qi))
        slip = self.flat_slip(self.both_qa, self.D_qa, np.stack([-self.n_qi[:, 1], self.n_qi[:, 0]], -1))
        return Contact(None, np.zeros(n_q), self.n_qi, np.ones(n_q), rows, slip=slip)

    @property
    def pairing(self) -> None:
        return None

    def contact(self, u_d: np.ndarray, guess: Pairing | None = None) -> Contact:
        jump_qi = (self.D_qa[:, None] @ u_d.reshape(-1, 2)[self.both_qa])[:, 0]
        rest = self.rest
        slip = None if rest.slip is None else replace(rest.slip, s_q=rest.slip.rows.rates(u_d))
        return replace(rest, g_q=np.sum(jump_qi * self.n_qi, -1), slip=slip)


def settled(interface: Interface) -> SettledInterface:
    """The same interface with the pairs and normals of the reference configuration."""
    common = {field.name: getattr(interface, field.name) for field in fields(Interface)}
    by_length = interface.rest_slopes if interface.slides and isinstance(interface, SearchedInterface) else None
    return SettledInterface(**common, at_rest=interface.rest, by_length=by_length)


@dataclass(frozen=True)
class Shear:
    """What sliding adds to the response of the points (n_q,): traction t_q along the master, the slopes of both
    tractions that opening alone does not have, the history ``slip_q`` of friction, the law, and the jumps and the
    damage at which it was asked.
    """

    t_q: np.ndarray
    dp_ds_q: np.ndarray
    dt_dg_q: np.ndarray
    dt_ds_q: np.ndarray
    slip_q: np.ndarray | None
    law: MixedLaw
    jump_qc: np.ndarray
    d_q: np.ndarray

    @cached_property
    def scaled(self) -> Scaled:
        """How far damage is on its way."""
        g_q, s_q = self.jump_qc.T.copy()
        return self.law.scaled(g_q, s_q, self.d_q)

    @cached_property
    def driven_q(self) -> np.ndarray:
        """The damage that the jump drives to on first loading."""
        g_q, s_q = self.jump_qc.T.copy()
        return self.law.driven(g_q, s_q)

    def along(self, g_q: np.ndarray, s_q: np.ndarray) -> np.ndarray:
        """Scaled jumps (n_q,) of undamaged points at small gaps and slips, in proportion to these."""
        return self.law.scaled(g_q, s_q, np.zeros(len(g_q))).x


class Tractions(NamedTuple):
    """Traction p_q, its slope dp_q by the gap, and the new history k_q (n_q,): the largest gap, or with ``shear`` the
    damage."""

    p_q: np.ndarray
    dp_q: np.ndarray
    k_q: np.ndarray
    shear: Shear | None = None

    @property
    def force_qc(self) -> np.ndarray:
        """Tractions (n_q, n_c), as the jumps of a `Contact`."""
        return np.stack([self.p_q] if self.shear is None else [self.p_q, self.shear.t_q], axis=1)

    @property
    def slope_qcc(self) -> np.ndarray:
        """Derivatives (n_q, n_c, n_c) of the tractions by the jumps."""
        if self.shear is None:
            return self.dp_q[:, None, None]
        rows = self.dp_q, self.shear.dp_ds_q, self.shear.dt_dg_q, self.shear.dt_ds_q
        return np.stack(rows, axis=1).reshape(-1, 2, 2)


@dataclass(frozen=True)
class Histories:
    """What the points (n_q,) bring along: k_q as in `Tractions`, the slip of friction, the time ``dt`` of the step."""

    k_q: np.ndarray
    slip_q: np.ndarray | None = None
    dt: float = 0.0


def traction(
    interface: Interface, contact: Contact, past: Histories, closed_q: np.ndarray, jump_qc: np.ndarray | None = None
) -> Tractions:
    """Tractions, their slopes and the new history at all points; a point that has left the master is free.

    Traction and slope are those of the share of each point that faces the master, over its whole area. ``jump_qc``
    are trial jumps in place of those of the contact.
    """
    law, k_q = interface.law, past.k_q
    if isinstance(law, MixedLaw):
        return _sheared(law, interface, contact, past, (closed_q, contact.jump_qc if jump_qc is None else jump_qc))
    p, dp, k_new = law.traction(contact.g_q if jump_qc is None else jump_qc[:, 0], k_q, closed_q)
    if interface.all_bonded and contact.whole:
        return Tractions(p, dp, k_new)
    holds_q, carries_q = holding(interface, contact), contact.share_q
    if not interface.all_bonded:
        carries_q = np.where(holds_q | (closed_q & law.contact), carries_q, 0.0)
    return Tractions(carries_q * p, carries_q * dp, np.where(holds_q, k_new, k_q))


def _sheared(
    law: MixedLaw, interface: Interface, contact: Contact, past: Histories, at: tuple[np.ndarray, np.ndarray]
) -> Tractions:
    """The same of a law that slides, ``at`` contact and jumps; points without cohesion have failed from the start, and
    touch and rub alone."""
    closed_q, jump_qc = at
    (g_q, s_q), share_q = jump_qc.T.copy(), contact.share_q
    found = law.traction(g_q, s_q, History(past.k_q, past.slip_q), past.dt, closed_q)
    d_q, slip_q = found.history
    if not contact.whole:
        d_q = np.where(holding(interface, contact), d_q, past.k_q)
    t_q, dp_ds_q, dt_dg_q, dt_ds_q = (share_q * part for part in (found.t, found.dp_ds, found.dt_dg, found.dt_ds))
    shear = Shear(t_q, dp_ds_q, dt_dg_q, dt_ds_q, slip_q, law, jump_qc, d_q)
    return Tractions(share_q * found.p, share_q * found.dp_dg, d_q, shear)


def holding(interface: Interface, contact: Contact) -> np.ndarray:
    """Points (n_q,) with cohesion: bonded ones that face the master. They alone have kinks and damage."""
    return contact.on_q & interface.bonded_q


def stored(interface: Interface, contact: Contact, past: Histories) -> tuple[float, float]:
    """Energies stored in a bond that slides, in cohesion and friction and in contact."""
    assert contact.slip is not None and isinstance(interface.law, MixedLaw)
    found = interface.law.stored(contact.g_q, contact.slip.s_q, History(past.k_q, past.slip_q))
    dA_q = interface.dA_q * contact.share_q
    return float(dA_q @ (found.cohesion + found.friction)), float(dA_q @ found.contact)


def forces(interface: Interface, contact: Contact, pull: Tractions, n_dof: int) -> np.ndarray:
    """Residual ``R = int (p dg/du + t ds/du) dGamma`` (n_dof,)."""
    R_d = contact.gap_rows.forces(pull.p_q * interface.dA_q, n_dof)
    if pull.shear is not None and contact.slip is not None:
        R_d += contact.slip.rows.forces(pull.shear.t_q * interface.dA_q, n_dof)
    return R_d


def stiffness(interface: Interface, contact: Contact, pull: Tractions) -> np.ndarray:
    """Complete tangent of each point (n_q, n_d, n_d), ``K = int (J' C J + p D(dg) + t D(ds)) dGamma``.

    J are the rows of gap and slip, C the slopes of the tractions.
    """
    dA_q, shear, slip = interface.dA_q, pull.shear, contact.slip
    if shear is None or slip is None:
        return contact.stiffness(pull.p_q * dA_q, pull.dp_q * dA_q)
    G_qd, n_d = contact.gap_rows.G_qd, slip.rows.G_qd.shape[1]
    J_qrd = np.stack([np.pad(G_qd, ((0, 0), (0, n_d - G_qd.shape[1]))), slip.rows.G_qd], axis=1)
    K_qdd = J_qrd.swapaxes(1, 2) @ (dA_q[:, None, None] * pull.slope_qcc @ J_qrd)
    n_g = G_qd.shape[1]
    K_qdd[:, :n_g, :n_g] += contact.stiffness(pull.p_q * dA_q, np.zeros_like(dA_q))
    return K_qdd + slip.stiffness(contact, shear.t_q * dA_q)


def unsymmetric(contact: Contact, pull: Tractions) -> np.ndarray:
    """Points (n_m,) with an unsymmetric tangent: those that slide off the master, and where the mode ratio changes."""
    off = contact.unsymmetric(pull.p_q)
    if pull.shear is None:
        return off
    one, other = pull.shear.dp_ds_q, pull.shear.dt_dg_q
    coupled = np.flatnonzero(np.abs(one - other) > UNSYMMETRIC * (np.abs(one) + np.abs(other)))
    return np.union1d(np.union1d(off, contact.unsymmetric(pull.shear.t_q)), coupled)


def combined(contact: Contact, by_g_q: np.ndarray, by_s_q: np.ndarray) -> Rows:
    """First variation of a function of gap and slip with these derivatives (n_q,)."""
    assert contact.slip is not None
    G_qd, rows = contact.gap_rows.G_qd, contact.slip.rows
    both_qd = by_s_q[:, None] * rows.G_qd
    both_qd[:, : G_qd.shape[1]] += by_g_q[:, None] * G_qd
    return Rows(rows.dof_qd, both_qd)


def _jump(D_qa: np.ndarray, u_qai: np.ndarray) -> np.ndarray:
    """Jump of the displacements (n_q, 2), rounded as the differences between neighbours and not as the displacements.

    A penalty multiplies every bit that is lost. The functions of a row, slave minus master, sum to zero.
    """
    return (D_qa[:, None] @ (u_qai - u_qai[:, -1:]))[:, 0]
