"""The row of numbers that is reported of a converged point where the bond carries shear."""

from __future__ import annotations

import numpy as np
from dolfinx import fem
from mpi4py import MPI

from fem_reference.model.mixed import DAMAGE, MixedModel
from fem_reference.path.control import at, most_open
from fem_reference.path.state import State, foremost, moment, opening_at, ordered_along, resultant
from fem_reference.problem.mode_mix import mix_of


def mixed_row(model: MixedModel, state: State) -> dict[str, float]:
    """Row of the curve for a converged point; forces and energies for the whole width; the same on every rank.

    ``J_loads`` and ``J_bond`` are the J-integral by loads and supports and by the bond, ``J_shear`` the part of the
    latter by sliding; ``support_1`` to ``support_n`` the reactions on the specimen, upwards or anticlockwise;
    ``arm_force_x``, ``arm_force_y``, ``arm_moment`` the sum of all that acts on the upper arm, zero in balance;
    ``mode_ratio`` is B where the scaled jump is largest of the points whose damage can still grow.
    """
    J_gap, J_slip = _by_bond(model, state)
    gap, slip = _at_tip(model, state)
    reactions_k = -_pulls(model, state)[model.actions.loads :]
    supports = len(model.specimen.rests)
    lowest = model.comm.allreduce(float(np.min(state.g_q[:, 0], initial=0.0)), MPI.MIN)
    return {
        "opening": state.opening,
        "load": state.load,
        "crack_length": foremost(model, state, model.failure),
        "stored_energy": state.bulk + state.bond.cohesive + state.bond.contact,
        "dissipated_energy": state.bond.dissipated,
        "external_work": state.work,
        "newton_iterations": state.iterations,
        "load_slope": state.slope,
        "heading": state.heading,
        "tip_opening": gap,
        "end_opening": opening_at(model, model.specimen.bond[1]),
        "tip_slip": slip,
        "damage_front": foremost(model, state, model.onset),
        "J_loads": _by_outline(model, state),
        "J_bond": J_gap + J_slip,
        "J_shear": J_slip,
        "mode_ratio": _mode_ratio(model, state),
        "friction_energy": state.bond.rubbed,
        **{f"support_{k + 1}": float(reactions_k[k]) for k in range(supports)},
        **_on_upper_arm(model, state),
        "bulk_energy": state.bulk,
        "cohesive_energy": state.bond.cohesive,
        "contact_energy": state.bond.contact,
        "penetration": -lowest,
    }


def _at_tip(model: MixedModel, state: State) -> tuple[float, float]:
    """Gap and slip at the tip of the bond, linear between the points on both sides of it."""
    s_q, g_q, slip_q = ordered_along(model, *state.g_q.T)
    tip = model.specimen.distance(model.specimen.bond[0])
    return float(np.interp(tip, s_q, g_q)), float(np.interp(tip, s_q, slip_q))


def _pulls(model: MixedModel, state: State) -> np.ndarray:
    """Forces (n_k,) of the loads, and of the springs with the sign of internal forces."""
    acts = model.actions
    mean_k = model.comm.allreduce(acts.mean_kn @ state.u_n)
    return acts.factor_k * np.where(np.arange(mean_k.size) < acts.loads, state.load, mean_k)


def _by_outline(model: MixedModel, state: State) -> float:
    """J by loads and supports: that of the outer contour, with the work of dead tractions on the slope of their faces.

    J = - sum F mean(du/dX) / width + energy on the end faces, for growth along X (Rice 1968, J. Appl. Mech. 35, 379).
    """
    acts, specimen = model.actions, model.specimen
    force_k = _pulls(model, state)
    force_k[acts.loads :] *= -1.0
    slopes = float(force_k @ model.comm.allreduce(acts.slope_kn @ state.u_n))
    signs_n = np.where(model.upper_n, np.sign(specimen.loads[0]), np.sign(specimen.loads[1]))
    slopes += state.load * model.dot(signs_n * model.slope_n, state.u_n)
    ends = model.comm.allreduce(fem.assemble_scalar(model.face_energy))
    return -specimen.direction * slopes / model.problem.width - ends


def _by_bond(model: MixedModel, state: State) -> tuple[float, float]:
    """J by opening and by sliding of the faces: minus the integrals of p dg/dX and t ds/dX, for growth along X."""
    traction_qi, _, _ = model.respond(state.g_q, state.k_q)
    dz_qja, z_X_qa = model.relative(state.u_n).dz_qja, model.bond.slopes(state.u_n)
    J_qj = traction_qi * np.einsum("qja,qa->qj", dz_qja, z_X_qa)
    sums_j = model.comm.allreduce(model.bond.weight_q @ J_qj) / model.problem.width
    return -model.specimen.direction * float(sums_j[0]), -model.specimen.direction * float(sums_j[1])


def _mode_ratio(model: MixedModel, state: State) -> float:
    """B at the point of the largest scaled jump whose damage is not complete; 0 where all is open."""
    alive_q = model.bonded_q & (state.k_q[:, DAMAGE] < 1.0)
    place = most_open(model, np.where(alive_q, model.measure(state.g_q), -np.inf))
    return 0.0 if place is None else at(model, place, mix_of(state.g_q[:, 0], state.g_q[:, 1], model.law.slope_j).B_q)


def _on_upper_arm(model: MixedModel, state: State) -> dict[str, float]:
    """Sums of the forces of loads, supports and the bond on the upper arm."""
    inside_n = model.bond_force(state.u_n, state.k_q) + model.spring_force(state.u_n)
    outside_n = state.load * model.load_n - inside_n
    held_n = (1 - model.free_n) * (model.bulk_force(state.u_n) - outside_n)
    force_n = (outside_n + held_n) * model.upper_n
    return {
        "arm_force_x": resultant(model, force_n, 0),
        "arm_force_y": resultant(model, force_n, 1),
        "arm_moment": moment(model, state, force_n),
    }
