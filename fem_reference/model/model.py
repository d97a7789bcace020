"""The assembled model: internal forces, load and tangent as plain arrays over the unknowns that this rank owns."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from dolfinx import fem
from mpi4py import MPI
from petsc4py import PETSc

from fem_reference.dolfinx_api import add_block_matrix, compile_forms, create_block_matrix
from fem_reference.model.assembled import BlockVector, owned
from fem_reference.model.bond import Bond
from fem_reference.model.forms import WeakForm, displacements, weak_form
from fem_reference.model.linear import Factorisation, outer, widened, without_zeros
from fem_reference.model.mesh import TwoBodies, two_bodies
from fem_reference.model.supports import point_load, supports, tie
from fem_reference.problem.law import MODELLED_LAWS, Law
from fem_reference.problem.problem import Debonding
from fem_reference.problem.specimen import Specimen

Phase = Callable[[str], AbstractContextManager]


@dataclass(frozen=True)
class Model:
    """A problem ready to be solved.

    Unknowns ``u_n`` are the displacements owned by this rank: x and y alternate, upper body first. The external force
    is ``load * load_n``, and the opening is ``load_n @ u_n``, summed over the ranks. Points ``q`` of the interface are
    those that this rank owns; where ``bonded_q`` is False the surfaces can only touch, and points have no history.
    """

    problem: Debonding
    specimen: Specimen
    bodies: TwoBodies
    displacement: tuple[fem.Function, fem.Function]  # upper, lower; the forms read them
    law: Law
    bond: Bond
    internal: BlockVector
    bulk: Any  # compiled blocks of the bodies' tangent
    energy: fem.Form
    face_energy: fem.Form
    bcs: tuple[fem.DirichletBC, ...]
    free_n: np.ndarray  # 1 where free, 0 where supported
    tie_n: np.ndarray  # elongation of the tie times the square root of its stiffness; zero without a tie
    load_n: np.ndarray
    slope_n: np.ndarray  # mean du_y/dX of the loaded faces, upper and lower, as functionals
    X_nI: np.ndarray  # (n, 2) reference position of the node of each unknown
    X_q: np.ndarray
    bonded_q: np.ndarray
    tie_matrix: PETSc.Mat
    bulk_matrix: PETSc.Mat
    tangent_matrix: PETSc.Mat
    factorisation: Factorisation
    largest_stiffness: float
    phase: Phase

    @property
    def comm(self) -> MPI.Intracomm:
        return self.bodies.parent.comm

    @property
    def upper_n(self) -> np.ndarray:
        """True for the unknowns of the upper body."""
        return np.arange(self.load_n.size) < owned(self.displacement[0])

    def dot(self, a_n: np.ndarray, b_n: np.ndarray) -> float:
        """Scalar product over all ranks."""
        return self.comm.allreduce(float(a_n @ b_n))

    def norm(self, a_n: np.ndarray) -> float:
        """Euclidean norm over all ranks."""
        return float(np.sqrt(self.dot(a_n, a_n)))

    def rounding(self, u_n: np.ndarray) -> float:
        """Size of the forces that rounding of the displacements causes."""
        largest = self.comm.allreduce(float(np.max(np.abs(u_n), initial=0.0)), MPI.MAX)
        return np.finfo(float).eps * largest * self.largest_stiffness

    def displace(self, u_n: np.ndarray) -> None:
        """Copy displacements into the functions that the forms read."""
        size = owned(self.displacement[0])
        for u, part_n in zip(self.displacement, (u_n[:size], u_n[size:]), strict=True):
            u.x.array[: part_n.size] = part_n
            u.x.scatter_forward()

    def bulk_force(self, u_n: np.ndarray) -> np.ndarray:
        """Internal forces (n,) of the bodies, at the supports too."""
        self.displace(u_n)
        return self.internal.assemble()

    def bulk_energy(self, u_n: np.ndarray) -> float:
        """Strain energy of the bodies."""
        self.displace(u_n)
        return float(self.comm.allreduce(fem.assemble_scalar(self.energy)))

    def traction(self, g_q: np.ndarray, k_q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Traction and slope (n_q,) each: those of `Law.traction` where bonded, elsewhere contact alone."""
        carries_q = self.bonded_q | ((g_q < 0.0) & self.law.contact)
        p_q, dp_q = self.law.traction(g_q, k_q)
        return np.where(carries_q, p_q, 0.0), np.where(carries_q, dp_q, 0.0)

    def history(self, g_q: np.ndarray, k_q: np.ndarray) -> np.ndarray:
        """Largest gap (n_q,) so far, the present gap included; 0 where nothing is bonded."""
        return np.where(self.bonded_q, self.law.history(g_q, k_q), 0.0)

    def damage(self, k_q: np.ndarray) -> np.ndarray:
        """d (n_q,); 1 where nothing is bonded."""
        return np.where(self.bonded_q, self.law.damage(k_q), 1.0)

    def bond_energies(self, g_q: np.ndarray, k_q: np.ndarray) -> tuple[float, float, float]:
        """Energies recoverable from cohesion, stored in contact, dissipated; over all ranks."""
        recoverable_q, contact_q, lost_q = self.law.energies(g_q, k_q)
        parts = np.where(self.bonded_q, recoverable_q, 0.0), contact_q, np.where(self.bonded_q, lost_q, 0.0)
        recoverable, contact, lost = (self.dot(self.bond.weight_q, part_q) for part_q in parts)
        return recoverable, contact, lost

    def bond_force(self, u_n: np.ndarray, k_q: np.ndarray) -> np.ndarray:
        """Internal forces (n,) of the bond, at the supports too; ``k_q`` is the committed history."""
        p_q, _ = self.traction(self.bond.gap(u_n), k_q)
        return self.bond.force(p_q)

    def residual(self, u_n: np.ndarray, load: float, k_q: np.ndarray) -> np.ndarray:
        """Internal minus external forces (n,); zero at supported unknowns."""
        with self.phase("assembly"):
            tie_force_n = self.dot(self.tie_n, u_n) * self.tie_n
            inside_n = self.bond_force(u_n, k_q) + self.bulk_force(u_n) + tie_force_n
            return self.free_n * (inside_n - load * self.load_n)

    def tangent(self, u_n: np.ndarray, k_q: np.ndarray) -> PETSc.Mat:
        """Derivative of the residual by the displacements, 1 on the diagonal at supports; valid until the next call."""
        if self.problem.kinematics == "finite":
            self.assemble_bulk(u_n)
        _, dp_q = self.traction(self.bond.gap(u_n), k_q)
        self.bulk_matrix.copy(self.tangent_matrix, PETSc.Mat.Structure.SAME_NONZERO_PATTERN)
        self.tangent_matrix.axpy(1.0, self.bond.tangent(dp_q), PETSc.Mat.Structure.SUBSET_NONZERO_PATTERN)
        return self.tangent_matrix

    def factorise(self, u_n: np.ndarray, k_q: np.ndarray) -> None:
        """Assemble and factorise the tangent, for `solve`."""
        with self.phase("assembly"):
            A = self.tangent(u_n, k_q)
        with self.phase("factor"):
            self.factorisation.factorise(A)

    def solve(self, force_n: np.ndarray) -> np.ndarray:
        """Displacements (n,) for forces (n,), by the tangent factorised last."""
        with self.phase("solve"):
            return self.factorisation.solve(force_n)

    def assemble_bulk(self, u_n: np.ndarray) -> None:
        """Assemble the part of the bodies and their tie in the tangent; it is constant in linear kinematics."""
        self.displace(u_n)
        self.bulk_matrix.zeroEntries()
        add_block_matrix(self.bulk_matrix, self.bulk, self.bcs)
        self.bulk_matrix.axpy(1.0, self.tie_matrix, PETSc.Mat.Structure.SUBSET_NONZERO_PATTERN)


def build_model(problem: Debonding, phase: Phase, comm: MPI.Intracomm) -> Model:
    """Mesh, spaces, compiled forms and matrices of a problem.

    Raises
    ------
    ValueError : an unknown traction law, or a point load without a node.
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
    bcs, free_n = supports(specimen, displacement)
    X_nI = np.concatenate([_node_positions(u) for u in displacement])
    at_nodes = problem.load_at != "face"
    tie_n = tie(specimen, displacement)
    with phase("assembly"):
        bond, X_q = _bond(problem, weak, free_n, phase)
        bulk_matrix, tie_matrix = _bulk_and_tie(bulk, bcs, bond, tie_n)
        tangent_matrix = bulk_matrix.copy()
    return Model(
        problem=problem,
        specimen=specimen,
        bodies=bodies,
        displacement=displacement,
        law=law_of(problem),
        bond=bond,
        internal=internal,
        bulk=bulk,
        energy=energy,
        face_energy=face_energy,
        bcs=bcs,
        free_n=free_n,
        tie_n=tie_n,
        load_n=point_load(specimen, problem.load_at, displacement, X_nI, comm) if at_nodes else load.assemble(),
        slope_n=slope.assemble(),
        X_nI=X_nI,
        X_q=X_q,
        bonded_q=(X_q > min(specimen.bond)) & (X_q < max(specimen.bond)),
        tie_matrix=tie_matrix,
        bulk_matrix=bulk_matrix,
        tangent_matrix=tangent_matrix,
        factorisation=Factorisation(tangent_matrix),
        largest_stiffness=_largest(bulk_matrix, free_n, comm),
        phase=phase,
    )


def _bulk_and_tie(bulk: Any, bcs: Sequence[fem.DirichletBC], bond: Bond, tie_n: np.ndarray) -> tuple[PETSc.Mat, ...]:
    """Stiffness of the unloaded bodies with the tie, in the pattern of the whole tangent, and that of the tie alone."""
    narrow = create_block_matrix(bulk)
    add_block_matrix(narrow, bulk, bcs)
    tie_matrix = outer(tie_n, narrow)
    bulk_matrix = widened(widened(narrow, bond.product), tie_matrix)
    add_block_matrix(bulk_matrix, bulk, bcs)
    bulk_matrix.axpy(1.0, tie_matrix, PETSc.Mat.Structure.SUBSET_NONZERO_PATTERN)
    return bulk_matrix, tie_matrix


def _largest(matrix: PETSc.Mat, free_n: np.ndarray, comm: MPI.Intracomm) -> float:
    """Largest diagonal entry of the free unknowns; that of a supported unknown is 1 and no stiffness."""
    diagonal_n = matrix.getDiagonal().array_r * free_n
    return comm.allreduce(float(np.max(diagonal_n, initial=0.0)), MPI.MAX)


def law_of(problem: Debonding) -> Law:
    """The traction law of a problem; raises ValueError for an unknown name."""
    p = problem
    if p.law_name not in MODELLED_LAWS:
        raise ValueError(f"law_name: must be one of {', '.join(MODELLED_LAWS)}, got {p.law_name}")
    law = MODELLED_LAWS[p.law_name]
    own = {field.name: getattr(p, field.name) for field in fields(law) if field.name in ("plateau", "table")}
    return law(p.strength, p.toughness, p.ductility, p.penalty, p.contact, p.irreversible, **own)


def _vector(blocks: list, weak: WeakForm) -> BlockVector:
    return BlockVector(compile_forms(blocks, weak.maps))


def _bond(problem: Debonding, weak: WeakForm, free_n: np.ndarray, phase: Phase) -> tuple[Bond, np.ndarray]:
    """Matrices of the interface, and the X of its points; G and X are integrals divided by the weight of the point."""
    with phase("compile"):
        gap = [compile_forms(weak.gap, weak.maps)]
        weight, position = (_vector([form], weak) for form in (weak.weight, weak.position))
    weight_q = weight.assemble()
    G = create_block_matrix(gap)
    add_block_matrix(G, gap, ())
    share = G.createVecLeft()
    share.array[:] = 1.0 / weight_q
    G.diagonalScale(L=share)
    X_q = position.assemble() / weight_q
    return Bond(without_zeros(G), problem.width * weight_q, free_n), X_q


def _node_positions(u: fem.Function) -> np.ndarray:
    n_nodes = owned(u) // 2
    return np.repeat(u.function_space.tabulate_dof_coordinates()[:n_nodes, :2], 2, axis=0)
