"""The interface between the bodies as matrices: the gap at a point is a fixed linear function of the displacements."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from petsc4py import PETSc


@dataclass(frozen=True)
class Bond:
    """Gap, forces and tangent of the interface, from two fixed sparse matrices.

    With matched meshes and the gap along the undeformed normal, g = G u at the quadrature points, so that

        internal force  f = G^T (w p)          tangent  K = G^T diag(w dp/dg) G

    with w the weight of a point times the width (Schellekens and de Borst 1993, Int. J. Numer. Methods Eng. 36, 43-66).

    Parameters
    ----------
    G : (n_q, n_n), gap at the points by the displacements, supported unknowns included.
    weight_q : quadrature weight of each point times the width [area].
    free_n : 1 for a free unknown, 0 for a supported one.
    """

    G: PETSc.Mat
    weight_q: np.ndarray
    free_n: np.ndarray
    G_free: PETSc.Mat = field(init=False)
    scaled: PETSc.Mat = field(init=False)
    product: PETSc.Mat = field(init=False)
    vec_n: PETSc.Vec = field(init=False)
    vec_q: PETSc.Vec = field(init=False)

    def __post_init__(self) -> None:
        vec_n, vec_q = self.G.createVecs()
        vec_n.array[:] = self.free_n
        G_free = self.G.copy()
        G_free.diagonalScale(R=vec_n)
        scaled = G_free.copy()
        made = {
            "G_free": G_free,
            "scaled": scaled,
            "product": G_free.transposeMatMult(scaled),
            "vec_n": vec_n,
            "vec_q": vec_q,
        }
        for name, value in made.items():
            object.__setattr__(self, name, value)

    def gap(self, u_n: np.ndarray) -> np.ndarray:
        """Normal opening (n_q,)."""
        self.vec_n.array[:] = u_n
        self.G.mult(self.vec_n, self.vec_q)
        return self.vec_q.array_r.copy()

    def force(self, p_q: np.ndarray) -> np.ndarray:
        """Internal forces (n_n,) of tractions p_q (n_q,), at supported unknowns too."""
        return self.spread(self.weight_q * p_q)

    def spread(self, force_q: np.ndarray) -> np.ndarray:
        """Nodal forces G^T f (n_n,) of forces f (n_q,) at the points."""
        self.vec_q.array[:] = force_q
        self.G.multTranspose(self.vec_q, self.vec_n)
        return self.vec_n.array_r.copy()

    def tangent(self, dp_q: np.ndarray) -> PETSc.Mat:
        """Tangent (n_n, n_n) for slopes dp/dg (n_q,), zero in supported rows and columns; valid until the next call."""
        self.vec_q.array[:] = self.weight_q * dp_q
        self.G_free.copy(self.scaled, PETSc.Mat.Structure.SAME_NONZERO_PATTERN)
        self.scaled.diagonalScale(L=self.vec_q)
        return self.G_free.transposeMatMult(self.scaled, result=self.product)
