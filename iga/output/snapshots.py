"""Fields at a converged point, sampled for pictures."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from iga.elements.bulk import Solid, gradient
from iga.output.front import front
from iga.path.point import Point
from iga.specimen.body import ELEMENT_SAMPLES
from iga.specimen.specimen import Specimen


@dataclass(frozen=True)
class Snapshot:
    """Interface profile, ordered along the specimen, and one grid of samples an element, in the specimen's own frame.

    ``s_q``, ``gap_q``, ``traction_q``, ``damage_q`` (n_q,): distance from the loaded end, normal gap, normal traction
    and damage from 0 to 1. ``X_euvi``, ``u_euvi`` (n_e, k+1, k+1, 2) and ``stress_euv`` (n_e, k+1, k+1): places,
    displacements and the Cauchy stress along the specimen, with k = `ELEMENT_SAMPLES`. ``line_nki`` (n, 2, 2) and
    ``junction_ni`` (n, 2): edges and T-junctions of the T-meshes; empty for other bases. Those of a solid are in the
    middle of its width; ``front_z``, ``front_s``, ``front_G`` (n_k,) are its front (see `iga.output.front.Front`).
    """

    opening: float
    load: float
    s_q: np.ndarray
    gap_q: np.ndarray
    traction_q: np.ndarray
    damage_q: np.ndarray
    X_euvi: np.ndarray
    u_euvi: np.ndarray
    stress_euv: np.ndarray
    line_nki: np.ndarray
    junction_ni: np.ndarray
    front_z: np.ndarray
    front_s: np.ndarray
    front_G: np.ndarray

    def _repr_html_(self) -> str:
        from iga.notebook import drawn, grids

        text = f"{len(self.X_euvi)} elements, deformed, at opening {self.opening:.4g} under load {self.load:.4g}"
        return drawn(grids(self.X_euvi + self.u_euvi), text)


def snapshot(specimen: Specimen, point: Point) -> Snapshot:
    """The fields of a converged point."""
    system, state, response = specimen.system, point.state, point.response
    interface = system.interface
    (s, order), across = specimen.ordered, np.zeros((3, 0))
    if specimen.pose.d == 3:
        line = front(specimen, point, interface.law.kinks[-1])
        across = np.stack([line.z_k, line.s_k, line.G_k])
        middle = specimen.places[0][order, 2] <= line.z_k[0] * (1.0 + 1e-6)
        s, order = s[middle], order[middle]
    u_Ai, sampled = specimen.pose.vectors(state.u_d), zip(specimen.sampled, specimen.sampled_places, strict=True)
    grids = [_grid(specimen, solid, X_eqi, u_Ai) for solid, X_eqi in sampled]
    X, u, stress = (np.concatenate([grid[i] for grid in grids]) for i in range(3))
    tmeshes = specimen.drawn.tmeshes
    places = [np.stack([m.knots_i[m.junctions[:, 0]], m.knots_j[m.junctions[:, 1]]], -1) for m in tmeshes]
    return Snapshot(
        opening=point.opening,
        load=state.load,
        s_q=s,
        gap_q=response.contact.g_q[order],
        traction_q=response.p_q[order],
        damage_q=np.where(interface.bonded_q, interface.law.damage(state.k_q), 1.0)[order],
        X_euvi=X,
        u_euvi=u,
        stress_euv=stress,
        line_nki=np.concatenate([np.zeros((0, 2, 2)), *(mesh.edges() for mesh in tmeshes)]),
        junction_ni=np.concatenate([np.zeros((0, 2)), *places]),
        front_z=across[0],
        front_s=across[1],
        front_G=across[2],
    )


def _grid(
    specimen: Specimen, solid: Solid, X_eqi: np.ndarray, u_Ai: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    basis, pose, shape = solid.basis, specimen.pose, (-1, ELEMENT_SAMPLES + 1, ELEMENT_SAMPLES + 1)
    u_eqi = pose.components(basis.N_eqa @ u_Ai.take(basis.conn_ea, axis=0))
    sigma = specimen.system.bulk.kinematics.cauchy(solid.D, gradient(basis, u_Ai))
    stress = np.outer(pose.axes_kI[0], pose.axes_kI[0]).ravel() @ sigma.reshape(pose.d**2, -1)
    X_eqi, u_eqi = X_eqi[..., :2], u_eqi[..., :2]
    return X_eqi.reshape(*shape, 2), u_eqi.reshape(*shape, 2), stress.reshape(shape)
