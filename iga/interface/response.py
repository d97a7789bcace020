"""Response of the points of an interface: tractions and new histories, and their energies, forces and tangents."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from iga.interface.contact import Contact, Rows
from iga.interface.interface import Histories, Interface
from iga.laws.mixed_law import History, MixedLaw, Scaled

#: A tangent is unsymmetric if the coupling slopes dp/ds and dt/dg differ by more than this part of their sum.
UNSYMMETRIC = 1e-12


@dataclass(frozen=True)
class Shear:
    """What sliding adds to the response of the points (n_q,): traction t_q along the master, the further slopes of both
    tractions, the history ``slip_q`` of friction, the law, and the jumps at which it was evaluated with the damage
    ``d_q`` after them.
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
        """Scaled jumps, which measure the progress of damage."""
        g_q, s_q = self.jump_qc.T.copy()
        return self.law.scaled(g_q, s_q, self.d_q)

    @cached_property
    def driven_q(self) -> np.ndarray:
        """The damage on first loading to the jump."""
        g_q, s_q = self.jump_qc.T.copy()
        return self.law.driven(g_q, s_q)

    def along(self, g_q: np.ndarray, s_q: np.ndarray) -> np.ndarray:
        """Scaled jumps (n_q,) of undamaged points at small gaps and slips."""
        return self.law.scaled(g_q, s_q, np.zeros(len(g_q))).x


class Tractions(NamedTuple):
    """Traction p_q, its slope dp_q by the gap, and the new history k_q (n_q,): the largest gap, or with ``shear`` the
    damage."""

    p_q: np.ndarray
    dp_q: np.ndarray
    k_q: np.ndarray
    shear: Shear | None = None

    @property
    def slope_qcc(self) -> np.ndarray:
        """Derivatives (n_q, 2, 2) of the tractions by gap and slip, where the bond slides."""
        assert self.shear is not None
        rows = self.dp_q, self.shear.dp_ds_q, self.shear.dt_dg_q, self.shear.dt_ds_q
        return np.stack(rows, axis=1).reshape(-1, 2, 2)


def traction(interface: Interface, contact: Contact, past: Histories, closed_q: np.ndarray) -> Tractions:
    """Tractions, their slopes and the new history at all points; a point that has left the master is free.

    Traction and slope are multiplied by the share of each point's area that faces the master, so that they refer to the
    whole area.
    """
    law, k_q = interface.law, past.k_q
    if isinstance(law, MixedLaw):
        return _sheared(law, interface, contact, past, closed_q)
    p, dp, k_new = law.traction(contact.g_q, k_q, closed_q)
    if interface.all_bonded and contact.whole:
        return Tractions(p, dp, k_new)
    holds_q, carries_q = holding(interface, contact), contact.share_q
    if not interface.all_bonded:
        carries_q = np.where(holds_q | (closed_q & law.contact), carries_q, 0.0)
    return Tractions(carries_q * p, carries_q * dp, np.where(holds_q, k_new, k_q))


def _sheared(law: MixedLaw, interface: Interface, contact: Contact, past: Histories, closed_q: np.ndarray) -> Tractions:
    """`traction` for a mixed-mode law. Points without cohesion only touch and rub."""
    assert contact.slip is not None
    g_q, s_q, share_q = contact.g_q, contact.slip.s_q, contact.share_q
    bonded_q = None if interface.all_bonded else interface.bonded_q
    found = law.traction(g_q, s_q, History(past.k_q, past.slip_q), past.dt, closed_q, bonded_q)
    d_q, slip_q = found.history
    if not contact.whole:
        d_q = np.where(holding(interface, contact), d_q, past.k_q)
    t_q, dp_ds_q, dt_dg_q, dt_ds_q = (share_q * part for part in (found.t, found.dp_ds, found.dt_dg, found.dt_ds))
    shear = Shear(t_q, dp_ds_q, dt_dg_q, dt_ds_q, slip_q, law, contact.jump_qc, d_q)
    return Tractions(share_q * found.p, share_q * found.dp_dg, d_q, shear)


def holding(interface: Interface, contact: Contact) -> np.ndarray:
    """Points (n_q,) with cohesion: bonded ones that face the master. Only they have kinks and damage."""
    return contact.on_q & interface.bonded_q


def stored(interface: Interface, contact: Contact, past: Histories) -> tuple[float, float]:
    """Energies stored in a bond that slides: in cohesion and friction together, and in contact."""
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
    J_qrd = np.stack([contact.gap_rows.G_qd, slip.rows.G_qd], axis=1)
    K_qdd = J_qrd.swapaxes(1, 2) @ (dA_q[:, None, None] * pull.slope_qcc @ J_qrd)
    return K_qdd + contact.curvature(pull.p_q * dA_q, shear.t_q * dA_q)


def unsymmetric(contact: Contact, pull: Tractions) -> np.ndarray:
    """Points (n_m,) with an unsymmetric tangent: those that slide off the master or have unequal coupling slopes."""
    off = contact.unsymmetric(pull.p_q)
    if pull.shear is None:
        return off
    one, other = pull.shear.dp_ds_q, pull.shear.dt_dg_q
    coupled = np.flatnonzero(np.abs(one - other) > UNSYMMETRIC * (np.abs(one) + np.abs(other)))
    return np.union1d(np.union1d(off, contact.unsymmetric(pull.shear.t_q)), coupled)


def combined(contact: Contact, by_g_q: np.ndarray, by_s_q: np.ndarray) -> Rows:
    """First variation of a function of gap and slip with these derivatives (n_q,)."""
    assert contact.slip is not None
    of_gap, of_slip = contact.gap_rows, contact.slip.rows
    return Rows(of_slip.dof_qd, by_g_q[:, None] * of_gap.G_qd + by_s_q[:, None] * of_slip.G_qd)
