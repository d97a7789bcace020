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
