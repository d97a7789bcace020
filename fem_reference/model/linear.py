"""One sparse LU factorisation, many back-substitutions."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from petsc4py import PETSc

#: Smallest pivot that is accepted. PETSc's default, 2.2e-14, does not scale with the units; zero alone is refused here.
ZERO_PIVOT = 1e-300


class Singular(ArithmeticError):
    """A matrix without an inverse."""


@dataclass(frozen=True)
class Factorisation:
    """LU of a matrix whose pattern does not change: PETSc's own in serial, MUMPS over several ranks and for solids.

    A specimen is long and thin: reverse Cuthill-McKee ordering makes the band narrow. That of a solid is wide: MUMPS,
    which works on dense blocks, took a third less time there, and with L D L^T of a ``symmetric`` matrix half of it.
    """

    matrix: PETSc.Mat
    solid: bool = False
    symmetric: bool = False
    ksp: PETSc.KSP = field(init=False)
    x: PETSc.Vec = field(init=False)
    b: PETSc.Vec = field(init=False)

    def __post_init__(self) -> None:
        ksp = PETSc.KSP().create(self.matrix.comm)
        ksp.setType(PETSc.KSP.Type.PREONLY)
        ksp.setErrorIfNotConverged(False)  # `factorise` raises
        pc = ksp.getPC()
        pc.setType(PETSc.PC.Type.CHOLESKY if self.solid and self.symmetric else PETSc.PC.Type.LU)
        if self.matrix.comm.size > 1 or self.solid:
            pc.setFactorSolverType("mumps")
        else:
            pc.setFactorSolverType("petsc")
            pc.setFactorOrdering(PETSc.Mat.OrderingType.RCM)
            pc.setFactorPivot(zeropivot=ZERO_PIVOT)
        x, b = self.matrix.createVecs()
        for name, value in (("ksp", ksp), ("x", x), ("b", b)):
            object.__setattr__(self, name, value)

    def factorise(self, A: PETSc.Mat) -> None:
        """Factorise ``A``, a matrix with the pattern of ``matrix``.

        Raises
        ------
        Singular : it has no inverse, on all ranks alike.
        """
        self.ksp.setOperators(A)
        self.ksp.setUp()
        failed, known = self.ksp.getPC().getFailedReason(), PETSc.PC.FailedReason
        if failed in (known.FACTOR_NUMERIC_ZEROPIVOT, known.FACTOR_STRUCT_ZEROPIVOT):
            raise Singular("a pivot is zero")
        if failed != known.NOERROR:
            raise MemoryError(f"the matrix has not been factorised (PETSc, PCFailedReason {failed})")

    def solve(self, force_n: np.ndarray) -> np.ndarray:
        """Owned entries of the solution for the owned entries of the right-hand side."""
        self.b.array[:] = force_n
        self.ksp.solve(self.b, self.x)
        return self.x.array_r.copy()


def without_zeros(A: PETSc.Mat) -> PETSc.Mat:
    """The matrix without the entries of its pattern that are zero up to rounding.

    The element matrix of a facet has entries for all nodes of both its cells, but only those of nodes on the facet are
    not zero.
    """
    row_starts, columns, values = A.getValuesCSR()
    kept = np.abs(values) > 1e-12 * np.max(np.abs(values), initial=0.0)
    starts = np.concatenate([[0], np.cumsum(kept)])[row_starts].astype(PETSc.IntType)
    return PETSc.Mat().createAIJ(A.getSizes(), csr=(starts, columns[kept], values[kept]), comm=A.comm)


def outer(row_n: np.ndarray, A: PETSc.Mat) -> PETSc.Mat:
    """Outer product r r^T of a functional (n,) with few entries, as a sparse matrix with the layout of ``A``."""
    first, _ = A.getOwnershipRange()
    own = np.flatnonzero(row_n)
    everywhere = A.comm.tompi4py().allgather((first + own, row_n[own]))
    columns, entries = (np.concatenate(parts) for parts in zip(*everywhere, strict=True))
    starts = np.concatenate([[0], np.cumsum(columns.size * (row_n != 0))]).astype(PETSc.IntType)
    csr = starts, np.tile(columns, own.size).astype(PETSc.IntType), np.outer(row_n[own], entries).ravel()
    return PETSc.Mat().createAIJ(A.getSizes(), csr=csr, comm=A.comm)


def widened(A: PETSc.Mat, other: PETSc.Mat) -> PETSc.Mat:
    """A matrix of zeros with the union of both patterns and the local numbering of ``A``."""
    both = A.copy()
    both.axpy(1.0, other, structure=PETSc.Mat.Structure.DIFFERENT_NONZERO_PATTERN)
    both.setLGMap(*A.getLGMap())
    both.zeroEntries()
    return both
