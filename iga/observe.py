"""What is read from a converged state: one row of numbers, by integrals over faces and interface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from iga.basis import BlockBasis
from iga.bulk import gradient
from iga.extraction import Mesh
from iga.interface import Interface, contact, pair
from iga.kinematics import KINEMATICS
from iga.path import Point
from iga.system import Solid, System


@dataclass(frozen=True)
class Arm:
    """One body: its element blocks, the basis on its loaded face, its elasticity matrix."""

    solids: tuple[Solid, ...]
    face: tuple[BlockBasis, ...]
    D: np.ndarray


@dataclass(frozen=True)
class Specimen:
    """A system and what it takes to read it: arms (upper first), meshes, and a probe at the two ends of the interface.

    ``copies`` is 2 where one arm stands for both.
    """

    system: System
    arms: tuple[Arm, ...]
    meshes: tuple[Mesh, ...]
    precrack: float
    upper_is_slave: bool
    copies: float
    probe: Interface


def row(specimen: Specimen, point: Point) -> dict[str, float]:
    """Numbers of one converged point; forces and energies for the whole width, ``face_energy`` per unit width."""
    system, state, response = specimen.system, point.state, point.response
    cohesive, contact_energy, dissipated = (
        float(system.interface.dA_q @ e) for e in system.interface.law.energies(response.contact.g_q, state.k_q)
    )
    reaction_d = np.where(system.free_d, 0.0, response.internal_d - state.load * system.load_d)
    reaction_d += system.spring_forces(state.u_d) @ system.springs_rd
    tip, end = openings(specimen, point)
    slopes = [face_slope(arm, state.u_d) for arm in specimen.arms]
    return {
        "opening": point.opening,
        "load": state.load,
        "crack_length": crack_length(specimen, state.k_q),
        "stored_energy": response.bulk_energy + cohesive + contact_energy,
        "dissipated_energy": dissipated,
        "external_work": point.external_work,
        "newton_iterations": point.iterations,
        "load_slope": point.slope,
        "tip_opening": tip,
        "end_opening": end,
        "face_slope_top": slopes[0],
        "face_slope_bottom": slopes[1] if len(slopes) > 1 else -slopes[0],
        "face_energy": specimen.copies * sum(face_energy(arm, state.u_d, system.kinematics) for arm in specimen.arms),
        **_balance(specimen, point, reaction_d.reshape(-1, 2)),
        "reaction_x": float(reaction_d[0::2].sum()),
        "reaction_y": float(reaction_d[1::2].sum()),
        "bulk_energy": response.bulk_energy,
        "cohesive_energy": cohesive,
        "contact_energy": contact_energy,
    }


def crack_length(specimen: Specimen, k_q: np.ndarray) -> float:
    """Distance from the loaded end to the foremost fully open point, linear between quadrature points."""
    X_q, g_u = specimen.system.interface.X_qi[:, 0], specimen.system.interface.law.g_u
    order = np.argsort(X_q)
    X, k = X_q[order], k_q[order]
    broken = np.flatnonzero(k >= g_u)
    if broken.size == 0:
        return specimen.precrack
    last = broken[-1]
    if last == len(k) - 1:
        return float(X[last])
    return float(X[last] + (X[last + 1] - X[last]) * (k[last] - g_u) / (k[last] - k[last + 1]))


def openings(specimen: Specimen, point: Point) -> tuple[float, float]:
    """Gaps at the end of the precrack and at the far end of the interface."""
    g_q = contact(specimen.probe, point.state.u_d, pair(specimen.probe)).g_q
    return float(g_q[0]), float(g_q[-1])


def face_slope(arm: Arm, u_d: np.ndarray) -> float:
    """Mean of du_y/dX over the loaded face."""
    u_Ai = u_d.reshape(-1, 2)
    total = sum(float(np.sum(gradient(basis, u_Ai)[1, 0] * basis.dV_eq)) for basis in arm.face)
    return total / face_length(arm.face)


def face_energy(arm: Arm, u_d: np.ndarray, kinematics: str) -> float:
    """Integral of the strain energy density over the loaded face, per unit width."""
    u_Ai = u_d.reshape(-1, 2)
    return sum(
        float(np.sum(KINEMATICS[kinematics](arm.D, gradient(basis, u_Ai))[2] * basis.dV_eq)) for basis in arm.face
    )


def face_length(face: tuple[BlockBasis, ...]) -> float:
    return sum(float(basis.dV_eq.sum()) for basis in face)


def mean_row(face: tuple[BlockBasis, ...], component: int, n_dof: int) -> np.ndarray:
    """Row (n_dof,) that gives the mean of one displacement component over a face."""
    row_d = np.zeros(n_dof)
    for basis in face:
        np.add.at(row_d, 2 * basis.conn_ea + component, np.einsum("eqa,eq->ea", basis.N_eqa, basis.dV_eq))
    return row_d / face_length(face)


def _balance(specimen: Specimen, point: Point, support_Ai: np.ndarray) -> dict[str, float]:
    """Force and moment of the interface on the upper arm, and the moment of load and supports there."""
    system, state, touch = specimen.system, point.state, point.response.contact
    interface = system.interface
    moved = 0.0 if system.kinematics == "linear" else 1.0
    x_qi = interface.X_qi + moved * (interface.at_slave(state.u_d.reshape(-1, 2)))
    pull_qi = (point.response.p_q * interface.dA_q)[:, None] * touch.n_qi  # on the master
    if not specimen.upper_is_slave:
        x_qi, pull_qi = x_qi - moved * touch.g_q[:, None] * touch.n_qi, -pull_qi
    face = specimen.arms[0].face
    x_face = sum(float(np.sum(b.X_eqI[..., 0] * b.dV_eq)) for b in face) / face_length(face)
    x_face += moved * float(mean_row(face, 0, system.n_dof) @ state.u_d)
    upper = slice(0, len(specimen.meshes[0].P_AI))
    held_Ai, R_Ai = (interface.P_AI + moved * state.u_d.reshape(-1, 2))[upper], support_Ai[upper]
    return {
        "interface_force": float(pull_qi[:, 1].sum()),
        "load_moment": x_face * state.load + float(np.sum(held_Ai[:, 0] * R_Ai[:, 1] - held_Ai[:, 1] * R_Ai[:, 0])),
        "interface_moment": float(np.sum(x_qi[:, 1] * pull_qi[:, 0] - x_qi[:, 0] * pull_qi[:, 1])),
    }
