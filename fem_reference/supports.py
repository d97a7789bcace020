"""What holds the specimen, and where it is among the unknowns."""

from __future__ import annotations

import numpy as np
from dolfinx import fem, mesh
from petsc4py import PETSc

from fem_reference.assembled import owned
from fem_reference.mesh import TwoBodies
from fem_reference.problem import Problem

Displacement = tuple[fem.Function, fem.Function]


def supports(
    problem: Problem, bodies: TwoBodies, displacement: Displacement
) -> tuple[tuple[fem.DirichletBC, ...], np.ndarray]:
    """Conditions at the far end of the bond: each arm is held in x, the lower one also in y.

    Returns the conditions, and for every owned unknown 1 where it is free and 0 where it is held.
    """
    bcs, free = [], []
    for u, body, components in zip(displacement, (bodies.upper, bodies.lower), ((0,), (0, 1)), strict=True):
        free_n = np.ones(owned(u))
        for i in components:
            dofs = dofs_at(u, body.mesh, problem, (problem.length, 0.0), i)
            bcs.append(fem.dirichletbc(PETSc.ScalarType(0.0), dofs, u.function_space.sub(i)))
            free_n[dofs[dofs < owned(u)]] = 0.0
        free.append(free_n)
    return tuple(bcs), np.concatenate(free)


def tie(problem: Problem, bodies: TwoBodies, displacement: Displacement) -> np.ndarray:
    """A spring between u_x of the upper and u_x of the lower far corner: elongation times the root of its stiffness.

    It is a functional (n,) of the owned unknowns. The supports are hinges at one point, about which the whole specimen
    turns freely. The spring holds it and carries nothing: by itself it could not balance about the hinge, and the loads
    have no moment while one loaded face is above the other, which is where both corners move alike.
    """
    stiffness = problem.E1 * problem.width
    parts = []
    for u, body, sign in zip(displacement, (bodies.upper, bodies.lower), (1.0, -1.0), strict=True):
        dofs = dofs_at(u, body.mesh, problem, (problem.length, sign * problem.arm_thickness), 0)
        part_n = np.zeros(owned(u))
        part_n[dofs[dofs < owned(u)]] = sign * np.sqrt(stiffness)
        parts.append(part_n)
    return np.concatenate(parts)


def dofs_at(u: fem.Function, body: mesh.Mesh, problem: Problem, X_I: tuple[float, float], component: int) -> np.ndarray:
    """Unknowns (owned or ghost) of one component at a vertex of a body; empty where this rank has none."""
    body.topology.create_connectivity(0, 2)
    near = 1e-6 * min(problem.arm_thickness / problem.elements_across, problem.length / problem.elements)
    vertices = mesh.locate_entities(body, 0, lambda x: (np.abs(x[0] - X_I[0]) < near) & (np.abs(x[1] - X_I[1]) < near))
    return fem.locate_dofs_topological(u.function_space.sub(component), 0, vertices)
