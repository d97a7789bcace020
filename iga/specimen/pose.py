"""The place of a specimen in the plane: mirrored, turned and moved."""

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

    M reflects X -> -X where ``mirror`` is set, Q turns by ``angle`` degrees counter-clockwise.
    """

    angle: float = 0.0
    mirror: bool = False
    shift: tuple[float, float] = (0.0, 0.0)

    @cached_property
    def axes_kI(self) -> np.ndarray:
        """Unit vectors (2, 2) along and across the specimen, one a row."""
        c, s = np.cos(np.radians(self.angle)), np.sin(np.radians(self.angle))
        sign = -1.0 if self.mirror else 1.0
        return np.array([[sign * c, sign * s], [-s, c]])

    def place(self, X_own: np.ndarray) -> np.ndarray:
        """Places (..., 2) of points given in the specimen's own frame."""
        return X_own @ self.axes_kI + np.asarray(self.shift)

    def own(self, X: np.ndarray) -> np.ndarray:
        """Coordinates (..., 2) of places in the specimen's own frame."""
        return self.components(X - np.asarray(self.shift))

    def components(self, v: np.ndarray) -> np.ndarray:
        """Components (..., 2) of vectors along and across the specimen."""
        return v @ self.axes_kI.T

    def turned(self, D: np.ndarray) -> np.ndarray:
        """Elasticity matrix (3, 3) of a material whose axis 1 lies along the specimen: ``C_IJKL`` in the plane."""
        a = self.axes_kI
        C = np.einsum("mI,nJ,oK,pL,mnop->IJKL", a, a, a, a, elasticity_tensor(D))
        place = [(0, 0), (1, 1), (0, 1)]
        return np.array([[C[*row, *column] for column in place] for row in place])

    def placed(self, mesh: Mesh) -> Mesh:
        """A mesh made in the own frame at its place; a mirrored one runs backwards, to keep its Jacobians positive."""
        mesh = from_behind(mesh) if self.mirror else mesh
        return replace(mesh, P_AI=self.place(mesh.P_AI))
