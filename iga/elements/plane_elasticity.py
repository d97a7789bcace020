"""Linear plane elasticity on any mesh: tractions on chains of sides, supports, one sparse solve.

K = stiffness(mesh, D)
f_Ai = traction_forces(mesh, chains, lambda X, n: ...)
u_Ai = solve(K, f_Ai, no_rigid_motion(mesh))
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array, csc_array
from scipy.sparse.linalg import splu

from iga.elements.bulk import all_values, element_stiffness, stiffness_entries
from iga.elements.kinematics import elasticity_tensor, of_pairs
from iga.elements.shape_functions import BlockBasis, block_basis, side_bases
from iga.mesh.bezier import homogeneous
from iga.mesh.extraction import Chain, Mesh
from iga.mesh.quadrature import gauss, square


@dataclass(frozen=True)
class Fixed:
    """Displacements ``value_d`` [length] of the degrees of freedom ``dof_d`` = 2 A + i (n_d,)."""

    dof_d: np.ndarray
    value_d: np.ndarray


def bulk_bases(mesh: Mesh, more: int = 0) -> tuple[BlockBasis, ...]:
    """Basis of every block at p + 1 + ``more`` Gauss points per direction, 4 more in rational elements.

    p + 1 integrate polynomial elements exactly, but not rational ones: on a ring of three elements per quadrant the
    error of the patch test is 1e-6 with p + 1, 1e-9 with p + 3 and rounding with p + 5.
    """
    bases = []
    for block in mesh.blocks:
        W_eb = homogeneous(mesh.P_AI, mesh.w_A, block)[..., 2]
        extra = more + 4 * (np.ptp(W_eb) > 1e-12 * np.max(W_eb))
        bases.append(block_basis(mesh, block, *square(*(gauss(p + 1 + extra) for p in block.degrees))))
    return tuple(bases)


def stiffness(mesh: Mesh, D: np.ndarray) -> csc_array:
    """Stiffness matrix (2 n_A, 2 n_A) for an elasticity matrix D (3, 3) [stress], per unit width."""
    bases, A_IpJ = bulk_bases(mesh), of_pairs(elasticity_tensor(D))
    parts = [element_stiffness(b, np.broadcast_to(A_IpJ, (*b.dV_eq.shape, *A_IpJ.shape))) for b in bases]
    entries = [stiffness_entries(b.conn_ea) for b in bases]
    row, column = (np.concatenate([e[k].ravel() for e in entries]) for k in (0, 1))
    n = 2 * len(mesh.P_AI)
    return coo_array((all_values(parts), (row, column)), shape=(n, n)).tocsc()


def traction_forces(
    mesh: Mesh, chains: Sequence[Chain], traction: Callable[[np.ndarray, np.ndarray], np.ndarray]
) -> np.ndarray:
    """Control point forces (n_A, 2) of a traction, a function of position and unit outward normal (..., 2)."""
    parts = []
    for side in side_bases(mesh, chains, 4):
        t_eqi = traction(side.X_eqI, side.n_eqI)
        parts.append((side.conn_ea, np.einsum("eqa,eqi,eq->eai", side.N_eqa, t_eqi, side.dV_eq)))
    return _gathered(len(mesh.P_AI), parts)


def no_rigid_motion(mesh: Mesh) -> Fixed:
    """Three degrees of freedom of two distant control points; loads in equilibrium cause no reactions there."""
    A = int(np.argmin(mesh.P_AI.sum(1)))
    arm = mesh.P_AI - mesh.P_AI[A]
    B = int(np.argmax(np.linalg.norm(arm, axis=1)))
    across = int(np.argmin(np.abs(arm[B])))
    return Fixed(np.array([2 * A, 2 * A + 1, 2 * B + across]), np.zeros(3))


def solve(K: csc_array, f_Ai: np.ndarray, fixed: Fixed) -> np.ndarray:
    """Displacements (n_A, 2) of the control points for control point forces (n_A, 2)."""
    u = np.zeros(f_Ai.size)
    u[fixed.dof_d] = fixed.value_d
    free = np.setdiff1d(np.arange(f_Ai.size), fixed.dof_d)
    load = (f_Ai.ravel() - K @ u)[free]
    ordering = {"permc_spec": "MMD_AT_PLUS_A", "diag_pivot_thresh": 0.0, "options": {"SymmetricMode": True}}
    u[free] = splu(K[free][:, free].tocsc(), **ordering).solve(load)
    return u.reshape(-1, 2)


def _gathered(n_A: int, parts: Sequence[tuple[np.ndarray, np.ndarray]]) -> np.ndarray:
    """Sum of element vectors (n_e, n_a, 2) over the control points (n_A, 2)."""
    A = np.concatenate([conn.ravel() for conn, _ in parts])
    f = np.concatenate([f_eai.reshape(-1, 2) for _, f_eai in parts])
    return np.stack([np.bincount(A, f[:, i], minlength=n_A) for i in (0, 1)], -1)
