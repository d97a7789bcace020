"""A problem as a model: mesh, spaces, compiled forms and matrices."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from dolfinx import fem
from mpi4py import MPI
from petsc4py import PETSc

from fem_reference.dolfinx_api import add_block_matrix, compile_forms, create_block_matrix
from fem_reference.model.assembled import BlockVector, owned
from fem_reference.model.bond import Bond
from fem_reference.model.forms import BondForms, WeakForm, bond_forms, displacements, weak_form
from fem_reference.model.linear import Factorisation, outer, widened, without_zeros
from fem_reference.model.mesh import two_bodies
from fem_reference.model.model import Model, Phase
from fem_reference.model.outline import action_rows
from fem_reference.model.supports import point_load, supports, tie
from fem_reference.problem.problem import Debonding


def build_model(problem: Debonding, phase: Phase, comm: MPI.Intracomm) -> Model:
    """Mesh, spaces, compiled forms and matrices of a problem.

    Raises
    ------
    ValueError : a point load without a node.
    """
    specimen = problem.specimen()
    with phase("mesh"):
        bodies = two_bodies(specimen, comm)
    with phase("basis"):
        displacement = displacements(bodies, problem.degree)
        weak = weak_form(problem, specimen, bodies, displacement)
    with phase("compile"):
        bulk = compile_forms(weak.bulk, weak.maps)
        internal, load, slope = (_vector(blocks, weak) for blocks in (weak.internal, weak.load, weak.slope))
        energy, face_energy = compile_forms([weak.energy, weak.face_energy], weak.maps)
        actions = action_rows(specimen, bodies, displacement, problem.degree, weak.maps)
    bcs, free_n = supports(specimen, displacement)
    X_nI = np.concatenate([_node_positions(u) for u in displacement])
    at_nodes = problem.load_at != "face"
    tie_n, springs_kn = tie(specimen, displacement), actions.springs_kn
    with phase("assembly"):
        area = problem.width / specimen.depth
        bond, X_q, *across = _interface(bond_forms(problem, bodies, displacement), weak, free_n, area, phase)
        bulk_matrix, tie_matrix = _bulk_and_springs(bulk, bcs, bond, free_n * np.stack([tie_n, *springs_kn]))
        tangent_matrix = bulk_matrix.copy()
    end_load_n = point_load(specimen, problem.load_at, displacement, X_nI, comm) if at_nodes else load.assemble()
    return Model(
        problem=problem,
        specimen=specimen,
        bodies=bodies,
        displacement=displacement,
        law=problem.law,
        bond=bond,
        internal=internal,
        bulk=bulk,
        energy=energy,
        face_energy=face_energy,
        bcs=bcs,
        free_n=free_n,
        tie_n=tie_n,
        actions=actions,
        springs_kn=springs_kn,
        load_n=actions.load_n if specimen.pulls else end_load_n,
        slope_n=slope.assemble(),
        X_nI=X_nI,
        X_q=X_q,
        Z_q=across[0] if across else np.zeros_like(X_q),
        bonded_q=(X_q > min(specimen.bond)) & (X_q < max(specimen.bond)),
        tie_matrix=tie_matrix,
        bulk_matrix=bulk_matrix,
        tangent_matrix=tangent_matrix,
        factorisation=Factorisation(tangent_matrix, problem.solid, symmetric=not problem.law.slides),
        largest_stiffness=_largest(bulk_matrix, free_n, comm),
        phase=phase,
    )


def _bulk_and_springs(
    bulk: Any, bcs: Sequence[fem.DirichletBC], bond: Bond, springs_kn: np.ndarray
) -> tuple[PETSc.Mat, ...]:
    """Stiffness of the unloaded bodies with the springs, in the pattern of the whole tangent, and that of the springs.

    A spring is a row of ``springs_kn`` (n_k, n_n): its elongation times the square root of its stiffness, zero at
    supported unknowns.
    """
    narrow = create_block_matrix(bulk)
    add_block_matrix(narrow, bulk, bcs)
    spring_matrix = outer(springs_kn[0], narrow)
    for spring_n in springs_kn[1:]:
        spring_matrix.axpy(1.0, outer(spring_n, narrow), PETSc.Mat.Structure.DIFFERENT_NONZERO_PATTERN)
    bulk_matrix = widened(widened(narrow, bond.product), spring_matrix)
    add_block_matrix(bulk_matrix, bulk, bcs)
    bulk_matrix.axpy(1.0, spring_matrix, PETSc.Mat.Structure.SUBSET_NONZERO_PATTERN)
    return bulk_matrix, spring_matrix


def _largest(matrix: PETSc.Mat, free_n: np.ndarray, comm: MPI.Intracomm) -> float:
    """Largest diagonal entry of the free unknowns; that of a supported unknown is 1 and no stiffness."""
    diagonal_n = matrix.getDiagonal().array_r * free_n
    return comm.allreduce(float(np.max(diagonal_n, initial=0.0)), MPI.MAX)


def _vector(blocks: list, weak: WeakForm) -> BlockVector:
    return BlockVector(compile_forms(blocks, weak.maps))


def _interface(forms: BondForms, weak: WeakForm, free_n: np.ndarray, width: float, phase: Phase) -> tuple[Any, ...]:
    """Matrices of the interface, and the X, of a solid also the Z, of its points (n_q,); all are integrals divided by
    the weight of the point."""
    with phase("compile"):
        weight, *positions = (_vector([form], weak) for form in (forms.weight, *forms.positions))
        blocks = [compile_forms([row], weak.maps) for row in (forms.functionals, forms.slopes) if row]
    weight_r = weight.assemble()

    def at_points(block: list) -> PETSc.Mat:
        Z = create_block_matrix(block)
        add_block_matrix(Z, block, ())
        share = Z.createVecLeft()
        share.array[:] = 1.0 / weight_r
        Z.diagonalScale(L=share)
        return without_zeros(Z)

    places = [(position.assemble() / weight_r)[:: forms.per_point] for position in positions]
    Z, *slopes = (at_points(block) for block in blocks)
    return Bond(Z, slopes[0] if slopes else None, width * weight_r[:: forms.per_point], free_n), *places


def _node_positions(u: fem.Function) -> np.ndarray:
    n_nodes = owned(u) // len(u)
    return np.repeat(u.function_space.tabulate_dof_coordinates()[:n_nodes, : len(u)], len(u), axis=0)
