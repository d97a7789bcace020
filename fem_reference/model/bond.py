"""The interface as one matrix: jump and mean tangent of the matched faces are linear in the displacements."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from petsc4py import PETSc


@dataclass(frozen=True)
class Bond:
    """Functionals z_qa of the displacements at the points of the interface, their forces and their tangent.

    With z = Z u the virtual work is the sum over the points of w f_a delta z_a, so that

        internal force  f = Z^T (w f)          tangent  K = Z^T diag(w H) Z

    with the matrix H_ab = df_a/dz_b of every point (Schellekens and de Borst 1993, Int. J. Numer. Methods Eng. 36,
    43-66). In mode I the only functional is the gap.

    Parameters
    ----------
    Z : (n_q m, n_n), the functionals of a point one after the other, supported unknowns included.
    Z_X : the same of their derivatives along X, where the bond slides.
    weight_q : quadrature weight of each point times the width [area].
    free_n : 1 for a free unknown, 0 for a supported one.
    """

    Z: PETSc.Mat
    Z_X: PETSc.Mat | None
    weight_q: np.ndarray
    free_n: np.ndarray
    Z_free: PETSc.Mat = field(init=False)
    m: int = field(init=False)
    H: PETSc.Mat = field(init=False)
    scaled: PETSc.Mat = field(init=False)
    product: PETSc.Mat = field(init=False)
    vec_n: PETSc.Vec = field(init=False)
    vec_r: PETSc.Vec = field(init=False)

    def __post_init__(self) -> None:
        vec_n, vec_r = self.Z.createVecs()
        vec_n.array[:] = self.free_n
        Z_free = self.Z.copy()
        Z_free.diagonalScale(R=vec_n)
        m = self._functionals(vec_r)
        H = self._blocks(vec_r, np.ones((self.weight_q.size, m, m)))
        scaled = H.matMult(Z_free)
        made = {
            "Z_free": Z_free,
            "m": m,
            "H": H,
            "scaled": scaled,
            "product": Z_free.transposeMatMult(scaled),
            "vec_n": vec_n,
            "vec_r": vec_r,
        }
        for name, value in made.items():
            object.__setattr__(self, name, value)

    def of(self, u_n: np.ndarray) -> np.ndarray:
        """Functionals z_qa (n_q, m)."""
        return self._product(self.Z, u_n)

    def slopes(self, u_n: np.ndarray) -> np.ndarray:
        """Derivatives along X of the functionals (n_q, m)."""
        assert self.Z_X is not None
        return self._product(self.Z_X, u_n)

    def force(self, f_qa: np.ndarray) -> np.ndarray:
        """Internal forces (n_n,) of the forces f_qa per area, at supported unknowns too."""
        return self.spread(self.weight_q[:, None] * f_qa)

    def spread(self, f_qa: np.ndarray) -> np.ndarray:
        """Nodal forces Z^T f (n_n,)."""
        self.vec_r.array[:] = f_qa.ravel()
        self.Z.multTranspose(self.vec_r, self.vec_n)
        return self.vec_n.array_r.copy()

    def tangent(self, H_qab: np.ndarray) -> PETSc.Mat:
        """Tangent (n_n, n_n), zero in supported rows and columns; valid until the next call."""
        starts, columns = self._pattern(self.vec_r, H_qab.shape)
        self.H.setValuesCSR(starts, columns, (self.weight_q[:, None, None] * H_qab).ravel())
        self.H.assemble()
        self.H.matMult(self.Z_free, result=self.scaled)
        return self.Z_free.transposeMatMult(self.scaled, result=self.product)

    def _product(self, Z: PETSc.Mat, u_n: np.ndarray) -> np.ndarray:
        self.vec_n.array[:] = u_n
        Z.mult(self.vec_n, self.vec_r)
        return self.vec_r.array_r.reshape(self.weight_q.size, self.m).copy()

    def _functionals(self, vec_r: PETSc.Vec) -> int:
        """Functionals of a point, also on a rank that owns no point."""
        points = self.Z.comm.tompi4py().allreduce(self.weight_q.size)
        return int(vec_r.getSize()) // points

    def _blocks(self, vec_r: PETSc.Vec, H_qab: np.ndarray) -> PETSc.Mat:
        starts, columns = self._pattern(vec_r, H_qab.shape)
        sizes = vec_r.getSizes()
        return PETSc.Mat().createAIJ((sizes, sizes), csr=(starts, columns, H_qab.ravel()), comm=self.Z.comm)

    @staticmethod
    def _pattern(vec_r: PETSc.Vec, shape: tuple[int, ...]) -> tuple[np.ndarray, np.ndarray]:
        """Row starts and columns of a matrix with one full block for every point."""
        n, m, _ = shape
        first, _ = vec_r.getOwnershipRange()
        starts = m * np.arange(n * m + 1)
        columns = first + m * np.repeat(np.arange(n), m * m) + np.tile(np.arange(m), n * m)
        return starts.astype(PETSc.IntType), columns.astype(PETSc.IntType)
