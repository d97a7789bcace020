"""Orthotropic elasticity in the plane."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Moduli:
    """Elastic constants [stress; nu12 without unit], axis 1 along the specimen.

    Isotropic is E1 = E2, G12 = E / (2 (1 + nu)). Plane strain alone needs nu23; left out it is nu12.
    """

    E1: float
    E2: float
    G12: float
    nu12: float
    nu23: float | None = None

    def stiffness_IJ(self, plane: str) -> np.ndarray:
        """In-plane stiffness D (3, 3), stress = D (E11, E22, 2 E12); raises as `in_plane_stiffness` does."""
        return in_plane_stiffness(self.E1, self.E2, self.G12, self.nu12, plane, self.nu23)


def in_plane_stiffness(
    E1: float, E2: float, G12: float, nu12: float, plane: str, nu23: float | None = None
) -> np.ndarray:
    """Stiffness (3, 3) of an orthotropic sheet in Voigt order 11, 22, 12 with engineering shear.

    Plane stress inverts the in-plane compliance. Plane strain inverts the compliance of the solid and takes its
    in-plane block; the third direction is a second transverse one: E3 = E2, nu13 = nu12, and nu23 = nu12 where it is
    left out. Both reduce to the usual isotropic matrices for E1 = E2 (Jones 1999, Mechanics of Composite Materials,
    ch. 2).

    Raises
    ------
    ValueError : the compliance is not positive definite.
    """
    across = nu12 if nu23 is None else nu23
    compliance_33 = np.array(
        [
            [1 / E1, -nu12 / E1, -nu12 / E1],
            [-nu12 / E1, 1 / E2, -across / E2],
            [-nu12 / E1, -across / E2, 1 / E2],
        ]
    )
    normal = compliance_33[:2, :2] if plane == "stress" else compliance_33
    if np.min(np.linalg.eigvalsh(normal)) <= 0:
        raise ValueError(f"nu12: with E1 = {E1} and E2 = {E2} the material would store negative energy, got {nu12}")
    D = np.zeros((3, 3))
    D[:2, :2] = np.linalg.inv(normal)[:2, :2]
    D[2, 2] = G12
    return D


@dataclass(frozen=True)
class Rectangle:
    """A body 0 <= X <= length, above or below Y = 0."""

    length: float
    thickness: float
    moduli: Moduli


#: The upper and the lower body.
Rectangles = tuple[Rectangle, Rectangle]
