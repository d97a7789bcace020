"""Steps that loads cause in a bordered system, each found no further than it is needed.

Of most loads only the work in each other's steps is needed, and of all steps one sum. With a Cholesky factor L of a
matrix the work of b in the displacements under c is ``(L^-1 b) . (L^-1 c)``: one substitution for a load instead of
two, which begins where the load does, and one more for the sum.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from iga.algebra.banded import BandCholesky
from iga.algebra.factors import Bordered


@dataclass(frozen=True)
class Caused:
    """Steps that n_r loads cause with an unchanged control.

    ``left_nr`` and ``right_nr``: the loads and the displacements of the factorised matrix under them, or what these
    are products of: their scalar products are the work. ``met_rk`` (n_r, 2): work of each load in the displacements
    under the spring that holds the opening and under the load of the specimen; ``ends_kr`` (2, n_r): how much of
    these displacements each step has, the second one being its change of the load. ``work_rr``: work of each load in
    each step.
    """

    tied: Bordered
    left_nr: np.ndarray
    right_nr: np.ndarray
    met_rk: np.ndarray
    ends_kr: np.ndarray
    work_rr: np.ndarray

    @staticmethod
    def none(tied: Bordered) -> Caused:
        """No loads yet."""
        left_nr, right_nr = _halves(tied, tied.a_d[:, None][:, :0])
        return Caused(tied, left_nr, right_nr, np.zeros((0, 2)), np.zeros((2, 0)), np.zeros((0, 0)))

    @property
    def loads(self) -> int:
        return len(self.work_rr)

    @cached_property
    def under_dk(self) -> np.ndarray:
        """Displacements (n_dof, 2) under the spring that holds the opening and under the load of the specimen."""
        inverse = self.tied.inverse
        held_d = np.zeros_like(inverse.under_load_d) if inverse.hold is None else inverse.hold.under_d
        return np.stack([held_d, inverse.under_load_d], -1)

    def with_loads(self, b_dm: np.ndarray) -> Caused:
        """The same with more loads (n_dof, n_m)."""
        tied, hold = self.tied, self.tied.inverse.hold
        left_nm, right_nm = _halves(tied, b_dm)
        met_mk = b_dm.T @ self.under_dk
        # the spring's row feels the load as the load feels the spring's displacements, which are those of the inverse
        part = 0.0 if hold is None else hold.stiffness / (1.0 + hold.stiffness * float(hold.row_d @ hold.under_d))
        held_m = part * met_mk[:, 0]
        moved_m = self._control_n @ right_nm + float(tied.a_d @ self.under_dk[:, 0]) * held_m
        ends_km = np.stack([held_m, -moved_m / tied.grip])
        left_nr, right_nr = (
            np.concatenate(two, axis=1) for two in ((self.left_nr, left_nm), (self.right_nr, right_nm))
        )
        met_rk, ends_kr = np.concatenate([self.met_rk, met_mk]), np.concatenate([self.ends_kr, ends_km], axis=1)
        above_rm = self.left_nr.T @ right_nm + self.met_rk @ ends_km
        below_mr = left_nm.T @ right_nr + met_mk @ ends_kr
        work_rr = np.concatenate([np.concatenate([self.work_rr, above_rm], axis=1), below_mr])
        more = Caused(tied, left_nr, right_nr, met_rk, ends_kr, work_rr)
        more.__dict__.update(under_dk=self.under_dk, _control_n=self._control_n)
        return more

    def step(self, z_r: np.ndarray) -> np.ndarray:
        """The step (n_dof + 1,) that the loads cause together in these sizes, the change of the load last."""
        ends_k, factors, right_n = self.ends_kr @ z_r, self.tied.inverse.factors, self.right_nr @ z_r
        found_d = factors.whole(right_n[:, None])[:, 0] if isinstance(factors, BandCholesky) else right_n
        return np.append(found_d + self.under_dk @ ends_k, ends_k[1])

    @cached_property
    def _control_n(self) -> np.ndarray:
        """The gradient of the control as a load (n,)."""
        return _halves(self.tied, self.tied.a_d[:, None])[0][:, 0]


def _halves(tied: Bordered, b_dm: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Loads (n_dof, n_m) and displacements under them, or the factors of which both are products."""
    factors = tied.inverse.factors
    if isinstance(factors, BandCholesky):
        half_nm = factors.half(b_dm)
        return half_nm, half_nm
    return b_dm, factors.solve(b_dm) if b_dm.shape[1] else b_dm
