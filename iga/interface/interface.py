"""Gauss-point-to-surface cohesion and contact in one formulation.

Every quadrature point of the slave is projected on the current master on its own; the gap along the master's normal
drives one traction law for opening and closing (Dimitri, De Lorenzis, Zavarise 2013; De Lorenzis, Temizer, Wriggers,
Zavarise 2011).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from iga.interface.closest_point import Pairing, closest_points, nearest_samples
from iga.interface.laws import TractionLaw
from iga.interface.master_point import MasterPoints, master_points
from iga.interface.surface import Surface, normal

#: Part of the model's size within which surfaces count as touching where nothing has moved.
FACES_TOUCH = 1e-9


@dataclass(frozen=True)
class Home:
    """Where the slave points lie on the master before anything moves.

    ``c_q`` sides, ``N_qb`` (n_q, n_b) master functions and ``Y_qi`` positions there, in local coordinates; ``apart_qi``
    (n_q, 2) from there to the slave point, nothing where the surfaces touch.
    """

    c_q: np.ndarray
    N_qb: np.ndarray
    Y_qi: np.ndarray
    apart_qi: np.ndarray


@dataclass(frozen=True)
class Interface:
    """Slave points, master surface and the law between them.

    ``N_qa`` (n_q, n_a) slave functions at the points, on the control points ``conn_qa``; ``dA_q`` (n_q,) reference area
    (length x width) of each point; ``X_qi`` (n_q, 2) reference positions; ``P_AI`` reference control points of the
    whole model.

    There is no search where ``master`` is None: ``mirror_i`` (2,) or (n_q, 2) is the unit normal, and each point meets
    the control points ``twin_qa`` that take the same functions and lie at the same places, or, without
    these, the mirror image of the slave in the straight line that it lies on: then the gap is twice the distance to it.

    Where the contact ``at_rest``, before anything moves, is given, points meet the master there for good, along the
    normals there, without a search (linear kinematics, see `settled`): gaps change in proportion to displacements.

    ``bonded_q`` (n_q,) is False for points that only touch: nothing holds them, and they have no history. All are
    bonded where it is left out. ``near`` is where its points nearly meet the master in the reference configuration, if
    that is known.
    """

    N_qa: np.ndarray
    conn_qa: np.ndarray
    dA_q: np.ndarray
    X_qi: np.ndarray
    P_AI: np.ndarray
    law: TractionLaw
    master: Surface | None
    mirror_i: np.ndarray | None = None
    twin_qa: np.ndarray | None = None
    bonded_q: np.ndarray | None = None
    at_rest: Contact | None = None
    near: Pairing | None = None

    @property
    def points(self) -> int:
        return len(self.dA_q)

    @cached_property
    def known_conn_qa(self) -> np.ndarray:
        """Control points that every point touches for good, where nothing is searched."""
        return self.conn_qa if self.twin_qa is None else np.concatenate([self.conn_qa, self.twin_qa], axis=1)

    @cached_property
    def local_AI(self) -> np.ndarray:
        """Control points seen from one of them: wherever the specimen lies, its coordinates are no larger than it."""
        return self.P_AI - self.P_AI[0]

    @property
    def surface(self) -> Surface:
        """The master; only where there is one."""
        assert self.master is not None
        return self.master

    @cached_property
    def pairing(self) -> Pairing | None:
        """Where its points meet the master in the reference configuration; None where nothing is searched."""
        if self.master is None:
            return None
        if self.at_rest is not None:
            return self.at_rest.pairing
        X_qi = self.at_slave(self.local_AI)
        start = self.near or nearest_samples(self.master, X_qi, self.local_AI)
        return closest_points(self.master, X_qi, self.local_AI, start)

    @cached_property
    def reference(self) -> MasterPoints:
        """The master where it is met in the reference configuration; only where there is one."""
        assert self.pairing is not None
        return master_points(self.surface, self.pairing, self.at_slave(self.local_AI), self.local_AI)

    @cached_property
    def home(self) -> Home:
        """Reference places on the master; only where there is one."""
        there = self.reference
        Y_qi = (there.M_qb[:, None] @ self.local_AI[self.surface.conn_ca[there.c_q]])[:, 0]
        apart_qi = self.at_slave(self.local_AI) - Y_qi
        touching = np.linalg.norm(apart_qi, axis=1) < FACES_TOUCH * np.ptp(self.local_AI, axis=0).max()
        return Home(there.c_q, there.M_qb, Y_qi, np.where(touching[:, None], 0.0, apart_qi))

    def beside(self, X_mi: np.ndarray) -> np.ndarray:
        """Its points (n_m,) next to some places (n_m, 2)."""
        return np.array([np.argmin(np.linalg.norm(self.X_qi - X_i, axis=1)) for X_i in X_mi])

    def at_slave(self, v_Ai: np.ndarray) -> np.ndarray:
        """A field of the control points (n_A, 2) at the slave points (n_q, 2)."""
        return (self.N_qa[:, None] @ v_Ai.take(self.conn_qa, axis=0))[:, 0]


@dataclass(frozen=True)
class Contact:
    """Gaps and their variations in one configuration.

    ``g_q`` (n_q,), ``n_qi`` (n_q, 2) master normals, ``share_q`` (n_q,) part of each point's area that faces the
    master. ``dof_qd`` (n_q, n_d) lists the unknowns of slave and master side that a point touches; ``V_qrd``
    (n_q, r, n_d) holds the row of the first variation, ``dg = V_0 du``, and, where these move, the rows
    T and Nb of the second (see `stiffness`) with ``m_q``, ``kappa_q`` and ``fading_q``. Of few unknowns ``full_qd``
    (n_q, n_dof) are the rows of the first over all of them.
    """

    pairing: Pairing | None
    g_q: np.ndarray
    n_qi: np.ndarray
    share_q: np.ndarray
    dof_qd: np.ndarray
    V_qrd: np.ndarray
    m_q: np.ndarray | None = None
    kappa_q: np.ndarray | None = None
    fading_q: np.ndarray | None = None
    full_qd: np.ndarray | None = None

    @cached_property
    def on_q(self) -> np.ndarray:
        """Points (n_q,) that face the master; the others are free."""
        return self.share_q > 0.0

    @cached_property
    def whole(self) -> bool:
        """Whether all of every point faces the master."""
        return bool((self.share_q == 1.0).all())

    def rates(self, v_d: np.ndarray, q: np.ndarray | slice = slice(None)) -> np.ndarray:
        """Rates (n_q, ...) of the gaps, or of some of them, when the displacements change by v_d (n_dof, ...)."""
        if self.full_qd is not None:
            return self.full_qd[q] @ v_d
        G_qd, v_qd = self.V_qrd[q, 0], v_d.take(self.dof_qd[q], axis=0)
        return np.sum(G_qd * v_qd, axis=1) if v_d.ndim == 1 else (G_qd[:, None] @ v_qd)[:, 0]

    def gaps(self, u_d: np.ndarray) -> np.ndarray:
        """Gaps (n_q,) after displacements u_d (n_dof,) from here, where the rows hold for good."""
        return self.g_q + self.rates(u_d)

    def rows(self, q_m: np.ndarray, n_dof: int) -> np.ndarray:
        """Gradients (n_dof, n_m) of the gaps at some points."""
        if self.full_qd is not None:
            return self.full_qd[q_m].T
        rows_dm = np.zeros((n_dof, q_m.size), order="F")
        np.add.at(rows_dm, (self.dof_qd[q_m], np.arange(q_m.size)[:, None]), self.V_qrd[q_m, 0])
        return rows_dm

    def row(self, q: int, n_dof: int) -> np.ndarray:
        """Gradient (n_dof,) of the gap at one point."""
        return self.rows(np.array([q]), n_dof)[:, 0]


def contact(interface: Interface, u_d: np.ndarray, guess: Pairing | None) -> Contact:
    """Gaps in the configuration u_d (2 n_A,), searching from the pairing ``guess``."""
    if interface.at_rest is not None:
        return replace(interface.at_rest, g_q=interface.at_rest.gaps(u_d))
    if interface.master is None or guess is None:
        return _known(interface, u_d)
    master, u_Ai = interface.master, u_d.reshape(-1, 2)
    y_AI = interface.local_AI + u_Ai
    x_qi = interface.at_slave(y_AI)
    pairing = closest_points(master, x_qi, y_AI, guess)
    there = master_points(master, pairing, x_qi, y_AI)
    conn_qa, D_qa, n_qi = _between(interface, there)
    g_q = np.sum((_slid(interface, there.c_q, there.M_qb) + _jump(D_qa, u_Ai.take(conn_qa, axis=0))) * n_qi, -1)
    moving_qa = np.concatenate([np.zeros_like(interface.N_qa), there.dM_qb], axis=1)
    V_qrd = np.stack([_along(D_qa, n_qi), _along(D_qa, there.t_qi), _along(moving_qa, n_qi)], axis=1)
    m_q, kappa_q = np.sum(there.t_qi**2, -1), np.sum(n_qi * there.t_xi_qi, -1)
    return Contact(pairing, g_q, n_qi, there.share_q, dofs(conn_qa), V_qrd, m_q, kappa_q, there.fading_q)


def settled(interface: Interface) -> Interface:
    """The same with closest points and normals for good as they are before anything moves."""
    return replace(interface, at_rest=resting(interface))


def resting(interface: Interface) -> Contact:
    """The contact before anything moves."""
    if interface.master is None:
        return _known(interface, np.zeros(interface.P_AI.size))
    there = interface.reference
    conn_qa, D_qa, n_qi = _between(interface, there)
    g_q, G_qd = np.sum(interface.home.apart_qi * n_qi, -1), _along(D_qa, n_qi)
    return Contact(interface.pairing, g_q, n_qi, there.share_q, dofs(conn_qa), G_qd[:, None])


def traction(
    interface: Interface, contact: Contact, k_q: np.ndarray, closed_q: np.ndarray, g_q: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Traction, tangent and new history at all points; a point that has left the master is free.

    Traction and tangent are those of the share of each point that faces the master, over its whole area. ``g_q`` are
    gaps to be tried in place of those of the contact.
    """
    p, dp, k_new = interface.law.traction(contact.g_q if g_q is None else g_q, k_q, closed_q)
    if interface.bonded_q is None and contact.whole:
        return p, dp, k_new
    holds_q, carries_q = holding(interface, contact), contact.share_q
    if interface.bonded_q is not None:
        carries_q = np.where(holds_q | (closed_q & interface.law.contact), carries_q, 0.0)
    return carries_q * p, carries_q * dp, np.where(holds_q, k_new, k_q)


def holding(interface: Interface, contact: Contact) -> np.ndarray:
    """Points (n_q,) that cohesion can hold: bonded ones that face the master. They alone have kinks and damage."""
    return contact.on_q if interface.bonded_q is None else contact.on_q & interface.bonded_q


def forces(interface: Interface, contact: Contact, p_q: np.ndarray, n_dof: int) -> np.ndarray:
    """Residual ``R = int p dg/du dGamma`` (n_dof,)."""
    if contact.full_qd is not None:
        return (p_q * interface.dA_q) @ contact.full_qd
    R_qd = contact.V_qrd[:, 0] * (p_q * interface.dA_q)[:, None]
    return np.bincount(contact.dof_qd.ravel(), weights=R_qd.ravel(), minlength=n_dof)


def stiffness(interface: Interface, contact: Contact, p_q: np.ndarray, dp_q: np.ndarray) -> np.ndarray:
    """Complete tangent of each point (n_q, 2 n_a, 2 n_a), ``K = int p' G'G dGamma + int p D(dg) dGamma``.

    With y' = t, m = t.t, kappa = n.y'', a = m - g kappa, T = t.(dx - dy), Nb = n.dy', the second variation of the gap
    is ``D(dg) = -1/a [T Nb + Nb T + g Nb Nb + (kappa / m) T T]`` (Wriggers 2006, sec. 9.1, in the present notation).

    Symmetric but for points that slide off the master: their share changes with the place on its continuation,
    ``d eta = (T + g Nb) / m``, and the force along the normal with it. There is no force along the surface that would
    make it symmetric: what slides off loses its bond and is not drawn.
    """
    V = contact.V_qrd
    c_qrs = np.zeros((len(V), V.shape[1], V.shape[1]))
    c_qrs[:, 0, 0] = dp_q * interface.dA_q
    if contact.m_q is not None:
        a = contact.m_q - contact.g_q * contact.kappa_q
        f = -p_q * interface.dA_q / np.where(np.abs(a) > 1e-12 * contact.m_q, a, contact.m_q)
        c_qrs[:, 1, 1] = f * contact.kappa_q / contact.m_q
        c_qrs[:, 1, 2] = c_qrs[:, 2, 1] = f
        c_qrs[:, 2, 2] = f * contact.g_q
        slides = p_q * interface.dA_q * contact.fading_q / contact.m_q
        c_qrs[:, 0, 1] += slides
        c_qrs[:, 0, 2] += slides * contact.g_q
    return V.swapaxes(1, 2) @ (c_qrs @ V)


def rounding(interface: Interface, u_d: np.ndarray, stiffness_q: np.ndarray | None = None) -> float:
    """Norm of what rounding of the displacements does to the interface forces.

    ``stiffness_q`` (n_q,) is the slope of each point's traction, or the largest that the law has.
    """
    if stiffness_q is None:
        stiffness_q = np.full(interface.points, max(interface.law.penalty, interface.law.stiffness))
    touched_qd = dofs(interface.conn_qa) if interface.at_rest is None else interface.at_rest.dof_qd
    u_q = np.abs(u_d[touched_qd]).max(1)
    return float(np.finfo(float).eps * np.linalg.norm(stiffness_q * interface.dA_q * u_q))


def dofs(conn_qa: np.ndarray) -> np.ndarray:
    """Degrees of freedom (..., 2 n_a) of control points (..., n_a), numbered 2A + i."""
    return np.stack([2 * conn_qa, 2 * conn_qa + 1], axis=-1).reshape(*conn_qa.shape[:-1], -1)


def _known(interface: Interface, u_d: np.ndarray) -> Contact:
    N_qa, conn_qa = interface.N_qa, interface.known_conn_qa
    D_qa = 2.0 * N_qa if interface.twin_qa is None else np.concatenate([N_qa, -N_qa], axis=1)
    assert interface.mirror_i is not None
    n_qi = np.broadcast_to(interface.mirror_i, interface.X_qi.shape)
    g_q = np.sum((D_qa[:, None] @ u_d.reshape(-1, 2)[conn_qa])[:, 0] * n_qi, -1)
    return Contact(None, g_q, n_qi, np.ones(interface.points), dofs(conn_qa), _along(D_qa, n_qi)[:, None])


def _between(interface: Interface, there: MasterPoints) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Control points of both sides, their functions, slave minus master (n_q, n_a + n_b), and the master's normals."""
    conn_qa = np.concatenate([interface.conn_qa, interface.surface.conn_ca.take(there.c_q, axis=0)], axis=1)
    D_qa = np.concatenate([interface.N_qa, -there.M_qb], axis=1)
    return conn_qa, D_qa, normal(there.t_qi, interface.surface.outward)


def _jump(D_qa: np.ndarray, u_qai: np.ndarray) -> np.ndarray:
    """Jump of the displacements (n_q, 2), rounded as the differences between neighbours and not as the displacements.

    A penalty multiplies every bit that is lost. The functions of a row, slave minus master, sum to zero.
    """
    return (D_qa[:, None] @ (u_qai - u_qai[:, -1:]))[:, 0]


def _slid(interface: Interface, c_q: np.ndarray, M_qb: np.ndarray) -> np.ndarray:
    """Slave minus master (n_q, 2) in the reference configuration, as far as the projection has moved from its home.

    That it is nothing at home is no matter of rounding: bodies that touch before anything moves have no gap.
    """
    home, X_qbi = interface.home, interface.local_AI.take(interface.surface.conn_ca.take(c_q, axis=0), axis=0)
    origin_qi, same = X_qbi[:, -1], c_q == home.c_q
    moved_qi = (np.where(same[:, None], home.N_qb - M_qb, -M_qb)[:, None] @ (X_qbi - origin_qi[:, None]))[:, 0]
    return moved_qi + np.where(same[:, None], 0.0, home.Y_qi - origin_qi) + home.apart_qi


def _along(N_qa: np.ndarray, v_qi: np.ndarray) -> np.ndarray:
    """Rows (n_q, 2 n_a) ``N_qa v_qi`` over the degrees of freedom."""
    rows_qai = np.empty((*N_qa.shape, 2))
    for i in range(2):  # a product over pairs would take four times as long
        np.multiply(N_qa, v_qi[:, i : i + 1], out=rows_qai[..., i])
    return rows_qai.reshape(len(N_qa), -1)
