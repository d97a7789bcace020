"""Linear plane elasticity on any mesh: tractions, body forces, supports, one sparse solve.

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

from iga.elements.bulk import element_stiffness, full_matrices
from iga.elements.kinematics import small_moduli
from iga.elements.shape_functions import BlockBasis, SideBasis, block_basis, chain_basis
from iga.mesh.bezier import homogeneous
from iga.mesh.extraction import Chain, Mesh
from iga.mesh.quadrature import gauss, square

#: A vector field: positions (..., 2) to values (..., 2).
Field = Callable[[np.ndarray], np.ndarray]


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
    n, values, rows, columns = 2 * len(mesh.P_AI), [], [], []
    for basis in bulk_bases(mesh):
        K = full_matrices(element_stiffness(basis, small_moduli(D, np.zeros((2, 2, *basis.dV_eq.shape)))))
        dof_ed = (2 * basis.conn_ea[..., None] + np.arange(2)).reshape(len(K), -1)
        row, column = np.broadcast_arrays(dof_ed[:, :, None], dof_ed[:, None])
        values, rows, columns = [*values, K.ravel()], [*rows, row.ravel()], [*columns, column.ravel()]
    row, column = np.concatenate(rows), np.concatenate(columns)
    return coo_array((np.concatenate(values), (row, column)), shape=(n, n)).tocsc()


def side_bases(mesh: Mesh, chains: Sequence[Chain], more: int) -> tuple[SideBasis, ...]:
    """Bases on the sides of some chains at p + 1 + ``more`` Gauss points, p the highest degree of the mesh."""
    rule = gauss(max(max(block.degrees) for block in mesh.blocks) + 1 + more)
    return tuple(basis for chain in chains for basis in chain_basis(mesh, chain, *rule))


def traction_forces(
    mesh: Mesh, chains: Sequence[Chain], traction: Callable[[np.ndarray, np.ndarray], np.ndarray]
) -> np.ndarray:
    """Control point forces (n_A, 2) of a traction, a function of position and unit outward normal (..., 2)."""
    parts = []
    for side in side_bases(mesh, chains, 4):
        t_eqi = traction(side.X_eqI, side.n_eqI)
        parts.append((side.conn_ea, np.einsum("eqa,eqi,eq->eai", side.N_eqa, t_eqi, side.dV_eq)))
    return gathered(len(mesh.P_AI), parts)


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


def together(*parts: Fixed) -> Fixed:
    """All of them; where two fix the same degree of freedom, the first counts."""
    dof_d, first = np.unique(np.concatenate([part.dof_d for part in parts]), return_index=True)
    return Fixed(dof_d, np.concatenate([part.value_d for part in parts])[first])


def prescribed(mesh: Mesh, chains: Sequence[Chain], displacement: Field) -> Fixed:
    """Displacements on chains by projection in L2 onto the functions that live there."""
    sides = side_bases(mesh, chains, 2)
    rows, columns, values = [], [], []
    for side in sides:
        row, column = np.broadcast_arrays(side.conn_ea[:, :, None], side.conn_ea[:, None, :])
        rows.append(row.ravel())
        columns.append(column.ravel())
        values.append(np.einsum("eqa,eqb,eq->eab", side.N_eqa, side.N_eqa, side.dV_eq).ravel())
    n_A = len(mesh.P_AI)
    entries = (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns)))
    mass = coo_array(entries, shape=(n_A, n_A)).tocsc()
    parts = [(s.conn_ea, np.einsum("eqa,eqi,eq->eai", s.N_eqa, displacement(s.X_eqI), s.dV_eq)) for s in sides]
    A = living(sides)
    u_Ai = splu(mass[A][:, A]).solve(gathered(n_A, parts)[A])
    return Fixed((2 * A[:, None] + np.arange(2)).ravel(), u_Ai.ravel())


def symmetry(mesh: Mesh, chain: Chain) -> Fixed:
    """No displacement normal to a straight chain along an axis."""
    sides = side_bases(mesh, (chain,), 1)
    n = np.concatenate([np.abs(s.n_eqI).reshape(-1, 2) for s in sides])
    component = int(np.argmax(n.sum(0)))
    assert np.max(n[:, 1 - component]) < 1e-8, "a symmetry line runs along an axis"
    dof = 2 * living(sides) + component
    return Fixed(dof, np.zeros(dof.size))


def living(sides: Sequence[SideBasis]) -> np.ndarray:
    """Control points (n,) whose functions do not vanish on the sides."""
    return np.unique(np.concatenate([s.conn_ea[np.max(np.abs(s.N_eqa), axis=1) > 1e-10] for s in sides]))


def gathered(n_A: int, parts: Sequence[tuple[np.ndarray, np.ndarray]]) -> np.ndarray:
    """Sum of element vectors (n_e, n_a, 2) over the control points (n_A, 2)."""
    f_Ai = np.zeros((n_A, 2))
    for conn_ea, f_eai in parts:
        np.add.at(f_Ai, conn_ea, f_eai)
    return f_Ai
