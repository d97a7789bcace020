"""What is read from a converged state: one row of numbers, by integrals over faces and interface.

Components are along and across the specimen, wherever it lies.
"""

from __future__ import annotations

import numpy as np

from iga.elements.bulk import energy, gradient, relative
from iga.elements.kinematics import KINEMATICS
from iga.interface.interface import Interface, contact
from iga.path.point import Point
from iga.specimen.specimen import Specimen


def row(specimen: Specimen, point: Point) -> dict[str, float]:
    """Numbers of one converged point; forces and energies for the whole width, ``face_energy`` per unit width.

    ``reaction_x`` and ``reaction_y`` are what springs and clamps carry besides the resultant of the loads.
    """
    system, state, energies = specimen.system, point.state, point.energies
    held_Ai = (system.spring_forces(state.u_d) @ system.springs_rd).reshape(-1, 2)
    reaction_x, reaction_y = specimen.pose.components(held_Ai.sum(0))
    tip, end = openings(specimen, point)
    slopes = [float(row_d @ state.u_d) for row_d in specimen.slope_rows]
    return {
        "opening": point.opening,
        "load": state.load,
        "crack_length": reach(specimen, state.k_q, system.interface.law.g_u),
        "stored_energy": energies.stored,
        "dissipated_energy": energies.dissipated,
        "external_work": point.external_work,
        "newton_iterations": point.iterations,
        "load_slope": point.slope,
        "heading": point.heading,
        "tip_opening": tip,
        "end_opening": end,
        "damage_front": reach(specimen, state.k_q, system.interface.law.g_max),
        "face_slope_top": slopes[0],
        "face_slope_bottom": slopes[1] if len(slopes) > 1 else -slopes[0],
        "face_energy": face_energy(specimen, state.u_d),
        **_balance(specimen, point, held_Ai),
        "reaction_x": float(reaction_x),
        "reaction_y": float(reaction_y),
        **({} if system.free_d.all() else _clamp(specimen, point, held_Ai)),
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
    # control points as points: those of splines reach back over the tip of the bond
    return max(float(s[last] + onward), specimen.layout.free_length)


def openings(specimen: Specimen, point: Point) -> tuple[float, float]:
    """Gaps at the tip of the bond and at its far end."""
    probe, met = specimen.probe, point.response.contact.pairing
    if probe.at_rest is not None:
        g_q = probe.at_rest.gaps(point.state.u_d)
    else:
        start = probe.pairing if probe.pairing is None or met is None else met[specimen.beside_probe]
        g_q = contact(probe, point.state.u_d, start).g_q
    return float(g_q[0]), float(g_q[-1])


def _closing(specimen: Specimen, faces: Interface, point: Point) -> dict[str, float]:
    """How deep the faces are in each other, between the interface's points as well, and what pushes them apart.

    Where they may touch beyond the bond, the gap at the end of the faces next to the load as well.
    """
    interface = specimen.system.interface
    if faces.at_rest is not None:
        g_q, on_q = faces.at_rest.gaps(point.state.u_d), faces.at_rest.on_q
    else:
        touch = contact(faces, point.state.u_d, faces.pairing)
        g_q, on_q = touch.g_q, touch.on_q
    return {
        "penetration": max(0.0, -float(np.min(g_q, where=on_q, initial=0.0))),
        "contact_pressure": max(0.0, -float(np.min(point.response.p_q))),
        **(
            {}
            if interface.bonded_q is None
            else {"mouth_opening": float(g_q[np.argmin(specimen.distance(faces.X_qi))])}
        ),
    }


def face_energy(specimen: Specimen, u_d: np.ndarray) -> float:
    """Strain energy on the end faces as the J-integral counts it, per unit width."""
    kinematics, u_Ai, doubled = specimen.system.kinematics, u_d.reshape(-1, 2), 0.0
    if kinematics == "linear":
        for side, K in zip(specimen.energy_sides, specimen.energy_matrices, strict=True):
            u_ed = relative(side.basis.conn_ea, u_Ai).reshape(len(K), -1, 1)
            doubled += float(np.sum(u_ed * (K @ u_ed)))
        return 0.5 * doubled
    stress = KINEMATICS[kinematics].stress
    return sum(energy(side.basis, stress(side.D, gradient(side.basis, u_Ai))[1]) for side in specimen.energy_sides)


def _balance(specimen: Specimen, point: Point, support_Ai: np.ndarray) -> dict[str, float]:
    """Force and moment of the interface on the upper body, and the moment of load and supports there."""
    system, state, touch, pose = specimen.system, point.state, point.response.contact, specimen.pose
    interface, upper = system.interface, specimen.bodies[0]
    moved = 0.0 if system.kinematics == "linear" else 1.0
    x_qi, held_Ai = specimen.places  # where tractions and supports act: with linear kinematics where nothing has moved
    if moved:
        u_Ai = pose.components(state.u_d.reshape(-1, 2))
        x_qi, held_Ai = x_qi + interface.at_slave(u_Ai), held_Ai + u_Ai[upper.points]
    n_qi = pose.components(touch.n_qi)
    pull_qi = (point.response.p_q * interface.dA_q)[:, None] * n_qi  # on the master
    if not specimen.upper_is_slave:
        x_qi, pull_qi = x_qi - moved * touch.g_q[:, None] * n_qi, -pull_qi
    x_face = specimen.layout.loaded_at + moved * float(specimen.face_row @ state.u_d)
    R_Ai = pose.components(support_Ai[upper.points])
    return {
        "interface_force": float(pull_qi[:, 1].sum()),
        "load_moment": x_face * state.load + float(np.sum(held_Ai[:, 0] * R_Ai[:, 1] - held_Ai[:, 1] * R_Ai[:, 0])),
        "interface_moment": float(np.sum(x_qi[:, 1] * pull_qi[:, 0] - x_qi[:, 0] * pull_qi[:, 1])),
    }


def _clamp(specimen: Specimen, point: Point, held_Ai: np.ndarray) -> dict[str, float]:
    """Reactions less the load, moment of the clamp, and what acts lengthwise on the upper body: tractions, springs."""
    system, state, pose, touch = specimen.system, point.state, specimen.pose, point.response.contact
    fixed_Ai = pose.components(np.where(system.free_d, 0.0, point.response.internal_d).reshape(-1, 2))
    held_Ai, load_Ai = pose.components(held_Ai), pose.components(state.load * system.load_d.reshape(-1, 2))
    reaction_x, reaction_y = np.sum(held_Ai + fixed_Ai + load_Ai, axis=0)
    P_Ai = pose.own(system.interface.P_AI)
    pull = float((point.response.p_q * system.interface.dA_q) @ pose.components(touch.n_qi)[:, 0])  # on the master
    return {
        "reaction_x": float(reaction_x),
        "reaction_y": float(reaction_y),
        "clamp_moment": float(np.sum(P_Ai[:, 0] * fixed_Ai[:, 1] - P_Ai[:, 1] * fixed_Ai[:, 0])),
        "interface_pull": -pull if specimen.upper_is_slave else pull,
        "anchor_pull": float(held_Ai[specimen.bodies[0].points, 0].sum()),
    }
