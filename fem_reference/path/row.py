"""The row of numbers that is reported of a converged point."""

from __future__ import annotations

import numpy as np
from dolfinx import fem
from mpi4py import MPI

from fem_reference.model.model import Model
from fem_reference.path.control import at, most_open
from fem_reference.path.state import (
    State,
    face_gaps,
    foremost,
    front_line,
    moment,
    opening_at,
    ordered_along,
    resultant,
)
from fem_reference.problem.mixed_law import DAMAGE, MixedLaw
from fem_reference.problem.mode_mix import mix_of


def row(model: Model, state: State) -> dict[str, float]:
    """Row of the curve; forces and energies for the whole width; the same on every rank."""
    bulk, (cohesive, contact, dissipated, *_) = state.bulk, state.bond
    return {
        "opening": state.opening,
        "load": state.load,
        "crack_length": foremost(model, state, model.law.failed),
        "stored_energy": bulk + cohesive + contact,
        "dissipated_energy": dissipated,
        "external_work": state.work,
        "newton_iterations": state.iterations,
        "load_slope": state.slope,
        "heading": state.heading,
        "end_opening": opening_at(model, model.specimen.bond[1]),
        "damage_front": foremost(model, state, model.law.begun),
        "bulk_energy": bulk,
        "cohesive_energy": cohesive,
        "contact_energy": contact,
        **(_of_front(model, state) if model.problem.solid else {}),
        **(_of_sliding(model, model.law, state) if isinstance(model.law, MixedLaw) else _of_opening(model, state)),
    }


def _of_front(model: Model, state: State) -> dict[str, float]:
    """Crack front in the middle of the width, which is a plane of symmetry, and at its edge: a parabola and a straight
    line through the points of the two nearest lines."""
    Z_l, s_l = model.along(model.Z_q)[1][:, 0], front_line(model, state, model.law.failed)
    first, last = ((s_l[1] - s_l[0]) / (Z_l[1] ** 2 - Z_l[0] ** 2), (s_l[-1] - s_l[-2]) / (Z_l[-1] - Z_l[-2]))
    return {
        "front_middle": float(s_l[0] - first * Z_l[0] ** 2),
        "front_edge": float(s_l[-1] + last * (model.specimen.depth - Z_l[-1])),
    }


def front_fields(model: Model, state: State) -> dict[str, np.ndarray]:
    """On the lines along a solid (n_l,): their Z, the place of the crack front and the J-integral of their bond."""
    weight_q, work_q = model.bond.weight_q, _work_by_advance(model, state).sum(1)
    _, Z_lp, weight_lp, work_lp = model.along(model.Z_q, weight_q, weight_q * work_q)
    low, high = sorted(model.specimen.interface)
    G_l = -model.specimen.direction * (high - low) * work_lp.sum(1) / weight_lp.sum(1)
    return {"front_z": Z_lp[:, 0], "front_s": front_line(model, state, model.law.failed), "front_G": G_l}


def _of_opening(model: Model, state: State) -> dict[str, float]:
    """Tip, loaded faces and balance; ``reaction_x`` and ``reaction_y`` are the resultants of support forces and loads.

    Where the opening decreases also the largest penetration at the nodes of the surfaces, the largest contact pressure,
    and where the faces are pressed the gap at the loaded end.
    """
    traction_qi, _ = model.respond(state.g_q, state.k_q)
    bond_force_n, load_n, upper_n = model.bond.force(traction_qi), state.load * model.load_n, model.upper_n
    on_upper_n = upper_n / model.specimen.copies
    reaction_n = (1 - model.free_n) * (model.bulk_force(state.u_n) + bond_force_n - load_n)
    found = {
        "tip_opening": opening_at(model, model.specimen.bond[0]),
        "face_slope_top": model.dot(model.slope_n * upper_n, state.u_n),
        "face_slope_bottom": model.dot(model.slope_n * ~upper_n, state.u_n),
        "face_energy": model.comm.allreduce(fem.assemble_scalar(model.face_energy)),
        "interface_force": -resultant(model, bond_force_n * on_upper_n, 1),
        "reaction_x": resultant(model, reaction_n + load_n, 0),
        "reaction_y": resultant(model, reaction_n + load_n, 1),
        "load_moment": moment(model, state, load_n * on_upper_n),
        "interface_moment": -moment(model, state, bond_force_n * on_upper_n),
    }
    if model.specimen.copies > 1.0:
        found |= {"face_slope_bottom": -found["face_slope_top"], "reaction_y": 0.0}
    if model.problem.solid:
        found["J_bond"] = _by_bond(model, state)[0]
    if model.problem.unloads:
        found["penetration"] = float(np.max(-face_gaps(model, state), initial=0.0))
        found["contact_pressure"] = model.comm.allreduce(float(np.max(-traction_qi, initial=0.0)), MPI.MAX)
    if model.problem.unloads and model.problem.presses:
        found["mouth_opening"] = opening_at(model, model.specimen.facing[0])
    return found


def _of_sliding(model: Model, law: MixedLaw, state: State) -> dict[str, float]:
    """Tip, J-integrals, supports and balance.

    ``J_loads`` and ``J_bond`` are the J-integral by loads and supports and by the bond, ``J_shear`` the part of the
    latter by sliding; ``support_1`` to ``support_n`` the reactions on the specimen, upwards or anticlockwise;
    ``arm_force_x``, ``arm_force_y``, ``arm_moment`` the sum of all that acts on the upper arm, zero in balance;
    ``mode_ratio`` is B where the scaled jump is largest of the points whose damage can still grow.
    """
    J_gap, J_slip = _by_bond(model, state)
    gap, slip = _at_tip(model, state)
    reactions_k = -_pulls(model, state)[model.actions.loads :]
    lowest = model.comm.allreduce(float(np.min(state.g_q[:, 0], initial=0.0)), MPI.MIN)
    return {
        "tip_opening": gap,
        "tip_slip": slip,
        "J_loads": _by_outline(model, state),
        "J_bond": J_gap + J_slip,
        "J_shear": J_slip,
        "mode_ratio": _mode_ratio(model, law, state),
        "friction_energy": state.bond.rubbed,
        **{f"support_{k + 1}": float(reactions_k[k]) for k in range(len(model.specimen.rests))},
        **_on_upper_arm(model, state),
        "penetration": -lowest,
    }


def _at_tip(model: Model, state: State) -> tuple[float, float]:
    """Gap and slip at the tip of the bond, linear between the points on both sides of it."""
    s_q, g_q, slip_q = ordered_along(model, *state.g_q.T)
    tip = model.specimen.distance(model.specimen.bond[0])
    return float(np.interp(tip, s_q, g_q)), float(np.interp(tip, s_q, slip_q))


def _pulls(model: Model, state: State) -> np.ndarray:
    """Forces (n_k,) of the loads, and of the springs with the sign of internal forces."""
    acts = model.actions
    mean_k = model.comm.allreduce(acts.mean_kn @ state.u_n)
    return acts.factor_k * np.where(np.arange(mean_k.size) < acts.loads, state.load, mean_k)


def _by_outline(model: Model, state: State) -> float:
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


def _by_bond(model: Model, state: State) -> tuple[float, ...]:
    """J by opening and by any sliding of the faces: minus the integrals of p dg/dX and t ds/dX, for growth along X."""
    sums_j = model.comm.allreduce(model.bond.weight_q @ _work_by_advance(model, state)) / model.problem.width
    return tuple(-model.specimen.direction * float(J) for J in sums_j)


def _work_by_advance(model: Model, state: State) -> np.ndarray:
    """p dg/dX and, where the bond slides, t ds/dX (n_q, n_j)."""
    traction_qi, _ = model.respond(state.g_q, state.k_q)
    return traction_qi * model.relative(state.u_n).rates(model.bond.slopes(state.u_n))


def _mode_ratio(model: Model, law: MixedLaw, state: State) -> float:
    """B at the point of the largest scaled jump whose damage is not complete; 0 where all is open."""
    alive_q = model.bonded_q & (state.k_q[:, DAMAGE] < 1.0)
    place = most_open(model, np.where(alive_q, model.measure(state.g_q), -np.inf))
    return 0.0 if place is None else at(model, place, mix_of(state.g_q[:, 0], state.g_q[:, 1], law.slope_j).B_q)


def _on_upper_arm(model: Model, state: State) -> dict[str, float]:
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
