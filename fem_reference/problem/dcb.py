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
    Held,
    Hook,
    Specimen,
    finer_at_first,
    lines_by_way_of,
    point,
)


@dataclass(frozen=True)
class PressedEnd:
    """The mesh at the loaded end of arms that are pressed together, where load and contact balance each other.

    longest : length of the elements at the end, in arm thicknesses; the stresses there fade within about one thickness.
    layers : least number of elements through an arm; one element of degree 2 is 0.5 % too stiff there.
    """

    longest: float = 0.25
    layers: int = 2


PRESSED_END = PressedEnd()


@dataclass(frozen=True, kw_only=True)
class Problem(Debonding):
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
    def elasticity_IJ(self) -> np.ndarray:
        """In-plane stiffness D (3, 3) of the arms."""
        return Moduli(self.E1, self.E2, self.G12, self.nu12).stiffness_IJ(self.plane)

    def specimen(self) -> Specimen:
        """Supports at the far end of the bond: each arm is held in x at one point, the lower one also in y."""
        L, h, D = self.length, self.arm_thickness, self.elasticity_IJ
        layers = max(self.layers, PRESSED_END.layers) if self.presses else self.layers
        Y, X = np.linspace(0.0, h, layers + 1), lines_by_way_of((self.precrack, L), self.elements)
        return Specimen(
            bodies=(Body(L, Y, D), Body(L, -Y[::-1], D)),
            X=finer_at_first(X, PRESSED_END.longest * h) if self.presses else X,
            bond=(self.precrack, L),
            facing=(0.0, L),
            touching=self.presses,
            loads=(1.0, -1.0),
            held=(Held(UPPER, point(L, 0.0), (0,)), Held(LOWER, point(L, 0.0), (0, 1))),
            hooks=self._tie(),
            loaded_at=0.0,
        )

    def _tie(self) -> tuple[Hook, Hook]:
        """A spring of stiffness E1 w between u_x of the outer far corners of the two arms.

        The supports are hinges at one point, so that the whole specimen could rotate about it. The spring prevents that
        and carries no force: nothing else could balance its moment about the hinge, since the loads have no moment as
        long as one loaded face is above the other.
        """
        root = float(np.sqrt(self.E1 * self.width))
        L, h = self.length, self.arm_thickness
        return Hook(UPPER, (L, h), root), Hook(LOWER, (L, -h), -root)
