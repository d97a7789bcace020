"""Gauss-point-to-surface cohesion and contact in one formulation.

Every quadrature point of the slave is projected on the current master on its own; the gap along the master's normal drives one
traction law for opening and closing (Dimitri, De Lorenzis, Zavarise 2013; De Lorenzis, Temizer, Wriggers, Zavarise 2011).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from iga.cohesive import BilinearLaw
from iga.projection import Pairing, closest_points, nearest_samples
from iga.surface import Surface, normal


@dataclass(frozen=True)
class Interface:
    """Slave points, master surface and the law between them.

    ``S_qA`` (n_q, n_A), sparse: slave functions at the points; ``dA_q`` (n_q,) reference area (length x width) of each point;
    ``X_qi`` (n_q, 2) reference positions. ``master`` is None where the partner is the mirror image of the slave in the line
    through the origin with normal ``mirror_i``: then the gap is twice the distance to it.
    ``frozen`` keeps the pairing and normals of the reference configuration (linear kinematics): no search is done.
    """

    S_qA: csr_array
    dA_q: np.ndarray
    X_qi: np.ndarray
    P_AI: np.ndarray
    law: BilinearLaw
    master: Surface | None
    mirror_i: np.ndarray | None = None
    frozen: bool = False

    @property
    def points(self) -> int:
        return len(self.dA_q)


@dataclass(frozen=True)
class Contact:
    """Gaps and their first variation in one configuration.

    ``g_q`` (n_q,), ``n_qi`` (n_q, 2) master normals, ``G_qd`` (n_q, 2 n_A) sparse, ``dg = G du``; ``T_qd``, ``Nb_qd`` and the
    three coefficients (n_q,) make the second variation (see `second_variation`), None where it vanishes.
    """

    pairing: Pairing | None
    g_q: np.ndarray
    n_qi: np.ndarray
    G_qd: csr_array
    on_q: np.ndarray
    curved: tuple | None = None


def pair(interface: Interface) -> Pairing | None:
    """Pairing in the reference configuration."""
    if interface.master is None:
        return None
    start = nearest_samples(interface.master, interface.X_qi, interface.P_AI)
    return closest_points(interface.master, interface.X_qi, interface.P_AI, start)


def contact(interface: Interface, u_d: np.ndarray, guess: Pairing | None) -> Contact:
    """Gaps in the configuration u_d (2 n_A,), searching from the pairing ``guess``."""
    if interface.master is None:
        n_qi = np.broadcast_to(interface.mirror_i, interface.X_qi.shape)
        G_qd = along(interface.S_qA, 2.0 * n_qi)
        g_q = 2.0 * interface.X_qi @ interface.mirror_i + G_qd @ u_d
        return Contact(None, g_q, n_qi, G_qd, np.ones(interface.points, dtype=bool))
    x_AI = interface.P_AI if interface.frozen else interface.P_AI + u_d.reshape(-1, 2)
    x_qi = interface.S_qA @ x_AI
    pairing = guess if interface.frozen else closest_points(interface.master, x_qi, x_AI, guess)
    r0, r1, r2 = interface.master.coefficients(pairing.c_q, pairing.xi_q, 2)
    Q_qbi = interface.master.bezier_points(x_AI)[pairing.c_q]
    y_qi, t_qi, t_xi_qi = (np.einsum("qb,qbi->qi", r, Q_qbi) for r in (r0, r1, r2))
    n_qi = normal(t_qi, interface.master.outward)
    D_qA = interface.S_qA - interface.master.rows(pairing.c_q, r0)
    G_qd = along(D_qA, n_qi)
    g_q = np.sum((x_qi - y_qi) * n_qi, -1)
    if interface.frozen:
        return Contact(pairing, g_q + G_qd @ u_d, n_qi, G_qd, pairing.on_q)
    m, kappa = np.sum(t_qi * t_qi, -1), np.sum(n_qi * t_xi_qi, -1)
    curved = (along(D_qA, t_qi), along(interface.master.rows(pairing.c_q, r1), n_qi), m, kappa)
    return Contact(pairing, g_q, n_qi, G_qd, pairing.on_q, curved)


def traction(
    interface: Interface, contact: Contact, k_q: np.ndarray, closed_q: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Traction, tangent and new history at all points; a point beyond the ends of the master is free."""
    p, dp, k_new = interface.law.traction(contact.g_q, k_q, closed_q)
    return np.where(contact.on_q, p, 0.0), np.where(contact.on_q, dp, 0.0), np.where(contact.on_q, k_new, k_q)


def forces(interface: Interface, contact: Contact, p_q: np.ndarray) -> np.ndarray:
    """Residual ``R = int p dg/du dGamma`` (2 n_A,)."""
    return contact.G_qd.T @ (p_q * interface.dA_q)


def stiffness(interface: Interface, contact: Contact, p_q: np.ndarray, dp_q: np.ndarray) -> csr_array:
    """Complete tangent ``K = int p' G'G dGamma + int p D(dg) dGamma`` (2 n_A, 2 n_A), symmetric.

    With y' = t, m = t.t, kappa = n.y'', a = m - g kappa, T = t.(dx - dy), Nb = n.dy', the second variation of the gap is
    ``D(dg) = -1/a [T Nb + Nb T + g Nb Nb + (kappa / m) T T]`` (Wriggers 2006, sec. 9.1, in the present notation).
    """
    G, w = contact.G_qd, interface.dA_q
    K = G.T @ scaled(G, dp_q * w)
    if contact.curved is None:
        return K
    T, Nb, m, kappa = contact.curved
    a = m - contact.g_q * kappa
    f = -p_q * w / np.where(np.abs(a) > 1e-12 * m, a, m)
    return K + T.T @ (scaled(T, f * kappa / m) + scaled(Nb, f)) + Nb.T @ (scaled(T, f) + scaled(Nb, f * contact.g_q))


def along(N_qA: csr_array, v_qi: np.ndarray) -> csr_array:
    """Rows over the degrees of freedom 2A + i: ``N_qA v_qi``."""
    q = np.repeat(np.arange(N_qA.shape[0]), np.diff(N_qA.indptr))
    data = N_qA.data[:, None] * v_qi[q]
    columns = 2 * N_qA.indices[:, None] + np.arange(2)
    return csr_array((data.ravel(), columns.ravel(), 2 * N_qA.indptr), shape=(N_qA.shape[0], 2 * N_qA.shape[1]))


def scaled(V_qd: csr_array, s_q: np.ndarray) -> csr_array:
    """Rows of V times s."""
    return csr_array((V_qd.data * np.repeat(s_q, np.diff(V_qd.indptr)), V_qd.indices, V_qd.indptr), shape=V_qd.shape)
