"""The assembled model: internal forces, load and tangent as plain arrays over the unknowns that this rank owns."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np
from dolfinx import fem
from mpi4py import MPI
from petsc4py import PETSc

from fem_reference.dolfinx_api import add_block_matrix
from fem_reference.model.assembled import BlockVector, owned
from fem_reference.model.bond import Bond
from fem_reference.model.frame import Relative, relative
from fem_reference.model.linear import Factorisation
from fem_reference.model.mesh import TwoBodies
from fem_reference.model.outline import ActionRows
from fem_reference.model.supports import Displacement, dofs_on
from fem_reference.problem.bond_law import BondLaw
from fem_reference.problem.problem import Debonding
from fem_reference.problem.specimen import Region, Specimen

Phase = Callable[[str], AbstractContextManager]


class BondEnergies(NamedTuple):
    """Energies of the bond over all ranks.

    ``cohesive`` is recoverable; ``contact`` is stored in contact and friction; ``dissipated`` is lost to damage and
    friction, ``rubbed`` the part of it by friction; ``released`` is the energy released by damage, where it has to be
    summed along the path.
    """

    cohesive: float = 0.0
    contact: float = 0.0
    dissipated: float = 0.0
    rubbed: float = 0.0
    released: float = 0.0

    @property
    def total(self) -> float:
        """All energy that has gone into the bond."""
        return self.cohesive + self.contact + self.dissipated


@dataclass(frozen=True)
class Model:
    """A problem ready to be solved.

    Unknowns ``u_n`` are the displacements owned by this rank: x and y, of a solid also z, alternate, upper body first.
    Of what is a mirror image of the mesh the forces are counted with those of the mesh. The external force
    is ``load * load_n``, and the opening is ``load_n @ u_n``, summed over the ranks. Points ``q`` of the interface are
    those that this rank owns; where ``bonded_q`` is False the surfaces can only touch, and points have no history.
    """

    problem: Debonding
    specimen: Specimen
    bodies: TwoBodies
    displacement: Displacement  # upper, lower; the forms read them
    law: BondLaw
    bond: Bond
    internal: BlockVector
    bulk: Any  # compiled blocks of the bodies' tangent
    energy: fem.Form
    face_energy: fem.Form
    bcs: tuple[fem.DirichletBC, ...]
    free_n: np.ndarray  # 1 where free, 0 where supported
    tie_n: np.ndarray  # elongation of the tie times the square root of its stiffness; zero without a tie
    actions: ActionRows
    springs_kn: np.ndarray  # the same of the springs on patches
    load_n: np.ndarray
    slope_n: np.ndarray  # mean du_y/dX of the loaded faces, upper and lower, as functionals
    X_nI: np.ndarray  # (n, d) reference position of the node of each unknown
    X_q: np.ndarray
    Z_q: np.ndarray  # 0 in the plane
    bonded_q: np.ndarray
    tie_matrix: PETSc.Mat
    bulk_matrix: PETSc.Mat
    tangent_matrix: PETSc.Mat
    factorisation: Factorisation
    largest_stiffness: float
    phase: Phase
    located: dict[tuple[int, Region], np.ndarray] = field(default_factory=dict, kw_only=True)
    dt: float = field(default=0.0, kw_only=True)  # time of the step in durations of the programme, for viscosity

    @property
    def comm(self) -> MPI.Intracomm:
        return self.bodies.parent.comm

    @property
    def upper_n(self) -> np.ndarray:
        """True for the unknowns of the upper body."""
        return np.arange(self.load_n.size) < owned(self.displacement[0])

    def along(self, *values_q: np.ndarray) -> list[np.ndarray]:
        """Distances (n_l, n_p) of all points of the bond, over all ranks, from the loaded end, rising on lines along
        the specimen, from the middle of the width to its edge; values in that order. One line in the plane."""
        s_q = np.asarray(self.specimen.distance(self.X_q))
        gathered = [np.concatenate(self.comm.allgather(v_q)) for v_q in (self.Z_q, s_q, *values_q)]
        order = np.argsort(gathered[0])
        line_q = np.empty(order.size, dtype=int)
        line_q[order] = np.cumsum(np.diff(gathered[0][order], prepend=-np.inf) > self.specimen.near) - 1
        lines = int(line_q.max()) + 1
        return [v_q[np.lexsort((gathered[1], line_q))].reshape(lines, -1) for v_q in gathered[1:]]

    @property
    def middle_q(self) -> np.ndarray:
        """Whether a point is on the line in the middle of the width."""
        first = self.comm.allreduce(float(np.min(self.Z_q, initial=np.inf)), MPI.MIN)
        return self.Z_q < first + self.specimen.near

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

    def across(self, body: int, place: Region) -> np.ndarray:
        """Owned unknowns u_y of a body, 0 the upper one, at a vertex or on a side; searched for once."""
        if (body, place) not in self.located:
            u = self.displacement[body]
            dofs = dofs_on(u, place, self.specimen.near, 1)
            self.located[body, place] = dofs[dofs < owned(u)]
        return self.located[body, place]

    def displace(self, u_n: np.ndarray) -> None:
        """Copy displacements into the functions that the forms read."""
        first = 0
        for u in self.displacement:
            u.x.array[: owned(u)] = u_n[first : first + owned(u)]
            u.x.scatter_forward()
            first += owned(u)

    def bulk_force(self, u_n: np.ndarray) -> np.ndarray:
        """Internal forces (n,) of the bodies, at the supports too."""
        self.displace(u_n)
        return self.internal.assemble()

    def bulk_energy(self, u_n: np.ndarray) -> float:
        """Strain energy of the bodies."""
        self.displace(u_n)
        return float(self.comm.allreduce(fem.assemble_scalar(self.energy)))

    @property
    def timed(self) -> bool:
        """Whether the bond is viscous, so that the opening, which the time is counted by, must not decrease."""
        return self.law.viscosity > 0.0

    def in_time(self, way: float) -> Model:
        """The model for a step of ``way`` in the opening."""
        return replace(self, dt=abs(way) / self.problem.way)

    def relative(self, u_n: np.ndarray) -> Relative:
        """Jumps at all points with their derivatives."""
        return relative(self.bond.of(u_n))

    def jump(self, u_n: np.ndarray) -> np.ndarray:
        """Jumps (n_q, n_j) at the points: the gap and, where the bond slides, the slip."""
        return self.relative(u_n).jump_qj

    def respond(self, jump_qj: np.ndarray, k_qh: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Tractions (n_q, n_j) and their slopes (n_q, n_j, n_j)."""
        return self.law.respond(jump_qj, k_qh, self.bonded_q, self.dt)

    def bond_force(self, u_n: np.ndarray, k_qh: np.ndarray) -> np.ndarray:
        """Internal forces (n,) of the bond, at the supports too; ``k_qh`` is the committed history."""
        at = self.relative(u_n)
        traction_qi, _ = self.respond(at.jump_qj, k_qh)
        return self.bond.force(at.forces(traction_qi))

    def bond_tangent(self, u_n: np.ndarray, k_qh: np.ndarray) -> PETSc.Mat:
        """Derivative of `bond_force` by the displacements, zero at supports; valid until the next call."""
        at = self.relative(u_n)
        traction_qi, D_qij = self.respond(at.jump_qj, k_qh)
        return self.bond.tangent(at.tangent(traction_qi, D_qij))

    def history(self, jump_qj: np.ndarray, k_qh: np.ndarray) -> np.ndarray:
        """History after a step to the jumps."""
        return self.law.committed(jump_qj, k_qh, self.bonded_q, self.dt)

    def damage(self, k_qh: np.ndarray) -> np.ndarray:
        """d (n_q,); 1 where nothing is bonded."""
        return self.law.damaged(k_qh, self.bonded_q)

    def bond_fields(self, jump_qj: np.ndarray, k_qh: np.ndarray) -> dict[str, np.ndarray]:
        """Fields of the bond for snapshots and frames, (n_q,) each; slip_q and shear_q, where it slides, are jump and
        traction along X."""
        (gap_q, *slip), (p_q, *shear) = jump_qj.T, self.respond(jump_qj, k_qh)[0].T
        of_damage = {"damage_q": self.damage(k_qh), "history_q": self.law.held(k_qh)}
        along = dict(zip(("slip_q", "shear_q"), (*slip, *shear), strict=False))
        return {"gap_q": gap_q, "traction_q": p_q, **of_damage, **along}

    def measure(self, jump_qj: np.ndarray) -> np.ndarray:
        """The measure (n_q,) of the jumps, see `BondLaw`."""
        return self.law.measure(jump_qj)[0]

    def measure_row(self, u_n: np.ndarray, share_q: np.ndarray) -> np.ndarray:
        """Change of the measures, weighted with ``share_q``, as a functional (n,) of the changes of displacement."""
        return self.bond.spread(share_q[:, None] * self._measure_slope(u_n))

    def rates(self, u_n: np.ndarray, rate_n: np.ndarray) -> np.ndarray:
        """Change (n_q,) of the measure with a change of the displacements."""
        return np.einsum("qa,qa->q", self._measure_slope(u_n), self.bond.of(rate_n))

    def _measure_slope(self, u_n: np.ndarray) -> np.ndarray:
        at = self.relative(u_n)
        return at.forces(self.law.measure(at.jump_qj)[1])

    def spring_force(self, u_n: np.ndarray) -> np.ndarray:
        """Internal forces (n,) of the tie and of the springs on patches."""
        force_n = self.dot(self.tie_n, u_n) * self.tie_n
        for spring_n in self.springs_kn:
            force_n += self.dot(spring_n, u_n) * spring_n
        return force_n

    def residual(self, u_n: np.ndarray, load: float, k_q: np.ndarray) -> np.ndarray:
        """Internal minus external forces (n,); zero at supported unknowns."""
        with self.phase("assembly"):
            inside_n = self.bond_force(u_n, k_q) + self.bulk_force(u_n) + self.spring_force(u_n)
            return self.free_n * (inside_n - load * self.load_n)

    def tangent(self, u_n: np.ndarray, k_q: np.ndarray) -> PETSc.Mat:
        """Derivative of the residual by the displacements, 1 on the diagonal at supports; valid until the next call."""
        if self.problem.kinematics == "finite":
            self.assemble_bulk(u_n)
        self.bulk_matrix.copy(self.tangent_matrix, PETSc.Mat.Structure.SAME_NONZERO_PATTERN)
        self.tangent_matrix.axpy(1.0, self.bond_tangent(u_n, k_q), PETSc.Mat.Structure.SUBSET_NONZERO_PATTERN)
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
