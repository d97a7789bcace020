"""Orthotropic elasticity in the plane."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Moduli:
    """Elastic constants [stress; nu12 without unit], axis 1 along the specimen.

    Isotropic is E1 = E2, G12 = E / (2 (1 + nu)).
    """

    E1: float
    E2: float
    G12: float
    nu12: float

    def stiffness_IJ(self, plane: str) -> np.ndarray:
        """In-plane stiffness D (3, 3), stress = D (E11, E22, 2 E12); raises as `in_plane_stiffness` does."""
        return in_plane_stiffness(self.E1, self.E2, self.G12, self.nu12, plane)


def in_plane_stiffness(E1: float, E2: float, G12: float, nu12: float, plane: str) -> np.ndarray:
    """Stiffness (3, 3) of an orthotropic sheet in Voigt order 11, 22, 12 with engineering shear.

    Plane stress inverts the in-plane compliance. Plane strain inverts the compliance of the solid and takes its
    in-plane block; the solid's third direction is a second transverse one: E3 = E2, nu13 = nu12, nu23 = nu12. Both
    reduce to the usual isotropic matrices for E1 = E2 (Jones 1999, Mechanics of Composite Materials, ch. 2).

    Raises
    ------
    ValueError : the compliance is not positive definite.
    """
    compliance_33 = np.array(
        [
            [1 / E1, -nu12 / E1, -nu12 / E1],
            [-nu12 / E1, 1 / E2, -nu12 / E2],
            [-nu12 / E1, -nu12 / E2, 1 / E2],
        ]
    )
    normal = compliance_33[:2, :2] if plane == "stress" else compliance_33
    if np.min(np.linalg.eigvalsh(normal)) <= 0:
        raise ValueError(f"nu12: with E1 = {E1} and E2 = {E2} the material would store negative energy, got {nu12}")
    D = np.zeros((3, 3))
    D[:2, :2] = np.linalg.inv(normal)[:2, :2]
    D[2, 2] = G12
    return D
