"""The row of numbers of a converged point, by integrals over faces and interface.

Components are along and across the specimen, wherever it lies. A bond that slides has some of its own: J-integrals,
mode ratio, supports, balance of an arm.
"""

from __future__ import annotations

import numpy as np

from iga.interface.contact import Slip
from iga.interface.interface import Interface
from iga.interface.response import forces
from iga.output.front import front
from iga.path.point import Point
from iga.specimen.specimen import Specimen


def sliding(specimen: Specimen, point: Point, slip: Slip | None) -> dict[str, float]:
    """Columns of a specimen whose bond slides, with the ``slip`` of the probe; forces for the whole width, J-integrals
    by area."""
    pull, q = point.response.pull, _front(point)
    (g, s), (K, Ks) = pull.jump_qc[q], pull.law.stiffness
    square = K * max(g, 0.0) ** 2 + Ks * s**2
    forces_r = specimen.system.spring_forces(point.state.u_d)[: len(specimen.rollers)]
    return {
        "J_loads": j_of_loads(specimen, point),
        **_of_bond(specimen, point),
        "mode_ratio": float(Ks * s**2 / square) if square > 0.0 else 0.0,
        "friction_energy": point.state.rubbed,
        "tip_slip": 0.0 if slip is None else float(slip.s_q[0]),
        **{f"support_{number}": float(force) for number, force in enumerate(forces_r, start=1)},
        **_on_upper_arm(specimen, point),
    }


def _front(point: Point) -> int:
    """The point with the largest `Response.x_q` among those whose damage grows, or else among those not broken."""
    x_q, tangent, response = point.response.x_q, point.tangent, point.response
    whole_q = response.k_q < 1.0
    among_q = tangent.growing_q if tangent.growing_q.any() else whole_q
    return int(np.argmax(np.where(among_q, x_q, -np.inf)))


def j_of_loads(specimen: Specimen, point: Point) -> float:
    """``J w = - sum F d(u_F)/dX + w int W N_X dY`` over loads, supports and end faces (Rice 1968), dead tractions."""
    system, u_d = specimen.system, point.state.u_d
    width = specimen.width
    shares = [load.share for load in specimen.layout.loads]
    forces_r = system.spring_forces(u_d)
    of_loads = point.state.load * sum(
        share * float(rows.slope_d @ u_d) for share, rows in zip(shares, specimen.loads, strict=True)
    )
    of_supports = sum(float(F * (rows.slope_d @ u_d)) for F, rows in zip(forces_r, specimen.rollers, strict=False))
    return -(of_loads + of_supports) / width - specimen.ends.energy(u_d)


def _of_bond(specimen: Specimen, point: Point) -> dict[str, float]:
    """``J = - int (p dg/dX + t ds/dX) dX``, and the part of it that comes from the slip."""
    interface, response = specimen.system.interface, point.response
    found = interface.slopes(point.state.u_d, response.contact)
    if found is None:
        return {}
    (dg_q, ds_q), dX_q = found, (1.0 if specimen.upper_is_slave else -1.0) * interface.dA_q / specimen.width
    of_slip = -float(dX_q @ (response.pull.t_q * ds_q))
    return {"J_bond": of_slip - float(dX_q @ (response.p_q * dg_q)), "J_shear": of_slip}


def _on_upper_arm(specimen: Specimen, point: Point) -> dict[str, float]:
    """Sums of all forces on the upper arm, and of their moments about the origin: zero in balance.

    Moments are those of the deformed body, with linear kinematics of the undeformed one.
    """
    system, pose, state, upper = specimen.system, specimen.pose, point.state, specimen.bodies[0].points
    of_bond_d = forces(system.interface, point.response.contact, point.response.pull, system.n_dof)
    of_springs_d = system.spring_forces(state.u_d) @ system.springs_rd
    force_Ai = pose.components(pose.vectors(state.load * system.load_d + of_springs_d - of_bond_d)[upper])
    x_Ai = specimen.places[1]
    if not system.linear:
        x_Ai = x_Ai + pose.components(pose.vectors(state.u_d)[upper])
    force_x, force_y, *_ = force_Ai.sum(0)
    moment = np.sum(x_Ai[:, 0] * force_Ai[:, 1] - x_Ai[:, 1] * force_Ai[:, 0])
    return {"arm_force_x": float(force_x), "arm_force_y": float(force_y), "arm_moment": float(moment)}


def row(specimen: Specimen, point: Point) -> dict[str, float]:
    """Numbers of one converged point; forces and energies for the whole width, ``face_energy`` per unit width.

    ``reaction_x`` and ``reaction_y`` are the forces of springs and clamps besides the resultant of the loads.
    """
    system, state, energies, law = specimen.system, point.state, point.energies, specimen.system.interface.law
    reached_q = np.where(system.interface.bonded_q, point.response.back_q, 0.0)
    spring_Ai = specimen.pose.vectors(system.spring_forces(state.u_d) @ system.springs_rd)
    reaction_x, reaction_y, *_ = specimen.pose.components(spring_Ai.sum(0))
    met = point.response.contact.pairing
    start = specimen.probe.pairing if met is None else met[specimen.beside_probe]
    probed = specimen.probe.contact(state.u_d, start)  # of a solid in the middle of its width
    slopes = [float(row_d @ state.u_d) for row_d in specimen.slope_rows]
    return {
        "opening": point.opening,
        "load": state.load,
        "crack_length": reach(specimen, reached_q, law.kinks[-1]),
        "stored_energy": energies.stored,
        "dissipated_energy": energies.dissipated,
        "external_work": point.external_work,
        "newton_iterations": point.iterations,
        "load_slope": point.slope,
        "heading": point.heading,
        "residual": point.residual,
        "tip_opening": float(probed.g_q[0]),
        "end_opening": float(probed.g_q[-1]),
        "damage_front": reach(specimen, reached_q, law.kinks[0]),
        "face_slope_top": slopes[0],
        "face_slope_bottom": slopes[1] if len(slopes) > 1 else -slopes[0],
        "face_energy": specimen.ends.energy(state.u_d),
        **(sliding(specimen, point, probed.slip) if system.interface.slides else _balance(specimen, point, spring_Ai)),
        "reaction_x": float(reaction_x),
        "reaction_y": float(reaction_y),
        **({} if system.free_d.all() or specimen.pose.d == 3 else _clamp(specimen, point, spring_Ai)),
        **(_across(specimen, point) if specimen.pose.d == 3 else {}),
        "bulk_energy": energies.bulk,
        "cohesive_energy": energies.cohesive,
        "contact_energy": energies.contact,
        **({} if specimen.faces is None else _closing(specimen, specimen.faces, point)),
    }


def reach(specimen: Specimen, k_q: np.ndarray, limit: float) -> float:
    """Distance from the loaded end to the foremost point opened to ``limit``, linear between quadrature points."""
    s, order = specimen.ordered
    k = k_q[order]
    beyond = np.flatnonzero(k >= limit)
    if beyond.size == 0:
        return specimen.layout.free_length
    last = beyond[-1]
    onward = 0.0 if last == len(k) - 1 else (s[last + 1] - s[last]) * (k[last] - limit) / (k[last] - k[last + 1])
    # lumped points are control points, and those of splines may lie before the tip of the bond
    return max(float(s[last] + onward), specimen.layout.free_length)


def _across(specimen: Specimen, point: Point) -> dict[str, float]:
    """What a solid has of its front: lengths are means over the width."""
    first, *_, last = specimen.system.interface.law.kinks
    crack = front(specimen, point, last)
    middle, edge = crack.ends
    return {
        "crack_length": crack.mean,
        "damage_front": front(specimen, point, first).mean,
        "front_middle": middle,
        "front_edge": edge,
        "J_bond": float(crack.part_k @ crack.G_k),
    }


def _closing(specimen: Specimen, faces: Interface, point: Point) -> dict[str, float]:
    """Largest penetration of the faces, also between the points of the interface, and largest contact pressure.

    Where the bodies may touch beyond the bond also the gap at the end of the faces next to the load.
    """
    touch = faces.contact(point.state.u_d, faces.pairing)
    found = {
        "penetration": max(0.0, -float(np.min(touch.g_q, where=touch.on_q, initial=0.0))),
        "contact_pressure": max(0.0, -float(np.min(point.response.p_q))),
    }
    if not specimen.system.interface.all_bonded:
        found["mouth_opening"] = float(touch.g_q[np.argmin(specimen.distance(faces.X_qi))])
    return found


def _balance(specimen: Specimen, point: Point, spring_Ai: np.ndarray) -> dict[str, float]:
    """Force and moment of the interface on the upper body, and the moment of load and springs on it.

    Moments are those of the deformed body, with linear kinematics of the undeformed one.
    """
    system, u_d, touch, pose = specimen.system, point.state.u_d, point.response.contact, specimen.pose
    interface, upper = system.interface, specimen.bodies[0]
    moved = 0.0 if system.linear else 1.0
    x_qi, x_Ai = specimen.places
    if moved:
        u_Ai = pose.components(pose.vectors(u_d))
        x_qi, x_Ai = x_qi + interface.at_slave(u_Ai), x_Ai + u_Ai[upper.points]
    n_qi = pose.components(touch.n_qi)
    pull_qi = (point.response.p_q * interface.dA_q)[:, None] * n_qi  # on the master
    if not specimen.upper_is_slave:
        x_qi, pull_qi = x_qi - moved * touch.g_q[:, None] * n_qi, -pull_qi
    x_face = specimen.layout.loaded_at + moved * float(specimen.face_row @ u_d)
    return {
        "interface_force": float(pull_qi[:, 1].sum()),
        "load_moment": x_face * point.state.load + _cross(x_Ai, pose.components(spring_Ai[upper.points])),
        "interface_moment": _cross(pull_qi, x_qi),  # on the upper body, which is pulled the other way
    }


def _clamp(specimen: Specimen, point: Point, spring_Ai: np.ndarray) -> dict[str, float]:
    """Reactions without the load, moment of the clamp, and axial forces of tractions and springs on the upper body."""
    system, state, pose, touch = specimen.system, point.state, specimen.pose, point.response.contact
    fixed_Ai = pose.components(np.where(system.free_d, 0.0, point.response.internal_d).reshape(-1, 2))
    spring_Ai, load_Ai = pose.components(spring_Ai), pose.components(state.load * system.load_d.reshape(-1, 2))
    reaction_x, reaction_y = np.sum(spring_Ai + fixed_Ai + load_Ai, axis=0)
    pull = float((point.response.p_q * system.interface.dA_q) @ pose.components(touch.n_qi)[:, 0])  # on the master
    return {
        "reaction_x": float(reaction_x),
        "reaction_y": float(reaction_y),
        "clamp_moment": _cross(pose.own(system.interface.P_AI), fixed_Ai),
        "interface_pull": -pull if specimen.upper_is_slave else pull,
        "anchor_pull": float(spring_Ai[specimen.bodies[0].points, 0].sum()),
    }


def _cross(a_ni: np.ndarray, b_ni: np.ndarray) -> float:
    """Sum of ``a x b``; for places and forces (n, 2) it is the moment about the origin, anticlockwise."""
    return float(np.sum(a_ni[:, 0] * b_ni[:, 1] - a_ni[:, 1] * b_ni[:, 0]))
