"""The place of a specimen in the plane, or of a solid along it: mirrored, turned and moved."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from iga.elements.kinematics import elasticity_tensor
from iga.mesh.extraction import Mesh
from iga.mesh.mirror import from_behind


@dataclass(frozen=True)
class Pose:
    """The specimen's own frame in the plane: ``X = shift + Q M X_own``.

    M reflects X -> -X where ``mirror`` is set, Q turns by ``angle`` degrees counter-clockwise. The third of ``d`` = 3
    directions, across the width, stays as it is.
    """

    angle: float = 0.0
    mirror: bool = False
    shift: tuple[float, float] = (0.0, 0.0)
    d: int = 2

    @cached_property
    def axes_kI(self) -> np.ndarray:
        """Unit vectors (d, d) along and across the specimen, and across its width, one a row."""
        c, s = np.cos(np.radians(self.angle)), np.sin(np.radians(self.angle))
        sign = -1.0 if self.mirror else 1.0
        axes_kI = np.eye(self.d)
        axes_kI[:2, :2] = [[sign * c, sign * s], [-s, c]]
        return axes_kI

    @cached_property
    def origin(self) -> np.ndarray:
        """Where the origin of the own frame lies (d,)."""
        return np.array([*self.shift, 0.0][: self.d])

    def vectors(self, v_d: np.ndarray) -> np.ndarray:
        """Vectors (n_A, d) of degrees of freedom (n_dof,)."""
        return v_d.reshape(-1, self.d)

    def place(self, X_own: np.ndarray) -> np.ndarray:
        """Places (..., d) of points given in the specimen's own frame."""
        return X_own @ self.axes_kI + self.origin

    def own(self, X: np.ndarray) -> np.ndarray:
        """Coordinates (..., d) of places in the specimen's own frame."""
        return self.components(X - self.origin)

    def components(self, v: np.ndarray) -> np.ndarray:
        """Components (..., d) of vectors along and across the specimen."""
        return v @ self.axes_kI.T

    def turned(self, D: np.ndarray) -> np.ndarray:
        """Elasticity matrix of a material whose axis 1 lies along the specimen, by its ``C_IJKL``."""
        a = self.axes_kI
        C = np.einsum("mI,nJ,oK,pL,mnop->IJKL", a, a, a, a, elasticity_tensor(D))
        place = [(0, 0), (1, 1), (0, 1)] if self.d == 2 else [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)]
        return np.array([[C[*row, *column] for column in place] for row in place])

    def placed(self, mesh: Mesh) -> Mesh:
        """A mesh made in the own frame at its place; a mirrored one runs backwards, to keep its Jacobians positive."""
        mesh = from_behind(mesh) if self.mirror else mesh
        return replace(mesh, P_AI=self.place(mesh.P_AI))
