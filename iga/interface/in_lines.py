"""Two solids that slide far on each other: lines along the specimen meet each other as faces do in the plane.

Points on a line Z = const of the slave meet the line of the same Z on the master, in the plane of X and Y: gap, slip
and their variations are those of the plane (`SearchedInterface`), with the control points of the lines,
``x_A = sum_k M_k(Z) x_Ak``. The bodies also slide across, by the lateral displacements w at a point and where it meets
the master, at the parameter xi:

    s_Z = w - w_m(xi),    ds_Z = dw - dw_m - w_m' dxi,    D(ds_Z) = -2 sym(dw_m' dxi) - w_m'' dxi dxi - w_m' D(dxi)

That a face is inclined across the width counts in second order and is left out.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from iga.interface.closest_point import Pairing
from iga.interface.contact import NB, NC, ROWS, Contact, G, Rows, SlidingContact
from iga.interface.interface import Interface, SearchedInterface, SettledInterface
from iga.interface.mean_frame import MeanContact
from iga.interface.slip import outer
from iga.interface.slip_in_plane import LEAST_SLIP, InPlaneContact, in_plane

#: Components of a unit vector below it are rounding.
ALIGNED = 1e-12


@dataclass(frozen=True)
class Lines:
    """Lines (n_l) along a solid: places Z_l across, parts w_l of the width that they stand for, and the functions M_lb
    (n_l, n_b) across that live there, numbers k_lb of ``n_k``."""

    Z_l: np.ndarray
    w_l: np.ndarray
    M_lb: np.ndarray
    k_lb: np.ndarray
    n_k: int

    def of_points(self, conn_qa: np.ndarray, N_qa: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Control points and functions (n_q, n_a n_b) of the solid for plane ones, line by line."""
        k_qb, M_qb = (np.repeat(v_lb, len(conn_qa), axis=0) for v_lb in (self.k_lb, self.M_lb))
        n_l = len(self.Z_l)
        conn_qab = np.tile(conn_qa, (n_l, 1))[..., None] * self.n_k + k_qb[:, None]
        N_qab = np.tile(N_qa, (n_l, 1))[..., None] * M_qb[:, None]
        return conn_qab.reshape(len(k_qb), -1), N_qab.reshape(len(k_qb), -1)


@dataclass(frozen=True)
class Spread:
    """Unknowns of the points of lines as unknowns of the solid: functions M_qb across, numbers k_qb of ``n_k``, over
    ``n_A`` control points along each line, and the axes of the specimen."""

    M_qb: np.ndarray
    k_qb: np.ndarray
    n_k: int
    n_A: int
    axes_kI: np.ndarray

    @cached_property
    def used_ic(self) -> np.ndarray:
        """Components of the solid that each of the plane has."""
        return np.array([np.flatnonzero(np.abs(axis) > ALIGNED) for axis in self.axes_kI[:2]])

    @property
    def each(self) -> int:
        """Unknowns of the solid for one of the plane."""
        return self.M_qb.shape[1] * self.used_ic.shape[1]

    def dofs(self, flat_qd: np.ndarray) -> np.ndarray:
        """Unknowns (n_q, n_d each) for those of lines, whose components alternate."""
        j_dc = np.tile(self.used_ic, (flat_qd.shape[1] // 2, 1))
        A_qdb = (flat_qd // 2 % self.n_A)[..., None] * self.n_k + self.k_qb[:, None]
        return (3 * A_qdb[..., None] + j_dc[:, None]).reshape(len(flat_qd), -1)

    def rows(self, V_qrd: np.ndarray) -> np.ndarray:
        """Rows (n_q, n_r, n_d each)."""
        a_dc = np.tile(np.take_along_axis(self.axes_kI[:2], self.used_ic, 1), (V_qrd.shape[2] // 2, 1))
        V_qrdb = V_qrd[..., None] * self.M_qb[:, None, None]
        return (V_qrdb[..., None] * a_dc[:, None]).reshape(*V_qrd.shape[:2], -1)

    def across(self, A_qa: np.ndarray, F_qra: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Unknowns across the width and rows (n_q, n_r, n) of functions F_qra of the control points of lines."""
        dof_qab = 3 * ((A_qa % self.n_A)[..., None] * self.n_k + self.k_qb[:, None]) + 2
        rows_qrab = F_qra[..., None] * self.M_qb[:, None, None]
        return dof_qab.reshape(len(A_qa), -1), rows_qrab.reshape(*F_qra.shape[:2], -1)

    def twice(self, K_qde: np.ndarray) -> np.ndarray:
        """Matrices (n_q, n_d each, n_d each)."""
        return self.rows(self.rows(K_qde).swapaxes(1, 2)).swapaxes(1, 2)


@dataclass(frozen=True)
class LinedContact(Contact):
    """A contact ``flat`` of all lines, over the unknowns of the solid."""

    flat: SlidingContact | MeanContact
    spread: Spread

    def needed(self, carries_q: np.ndarray, shears_q: np.ndarray) -> np.ndarray:
        return self.spread.dofs(self.flat.needed(carries_q, shears_q))

    def curvature(self, f_qc: np.ndarray) -> np.ndarray:
        return self.spread.twice(self.flat.curvature(f_qc))

    def unsymmetric(self, f_qc: np.ndarray) -> np.ndarray:
        return self.flat.unsymmetric(f_qc)


@dataclass(frozen=True)
class LinedSlip(InPlaneContact):
    """The same with slips along (``flat``) and across. The unknowns begin with those across, of which the slip has the
    rows ``across_qrd`` (n_q, 2, n_Z): of s_Z at a place, and of w_m'; ``bend_rq`` are w_m' and w_m''."""

    flat: MeanContact
    spread: Spread
    across_qrd: np.ndarray
    bend_rq: np.ndarray

    def needed(self, carries_q: np.ndarray, shears_q: np.ndarray) -> np.ndarray:
        n_Z = self.across_qrd.shape[2]
        return np.hstack([self.dof_qd[:, :n_Z], self.spread.dofs(self.flat.needed(carries_q, shears_q))])

    def within(self, columns: int) -> LinedSlip:
        assert self.slip is not None
        if columns >= self.dof_qd.shape[1]:
            return self
        one, other, along, gap = (
            Rows(rows.dof_qd[:, :columns], rows.G_qd[:, :columns])
            for rows in (*self.ways, self.slip.rows, self.gap_rows)
        )
        flat = self.flat.within((columns - self.across_qrd.shape[2]) // self.spread.each)
        slip = replace(self.slip, rows=along)
        return replace(self, ways=(one, other), slip=slip, gap_rows=gap, flat=flat)

    def curvature(self, f_qc: np.ndarray) -> np.ndarray:
        flat, (_, across), n_Z = self.flat, self.ways, self.across_qrd.shape[2]
        along_qc, lateral_q = f_qc * np.stack([np.ones(len(f_qc)), self.part_kq[0]], 1), f_qc[:, 1] * self.part_kq[1]
        place_qr, (bend_q, bends_q) = flat.slid.place_qr, self.bend_rq
        c_qrs, V_qrd = np.zeros((len(f_qc), ROWS + 1, ROWS + 1)), np.zeros((len(f_qc), ROWS + 1, across.G_qd.shape[1]))
        V_qrd[:, :ROWS, n_Z:], V_qrd[:, ROWS, :n_Z] = self.spread.rows(flat.V_qrd[:, :ROWS]), self.across_qrd[:, 1]
        c_qrs[:, :ROWS, :ROWS] = bends_q[:, None, None] * outer(place_qr, place_qr)
        c_qrs[:, :ROWS, :ROWS] += bend_q[:, None, None] * flat.slid.of_place(flat.on_master.g_q)
        c_qrs[:, ROWS, :ROWS] = c_qrs[:, :ROWS, ROWS] = place_qr
        K_qdd = -V_qrd.swapaxes(1, 2) @ (lateral_q[:, None, None] * c_qrs @ V_qrd)
        K_qdd[:, n_Z:, n_Z:] += self.spread.twice(flat.curvature(along_qc))
        flat.on_master.fade(K_qdd, [(lateral_q, across)], V_qrd[:, :ROWS], place_qr)
        return K_qdd

    def unsymmetric(self, f_qc: np.ndarray) -> np.ndarray:
        return self.flat.unsymmetric(f_qc)


@dataclass(frozen=True)
class LinedInterface(Interface):
    """Points of all lines, one after the other; ``flat`` is their interface, each line a chain of the master."""

    flat: SearchedInterface
    spread: Spread
    lines: Lines

    @property
    def pairing(self) -> Pairing:
        return self.flat.pairing

    @cached_property
    def rest(self) -> Contact:
        return self.contact(np.zeros(self.P_AI.size), None)

    def contact(self, u_d: np.ndarray, guess: Pairing | None) -> LinedContact | LinedSlip:
        spread, v_Ai = self.spread, self._on_lines(u_d)
        if guess is not None:  # that of another interface may be on other lines
            sides = self.flat.master.sides // len(self.lines.Z_l)
            guess = replace(guess, c_q=guess.c_q % sides + sides * self.line_q)
        flat = self.flat.contact(v_Ai[:, :2].ravel(), guess)
        n_qi, rows = flat.n_qi @ spread.axes_kI[:2], flat.gap_rows
        known = flat.pairing, flat.g_q, n_qi, flat.share_q
        if not isinstance(flat, MeanContact):
            moved = Rows(spread.dofs(rows.dof_qd), spread.rows(rows.G_qd[:, None])[:, 0])
            return LinedContact(*known, moved, flat, spread)
        assert flat.slip is not None
        met, slid = flat.on_master, flat.slid
        A_qa, own = met.gap_rows.dof_qd[:, ::2] // 2, met.gap_rows.dof_qd.shape[1]
        turns_qrd = np.stack([slid.V_qrd[:, r, :own] for r in (G, NB, NC)], axis=1)  # along the normal of the master
        F_qra = (turns_qrd.reshape(len(A_qa), 3, -1, 2) @ flat.n_qi[:, None, :, None])[..., 0]
        slip_q, *bend_rq = np.sum(F_qra * v_Ai[A_qa, 2][:, None], axis=2).T
        dof_qZ, across_qrd = spread.across(A_qa, F_qra[:, :2])
        dof_qd, dxi_qd = np.hstack([dof_qZ, spread.dofs(rows.dof_qd)]), (slid.place_qr[:, None] @ slid.V_qrd)[:, 0]
        gap_qd, along_qd, dxi_qd = spread.rows(np.stack([rows.G_qd, flat.slip.rows.G_qd, dxi_qd], 1)).swapaxes(0, 1)
        still_qd = np.zeros(dof_qZ.shape)
        ways = (
            Rows(dof_qd, np.hstack([still_qd, along_qd])),
            Rows(dof_qd, np.hstack([across_qrd[:, 0], -bend_rq[0][:, None] * dxi_qd])),
        )
        least = LEAST_SLIP * float(np.ptp(self.P_AI))
        slip, part_kq = in_plane(ways, np.stack([flat.slip.s_q, slip_q]), least)
        slip, gaps = replace(slip, side_q=flat.slip.side_q), Rows(dof_qd, np.hstack([still_qd, gap_qd]))
        return LinedSlip(*known, gaps, ways, part_kq, least, flat, spread, across_qrd, np.stack(bend_rq), slip=slip)

    def slopes(self, u_d: np.ndarray, contact: Contact) -> tuple[np.ndarray, ...]:
        assert isinstance(contact, LinedContact | LinedSlip)
        v_Ai = self._on_lines(u_d)
        found = self.flat.slopes(v_Ai[:, :2].ravel(), contact.flat)
        if not isinstance(contact, LinedSlip):
            return found
        dg_q, ds_q = found
        dw_q = self.flat.direction_q * np.sum(self.flat.dN_qa * v_Ai[self.flat.conn_qa, 2], axis=1)
        dxi_q = self.flat.rate_of_place(v_Ai[:, :2].ravel(), contact.flat)
        return dg_q, contact.slip_rate([ds_q, dw_q - contact.bend_rq[0] * dxi_q])

    def _on_lines(self, u_d: np.ndarray) -> np.ndarray:
        """Displacements (n_l n_A, 3) of the control points of all lines, along the axes of the specimen."""
        v_Aki = (u_d.reshape(-1, 3) @ self.spread.axes_kI.T).reshape(self.spread.n_A, self.spread.n_k, 3)
        return np.einsum("lb,Albi->lAi", self.lines.M_lb, v_Aki[:, self.lines.k_lb]).reshape(-1, 3)


def in_lines(
    one: Interface, lines: Lines, P_AI: np.ndarray, axes_kI: np.ndarray, origin_i: np.ndarray, search: bool
) -> Interface:
    """The interface of a plane specimen in its own frame, on all lines of the solid over it.

    ``P_AI`` (n_A n_k, 3) are the control points of the solid in place, ``axes_kI`` and ``origin_i`` its frame. With
    ``search`` points search for the other body on their lines, else they keep the pairs and normals of the reference
    configuration.
    """
    (n_q, n_l), n_A = (one.points, len(lines.Z_l)), len(one.P_AI)
    at_q = np.repeat(np.arange(n_l), n_q)
    spread = Spread(lines.M_lb[at_q], lines.k_lb[at_q], lines.n_k, n_A, axes_kI)
    (conn_qa, N_qa), (_, dN_qa), (_, d2N_qa) = (
        lines.of_points(one.conn_qa, values) for values in (one.N_qa, one.dN_qa, one.d2N_qa)
    )
    points: dict[str, Any] = {
        "N_qa": N_qa,
        "dN_qa": dN_qa,
        "d2N_qa": d2N_qa,
        "conn_qa": conn_qa,
        "dA_q": np.outer(lines.w_l, one.dA_q).ravel(),
        "X_qi": np.column_stack([np.tile(one.X_qi, (n_l, 1)), lines.Z_l[at_q]]) @ axes_kI + origin_i,
        "P_AI": P_AI,
        "law": one.law,
        "bonded_q": np.tile(one.bonded_q, n_l),
        "forward_i": np.append(one.forward_i, 0.0) @ axes_kI,
    }
    if isinstance(one, SearchedInterface) and search:
        return LinedInterface(**points, flat=_chained(one, n_l), spread=spread, lines=lines)
    rest, slopes = one.rest, one.rest_slopes
    known = None, np.tile(rest.g_q, n_l), np.tile(rest.n_qi, (n_l, 1)) @ axes_kI[:2], np.tile(rest.share_q, n_l)

    def lined(rows: Rows) -> Rows:
        G_qd = np.tile(rows.G_qd, (n_l, 1))
        return Rows(spread.dofs(np.tile(rows.dof_qd, (n_l, 1))), spread.rows(G_qd[:, None])[:, 0])

    if rest.slip is None:
        at_rest = Contact(*known, lined(rest.gap_rows).moving)
        return SettledInterface(**points, at_rest=at_rest, by_length=(lined(slopes[0]),))
    every = [lined(rows) for rows in (rest.gap_rows, rest.slip.rows, *slopes)]
    normal_qi, A_qa = rest.n_qi[:, None, :, None], np.tile(rest.gap_rows.dof_qd[:, ::2] // 2, (n_l, 1))
    F_qra = np.stack([rows.G_qd.reshape(n_q, -1, 2) for rows in (rest.gap_rows, slopes[0])], axis=1) @ normal_qi
    dof_qZ, across_qrd = spread.across(A_qa, np.tile(F_qra[..., 0], (n_l, 1, 1)))
    dof_qd = np.hstack([dof_qZ, every[0].dof_qd])
    gap, along, dg, ds = (Rows(dof_qd, np.hstack([np.zeros(dof_qZ.shape), rows.G_qd])) for rows in every)
    aside, dw = (
        Rows(dof_qd, np.hstack([row_qd, np.zeros_like(every[0].G_qd)])) for row_qd in across_qrd.swapaxes(0, 1)
    )
    at_rest = InPlaneContact.at_rest(known[1:], gap, (along, aside), LEAST_SLIP * float(np.ptp(P_AI)))
    return SettledInterface(**points, at_rest=at_rest, by_length=(dg, ds, dw))


def _chained(one: SearchedInterface, n_l: int) -> SearchedInterface:
    """The interface on n_l lines, each a chain of the master with control points of its own."""
    n_A, master, met = len(one.P_AI), one.master, one.pairing
    at_q, at_c = np.repeat(np.arange(n_l), one.points), np.repeat(np.arange(n_l), master.sides)
    chains = replace(
        master,
        C_cab=np.tile(master.C_cab, (n_l, 1, 1)),
        conn_ca=np.tile(master.conn_ca, (n_l, 1)) + n_A * at_c[:, None],
        w_cb=np.tile(master.w_cb, (n_l, 1)),
        chains=n_l,
    )
    each: dict[str, Any] = {
        name: np.tile(getattr(one, name), (n_l, 1)) for name in ("N_qa", "dN_qa", "d2N_qa", "X_qi", "P_AI")
    }
    return replace(
        one,
        **each,
        conn_qa=np.tile(one.conn_qa, (n_l, 1)) + n_A * at_q[:, None],
        dA_q=np.tile(one.dA_q, n_l),
        bonded_q=np.tile(one.bonded_q, n_l),
        master=chains,
        near=Pairing(np.tile(met.c_q, n_l) + master.sides * at_q, np.tile(met.xi_q, n_l), np.tile(met.on_q, n_l)),
    )
