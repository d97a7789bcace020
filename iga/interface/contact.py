"""The interface in one configuration: the gap at every point, with its first and second variation."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from iga.interface.closest_point import Pairing

#: Rounding of a place on a side of the master, relative to the side; it comes from parameter, length and way.
PLACE_ROUNDED = 4.0 * float(np.finfo(float).eps)
#: Rows of `SlidingContact.V_qrd`, the first three, and of `iga.interface.slip.Slid.V_qrd`, and their number.
T, G, NB, TB, NC, ROWS = range(6)
#: Derivatives below this part of the largest are rounding.
STILL_ROW = 1e-12


def dofs(conn_qa: np.ndarray, d: int = 2) -> np.ndarray:
    """Degrees of freedom (..., d n_a) of control points (..., n_a), numbered d A + i."""
    each_qai = np.stack([d * conn_qa + i for i in range(d)], axis=-1)
    return each_qai.reshape(*conn_qa.shape[:-1], d * conn_qa.shape[-1])


def along(N_qa: np.ndarray, v_qi: np.ndarray) -> np.ndarray:
    """Rows (n_q, d n_a) ``N_qa v_qi`` over the degrees of freedom."""
    rows_qai = np.empty((*N_qa.shape, v_qi.shape[1]))
    for i in range(v_qi.shape[1]):  # a product over pairs would take four times as long
        np.multiply(N_qa, v_qi[:, i : i + 1], out=rows_qai[..., i])
    return rows_qai.reshape(len(N_qa), -1)


@dataclass(frozen=True)
class Rows:
    """First variation of a scalar at every point: ``G_qd`` (n_q, n_d), derivatives by the unknowns ``dof_qd``.

    The scalar is the gap, the slip, or another quantity on which a law depends.
    """

    dof_qd: np.ndarray
    G_qd: np.ndarray

    @property
    def moving(self) -> Rows:
        """The same without the unknowns of all points that move none, up to rounding."""
        size_d = np.abs(self.G_qd).max(0)
        moves_d = size_d > STILL_ROW * size_d.max()
        return Rows(self.dof_qd[:, moves_d], self.G_qd[:, moves_d])

    def rates(self, v_d: np.ndarray, q: np.ndarray | slice = slice(None)) -> np.ndarray:
        """Rates (n_q, ...) at all or some points when the displacements change by v_d (n_dof, ...)."""
        G_qd, v_qd = self.G_qd[q], v_d.take(self.dof_qd[q], axis=0)
        return np.sum(G_qd * v_qd, axis=1) if v_d.ndim == 1 else (G_qd[:, None] @ v_qd)[:, 0]

    def gradients(self, q_m: np.ndarray, n_dof: int) -> np.ndarray:
        """Gradients (n_dof, n_m) at some points."""
        rows_dm = np.zeros((n_dof, q_m.size), order="F")
        np.add.at(rows_dm, (self.dof_qd[q_m], np.arange(q_m.size)[:, None]), self.G_qd[q_m])
        return rows_dm

    def forces(self, f_q: np.ndarray, n_dof: int) -> np.ndarray:
        """Forces (n_dof,) on the unknowns from forces f_q (n_q,) that are conjugate to the scalar."""
        R_qd = self.G_qd * f_q[:, None]
        return np.bincount(self.dof_qd.ravel(), weights=R_qd.ravel(), minlength=n_dof)

    def rounding(self, u_d: np.ndarray, slope_q: np.ndarray) -> float:
        """Norm of the change of such forces, of slopes slope_q (n_q,), when displacements u_d change by rounding."""
        u_q = np.abs(u_d[self.dof_qd]).max(1)
        return float(np.finfo(float).eps * np.linalg.norm(slope_q * u_q))


@dataclass(frozen=True)
class Slip:
    """Slips s_q (n_q,) with their first variation ``rows``; ``side_q`` (n_q,) is the length of a side of the master
    where the place on it is searched for."""

    s_q: np.ndarray
    rows: Rows
    side_q: np.ndarray | float = 0.0

    def rounding(self, u_d: np.ndarray, slope_q: np.ndarray) -> float:
        """Norm of the change of forces of slopes slope_q (n_q,) when displacements u_d and places change by
        rounding."""
        of_place = PLACE_ROUNDED * float(np.linalg.norm(slope_q * self.side_q))
        return float(np.hypot(self.rows.rounding(u_d, slope_q), of_place))


@dataclass(frozen=True)
class Contact:
    """Gaps and their variation in one configuration, along normals that do not turn.

    ``g_q`` (n_q,) gaps with their first variation ``gap_rows``, ``n_qi`` (n_q, 2) master normals, ``share_q`` (n_q,)
    part of each point's area that faces the master, ``pairing`` the closest points on the master where these are
    searched for, ``slip`` the slip along the master where the law depends on it.
    """

    pairing: Pairing | None
    g_q: np.ndarray
    n_qi: np.ndarray
    share_q: np.ndarray
    gap_rows: Rows
    slip: Slip | None = field(default=None, kw_only=True)

    @property
    def dof_qd(self) -> np.ndarray:
        """Unknowns (n_q, n_d) of slave and master side on which each point depends."""
        return self.gap_rows.dof_qd if self.slip is None else self.slip.rows.dof_qd

    def moved(self, u_d: np.ndarray) -> Contact:
        """The contact of the same pairs at displacements u_d (n_dof,), from that of none."""
        slip = None if self.slip is None else replace(self.slip, s_q=self.slip.rows.rates(u_d))
        return replace(self, g_q=self.g_q + self.rates(u_d), slip=slip)

    def slip_rate(self, ways_kq: list[np.ndarray]) -> np.ndarray:
        """Rate (n_q,) of the slip from those (n_q,) along each of its directions."""
        return ways_kq[0]

    def needed(self, carries_q: np.ndarray, shears_q: np.ndarray) -> np.ndarray:
        """`dof_qd` without those on which no point depends that ``carries_q`` a traction or ``shears_q`` (n_q,)."""
        return self.dof_qd

    def within(self, columns: int) -> Contact:
        """The same on the first of its unknowns alone, where no point needs the others."""
        return self

    def quadratic(self, _f_qc: np.ndarray, slope_qcc: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Rows J_qcd (n_q, n_r, n_d) and matrices C_qcc (n_q, n_r, n_r) of the part ``J' C J`` of the tangent, for
        forces f_qc (n_q, n_c) and their slopes by the jumps (n_q, n_c, n_c)."""
        return np.stack([rows.G_qd for rows in self.jump_rows], axis=1), slope_qcc

    def curvature(self, _f_qc: np.ndarray) -> np.ndarray | None:
        """What else the second variation of the jumps adds to it (n_q, n_d, n_d), None where that is nothing."""
        return None

    @cached_property
    def on_q(self) -> np.ndarray:
        """Points (n_q,) that face the master; the others are free."""
        return self.share_q > 0.0

    @cached_property
    def whole(self) -> bool:
        """Whether the whole area of every point faces the master."""
        return bool((self.share_q == 1.0).all())

    def rates(self, v_d: np.ndarray, q: np.ndarray | slice = slice(None)) -> np.ndarray:
        """Rates (n_q, ...) of all or some gaps when the displacements change by v_d (n_dof, ...)."""
        return self.gap_rows.rates(v_d, q)

    def rows(self, q_m: np.ndarray, n_dof: int) -> np.ndarray:
        """Gradients (n_dof, n_m) of the gaps at some points."""
        return self.gap_rows.gradients(q_m, n_dof)

    @property
    def jump_qc(self) -> np.ndarray:
        """Jumps (n_q, n_c) on which the tractions depend: the gap, and the slip where the law depends on it."""
        return self.g_q[:, None] if self.slip is None else np.stack([self.g_q, self.slip.s_q], axis=1)

    @property
    def jump_rows(self) -> tuple[Rows, ...]:
        """First variation of each jump."""
        return (self.gap_rows,) if self.slip is None else (self.gap_rows, self.slip.rows)

    def rounding(self, u_d: np.ndarray, slope_qcc: np.ndarray) -> float:
        """Norm of the change of the forces of slopes (n_q, n_c, n_c) when displacements and places change by
        rounding."""
        of_gap = self.gap_rows.rounding(u_d, np.abs(slope_qcc[:, 0, 0]))
        return of_gap if self.slip is None else float(np.hypot(of_gap, self.slip.rounding(u_d, slope_qcc[:, 1, 1])))

    def share_rates(self, _v_d: np.ndarray, q: np.ndarray) -> np.ndarray:
        """Rates (n_m,) of the share of some points when the displacements change by v_d (n_dof,)."""
        return np.zeros(q.size)

    def unsymmetric(self, _f_qc: np.ndarray) -> np.ndarray:
        """Points (n_m,) whose curvature is unsymmetric."""
        return np.arange(0)


@dataclass(frozen=True)
class SlidingContact(Contact):
    """Contact at closest points, which move along the master, and normals that turn with it.

    ``V_qrd`` (n_q, 3, n_d) are the rows T, G and Nb of `curvature`. With the factors ``m_q``, ``kappa_q`` and
    ``fading_q`` (see `iga.interface.master_point.MasterPoints`) they give the variations of every function of the
    closest point.
    """

    V_qrd: np.ndarray
    m_q: np.ndarray
    kappa_q: np.ndarray
    fading_q: np.ndarray

    @cached_property
    def place_qr(self) -> np.ndarray:
        """Factors (n_q, 3) of the rows in the rate ``dxi = (T + g Nb) / a`` of the closest point's parameter."""
        a_q = self.m_q - self.g_q * self.kappa_q
        a_q = np.where(np.abs(a_q) > 1e-12 * self.m_q, a_q, self.m_q)
        return np.stack([1.0 / a_q, np.zeros_like(a_q), self.g_q / a_q], axis=1)

    def of_gap(self, f_q: np.ndarray) -> np.ndarray:
        """``f D(dg)`` (n_q, 3, 3) over the rows, of points that do not slide off."""
        c_qrs, f_q = np.zeros((len(f_q), 3, 3)), -f_q * self.place_qr[:, T]
        c_qrs[:, T, T], c_qrs[:, NB, NB] = f_q * self.kappa_q / self.m_q, f_q * self.g_q
        c_qrs[:, T, NB] = c_qrs[:, NB, T] = f_q
        return c_qrs

    def fade(
        self, K_qdd: np.ndarray, forces: Iterable[tuple[np.ndarray, Rows]], V_qrd: np.ndarray, place_qr: np.ndarray
    ) -> None:
        """Add to the stiffness of points that slide off what forces f_q along rows lose with their share; ``place_qr``
        are the factors of the rows V_qrd in dxi."""
        q = np.flatnonzero(self.fading_q)
        fades_qd = self.fading_q[q, None] * (place_qr[q, None] @ V_qrd[q])[:, 0]
        K_qdd[q] += sum(f_q[q, None] * rows.G_qd[q] for f_q, rows in forces)[:, :, None] * fades_qd[:, None]

    def share_rates(self, v_d: np.ndarray, q: np.ndarray) -> np.ndarray:
        """``share' = share fading dxi``."""
        place_q = np.sum(self.place_qr[q] * np.sum(self.V_qrd[q] * v_d[self.dof_qd[q]][:, None], axis=2), axis=1)
        return self.share_q[q] * self.fading_q[q] * place_q

    def curvature(self, f_qc: np.ndarray) -> np.ndarray:
        """``f D(dg)``.

        With y' = t, m = t.t, kappa = n.y'', a = m - g kappa, T = t.(dx - dy), Nb = n.dy', the second variation of the
        gap is ``D(dg) = -1/a [T Nb + Nb T + g Nb Nb + (kappa / m) T T]`` (Wriggers 2006, sec. 9.1, in the present
        notation).

        Symmetric except at points that slide off the master. Their share changes with the place on the continuation of
        the master, ``d eta = dxi``, and so does the normal force. The tangential force that would make the
        tangent symmetric does not exist: what slides off loses its bond and is not pulled back.
        """
        K_qdd = self.V_qrd.swapaxes(1, 2) @ (self.of_gap(f_qc[:, 0]) @ self.V_qrd)
        self.fade(K_qdd, [(f_qc[:, 0], self.gap_rows)], self.V_qrd, self.place_qr)
        return K_qdd

    def unsymmetric(self, f_qc: np.ndarray) -> np.ndarray:
        return np.flatnonzero(self.fading_q * np.abs(f_qc).sum(1))
