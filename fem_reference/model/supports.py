"""Supports, tie and point loads of a specimen as conditions, functionals and forces on its unknowns."""

from __future__ import annotations

import numpy as np
from dolfinx import fem
from mpi4py import MPI
from petsc4py import PETSc

from fem_reference.model.assembled import owned
from fem_reference.model.mesh import entities_on
from fem_reference.problem.specimen import UPPER, Region, Specimen

#: Upper and lower body, or the upper one alone.
Displacement = tuple[fem.Function, ...]


def supports(specimen: Specimen, displacement: Displacement) -> tuple[tuple[fem.DirichletBC, ...], np.ndarray]:
    """Boundary conditions of the supports, and a mask (n,) of the owned unknowns: 1 free, 0 supported."""
    bcs, free = [], [np.ones(owned(u)) for u in displacement]
    for held in specimen.held:
        u = displacement[held.body]
        for i in held.components:
            dofs = dofs_on(u, held.place, specimen.near, i)
            bcs.append(fem.dirichletbc(PETSc.ScalarType(0.0), dofs, u.function_space.sub(i)))
            free[held.body][dofs[dofs < owned(u)]] = 0.0
    return tuple(bcs), np.concatenate(free)


def tie(specimen: Specimen, displacement: Displacement) -> np.ndarray:
    """Elongation of the tie times the square root of its stiffness, as a functional (n,) of the owned unknowns."""
    parts = [np.zeros(owned(u)) for u in displacement]
    for hook in specimen.hooks:
        u = displacement[hook.body]
        dofs = dofs_on(u, hook.place, specimen.near, 0)
        parts[hook.body][dofs[dofs < owned(u)]] += hook.factor
    return np.concatenate(parts)


def point_load(
    specimen: Specimen, at: str, displacement: Displacement, X_nI: np.ndarray, comm: MPI.Intracomm
) -> np.ndarray:
    """Forces (n,) of a unit load at one node of each loaded face: its corner away from the interface, or its middle.

    Raises
    ------
    ValueError : there is no node in the middle.
    """
    load_n, upper_n = np.zeros(len(X_nI)), np.arange(len(X_nI)) < owned(displacement[0])
    for face in (face for face in specimen.faces if face.load != 0.0):
        Y = specimen.bodies[face.body].Y
        outer = Y[np.argmax(np.abs(Y))]
        place = np.array([face.X, outer if at == "node" else 0.5 * outer])
        there_n = (np.max(np.abs(X_nI - place), axis=1) < specimen.near) & (upper_n == (face.body == UPPER))
        there_n[::2] = False  # x
        if comm.allreduce(int(there_n.sum())) == 0:
            raise ValueError(
                'load_at: must be "face" or "node" where no node is in the middle of the face; an even degree, or an '
                "even number of elements across, has one"
            )
        load_n[there_n] = face.load
    return load_n


def dofs_on(u: fem.Function, place: Region, near: float, component: int) -> np.ndarray:
    """Local unknowns (owned or ghost) of one component at a vertex or on a side of a body; may be empty on a rank."""
    dim = sum(low < high for low, high in place) + u.function_space.mesh.topology.dim - len(place)
    entities = entities_on(u.function_space.mesh, dim, place, near)
    return fem.locate_dofs_topological(u.function_space.sub(component), dim, entities)
