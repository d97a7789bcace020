"""Errors of a plane solution against an exact field."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from iga.elements.bulk import gradient
from iga.elements.kinematics import small_stress
from iga.elements.plane_elasticity import bulk_bases
from iga.mesh.extraction import Mesh
from verify.theory.plane_fields import PlaneField


@dataclass(frozen=True)
class Errors:
    """Relative errors: displacement in L2, stress in the energy norm, largest stress error over largest stress."""

    displacement: float
    energy: float
    stress: float


def errors(mesh: Mesh, D: np.ndarray, u_Ai: np.ndarray, exact: PlaneField, up_to_rigid: bool = False) -> Errors:
    """Errors by p + 3 or more Gauss points per direction.

    Parameters
    ----------
    D : (3, 3) elasticity matrix of the numerical solution.
    u_Ai : (n_A, 2) its control displacements.
    up_to_rigid : subtract the rigid motion from the difference, as tractions alone do not determine it.
    """
    parts: list[tuple[np.ndarray, ...]] = []
    for basis in bulk_bases(mesh, 2):
        sigma_ijeq = small_stress(D, gradient(basis, u_Ai))[0]
        exact_ijeq = np.moveaxis(exact.stress(basis.X_eqI), (2, 3), (0, 1))
        u_eqi = exact.displacement(basis.X_eqI)
        miss_eqi = np.einsum("eqa,eai->eqi", basis.N_eqa, u_Ai[basis.conn_ea]) - u_eqi
        vectors = (v.reshape(-1, 2) for v in (u_eqi, miss_eqi, basis.X_eqI))
        tensors = (t.reshape(4, -1).T for t in (exact_ijeq, sigma_ijeq - exact_ijeq))
        parts.append((*vectors, *tensors, basis.dV_eq.ravel()))
    u, miss, X, stress_qk, gap_qk, dV = (np.concatenate(part) for part in zip(*parts, strict=True))
    stress, gap = stress_qk.T, gap_qk.T
    if up_to_rigid:
        u, miss = (_without_rigid_motion(v, X, dV) for v in (u, miss))
    return Errors(
        float(np.sqrt(np.sum(miss**2 * dV[:, None]) / np.sum(u**2 * dV[:, None]))),
        float(np.sqrt(_energy(gap, D, dV) / _energy(stress, D, dV))),
        float(np.max(np.abs(gap)) / np.max(np.abs(stress))),
    )


def _energy(stress_kq: np.ndarray, D: np.ndarray, dV: np.ndarray) -> float:
    voigt = stress_kq[[0, 3, 1]]
    return float(np.sum(voigt * np.linalg.solve(D, voigt) * dV))


def _without_rigid_motion(u: np.ndarray, X: np.ndarray, dV: np.ndarray) -> np.ndarray:
    """The field minus its L2 projection onto translations and the rotation about the centre."""
    x = X - dV @ X / dV.sum()
    turn = np.stack([-x[:, 1], x[:, 0]], -1)
    return u - dV @ u / dV.sum() - turn * (np.sum(turn * u, 1) @ dV) / (np.sum(turn**2, 1) @ dV)
