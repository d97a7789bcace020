"""The jump of a bond that slides: gap and slip in the mean frame of both faces (Ortiz and Pandolfi 1999).

In the frame of the master alone the mode ratio of an open bond would depend on which face is the master: where the
faces make an angle ``theta``, the other face sees the gap ``g - s theta`` and the slip ``s + g theta``. The jump (g, s)
of the closest point is turned by half of it, ``h = theta / 2``:

    g_m = g cos h - s sin h,    s_m = s cos h + g sin h
    dg_m = cos h dg - sin h ds - s_m dh,    ds_m = cos h ds + sin h dg + g_m dh

All are objective scalars of the present positions; their variations give forces in balance and the complete tangent.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from iga.interface.contact import NB, NC, ROWS, TB, Contact, G, Rows, SlidingContact, Slip, along
from iga.interface.slip import Slid, both, outer

#: Further rows of `MeanContact.V_qrd`: the turn and the stretch of the slave, and the slip along the master.
TURNED, STRETCHED, WAY = range(ROWS, ROWS + 3)


@dataclass(frozen=True)
class MeanContact(Contact):
    """Gap and slip in the mean frame, from those ``on_master`` and the length ``slid`` along it.

    ``half_q`` (n_q,) are the angles h, ``turns_q`` the sign with which the turn of the slave counts in them, zero where
    the frame of the master is kept; ``V_qrd`` (n_q, 8, n_d) the rows of `Slid`, the turn ``k.dx' / |x'|`` and the
    stretch ``x'.dx' / x'.x'`` of the slave, where k is normal to x', and the slip along the master; ``dh_qr`` (n_q, 8)
    the factors of these rows in dh.
    """

    on_master: SlidingContact
    slid: Slid
    outward: float
    turns_q: np.ndarray
    half_q: np.ndarray
    V_qrd: np.ndarray
    dh_qr: np.ndarray

    def needed(self, carries_q: np.ndarray, shears_q: np.ndarray) -> np.ndarray:
        """A point without shear in the frame of the master depends on no way along it."""
        gap_qd, side = self.on_master.gap_rows.dof_qd, self.slid.side
        ways_q = shears_q | (carries_q & (self.turns_q != 0.0))
        further_qd = self.slid.dof_qd[:, gap_qd.shape[1] :]
        moves_d = np.any(further_qd[ways_q, side:] != further_qd[ways_q, :-side], axis=0)
        parts = 0 if not ways_q.any() else 1 if not moves_d.any() else int(np.flatnonzero(moves_d)[-1]) // side + 2
        further_qd = further_qd[:, : side * parts]
        return np.hstack([gap_qd, np.where(ways_q[:, None], further_qd, gap_qd[:, :1])])

    def within(self, columns: int) -> MeanContact:
        assert self.slip is not None
        if columns >= self.V_qrd.shape[2]:
            return self
        of_gap, of_slip = (
            Rows(rows.dof_qd[:, :columns], rows.G_qd[:, :columns]) for rows in (self.gap_rows, self.slip.rows)
        )
        return replace(
            self,
            gap_rows=of_gap,
            slip=replace(self.slip, rows=of_slip),
            slid=self.slid.within(columns),
            V_qrd=self.V_qrd[..., :columns],
        )

    def share_rates(self, v_d: np.ndarray, q: np.ndarray) -> np.ndarray:
        return self.on_master.share_rates(v_d, q)

    def unsymmetric(self, f_qc: np.ndarray) -> np.ndarray:
        return self.on_master.unsymmetric(f_qc)

    def slopes(self, dg_q: np.ndarray, ds_q: np.ndarray, dtheta_q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Derivatives (n_q,) of gap and slip from those on the master, and of the angle from master to slave."""
        assert self.slip is not None
        c, z, dh_q = np.cos(self.half_q), np.sin(self.half_q), 0.5 * self.turns_q * dtheta_q
        return c * dg_q - z * ds_q - self.slip.s_q * dh_q, c * ds_q + z * dg_q + self.g_q * dh_q

    def curvature(self, f_qc: np.ndarray) -> np.ndarray:
        """``p D(dg_m) + t D(ds_m)``, with the tractions P, Q in the frame of the master:

            P = p cos h + t sin h,      Q = t cos h - p sin h
            P D(dg) + Q D(ds) + (Q g - P s) D(dh) + 2 sym(dh (Q dg - P ds)) - (P g + Q s) dh dh

        D(dg) is that of `SlidingContact.curvature`, D(ds) that of `Slid`. The traction of a point that slides off the
        master fades with its share (see `SlidingContact.curvature`).
        """
        on, way, g_q, s_q, (p_q, t_q) = self.on_master, self.slid, self.on_master.g_q, self.slid.s_q, f_qc.T
        P, Q = self._on_master(p_q, t_q)
        of_place_qrs, c_qrs = way.of_place(g_q), np.zeros((len(P), WAY + 1, WAY + 1))
        c_qrs[:, :ROWS, :ROWS] = Q[:, None, None] * way.of_length(of_place_qrs)
        c_qrs[:, :3, :3] += on.of_gap(P)
        c_qrs[:, : STRETCHED + 1, : STRETCHED + 1] += (Q * g_q - P * s_q)[:, None, None] * self._of_turn(of_place_qrs)
        pull_qr = np.zeros_like(self.dh_qr)
        pull_qr[:, G], pull_qr[:, WAY] = Q, -P
        c_qrs += both(self.dh_qr, pull_qr) - (P * g_q + Q * s_q)[:, None, None] * outer(self.dh_qr, self.dh_qr)
        V = self.V_qrd
        K_qdd = V.swapaxes(1, 2) @ (c_qrs @ V)
        way.add_bent(K_qdd, Q * way.forward_q)
        on.fade(K_qdd, zip(f_qc.T, self.jump_rows, strict=True), V[:, :ROWS], way.place_qr)
        return K_qdd

    def _on_master(self, p_q: np.ndarray, t_q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Tractions (n_q,) along the normal and the tangent of the master."""
        c, z = np.cos(self.half_q), np.sin(self.half_q)
        return c * p_q + z * t_q, c * t_q - z * p_q

    def _of_turn(self, of_place_qrs: np.ndarray) -> np.ndarray:
        """``D(dh)`` (n_q, 7, 7), half of that of the slave less that of the master, from ``D(dphi) = k.D(dt) / |t| -
        2 sym(dphi t.dt / t.t)`` for the turn dphi of a tangent t, of the master also by the parameter."""
        place_qr, (m, size, ty, ny, nyy) = self.slid.place_qr, self.slid.jet_kq
        c_qrs, curving_qr = np.zeros((len(m), WAY, WAY)), np.zeros_like(place_qr)
        c_qrs[:, TURNED, STRETCHED] = c_qrs[:, STRETCHED, TURNED] = -1.0
        turn_qr, stretch_qr = _master_turn(self.slid, self.outward), ty[:, None] * place_qr
        stretch_qr[:, TB] += 1.0
        curving_qr[:, NC] = 1.0
        of_tangent_qrs = both(curving_qr, place_qr) + nyy[:, None, None] * outer(place_qr, place_qr)
        of_tangent_qrs += ny[:, None, None] * of_place_qrs
        of_tangent_qrs *= (-self.outward / size)[:, None, None]
        c_qrs[:, :ROWS, :ROWS] -= of_tangent_qrs - both(turn_qr, stretch_qr / m[:, None])
        return 0.5 * self.turns_q[:, None, None] * c_qrs


def angle_between(a_qi: np.ndarray, b_qi: np.ndarray) -> np.ndarray:
    """Complex numbers (n_q,) whose angles lead from vectors a_qi (n_q, 2) to b_qi, counterclockwise."""
    return np.sum(a_qi * b_qi, -1) + 1j * (a_qi[:, 0] * b_qi[:, 1] - a_qi[:, 1] * b_qi[:, 0])


def in_mean_frame(
    on: SlidingContact,
    slid: Slid,
    outward: float,
    turns_q: np.ndarray,
    angle_q: np.ndarray,
    dN_qa: np.ndarray,
    tangent_qi: np.ndarray,
) -> MeanContact:
    """The jumps of a contact, slid along the master, in the mean frame of both faces.

    Parameters
    ----------
    outward : of the master (see `iga.interface.surface.Surface`).
    turns_q : see `MeanContact`.
    angle_q : (n_q,) angles by which the slave has turned against the master, counterclockwise.
    dN_qa : (n_q, n_a) derivatives of the slave functions, the first ones among the unknowns.
    tangent_qi : (n_q, 2) the tangents of the slave that they give.
    """
    stretch_qi = tangent_qi / np.sum(tangent_qi**2, -1)[:, None]
    turn_qi = np.stack([-stretch_qi[:, 1], stretch_qi[:, 0]], -1)
    own = 2 * dN_qa.shape[1]
    V_qrd = np.zeros((len(angle_q), WAY + 1, slid.dof_qd.shape[1]))
    V_qrd[:, :ROWS], V_qrd[:, WAY] = slid.V_qrd, slid.G_qd
    V_qrd[:, TURNED, :own], V_qrd[:, STRETCHED, :own] = (along(dN_qa, v_qi) for v_qi in (turn_qi, stretch_qi))
    dh_qr = np.pad(-_master_turn(slid, outward), ((0, 0), (0, WAY + 1 - ROWS)))
    dh_qr[:, TURNED] = 1.0
    half_q, dh_qr = 0.5 * turns_q * angle_q, 0.5 * turns_q[:, None] * dh_qr
    c_q, z_q, dh_qd = np.cos(half_q), np.sin(half_q), (dh_qr[:, None] @ V_qrd)[:, 0]
    g_q, s_q = c_q * on.g_q - z_q * slid.s_q, c_q * slid.s_q + z_q * on.g_q
    c_q1, z_q1, dg_qd, ds_qd = c_q[:, None], z_q[:, None], V_qrd[:, G], V_qrd[:, WAY]
    of_gap = Rows(slid.dof_qd, c_q1 * dg_qd - z_q1 * ds_qd - s_q[:, None] * dh_qd)
    of_slip = Rows(slid.dof_qd, c_q1 * ds_qd + z_q1 * dg_qd + g_q[:, None] * dh_qd)
    slip = Slip(s_q, of_slip, slid.jet_kq[1])
    return MeanContact(
        on.pairing, g_q, on.n_qi, on.share_q, of_gap, on, slid, outward, turns_q, half_q, V_qrd, dh_qr, slip=slip
    )


def _master_turn(slid: Slid, outward: float) -> np.ndarray:
    """Factors (n_q, 5) of the rows in the turn of the master, ``k.(dy' + y'' dxi) / |t|`` with k = -outward n."""
    _, size, _, ny, _ = slid.jet_kq
    turn_qr = ny[:, None] * slid.place_qr
    turn_qr[:, NB] += 1.0
    return (-outward / size)[:, None] * turn_qr
