"""The assembled model in mode I: gaps, tractions along the undeformed normal, and the largest gap as history."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from petsc4py import PETSc

from fem_reference.model.model import BondEnergies, Model
from fem_reference.problem.law import Law


@dataclass(frozen=True)
class OpeningModel(Model):
    """A model whose bond carries normal tractions only; jumps and histories are gaps (n_q,)."""

    law: Law

    def jump(self, u_n: np.ndarray) -> np.ndarray:
        """Normal opening (n_q,)."""
        return self.bond.of(u_n)[:, 0]

    def bond_force(self, u_n: np.ndarray, k_q: np.ndarray) -> np.ndarray:
        """Internal forces (n,) of the bond, at the supports too; ``k_q`` is the committed history."""
        p_q, _ = self.traction(self.jump(u_n), k_q)
        return self.bond.force(p_q[:, None])

    def traction(self, g_q: np.ndarray, k_q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Traction and slope (n_q,) each: those of `Law.traction` where bonded, elsewhere only contact."""
        carries_q = self.bonded_q | ((g_q < 0.0) & self.law.contact)
        p_q, dp_q = self.law.traction(g_q, k_q)
        return np.where(carries_q, p_q, 0.0), np.where(carries_q, dp_q, 0.0)

    def history(self, g_q: np.ndarray, k_q: np.ndarray) -> np.ndarray:
        """Largest gap (n_q,) so far, the present gap included; 0 where nothing is bonded."""
        return np.where(self.bonded_q, self.law.history(g_q, k_q), 0.0)

    def damage(self, k_q: np.ndarray) -> np.ndarray:
        """d (n_q,); 1 where nothing is bonded."""
        return np.where(self.bonded_q, self.law.damage(k_q), 1.0)

    def bond_fields(self, g_q: np.ndarray, k_q: np.ndarray) -> dict[str, np.ndarray]:
        """Fields of the bond for snapshots and frames, (n_q,) each."""
        p_q, _ = self.traction(g_q, k_q)
        return {"gap_q": g_q, "traction_q": p_q, "damage_q": self.damage(k_q), "history_q": k_q}

    def bond_tangent(self, u_n: np.ndarray, k_q: np.ndarray) -> PETSc.Mat:
        """Derivative of `bond_force` by the displacements, zero at supports; valid until the next call."""
        _, dp_q = self.traction(self.jump(u_n), k_q)
        return self.bond.tangent(dp_q[:, None, None])

    @property
    def onset(self) -> float:
        """The measure of a jump at which damage begins."""
        return self.law.g_peak

    @property
    def failure(self) -> float:
        """The measure of a jump from which a point is open."""
        return self.law.g_open

    @property
    def unit(self) -> float:
        """Unit in which steps of the front's measure are measured."""
        return self.law.g_open

    def intact(self) -> np.ndarray:
        """The history before anything has moved."""
        return np.zeros_like(self.X_q)

    def held(self, k_q: np.ndarray) -> np.ndarray:
        """The measure (n_q,) beyond which damage grows again."""
        return k_q

    def measure(self, g_q: np.ndarray) -> np.ndarray:
        """The measure (n_q,) of a jump, which is the gap."""
        return g_q

    def rates(self, u_n: np.ndarray, rate_n: np.ndarray) -> np.ndarray:
        """Change (n_q,) of the measure with a change of the displacements."""
        return self.bond.of(rate_n)[:, 0]

    def measure_row(self, u_n: np.ndarray, share_q: np.ndarray) -> np.ndarray:
        """Change of the measures, weighted with ``share_q``, as a functional (n,) of the changes of displacement."""
        return self.bond.spread(share_q)

    def level(self, measure: float, row_n: np.ndarray, u_n: np.ndarray) -> float:
        """Value of the functional ``row_n`` of `measure_row`: the gap is linear in the displacements."""
        return measure

    def energies_after(
        self, before: tuple[np.ndarray, np.ndarray, BondEnergies], g_q: np.ndarray, k_q: np.ndarray
    ) -> BondEnergies:
        """Energies of the bond after a step; ``before`` are jumps, history and energies at its start."""
        return BondEnergies(*self.bond_energies(g_q, k_q))

    def bond_energies(self, g_q: np.ndarray, k_q: np.ndarray) -> tuple[float, float, float]:
        """Energies recoverable from cohesion, stored in contact, dissipated; over all ranks."""
        recoverable_q, contact_q, lost_q = self.law.energies(g_q, k_q)
        parts = np.where(self.bonded_q, recoverable_q, 0.0), contact_q, np.where(self.bonded_q, lost_q, 0.0)
        recoverable, contact, lost = (self.dot(self.bond.weight_q, part_q) for part_q in parts)
        return recoverable, contact, lost
