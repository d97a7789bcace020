"""What the model is asked to solve: one double cantilever beam, in plain numbers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Problem:
    """A double cantilever beam with a cohesive interface, in any consistent set of units.

    Parameters
    ----------
    length, arm_thickness, precrack, width : the specimen; the interface is bonded on ``precrack <= X <= length``.
    plane : "stress" or "strain".
    E1, E2, G12, nu12 : moduli, axis 1 along the specimen; isotropic is E1 = E2, G12 = E / (2 (1 + nu)).
    strength, toughness, ductility, penalty : bilinear law p_max, G_Ic, g_u / g_max, and the stiffness against closing.
    contact : where false, the secant of the opening side continues into closing.
    irreversible : where false, damage follows the present gap and nothing is dissipated.
    opening : the displacement programme, for instance ``(3.0,)`` or ``(1.5, 0.0, 3.0)``; it starts at zero.
    kinematics : "linear" or "finite".
    symmetry : must be false, both arms are modelled.
    degree, elements, elements_across : Lagrange degree 1 to 4, elements along the specimen and through one arm.
    steps : equal opening increments over the whole programme, ends of its branches added.
    snapshot_openings : fields are kept at the first converged step that reaches each of these openings.
    """

    length: float
    arm_thickness: float
    precrack: float
    E1: float
    E2: float
    G12: float
    nu12: float
    strength: float
    toughness: float
    ductility: float
    width: float = 1.0
    plane: str = "stress"
    penalty: float = 1e5
    contact: bool = True
    irreversible: bool = True
    opening: tuple[float, ...] = (3.0,)
    kinematics: str = "finite"
    symmetry: bool = False
    degree: int = 2
    elements: int = 112
    elements_across: int = 1
    steps: int = 150
    snapshot_openings: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        if self.symmetry:
            raise ValueError("symmetry: this model has both arms; use symmetry = false")
        _one_of("plane", self.plane, ("stress", "strain"))
        _one_of("kinematics", self.kinematics, ("linear", "finite"))
        _one_of("degree", self.degree, (1, 2, 3, 4))
        lengths = ("length", "arm_thickness", "precrack", "width")
        moduli = ("E1", "E2", "G12", "strength", "toughness", "penalty")
        for name in (*lengths, *moduli, "elements_across", "steps"):
            if not getattr(self, name) > 0:
                raise ValueError(f"{name}: must be > 0, got {getattr(self, name)}")
        if not self.precrack < self.length:
            raise ValueError(f"precrack: must be < length = {self.length}, got {self.precrack}")
        if not self.ductility > 1:
            raise ValueError(f"ductility: must be > 1, got {self.ductility}")
        if self.elements < 2:
            raise ValueError(f"elements: must be >= 2, one on the precrack and one on the bond, got {self.elements}")
        in_plane_stiffness(self.E1, self.E2, self.G12, self.nu12, self.plane)
        if not np.any(self.opening):
            raise ValueError(f"opening: must have an opening other than 0, got {self.opening}")

    @property
    def elasticity_IJ(self) -> np.ndarray:
        """In-plane stiffness D (3, 3), stress = D (E11, E22, 2 E12)."""
        return in_plane_stiffness(self.E1, self.E2, self.G12, self.nu12, self.plane)


def in_plane_stiffness(E1: float, E2: float, G12: float, nu12: float, plane: str) -> np.ndarray:
    """Stiffness (3, 3) of an orthotropic sheet in Voigt order 11, 22, 12 with engineering shear.

    Plane stress inverts the in-plane compliance. Plane strain inverts the compliance of the solid and takes its
    in-plane block; the solid's third direction is a second transverse one: E3 = E2, nu13 = nu12, nu23 = nu12. Both
    reduce to the usual isotropic matrices where E1 = E2 (Jones 1999, Mechanics of Composite Materials, ch. 2).
    Raises ValueError where the compliance is not positive definite.
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


def _one_of(name: str, value: object, allowed: tuple) -> None:
    if value not in allowed:
        raise ValueError(f"{name}: must be one of {', '.join(map(str, allowed))}, got {value}")
