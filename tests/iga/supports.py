"""Supports and body forces of plane elasticity, for solutions that are known."""

from collections.abc import Callable, Sequence

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.linalg import splu

from iga.elements.plane_elasticity import Fixed, bulk_bases
from iga.elements.shape_functions import SideBasis, side_bases
from iga.mesh.extraction import Chain, Mesh

#: A vector field: positions (..., 2) to values (..., 2).
Field = Callable[[np.ndarray], np.ndarray]


def together(*parts: Fixed) -> Fixed:
    """All of them; where two fix the same degree of freedom, the first counts."""
    dof_d, first = np.unique(np.concatenate([part.dof_d for part in parts]), return_index=True)
    return Fixed(dof_d, np.concatenate([part.value_d for part in parts])[first])


def body_forces(mesh: Mesh, force: Field) -> np.ndarray:
    """Control point forces (n_A, 2) of a force per volume."""
    parts = [(b.conn_ea, np.einsum("eqa,eqi,eq->eai", b.N_eqa, force(b.X_eqI), b.dV_eq)) for b in bulk_bases(mesh, 2)]
    return gathered(len(mesh.P_AI), parts)


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
