"""Response of the points of an interface: tractions and new histories, forces and tangents."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from iga.interface.contact import Contact
from iga.interface.interface import Interface
from iga.laws.law import INSTANT, History, Law, Scaled

#: A tangent is unsymmetric if the coupling slopes dp/ds and dt/dg differ by more than this part of their sum.
UNSYMMETRIC = 1e-12


@dataclass(frozen=True)
class Tractions:
    """Tractions f_qc (n_q, n_c) along the normal and, where the bond slides, along the master; their slopes slope_qcc
    (n_q, n_c, n_c) by the jumps; the new history; the law and the jumps (n_q, n_c) at which it was evaluated."""

    f_qc: np.ndarray
    slope_qcc: np.ndarray
    history: History
    law: Law
    jump_qc: np.ndarray

    @property
    def p_q(self) -> np.ndarray:
        """Traction along the normal."""
        return self.f_qc[:, 0]

    @property
    def t_q(self) -> np.ndarray:
        """Traction along the master of a bond that slides."""
        return self.f_qc[:, 1]

    @property
    def dp_q(self) -> np.ndarray:
        """Slope of p_q by the gap."""
        return self.slope_qcc[:, 0, 0]

    @property
    def shears_q(self) -> np.ndarray:
        """Points (n_q,) with more than a traction along the normal that depends on the gap alone."""
        others_qs = self.slope_qcc.reshape(len(self.f_qc), -1)[:, 1:]
        return np.asarray(self.f_qc[:, 1:].any(axis=1) | others_qs.any(axis=1))

    @cached_property
    def scaled(self) -> Scaled:
        """Scaled jumps, which measure the progress of damage."""
        return self.law.scaled(*self.jump_qc.T.copy(), self.history.d)

    @cached_property
    def driven_q(self) -> np.ndarray:
        """The history on first loading to the jumps."""
        return self.law.driven(*self.jump_qc.T.copy())

    def slopes_across(self, q: int, kink: float) -> np.ndarray:
        """Slopes (n_c, n_c) at a point that stands on a kink of its law just before that, less those after it."""
        law, jump_1c = self.law, self.jump_qc[[q]]
        before = np.zeros(1) if kink <= law.kinks[0] else 0.5 * law.driven(*jump_1c.T)
        slip = None if self.history.slip is None else self.history.slip[[q]]
        past = History(np.minimum(before, self.history.d[[q]]), slip)
        low, high = (law.respond(part * jump_1c, past, INSTANT, None, None)[1][0] for part in (1.0 - 1e-6, 1.0 + 1e-6))
        return low - high


def traction(
    interface: Interface, contact: Contact, past: History, closed_q: np.ndarray, dt: float = INSTANT
) -> Tractions:
    """Tractions, their slopes and the new history at all points; a point that has left the master is free.

    Traction and slope are multiplied by the share of each point's area that faces the master, so that they refer to the
    whole area. Points without cohesion only touch and rub.
    """
    law, jump_qc = interface.law, contact.jump_qc
    bonded_q = None if interface.all_bonded else interface.bonded_q
    f_qc, slope_qcc, after = law.respond(jump_qc, past, dt, closed_q, bonded_q)
    if not contact.whole:
        share_q11 = contact.share_q[:, None, None]
        f_qc, slope_qcc = share_q11[:, 0] * f_qc, share_q11 * slope_qcc
        after = after._replace(d=np.where(holding(interface, contact), after.d, past.d))
    return Tractions(f_qc, slope_qcc, after, law, jump_qc)


def holding(interface: Interface, contact: Contact) -> np.ndarray:
    """Points (n_q,) with cohesion: bonded ones that face the master. Only they have kinks and damage."""
    return contact.on_q & interface.bonded_q


def forces(interface: Interface, contact: Contact, pull: Tractions, n_dof: int) -> np.ndarray:
    """Residual ``R = int (p dg/du + t ds/du) dGamma`` (n_dof,)."""
    pairs = zip(contact.jump_rows, pull.f_qc.T, strict=True)
    first, *others = [rows.forces(f_q * interface.dA_q, n_dof) for rows, f_q in pairs]
    return sum(others, first)


def stiffness(interface: Interface, contact: Contact, pull: Tractions, each: int = 1) -> np.ndarray:
    """Complete tangent (n_g, n_d, n_d) of groups of ``each`` successive points that depend on the same unknowns,
    ``K = int (J' C J + p D(dg) + t D(ds)) dGamma``.

    J are the rows of the jumps, C the slopes of the tractions.
    """
    dA_q = interface.dA_q[:, None]
    f_qc = pull.f_qc * dA_q
    J_qcd, C_qcc = contact.quadratic(f_qc, pull.slope_qcc * dA_q[..., None])
    left_gcd, right_gcd = (v_qcd.reshape(-1, each * v_qcd.shape[1], v_qcd.shape[2]) for v_qcd in (J_qcd, C_qcc @ J_qcd))
    K_gdd, curved_qdd = left_gcd.swapaxes(1, 2) @ right_gcd, contact.curvature(f_qc)
    return K_gdd if curved_qdd is None else K_gdd + curved_qdd.reshape(-1, each, *K_gdd.shape[1:]).sum(1)


def unsymmetric(contact: Contact, pull: Tractions) -> np.ndarray:
    """Points (n_m,) with an unsymmetric tangent: those that slide off the master or have unequal coupling slopes."""
    C_qcc, turned_qcc = pull.slope_qcc, pull.slope_qcc.swapaxes(1, 2)
    unequal_qcc = np.abs(C_qcc - turned_qcc) > UNSYMMETRIC * (np.abs(C_qcc) + np.abs(turned_qcc))
    return np.union1d(contact.unsymmetric(pull.f_qc), np.flatnonzero(unequal_qcc.any((1, 2))))
