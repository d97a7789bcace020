"""The double cantilever beam: two equal arms, pulled apart at one end."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem_reference.problem.material import Moduli
from fem_reference.problem.problem import Debonding
from fem_reference.problem.specimen import (
    LOWER,
    UPPER,
    Body,
    Face,
    Held,
    Hook,
    Specimen,
    finer_at_first,
    lines_by_way_of,
    point,
)

#: Where the arms are pressed together, elements at the loaded end are no longer than this part of their thickness: load
#: and contact balance each other within about one thickness. So many of them, at least, are then through an arm: one of
#: degree 2 is 0.5 % too stiff there.
PRESSED, ACROSS = 0.25, 2


@dataclass(frozen=True, kw_only=True)
class Problem(Debonding):
    """A double cantilever beam with a cohesive interface.

    Parameters
    ----------
    length, arm_thickness, precrack : the specimen; the interface is bonded on ``precrack <= X <= length``, and the
        faces at X = 0 are pulled apart.
    E1, E2, G12, nu12 : moduli, axis 1 along the specimen; isotropic is E1 = E2, G12 = E / (2 (1 + nu)).
    symmetry : must be false, both arms are modelled.
    elements_across : elements through one arm; `ACROSS` at least where the arms are pressed together.
    """

    length: float
    arm_thickness: float
    precrack: float
    E1: float
    E2: float
    G12: float
    nu12: float
    symmetry: bool = False
    elements_across: int = 1

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.symmetry:
            raise ValueError("symmetry: this model has both arms; use symmetry = false")
        self.require_positive("length", "arm_thickness", "precrack", "E1", "E2", "G12", "elements_across")
        self.require_place(self.elements_across)
        if not self.precrack < self.length:
            raise ValueError(f"precrack: must be < length = {self.length}, got {self.precrack}")
        self.specimen()

    @property
    def elasticity_IJ(self) -> np.ndarray:
        """In-plane stiffness D (3, 3) of the arms."""
        return Moduli(self.E1, self.E2, self.G12, self.nu12).stiffness_IJ(self.plane)

    def specimen(self) -> Specimen:
        """Supports at the far end of the bond: each arm is held in x at one point, the lower one also in y."""
        L, h, D = self.length, self.arm_thickness, self.elasticity_IJ
        across = max(self.elements_across, ACROSS) if self.presses else self.elements_across
        Y, X = np.linspace(0.0, h, across + 1), lines_by_way_of((self.precrack, L), self.elements)
        return Specimen(
            bodies=(Body(L, Y, D), Body(L, -Y[::-1], D)),
            X=finer_at_first(X, PRESSED * h) if self.presses else X,
            bond=(self.precrack, L),
            facing=(0.0, L),
            touching=self.presses,
            faces=(
                Face(UPPER, 0.0, load=1.0, energy=1.0),
                Face(LOWER, 0.0, load=-1.0, energy=1.0),
                Face(UPPER, L, load=0.0, energy=-1.0),
                Face(LOWER, L, load=0.0, energy=-1.0),
            ),
            held=(Held(UPPER, point(L, 0.0), (0,)), Held(LOWER, point(L, 0.0), (0, 1))),
            hooks=self._tie(),
            loaded_at=0.0,
        )

    def _tie(self) -> tuple[Hook, Hook]:
        """A spring between u_x of the upper and u_x of the lower far corner.

        The supports are hinges at one point, about which the whole specimen turns freely. The spring holds it and
        carries nothing: by itself it could not balance about the hinge, and the loads have no moment while one loaded
        face is above the other, which is where both corners move alike.
        """
        root = float(np.sqrt(self.E1 * self.width))
        L, h = self.length, self.arm_thickness
        return Hook(UPPER, (L, h), root), Hook(LOWER, (L, -h), -root)
