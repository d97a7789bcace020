"""Two elastic bodies pressed on each other: linear elasticity in the bulk, contact alone between them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from plane_elasticity import Fixed
from plane_elasticity import stiffness as bulk_stiffness
from scipy.sparse import block_diag, coo_array
from scipy.sparse.linalg import splu

from iga.interface.contact import Contact
from iga.interface.interface import Interface, settled
from iga.interface.response import Tractions, forces, stiffness, traction
from iga.interface.surface import surface
from iga.laws.laws import ShapedLaw
from iga.mesh.extraction import Mesh
from iga.mesh.quadrature import gauss
from iga.specimen.bond import between, everywhere

ITERATIONS = 40


@dataclass(frozen=True)
class Pressed:
    """Displacements u_d (n_dof,), the contact there, and pressures p_q (n_q,), positive where the bodies press."""

    interface: Interface
    u_d: np.ndarray
    touch: Contact
    p_q: np.ndarray
    iterations: int


def loose(
    slave: int, meshes: Sequence[Mesh], faces: Sequence[str], penalty: float, points: int, stays: bool
) -> Interface:
    """Contact without cohesion between the faces of two meshes, numbered one after the other; partners may stay."""
    first = (0, len(meshes[0].P_AI))
    both = [surface(mesh, mesh.chains[face], start) for mesh, face, start in zip(meshes, faces, first, strict=True)]
    law = ShapedLaw.opening(strength=1.0, toughness=1.0, ductility=2.0, penalty=penalty)
    P_AI = np.concatenate([mesh.P_AI for mesh in meshes])
    ours, theirs = both[slave], both[1 - slave]
    interface = between(ours, theirs, P_AI, law, everywhere(np.arange(ours.sides), gauss(points)))
    interface = replace(interface, bonded_q=np.zeros(interface.points, dtype=bool))
    return settled(interface) if stays else interface


def press(
    interface: Interface,
    meshes: Sequence[Mesh],
    D: Sequence[np.ndarray],
    f_d: np.ndarray,
    fixed: Fixed,
) -> Pressed:
    """Equilibrium under forces f_d (n_dof,) and prescribed displacements, by Newton with the complete tangent."""
    K = block_diag([bulk_stiffness(mesh, D_) for mesh, D_ in zip(meshes, D, strict=True)]).tocsc()
    u_d = np.zeros(f_d.size)
    u_d[fixed.dof_d] = fixed.value_d
    past, pairing = interface.start(), interface.pairing
    is_free = np.ones(f_d.size, dtype=bool)
    is_free[fixed.dof_d] = False
    free = np.flatnonzero(is_free)

    def respond(u_d: np.ndarray) -> tuple[np.ndarray, np.ndarray, Contact, Tractions]:
        touch = interface.contact(u_d, pairing)
        pull = traction(interface, touch, past, touch.g_q <= 0.0)
        held_d = forces(interface, touch, pull, u_d.size)
        return np.where(is_free, K @ u_d + held_d - f_d, 0.0), held_d, touch, pull

    residual_d, held_d, touch, pull = respond(u_d)
    for iteration in range(ITERATIONS):
        if iteration and np.linalg.norm(residual_d) < 1e-10 * np.linalg.norm(held_d):
            return Pressed(interface, u_d, touch, -pull.p_q, iteration)
        d_qd, K_qdd = touch.dof_qd, stiffness(interface, touch, pull)
        row, column = np.broadcast_arrays(d_qd[:, :, None], d_qd[:, None, :])
        tangent = K + coo_array((K_qdd.ravel(), (row.ravel(), column.ravel())), shape=K.shape).tocsc()
        step_d = np.zeros(u_d.size)
        step_d[free] = -splu(tangent[free][:, free].tocsc()).solve(residual_d[free])
        work = abs(step_d @ residual_d)
        for part in 0.5 ** np.arange(6):  # until less work is left along the step than there was
            residual_d, held_d, touch, pull = respond(u_d + part * step_d)
            if abs(step_d @ residual_d) < 0.9 * work:
                break
        u_d, pairing = u_d + part * step_d, touch.pairing
    raise AssertionError(f"no equilibrium in {ITERATIONS} iterations")
