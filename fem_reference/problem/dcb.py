"""The double cantilever beam: two equal arms, pulled apart at one end."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem_reference.problem.delamination import free_arms
from fem_reference.problem.material import Moduli, Rectangle
from fem_reference.problem.problem import OpeningProblem
from fem_reference.problem.specimen import Specimen


@dataclass(frozen=True, kw_only=True)
class Problem(OpeningProblem):
    """A double cantilever beam with a cohesive interface.

    Parameters
    ----------
    length, arm_thickness, precrack : the interface is bonded on ``precrack <= X <= length``, and the faces at X = 0 are
        pulled apart.
    E1, E2, G12, nu12 : moduli [stress] and Poisson's ratio, axis 1 along the specimen; isotropic is E1 = E2,
        G12 = E / (2 (1 + nu)).
    layers : elements through each arm; at least ``PRESSED_END.layers`` if the arms are pressed together.
    """

    length: float
    arm_thickness: float
    precrack: float
    E1: float
    E2: float
    G12: float
    nu12: float

    def __post_init__(self) -> None:
        super().__post_init__()
        self.require_positive("length", "arm_thickness", "precrack", "E1", "E2", "G12")
        if not self.precrack < self.length:
            raise ValueError(f"precrack: must be < length = {self.length}, got {self.precrack}")
        self.specimen()

    @property
    def moduli(self) -> Moduli:
        """Those of the arms."""
        return Moduli(self.E1, self.E2, self.G12, self.nu12)

    @property
    def elasticity_IJ(self) -> np.ndarray:
        """In-plane stiffness D (3, 3) of the arms."""
        return self.moduli.stiffness_IJ(self.plane)

    def specimen(self) -> Specimen:
        arm = Rectangle(self.length, self.arm_thickness, self.moduli)
        return free_arms(self, (arm, arm), (self.precrack, self.length))
