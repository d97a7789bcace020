"""The assembled model where the bond carries shear: jumps of two components, histories of damage and friction."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from fem_reference.model.frame import Relative, relative
from fem_reference.model.model import BondEnergies, Model
from fem_reference.problem.mixed_law import MixedLaw

#: Parts of a step over which the energy released by damage is summed. With 16 parts the error of a step from intact to
#: open is 2e-4. While the crack runs over several process zones points are damaged on a few parts of the step alone.
PARTS_OF_A_STEP, PARTS_OF_A_LEAP = 16, 96

#: Columns of the history: damage d, slip of friction, and the scaled jump beyond which damage grows again.
DAMAGE, SLIP, HELD = range(3)


@dataclass(frozen=True)
class MixedModel(Model):
    """A model with opening and sliding: jumps (n_q, 2) are gap and slip, histories (n_q, 3) see `DAMAGE`.

    Where nothing is bonded damage is 1 from the start, so that only contact and friction act. ``dt`` is the time of the
    step in durations of the programme; only viscosity needs it.
    """

    law: MixedLaw
    dt: float = 0.0

    @property
    def onset(self) -> float:
        """Scaled jump at which damage begins."""
        return 1.0

    @property
    def failure(self) -> float:
        """Scaled jump from which a point is open."""
        return 2.0

    @property
    def unit(self) -> float:
        """Unit in which steps of the front's scaled jump are measured."""
        return 1.0

    @property
    def timed(self) -> bool:
        """Whether the bond is viscous."""
        return self.law.viscosity > 0.0

    def in_time(self, way: float) -> Model:
        """The model for a step of ``way`` in the opening."""
        goals = np.concatenate([[0.0], self.problem.opening])
        return replace(self, dt=abs(way) / float(np.sum(np.abs(np.diff(goals)))))

    def intact(self) -> np.ndarray:
        """The history before anything has moved."""
        k_qh = np.zeros((self.X_q.size, 3))
        k_qh[~self.bonded_q, DAMAGE] = 1.0
        return k_qh

    def relative(self, u_n: np.ndarray) -> Relative:
        """Gap and slip at all points with their derivatives."""
        return relative(self.bond.of(u_n))

    def jump(self, u_n: np.ndarray) -> np.ndarray:
        """Gap and slip (n_q, 2)."""
        return self.relative(u_n).jump_qj

    def respond(self, jump_qj: np.ndarray, k_qh: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Tractions (n_q, 2), their slopes (n_q, 2, 2) and the history (n_q, 2) of damage and slip after the step."""
        arguments = jump_qj[:, 0], jump_qj[:, 1], k_qh[:, DAMAGE], k_qh[:, SLIP], self.dt
        p_q, t_q, D_qij, d_q, slip_q = self.law.traction(*arguments)
        traction_qi, history_qh = np.stack([p_q, t_q], -1), np.stack([d_q, slip_q], -1)
        if not self.law.irreversible:  # what is not bonded stays open
            p_q, t_q, open_qij, d_q, slip_q = replace(self.law, irreversible=True).traction(*arguments)
            bonded_qi = self.bonded_q[:, None]
            traction_qi = np.where(bonded_qi, traction_qi, np.stack([p_q, t_q], -1))
            history_qh = np.where(bonded_qi, history_qh, np.stack([d_q, slip_q], -1))
            D_qij = np.where(bonded_qi[:, None], D_qij, open_qij)
        return traction_qi, D_qij, history_qh

    def bond_force(self, u_n: np.ndarray, k_q: np.ndarray) -> np.ndarray:
        """Internal forces (n,) of the bond, at the supports too; ``k_q`` is the committed history."""
        at = self.relative(u_n)
        traction_qi, _, _ = self.respond(at.jump_qj, k_q)
        return self.bond.force(np.einsum("qj,qja->qa", traction_qi, at.dz_qja))

    def bond_tangent(self, u_n: np.ndarray, k_q: np.ndarray) -> PETSc.Mat:
        """Derivative of `bond_force` by the displacements, zero at supports; valid until the next call."""
        at = self.relative(u_n)
        traction_qi, D_qij, _ = self.respond(at.jump_qj, k_q)
        H_qab = at.dz_qja.swapaxes(1, 2) @ D_qij @ at.dz_qja + np.einsum("qj,qjab->qab", traction_qi, at.dz_qjab)
        return self.bond.tangent(H_qab)

    def history(self, g_q: np.ndarray, k_q: np.ndarray) -> np.ndarray:
        """Histories (n_q, 3) after a step to the jumps ``g_q`` (n_q, 2)."""
        _, _, new_qh = self.respond(g_q, k_q)
        r_q, _ = self.law.reach(*g_q.T)
        d_q, held_q = new_qh[:, DAMAGE], k_q[:, HELD]
        held_q = np.where(d_q > k_q[:, DAMAGE], r_q, np.where(d_q < 1.0, held_q, np.maximum(held_q, r_q)))
        return np.column_stack([new_qh, np.where(self.bonded_q, held_q, 0.0)])

    def damage(self, k_q: np.ndarray) -> np.ndarray:
        """d (n_q,); 1 where nothing is bonded."""
        return k_q[:, DAMAGE]

    def bond_fields(self, g_q: np.ndarray, k_q: np.ndarray) -> dict[str, np.ndarray]:
        """Fields of the bond for snapshots and frames, (n_q,) each; slip_q and shear_q: jump and traction along X."""
        traction_qi, _, _ = self.respond(g_q, k_q)
        (gap_q, slip_q), (p_q, t_q) = g_q.T, traction_qi.T
        of_damage = {"damage_q": self.damage(k_q), "history_q": self.held(k_q)}
        return {"gap_q": gap_q, "traction_q": p_q, **of_damage, "slip_q": slip_q, "shear_q": t_q}

    def held(self, k_q: np.ndarray) -> np.ndarray:
        """Scaled jump (n_q,) beyond which damage grows again, 0 before it has grown."""
        return k_q[:, HELD]

    def measure(self, g_q: np.ndarray) -> np.ndarray:
        """Scaled jump (n_q,)."""
        return self.law.reach(*g_q.T)[0]

    def rates(self, u_n: np.ndarray, rate_n: np.ndarray) -> np.ndarray:
        """Change (n_q,) of the measure with a change of the displacements."""
        return np.einsum("qa,qa->q", self._measure_slope(u_n), self.bond.of(rate_n))

    def measure_row(self, u_n: np.ndarray, share_q: np.ndarray) -> np.ndarray:
        """Change of the measures, weighted with ``share_q``, as a functional (n,) of the changes of displacement."""
        return self.bond.spread(share_q[:, None] * self._measure_slope(u_n))

    def level(self, measure: float, row_n: np.ndarray, u_n: np.ndarray) -> float:
        """Value of the functional ``row_n`` of `measure_row` at the displacements."""
        return self.dot(row_n, u_n)

    def _measure_slope(self, u_n: np.ndarray) -> np.ndarray:
        at = self.relative(u_n)
        return np.einsum("qj,qja->qa", self.law.reach(*at.jump_qj.T)[1], at.dz_qja)

    def energies_after(
        self, before: tuple[np.ndarray, np.ndarray, BondEnergies], g_q: np.ndarray, k_q: np.ndarray
    ) -> BondEnergies:
        """Energies of the bond after a step; ``before`` are jumps, history and energies at its start."""
        g_old_q, k_old_q, old = before
        cohesive_q, contact_q, stuck_q = self.law.energies(*g_q.T, *k_q.T[:HELD])
        bonded_q, total = self.bonded_q, self._total
        lost = total(np.where(bonded_q, self._released((g_old_q, k_old_q), (g_q, k_q)), 0.0))
        rubbed = total(self._rubbed((g_old_q, k_old_q), (g_q, k_q)))
        cohesive, contact = total(np.where(bonded_q, cohesive_q, 0.0)), total(contact_q + stuck_q)
        released = old.released + lost
        if not self.law.irreversible:  # the energy of damage is recovered
            cohesive, lost = cohesive + released, 0.0
        return BondEnergies(cohesive, contact, old.dissipated + lost + rubbed, old.rubbed + rubbed, released)

    def _total(self, density_q: np.ndarray) -> float:
        return self.dot(self.bond.weight_q, density_q)

    def _released(self, before: tuple[np.ndarray, np.ndarray], after: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
        """Energy per area (n_q,) released by damage in a step, with the jumps of `_way`."""
        (g_0_qj, k_0_qh), (g_1_qj, k_1_qh) = before, after
        lost_q = np.zeros(len(g_0_qj))
        moves_q = np.flatnonzero(k_1_qh[:, DAMAGE] != k_0_qh[:, DAMAGE])
        run = self._run(before, after)
        time_m = np.linspace(0.0, 1.0, (PARTS_OF_A_LEAP if run else PARTS_OF_A_STEP) + 1)[:, None]
        half_m = 0.5 * (time_m[1:] + time_m[:-1])
        jump_mqj, middle_mqj = (self._way(g_0_qj, g_1_qj, run, at_m, moves_q) for at_m in (time_m, half_m))
        if not moves_q.size:
            return lost_q

        def along(start_q: np.ndarray, end_q: np.ndarray, at_m: np.ndarray) -> np.ndarray:
            return (1.0 - at_m) * start_q[moves_q] + at_m * end_q[moves_q]

        d_0_q, d_1_q = k_0_qh[moves_q, DAMAGE], k_1_qh[moves_q, DAMAGE]
        if self.law.viscosity > 0.0:
            d_mq = along(k_0_qh[:, DAMAGE], k_1_qh[:, DAMAGE], time_m)
        else:
            d_mq = self.law.driving(*jump_mqj.reshape(-1, 2).T)[0].reshape(jump_mqj.shape[:2])
            if self.law.irreversible:
                d_mq = np.clip(np.maximum.accumulate(d_mq), d_0_q, d_1_q)
            d_mq[0], d_mq[-1] = d_0_q, d_1_q
        slip_mq = along(k_0_qh[:, SLIP], k_1_qh[:, SLIP], half_m)
        d_half_mq = 0.5 * (d_mq[1:] + d_mq[:-1])
        g_mq, s_mq = middle_mqj.reshape(-1, 2).T
        free_mq = self.law.release(g_mq, s_mq, d_half_mq.ravel(), slip_mq.ravel())
        lost_q[moves_q] = np.sum(free_mq.reshape(d_half_mq.shape) * np.diff(d_mq, axis=0), axis=0)
        return lost_q

    def _run(self, *states: tuple[np.ndarray, np.ndarray]) -> float:
        """How far the foremost broken point has moved in a step, over all ranks; 0 before any is broken.

        ``states`` are jumps and histories before and after it. Where damage stays the history tells, as a crack that
        opens again does not run; a reversible bond has none.
        """
        s_q = np.asarray(self.specimen.distance(self.X_q))
        ends = []
        for g_qj, k_qh in states:
            reached_q = self.held(k_qh) if self.law.irreversible else self.measure(g_qj)
            open_q = self.bonded_q & (reached_q >= self.failure)
            ends.append(self.comm.allreduce(float(np.max(s_q[open_q], initial=-np.inf)), MPI.MAX))
        return max(ends[1] - ends[0], 0.0) if np.isfinite(ends[0]) else 0.0

    def _way(self, g_0_qj: np.ndarray, g_1_qj: np.ndarray, run: float, time_m: np.ndarray, q: np.ndarray) -> np.ndarray:
        """Jumps (m, n, 2) of the points q at the parts time_m (m, 1) of a step: along straight lines where the crack
        stands, and where it runs on those of the profile that travels with it, from that of the start to that of the
        end."""
        if not run:
            return (1.0 - time_m[..., None]) * g_0_qj[q] + time_m[..., None] * g_1_qj[q]
        s_q = np.asarray(self.specimen.distance(self.X_q))
        s_n, jump_nk = (np.concatenate(self.comm.allgather(a)) for a in (s_q, np.hstack([g_0_qj, g_1_qj])))
        order = np.argsort(s_n)
        s_n, jump_nk = s_n[order], jump_nk[order]
        behind, ahead = s_q[q] - time_m * run, s_q[q] + (1.0 - time_m) * run
        start, end = (
            np.stack([np.interp(at, s_n, jump_nk[:, k]) for k in columns], -1)
            for at, columns in ((behind, (0, 1)), (ahead, (2, 3)))
        )
        return (1.0 - time_m[..., None]) * start + time_m[..., None] * end

    def _rubbed(self, before: tuple[np.ndarray, np.ndarray], after: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
        """Energy per area (n_q,) that friction turned into heat in a step, by the trapezoidal rule."""
        (g_0_qj, k_0_qh), (g_1_qj, k_1_qh) = before, after
        per_slip_q = 0.5 * sum(
            self.law.rubbing(g_qj[:, 0], k_qh[:, DAMAGE]) for g_qj, k_qh in ((g_0_qj, k_0_qh), (g_1_qj, k_1_qh))
        )
        return per_slip_q * np.abs(k_1_qh[:, SLIP] - k_0_qh[:, SLIP])
