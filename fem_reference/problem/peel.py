"""The peel test: a strip bonded on a clamped substrate, its free end pulled up."""

from __future__ import annotations

from dataclasses import dataclass

from fem_reference.problem.delamination import strip_on_base
from fem_reference.problem.material import Moduli, Rectangle
from fem_reference.problem.problem import OpeningProblem
from fem_reference.problem.specimen import Specimen


@dataclass(frozen=True, kw_only=True)
class Problem(OpeningProblem):
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
        strip = Rectangle(self.strip_length, self.strip_thickness, self.strip)
        substrate = Rectangle(self.substrate_length, self.substrate_thickness, self.substrate)
        return strip_on_base(self, (strip, substrate), (self.bond_length, 0.0))
