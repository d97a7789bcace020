"""The peel test: a strip bonded on a clamped substrate, its free end pulled up."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem_reference.problem.material import Moduli
from fem_reference.problem.problem import Debonding
from fem_reference.problem.specimen import LOWER, UPPER, Body, Held, Specimen, lines_by_way_of, point

#: Ratio of the thickness of a layer of the substrate to that of the layer above. The stresses of the process zone decay
#: with the depth over the length of the zone; a smaller ratio costs unknowns where they have decayed.
LAYER_RATIO = 2.0


@dataclass(frozen=True, kw_only=True)
class Problem(Debonding):
    """A peel test with a cohesive interface.

    Strip (above) and substrate (below) meet on Y = 0 with their left ends flush at X = 0, and are bonded for X from 0
    to ``bond_length``; beyond, the strip is free. Its right face is pulled up, and the opening is the mean vertical
    displacement of that face. ``layers`` is the number of elements through the strip.

    A point of the strip always faces the point of the substrate that it was bonded to, and gap and traction are
    vertical. This neglects the tilt of the substrate's surface and the sliding of the strip along it; rotations of the
    strip are not restricted.
    """

    strip_length: float
    strip_thickness: float
    substrate_length: float
    substrate_thickness: float
    bond_length: float
    strip: Moduli
    substrate: Moduli

    def __post_init__(self) -> None:
        super().__post_init__()
        lengths = ("strip_length", "strip_thickness", "substrate_length", "substrate_thickness", "bond_length")
        self.require_positive(*lengths)
        if not self.bond_length < self.strip_length:
            raise ValueError(f"bond_length: must be < strip_length = {self.strip_length}, got {self.bond_length}")
        if not self.bond_length <= self.substrate_length:
            text = f"must be <= substrate_length = {self.substrate_length}, got {self.bond_length}"
            raise ValueError(f"bond_length: {text}")
        self.specimen()

    def specimen(self) -> Specimen:
        """Supports: the base of the substrate is clamped, the strip is held in x at one point of its unloaded end."""
        upper, lower, bond = self.strip_length, self.substrate_length, self.bond_length
        X = lines_by_way_of((bond, lower, upper), self.elements)
        strip_Y = np.linspace(0.0, self.strip_thickness, self.layers + 1)
        substrate_Y = -layers(self.substrate_thickness, bond / np.count_nonzero(X[1:] <= bond))[::-1]
        base = (0.0, lower), (-self.substrate_thickness,) * 2
        return Specimen(
            bodies=(
                Body(upper, strip_Y, self.strip.stiffness_IJ(self.plane)),
                Body(lower, substrate_Y, self.substrate.stiffness_IJ(self.plane)),
            ),
            X=X,
            bond=(bond, 0.0),
            facing=(min(lower, upper), 0.0),
            touching=self.presses,
            loads=(1.0, 0.0),
            held=(Held(UPPER, point(0.0, 0.0), (0,)), Held(LOWER, base, (0, 1))),
            hooks=(),
            loaded_at=upper,
        )


def layers(thickness: float, first: float) -> np.ndarray:
    """Boundaries (n + 1,) from 0 to ``thickness`` of the fewest layers whose first is no thicker than ``first``."""
    n = max(1, int(np.ceil(np.log2(thickness / first * (LAYER_RATIO - 1.0) + 1.0) / np.log2(LAYER_RATIO) - 1e-9)))
    tops = (LAYER_RATIO ** np.arange(n + 1) - 1.0) / (LAYER_RATIO**n - 1.0)
    return thickness * tops
