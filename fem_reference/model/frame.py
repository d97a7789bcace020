"""Gap and slip of the matched faces from their jump and, where arms turn, from their mean deformed tangent."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


class Relative(NamedTuple):
    """Gap and slip at the points: jump_qj (n_q, n_j), first (n_q, n_j, m) and second (n_q, n_j, m, m) derivatives by
    z_qa; None for these where the jumps are the functionals themselves, in reverse order."""

    jump_qj: np.ndarray
    dz_qja: np.ndarray | None = None
    dz_qjab: np.ndarray | None = None

    def forces(self, f_qj: np.ndarray) -> np.ndarray:
        """Forces (n_q, m) on the functionals of forces on the jumps."""
        return f_qj[:, ::-1] if self.dz_qja is None else np.einsum("qj,qja->qa", f_qj, self.dz_qja)

    def rates(self, z_qa: np.ndarray) -> np.ndarray:
        """Changes (n_q, n_j) of the jumps with changes of the functionals."""
        return z_qa[:, ::-1] if self.dz_qja is None else np.einsum("qja,qa->qj", self.dz_qja, z_qa)

    def tangent(self, f_qj: np.ndarray, D_qij: np.ndarray) -> np.ndarray:
        """Derivative (n_q, m, m) of `forces` by the functionals, where D_qij is that of f_qj by the jumps."""
        if self.dz_qja is None or self.dz_qjab is None:
            return D_qij[:, ::-1, ::-1]
        bent_qab = np.einsum("qj,qjab->qab", f_qj, self.dz_qjab)
        return self.dz_qja.swapaxes(1, 2) @ D_qij @ self.dz_qja + bent_qab


def relative(z_qa: np.ndarray) -> Relative:
    """Gap and slip by the functionals of `fem_reference.model.bond`.

    One functional per point is the gap. Two are the jump of the displacement, from the lower to the upper face, in the
    reference frame. Four are the jump and the X-derivative of the mean displacement of both faces: with the unit
    vectors e and n along and across the mean deformed tangent m, s = jump . e and g = jump . n (Ortiz and Pandolfi
    1999, Int. J. Numer. Methods Eng. 44, 1267-1282). From de = n (n . dm) / |m| and dn = -e (n . dm) / |m|

        ds = e . d jump + g n . dm / |m|        dg = n . d jump - s n . dm / |m|
    """
    n_q, m = z_qa.shape
    if m in (3, 9):
        return _in_space(z_qa)
    if m < 4:
        return Relative(z_qa[:, ::-1])
    dz_qja, dz_qjab = np.zeros((n_q, 2, m)), np.zeros((n_q, 2, m, m))
    delta_qi = z_qa[:, :2]
    m_qi = z_qa[:, 2:] + np.array([1.0, 0.0])
    length_q = np.linalg.norm(m_qi, axis=1)
    e_qi = m_qi / length_q[:, None]
    n_qi = np.stack([-e_qi[:, 1], e_qi[:, 0]], -1)
    g_q, s_q = np.sum(delta_qi * n_qi, -1), np.sum(delta_qi * e_qi, -1)
    turn_qi = n_qi / length_q[:, None]  # derivative of the angle by m
    dz_qja[:, 0, :2], dz_qja[:, 0, 2:] = n_qi, -s_q[:, None] * turn_qi
    dz_qja[:, 1, :2], dz_qja[:, 1, 2:] = e_qi, g_q[:, None] * turn_qi
    turned = np.einsum("qi,qj->qij", turn_qi, turn_qi)
    bent = np.einsum("qi,qj->qij", e_qi / length_q[:, None], turn_qi)
    bent = bent + bent.swapaxes(1, 2)
    mixed_g, mixed_s = (np.einsum("qi,qj->qij", side_qi, turn_qi) for side_qi in (-e_qi, n_qi))
    g_qii, s_qii = g_q[:, None, None], s_q[:, None, None]
    for j, mixed, both in ((0, mixed_g, s_qii * bent - g_qii * turned), (1, mixed_s, -g_qii * bent - s_qii * turned)):
        dz_qjab[:, j, :2, 2:], dz_qjab[:, j, 2:, :2] = mixed, mixed.swapaxes(1, 2)
        dz_qjab[:, j, 2:, 2:] = both
    return Relative(np.stack([g_q, s_q], -1), dz_qja, dz_qjab)


#: Length below which a slip has no direction: its inverse is a number, its energy is not.
NO_SLIP = 1e-170


def _in_space(z_qa: np.ndarray) -> Relative:
    """Gap and slip of a solid: with the jump delta and the unit normal n

        g = delta . n        s = +- |delta - g n|

    with the sign of the slip along X. Three functionals are delta, and n is across the reference plane; nine have also
    the derivatives by X and Z of the mean displacement, and n is across both mean deformed tangents. All derivatives
    follow by the chain rule. A slip of zero has no direction: the root is rounded off there, so that t ds is exact.
    """
    n_q, m = z_qa.shape
    to_delta_ia = np.eye(3, m)
    delta_qi = z_qa[:, :3]
    n_qi, dn_qia, dn_qiab = _normal(z_qa)
    g_q = np.einsum("qi,qi->q", delta_qi, n_qi)
    dg_qa = n_qi @ to_delta_ia + np.einsum("qi,qia->qa", delta_qi, dn_qia)
    cross_qab = np.einsum("ia,qib->qab", to_delta_ia, dn_qia)
    dg_qab = cross_qab + cross_qab.swapaxes(1, 2) + np.einsum("qi,qiab->qab", delta_qi, dn_qiab)
    slip_qi = delta_qi - g_q[:, None] * n_qi
    dslip_qia = to_delta_ia - np.einsum("qa,qi->qia", dg_qa, n_qi) - g_q[:, None, None] * dn_qia
    # terms along n are left out: they are orthogonal to the slip
    turns_qab = np.einsum("qi,qia,qb->qab", slip_qi, dn_qia, dg_qa)
    bent_qab = -turns_qab - turns_qab.swapaxes(1, 2) - g_q[:, None, None] * np.einsum("qi,qiab->qab", slip_qi, dn_qiab)
    s_q = np.where(slip_qi[:, 0] < 0.0, -1.0, 1.0) * np.hypot(np.linalg.norm(slip_qi, axis=1), NO_SLIP)
    ds_qa = np.einsum("qi,qia->qa", slip_qi, dslip_qia) / s_q[:, None]
    bent_qab += np.einsum("qia,qib->qab", dslip_qia, dslip_qia) - np.einsum("qa,qb->qab", ds_qa, ds_qa)
    ds_qab = bent_qab / s_q[:, None, None]
    return Relative(np.stack([g_q, s_q], -1), np.stack([dg_qa, ds_qa], 1), np.stack([dg_qab, ds_qab], 1))


def _normal(z_qa: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Unit normal (n_q, 3), m_Z x m_X over its length, with both derivatives by the functionals."""
    n_q, m = z_qa.shape
    if m < 9:
        return np.tile([0.0, 1.0, 0.0], (n_q, 1)), np.zeros((n_q, 3, m)), np.zeros((n_q, 3, m, m))
    e_ijk = np.zeros((3, 3, 3))
    e_ijk[[0, 1, 2], [1, 2, 0], [2, 0, 1]], e_ijk[[0, 2, 1], [2, 1, 0], [1, 0, 2]] = 1.0, -1.0
    turn_iab = np.zeros((3, m, m))  # N_i = 1/2 turn_iab z_a z_b, with the reference tangents in z
    turn_iab[:, 6:, 3:6], turn_iab[:, 3:6, 6:] = e_ijk, -e_ijk
    whole_qa = z_qa + np.array([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0])
    dN_qia = np.einsum("iab,qb->qia", turn_iab, whole_qa)
    N_qi = 0.5 * np.einsum("qia,qa->qi", dN_qia, whole_qa)
    length_q = np.linalg.norm(N_qi, axis=1)
    n_qi, dN_qia = N_qi / length_q[:, None], dN_qia / length_q[:, None, None]
    dlength_qa = np.einsum("qi,qia->qa", n_qi, dN_qia)
    dn_qia = dN_qia - np.einsum("qi,qa->qia", n_qi, dlength_qa)
    along_qab = np.einsum("qia,qib->qab", dn_qia, dN_qia)
    along_qab += np.einsum("qi,iab->qab", n_qi, turn_iab) / length_q[:, None, None]
    dn_qiab = (
        turn_iab / length_q[:, None, None, None]
        - np.einsum("qib,qa->qiab", dn_qia, dlength_qa)
        - np.einsum("qia,qb->qiab", dn_qia, dlength_qa)
        - np.einsum("qi,qab->qiab", n_qi, along_qab)
    )
    return n_qi, dn_qia, dn_qiab
