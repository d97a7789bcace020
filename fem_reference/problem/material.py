"""Orthotropic elasticity in the plane and in space."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Moduli:
    """Elastic constants [stress; nu without unit], axis 1 along the specimen, 2 across its thickness, 3 its width.

    Isotropic is E1 = E2, G12 = E / (2 (1 + nu)). What is left out is that of a second transverse direction: E3 = E2,
    nu13 = nu12, nu23 = nu12, G13 = G12, G23 = E2 / (2 (1 + nu23)). Plane stress needs none of these, plane strain the
    first three.
    """

    E1: float
    E2: float
    G12: float
    nu12: float
    nu23: float | None = None
    E3: float | None = None
    nu13: float | None = None
    G13: float | None = None
    G23: float | None = None

    def stiffness_IJ(self, plane: str) -> np.ndarray:
        """Stiffness in Voigt order with engineering shear: (3, 3) of 11, 22, 12 in the plane, (6, 6) of 11, 22, 33, 23,
        13, 12 of a solid.

        Plane stress inverts the in-plane compliance. Plane strain inverts the compliance of the solid and takes its
        in-plane block. All reduce to the isotropic matrices for E1 = E2 (Jones 1999, Mechanics of Composite Materials,
        ch. 2).

        Raises
        ------
        ValueError : the compliance is not positive definite.
        """
        E1, E2, nu12 = self.E1, self.E2, self.nu12
        E3 = E2 if self.E3 is None else self.E3
        nu13, nu23 = (nu12 if nu is None else nu for nu in (self.nu13, self.nu23))
        compliance_33 = np.array(
            [
                [1 / E1, -nu12 / E1, -nu13 / E1],
                [-nu12 / E1, 1 / E2, -nu23 / E2],
                [-nu13 / E1, -nu23 / E2, 1 / E3],
            ]
        )
        normal = compliance_33[:2, :2] if plane == "stress" else compliance_33
        if np.min(np.linalg.eigvalsh(normal)) <= 0:
            raise ValueError(f"nu12: with E1 = {E1} and E2 = {E2} the material would store negative energy, got {nu12}")
        if plane == "solid":
            G23 = E2 / (2.0 * (1.0 + nu23)) if self.G23 is None else self.G23
            D = np.diag([0.0, 0.0, 0.0, G23, self.G12 if self.G13 is None else self.G13, self.G12])
            D[:3, :3] = np.linalg.inv(normal)
            return D
        D = np.zeros((3, 3))
        D[:2, :2] = np.linalg.inv(normal)[:2, :2]
        D[2, 2] = self.G12
        return D


@dataclass(frozen=True)
class Rectangle:
    """A body 0 <= X <= length, above or below Y = 0."""

    length: float
    thickness: float
    moduli: Moduli


#: The upper and the lower body.
Rectangles = tuple[Rectangle, Rectangle]
