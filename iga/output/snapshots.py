"""Fields at a converged point, sampled for pictures."""

from __future__ import annotations

import numpy as np

from iga.elements.bulk import Solid, gradient
from iga.path.point import Point
from iga.specimen.body import ELEMENT_SAMPLES
from iga.specimen.specimen import Specimen


def snapshot(specimen: Specimen, point: Point) -> dict[str, object]:
    """Interface profile, ordered along the specimen, and one grid of samples an element, in the specimen's own frame.

    Keys: opening, load; s_q, gap_q, traction_q, damage_q (n_q,); X_euvi, u_euvi (n_e, k+1, k+1, 2) and stress_euv
    (n_e, k+1, k+1), the Cauchy stress along it, with k = `ELEMENT_SAMPLES`; of T-splines the edges line_nki (n, 2, 2)
    and T-junctions junction_ni (n, 2) of the T-meshes.
    """
    system, state, response = specimen.system, point.state, point.response
    interface = system.interface
    s, order = specimen.ordered
    u_Ai, sampled = state.u_d.reshape(-1, 2), zip(specimen.sampled, specimen.sampled_places, strict=True)
    grids = [_grid(specimen, solid, X_eqi, u_Ai) for solid, X_eqi in sampled]
    X, u, stress = (np.concatenate([grid[i] for grid in grids]) for i in range(3))
    return {
        "opening": point.opening,
        "load": state.load,
        "s_q": s,
        "gap_q": response.contact.g_q[order],
        "traction_q": response.p_q[order],
        "damage_q": np.where(interface.bonded_q, interface.law.damage(state.k_q), 1.0)[order],
        "X_euvi": X,
        "u_euvi": u,
        "stress_euv": stress,
        **_tmesh(specimen),
    }


def _tmesh(specimen: Specimen) -> dict[str, np.ndarray]:
    """Edges and T-junctions of the T-meshes, if any."""
    meshes = specimen.drawn.tmeshes
    if not meshes:
        return {}
    return {
        "line_nki": np.concatenate([mesh.edges() for mesh in meshes]),
        "junction_ni": np.concatenate(
            [np.stack([m.knots_i[m.junctions[:, 0]], m.knots_j[m.junctions[:, 1]]], -1) for m in meshes]
        ),
    }


def _grid(
    specimen: Specimen, solid: Solid, X_eqi: np.ndarray, u_Ai: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    basis, pose, shape = solid.basis, specimen.pose, (-1, ELEMENT_SAMPLES + 1, ELEMENT_SAMPLES + 1)
    u_eqi = pose.components(basis.N_eqa @ u_Ai.take(basis.conn_ea, axis=0))
    sigma = specimen.system.bulk.kinematics.cauchy(solid.D, gradient(basis, u_Ai))
    stress = np.outer(pose.axes_kI[0], pose.axes_kI[0]).ravel() @ sigma.reshape(4, -1)
    return X_eqi.reshape(*shape, 2), u_eqi.reshape(*shape, 2), stress.reshape(shape)
