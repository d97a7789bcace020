"""Energies of the bond after a step; those that depend on the path are summed over it."""

from __future__ import annotations

import numpy as np
from mpi4py import MPI

from fem_reference.model.model import BondEnergies, Model
from fem_reference.problem.bond_law import DAMAGE, SLIP
from fem_reference.problem.mixed_law import MixedLaw

#: Parts of a step over which the energy released by damage is summed. With 16 parts the error of a step from intact to
#: open is 2e-4. While the crack runs over several process zones points are damaged on a few parts of the step alone.
PARTS_OF_A_STEP, PARTS_OF_A_LEAP = 16, 96

#: Jumps (n_q, n_j) and histories (n_q, n_h) of a state.
OfState = tuple[np.ndarray, np.ndarray]


def energies_after(model: Model, before: OfState, old: BondEnergies, after: OfState) -> BondEnergies:
    """Energies of the bond after a step from a state with the energies ``old``."""
    law, bonded_q = model.law, model.bonded_q

    def total(density_q: np.ndarray) -> float:
        return model.dot(model.bond.weight_q, density_q)

    cohesive_q, contact_q, lost_q = law.balance(*after)
    cohesive, contact = total(np.where(bonded_q, cohesive_q, 0.0)), total(contact_q)
    if lost_q is not None:
        return BondEnergies(cohesive, contact, total(np.where(bonded_q, lost_q, 0.0)))
    assert isinstance(law, MixedLaw)
    lost = total(np.where(bonded_q, _released(model, law, before, after), 0.0))
    rubbed = total(_rubbed(law, before, after))
    released = old.released + lost
    if not law.irreversible:  # the energy of damage is recovered
        cohesive, lost = cohesive + released, 0.0
    return BondEnergies(cohesive, contact, old.dissipated + lost + rubbed, old.rubbed + rubbed, released)


def _released(model: Model, law: MixedLaw, before: OfState, after: OfState) -> np.ndarray:
    """Energy per area (n_q,) released by damage in a step, with the jumps of `_way`."""
    (g_0_qj, k_0_qh), (g_1_qj, k_1_qh) = before, after
    lost_q = np.zeros(len(g_0_qj))
    moves_q = np.flatnonzero(k_1_qh[:, DAMAGE] != k_0_qh[:, DAMAGE])
    run = advance(model, before, after)
    time_m = np.linspace(0.0, 1.0, (PARTS_OF_A_LEAP if run else PARTS_OF_A_STEP) + 1)[:, None]
    half_m = 0.5 * (time_m[1:] + time_m[:-1])
    jump_mqj, middle_mqj = (_way(model, g_0_qj, g_1_qj, run, at_m, moves_q) for at_m in (time_m, half_m))
    if not moves_q.size:
        return lost_q

    def along(start_q: np.ndarray, end_q: np.ndarray, at_m: np.ndarray) -> np.ndarray:
        return (1.0 - at_m) * start_q[moves_q] + at_m * end_q[moves_q]

    d_0_q, d_1_q = k_0_qh[moves_q, DAMAGE], k_1_qh[moves_q, DAMAGE]
    if law.viscosity > 0.0:
        d_mq = along(k_0_qh[:, DAMAGE], k_1_qh[:, DAMAGE], time_m)
    else:
        d_mq = law.driving(*jump_mqj.reshape(-1, 2).T)[0].reshape(jump_mqj.shape[:2])
        if law.irreversible:
            d_mq = np.clip(np.maximum.accumulate(d_mq), d_0_q, d_1_q)
        d_mq[0], d_mq[-1] = d_0_q, d_1_q
    slip_mq = along(k_0_qh[:, SLIP], k_1_qh[:, SLIP], half_m)
    d_half_mq = 0.5 * (d_mq[1:] + d_mq[:-1])
    g_mq, s_mq = middle_mqj.reshape(-1, 2).T
    free_mq = law.release(g_mq, s_mq, d_half_mq.ravel(), slip_mq.ravel())
    lost_q[moves_q] = np.sum(free_mq.reshape(d_half_mq.shape) * np.diff(d_mq, axis=0), axis=0)
    return lost_q


def advance(model: Model, *states: OfState) -> float:
    """How far the foremost broken point has moved in a step, over all ranks; 0 before any is broken.

    ``states`` are jumps and histories before and after it. Where damage stays the history tells, as a crack that
    opens again does not run; a reversible bond has none.
    """
    s_q = np.asarray(model.specimen.distance(model.X_q))
    ends = []
    for g_qj, k_qh in states:
        reached_q = model.law.held(k_qh) if model.law.irreversible else model.measure(g_qj)
        open_q = model.bonded_q & (reached_q >= model.law.failed)
        ends.append(model.comm.allreduce(float(np.max(s_q[open_q], initial=-np.inf)), MPI.MAX))
    return max(ends[1] - ends[0], 0.0) if np.isfinite(ends[0]) else 0.0


def _way(
    model: Model, g_0_qj: np.ndarray, g_1_qj: np.ndarray, run: float, time_m: np.ndarray, q: np.ndarray
) -> np.ndarray:
    """Jumps (m, n, 2) of the points q at the parts time_m (m, 1) of a step: along straight lines where the crack
    stands, and where it runs on those of the profile that travels with it, from that of the start to that of the
    end."""
    if not run:
        return (1.0 - time_m[..., None]) * g_0_qj[q] + time_m[..., None] * g_1_qj[q]
    s_q = np.asarray(model.specimen.distance(model.X_q))
    s_lp, Z_lp, *jump_klp = model.along(model.Z_q, *g_0_qj.T, *g_1_qj.T)
    behind, ahead = s_q[q] - time_m * run, s_q[q] + (1.0 - time_m) * run
    start, end = np.empty((2, *behind.shape, 2))
    for line, s_p in enumerate(s_lp):
        on_q = np.abs(model.Z_q[q] - Z_lp[line, 0]) < model.specimen.near
        for j in (0, 1):
            start[:, on_q, j] = np.interp(behind[:, on_q], s_p, jump_klp[j][line])
            end[:, on_q, j] = np.interp(ahead[:, on_q], s_p, jump_klp[j + 2][line])
    return (1.0 - time_m[..., None]) * start + time_m[..., None] * end


def _rubbed(law: MixedLaw, before: OfState, after: OfState) -> np.ndarray:
    """Energy per area (n_q,) that friction turned into heat in a step, by the trapezoidal rule."""
    (g_0_qj, k_0_qh), (g_1_qj, k_1_qh) = before, after
    per_slip_q = 0.5 * sum(
        law.rubbing(g_qj[:, 0], k_qh[:, DAMAGE]) for g_qj, k_qh in ((g_0_qj, k_0_qh), (g_1_qj, k_1_qh))
    )
    return per_slip_q * np.abs(k_1_qh[:, SLIP] - k_0_qh[:, SLIP])
