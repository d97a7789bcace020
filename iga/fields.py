"""Fields at a converged point, sampled for pictures."""

from __future__ import annotations

import numpy as np

from iga.basis import block_basis
from iga.bulk import gradient
from iga.kinematics import cauchy_stress
from iga.observe import Specimen
from iga.path import Point

#: Sample intervals along each direction of an element.
INTERVALS = 3


def snapshot(specimen: Specimen, point: Point) -> dict[str, object]:
    """Interface profile, ordered along the specimen, and one grid of samples an element.

    Keys: opening, load; s_q, gap_q, traction_q, damage_q (n_q,); X_euvi, u_euvi (n_e, k+1, k+1, 2) and stress_euv
    (n_e, k+1, k+1), the Cauchy stress sigma_xx, with k = `INTERVALS`.
    """
    system, state, response = specimen.system, point.state, point.response
    interface = system.interface
    order = np.argsort(interface.X_qi[:, 0])
    grids = [_grids(specimen, number, state.u_d) for number in range(len(specimen.meshes))]
    X, u, stress = (np.concatenate([grid[i] for grid in grids]) for i in range(3))
    return {
        "opening": point.opening,
        "load": state.load,
        "s_q": interface.X_qi[order, 0],
        "gap_q": response.contact.g_q[order],
        "traction_q": response.p_q[order],
        "damage_q": interface.law.damage(state.k_q[order]),
        "X_euvi": X,
        "u_euvi": u,
        "stress_euv": stress,
    }


def _grids(specimen: Specimen, number: int, u_d: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    mesh, arm = specimen.meshes[number], specimen.arms[number]
    first = sum(len(other.P_AI) for other in specimen.meshes[:number])
    u_Ai = u_d.reshape(-1, 2)[first : first + len(mesh.P_AI)]
    t, s = np.meshgrid(*[np.linspace(0.0, 1.0, INTERVALS + 1)] * 2, indexing="ij")
    points_q = np.stack([s.ravel(), t.ravel()], -1)
    parts = []
    for block in mesh.blocks:
        basis = block_basis(mesh, block, points_q, np.ones(len(points_q)))
        u_eqi = np.einsum("eqa,eai->eqi", basis.N_eqa, u_Ai[basis.conn_ea])
        stress_eq = cauchy_stress(arm.D, gradient(basis, u_Ai), specimen.system.kinematics)[0, 0]
        parts.append((basis.X_eqI, u_eqi, stress_eq))
    shape = (-1, INTERVALS + 1, INTERVALS + 1)
    X, u, stress = (np.concatenate([part[i] for part in parts]) for i in range(3))
    return X.reshape(*shape, 2), u.reshape(*shape, 2), stress.reshape(shape)
