"""How far every point has slid along the master, with the first and second variation.

That is the length along the present master from the origin of a point, where it met the master before anything moved,
to where it meets the master now: an objective scalar of the present positions, as the gap is.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from iga.interface.closest_point import Pairing
from iga.interface.contact import NB, NC, ROWS, TB, G, SlidingContact, T, along, dofs
from iga.interface.master_point import MasterPoints
from iga.interface.surface import Surface
from iga.mesh.quadrature import gauss

#: Gauss points for the length of a way on each side of the master.
ON_A_PART = 6


@dataclass(frozen=True)
class Way:
    """Quadrature nodes on the ways from the origins to the closest points, node `ON_A_PART` the closest point itself.

    ``c_qk`` sides, ``xi_qk`` parameters, ``w_qk`` (n_q, n_k) weights, negative on a way to smaller parameters.
    """

    c_qk: np.ndarray
    xi_qk: np.ndarray
    w_qk: np.ndarray


@dataclass(frozen=True)
class Slid:
    """Lengths s_q (n_q,) along the present master, and their first variation ``G_qd`` over the unknowns ``dof_qd``.

    ``V_qrd`` (n_q, 5, n_d) are the rows T = t.(dx - dy), G = n.(dx - dy), Nb = n.dy', Tb = t.dy' and Nc = n.dy'' at the
    closest points, ``place_qr`` (n_q, 5) the factors of these rows in the rate dxi of the parameter; ``across_qkb``
    (n_q, n_k, n_b) the rates n.dy' at the nodes of the way, of weights ``bent_qk``, over the unknowns of the side that
    a node lies on; ``jet_kq`` (5, n_q) are t.t, |t|, t.y'', n.y'' and n.y''' at the closest points, with t = y'.
    """

    s_q: np.ndarray
    G_qd: np.ndarray
    dof_qd: np.ndarray
    forward_q: np.ndarray
    V_qrd: np.ndarray
    place_qr: np.ndarray
    across_qkb: np.ndarray
    bent_qk: np.ndarray
    jet_kq: np.ndarray

    @property
    def side(self) -> int:
        """Number of unknowns of a side of the master."""
        return self.across_qkb.shape[2]

    def within(self, columns: int) -> Slid:
        """The same without the sides whose unknowns are beyond the first ``columns``, but for `dof_qd`."""
        n_k = self.bent_qk.shape[1] - (self.dof_qd.shape[1] - columns) // self.side * ON_A_PART
        return replace(self, across_qkb=self.across_qkb[:, :n_k], bent_qk=self.bent_qk[:, :n_k])

    def add_bent(self, K_qdd: np.ndarray, f_q: np.ndarray) -> None:
        """Add ``f int (n.dy') (n.dy') / |y'| dxi``, what the ways bend, to the stiffness of points with the tractions
        f_q along the master."""
        bent_qk, n_k = f_q[:, None] * self.bent_qk, self.bent_qk.shape[1]
        own = K_qdd.shape[1] - self.side * (_sides(n_k) - 1)
        for nodes, columns in _parts(n_k, own, self.side):
            W_qkb = self.across_qkb[:, nodes]
            K_qdd[:, columns, columns] += W_qkb.swapaxes(1, 2) @ (bent_qk[:, nodes, None] * W_qkb)

    def of_place(self, g_q: np.ndarray) -> np.ndarray:
        """Second variation (n_q, 5, 5) of the parameter xi of the closest point, at which ``F = (x - y).y' = 0``:

        a dxi = T + g Nb,      a = m - g n.y'',      m = t.t
        a D(dxi) = F_uu + 2 sym(F_u,xi dxi) + F_xi,xi dxi dxi
        F_uu = 2 sym(G Nb + T Tb / m),      F_u,xi = -2 Tb + G n.y'' + T t.y'' / m + g Nc
        F_xi,xi = -3 t.y'' + g n.y'''
        """
        m, _, ty, ny, nyy = self.jet_kq
        c_qrs, F_qr = np.zeros((len(m), ROWS, ROWS)), np.zeros_like(self.place_qr)
        c_qrs[:, G, NB] = c_qrs[:, NB, G] = 1.0
        c_qrs[:, T, TB] = c_qrs[:, TB, T] = 1.0 / m
        F_qr[:, TB], F_qr[:, G], F_qr[:, T], F_qr[:, NC] = -2.0, ny, ty / m, g_q
        c_qrs += both(F_qr, self.place_qr) + (g_q * nyy - 3.0 * ty)[:, None, None] * outer(self.place_qr, self.place_qr)
        return c_qrs * self.place_qr[:, T, None, None]

    def of_length(self, of_place_qrs: np.ndarray) -> np.ndarray:
        """Second variation (n_q, 5, 5) of the length without what the way bends:

        ``D(ds) = |t| D(dxi) + (t.y'' / |t|) dxi dxi + 2 sym(Tb dxi) / |t| + int (n.dy') (n.dy') / |y'| dxi``
        """
        _, size, ty, _, _ = self.jet_kq[..., None, None]
        c_qrs = size * of_place_qrs + ty / size * outer(self.place_qr, self.place_qr)
        c_qrs[:, TB] += self.place_qr / size[..., 0]
        c_qrs[:, :, TB] += self.place_qr / size[..., 0]
        return self.forward_q[:, None, None] * c_qrs


def outer(a_qr: np.ndarray, b_qr: np.ndarray) -> np.ndarray:
    """``a b'`` at every point (n_q, n_r, n_r)."""
    return a_qr[:, :, None] * b_qr[:, None]


def both(a_qr: np.ndarray, b_qr: np.ndarray) -> np.ndarray:
    """``a b' + b a'`` at every point (n_q, n_r, n_r)."""
    c_qrs = outer(a_qr, b_qr)
    return c_qrs + c_qrs.swapaxes(1, 2)


def slid(
    master: Surface,
    origin: Pairing,
    forward_q: np.ndarray,
    contact: SlidingContact,
    there: MasterPoints,
    apart_qi: np.ndarray,
    y_AI: np.ndarray,
) -> Slid:
    """How far points have slid that are ``apart_qi`` (n_q, 2) from ``there``, in a contact at control points y_AI
    (n_A, 2).

    ``origin`` is their pairing before anything moved; ``forward_q`` is 1 where a positive slip leads to larger
    parameters, else -1. The unknowns are those of the contact, followed by those of the sides between the closest
    points and the origins.
    """
    pairing, g_q, n_qi = contact.pairing, contact.g_q, contact.n_qi
    assert pairing is not None
    _, t_qi, _, ttt_qi = _jet(master, y_AI, pairing.c_q, pairing.xi_q)
    tt_qi, ttt_qi = there.t_xi_qi, np.where(there.straight_q[:, None], 0.0, ttt_qi)
    m_q = np.sum(t_qi**2, -1)
    curves = (np.sum(a * b, -1) for a, b in ((t_qi, tt_qi), (n_qi, tt_qi), (n_qi, ttt_qi)))
    jet_kq = np.stack([m_q, m_q**0.5, *curves])
    # Exactly zero where nothing has moved.
    beyond_q = there.eta_q + np.sum(apart_qi * t_qi, -1) / (m_q - g_q * jet_kq[3])
    way = _way(master, origin, pairing, beyond_q)
    row = Unknowns.of(master, way, contact.dof_qd)
    r2 = master.coefficients(pairing.c_q, pairing.xi_q, 2)[2]
    d2M_qb = np.where(there.straight_q[:, None], 0.0, master.functions(pairing.c_q, r2))
    turns = [row.met(N_qb, v_qi) for N_qb, v_qi in ((there.dM_qb, n_qi), (there.dM_qb, t_qi), (d2M_qb, n_qi))]
    V_qrd = np.stack([*(row.first(contact.V_qrd[:, r]) for r in (T, G)), *turns], axis=1)
    s_q, stretch_qd, across_qkb, size_qk = _along_way(master, way, row, y_AI)
    place_qr = np.pad(contact.place_qr, ((0, 0), (0, ROWS - 3)))
    ahead_qd = ((jet_kq[1][:, None] * place_qr)[:, None] @ V_qrd)[:, 0]
    G_qd, bent_qk = forward_q[:, None] * (stretch_qd + ahead_qd), way.w_qk / size_qk
    return Slid(forward_q * s_q, G_qd, row.dof_qd, forward_q, V_qrd, place_qr, across_qkb, bent_qk, jet_kq)


@dataclass(frozen=True)
class Unknowns:
    """Unknowns dof_qd (n_q, n_d) of slips: first the ``own`` unknowns of the contact, the last ``side`` of which are
    those of the side with the closest point, then ``side`` unknowns for each further side of the way."""

    dof_qd: np.ndarray
    own: int
    side: int

    @staticmethod
    def of(master: Surface, way: Way, dof_qd: np.ndarray) -> Unknowns:
        conn_qsb = master.conn_ca[way.c_qk[:, ON_A_PART + 1 :: ON_A_PART]]
        further_qd = dofs(conn_qsb).reshape(len(dof_qd), 2 * conn_qsb.shape[1] * conn_qsb.shape[2])
        return Unknowns(np.concatenate([dof_qd, further_qd], axis=1), dof_qd.shape[1], 2 * master.conn_ca.shape[1])

    def first(self, row_qd: np.ndarray) -> np.ndarray:
        """A row over the unknowns of the contact, padded with zeros to all unknowns."""
        return np.pad(row_qd, ((0, 0), (0, self.dof_qd.shape[1] - row_qd.shape[1])))

    def met(self, N_qb: np.ndarray, v_qi: np.ndarray) -> np.ndarray:
        """Rows ``v . N`` of functions N_qb on the side with the closest point."""
        row_qd = np.zeros(self.dof_qd.shape)
        row_qd[:, self.own - self.side : self.own] = along(N_qb, v_qi)
        return row_qd


def _way(master: Surface, origin: Pairing, pairing: Pairing, beyond_q: np.ndarray) -> Way:
    """The ways from the origins to the closest points, which are ``beyond_q`` (n_q,) beyond those of the pairing.

    The first part is on the side with the closest point; node `ON_A_PART` is that point, with ``beyond_q`` as weight.
    """
    over_q = pairing.c_q - origin.c_q
    if master.closed:
        over_q = (over_q + master.sides // 2) % master.sides - master.sides // 2
    sign_q, x, w = np.sign(over_q), *gauss(ON_A_PART)
    c, xi, weight = [], [], []
    for part in range(int(np.abs(over_q).max(initial=0)) + 1):
        left_q = np.abs(over_q) - part  # sides to the origin
        start_q = np.where(left_q > 0, np.where(sign_q > 0, 0.0, 1.0), origin.xi_q)
        end_q = pairing.xi_q if part == 0 else np.where(sign_q > 0, 1.0, 0.0)
        length_q = np.where(left_q >= 0, end_q - start_q, 0.0)
        c_q = master.following(pairing.c_q, -sign_q * np.minimum(part, np.abs(over_q)))
        xi.append(np.where(left_q >= 0, start_q, 0.0)[:, None] + length_q[:, None] * x)
        weight.append(length_q[:, None] * w)
        c.append(np.repeat(c_q[:, None], ON_A_PART, axis=1))
        if part == 0:
            c[0], xi[0] = np.append(c[0], c_q[:, None], axis=1), np.append(xi[0], pairing.xi_q[:, None], axis=1)
            weight[0] = np.append(weight[0], beyond_q[:, None], axis=1)
    return Way(*(np.concatenate(parts, axis=1) for parts in (c, xi, weight)))


def _along_way(
    master: Surface, way: Way, row: Unknowns, y_AI: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Lengths s_q (n_q,), their variation (n_q, n_d) at fixed ends, rows n.dy' (n_q, n_k, n_b) over the side of each
    node, and lengths |y'| (n_q, n_k)."""
    (n_q, n_k), c = way.c_qk.shape, way.c_qk.ravel()
    r1 = master.coefficients(c, way.xi_qk.ravel(), 1)[1]
    t_mi, dM_mb = np.sum(r1[..., None] * master.bezier_points(y_AI, c), axis=1), master.functions(c, r1)
    size_m = np.sqrt(np.sum(t_mi**2, -1))
    unit_mi = t_mi / size_m[:, None]
    across_mi = np.stack([-unit_mi[:, 1], unit_mi[:, 0]], -1)
    ahead_qkb, across_qkb = (along(dM_mb, v_mi).reshape(n_q, n_k, row.side) for v_mi in (unit_mi, across_mi))
    stretch_qd = np.zeros(row.dof_qd.shape)
    for nodes, columns in _parts(n_k, row.own, row.side):
        stretch_qd[:, columns] = (way.w_qk[:, None, nodes] @ ahead_qkb[:, nodes])[:, 0]
    size_qk = size_m.reshape(n_q, n_k)
    return np.sum(way.w_qk * size_qk, axis=1), stretch_qd, across_qkb, size_qk


def _sides(n_k: int) -> int:
    """Number of sides of the master on a way of n_k nodes."""
    return (n_k - 1) // ON_A_PART


def _parts(n_k: int, own: int, side: int) -> Iterator[tuple[slice, slice]]:
    """Nodes of each part of a way of n_k nodes, and the columns of the unknowns of the side that it lies on.

    The first part has one node more; its side has the last ``side`` of the ``own`` unknowns of the contact.
    """
    for part in range(_sides(n_k)):
        first, start = ON_A_PART * part + min(part, 1), own + side * (part - 1)
        yield slice(first, ON_A_PART * (part + 1) + 1), slice(start, start + side)


def tangents(master: Surface, x_AI: np.ndarray, c_q: np.ndarray, xi_q: np.ndarray) -> np.ndarray:
    """Derivatives (n_q, 2) of the position on the master by its parameter, at control points x_AI (n_A, 2)."""
    return _jet(master, x_AI, c_q, xi_q)[1]


def _jet(master: Surface, y_AI: np.ndarray, c_q: np.ndarray, xi_q: np.ndarray) -> list[np.ndarray]:
    """Positions and their derivatives (n_q, 2) up to the third at xi_q on the sides c_q."""
    Q_qbi = master.bezier_points(y_AI, c_q)
    return [np.sum(r[..., None] * Q_qbi, axis=1) for r in master.coefficients(c_q, xi_q, 3)]
