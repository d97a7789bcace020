"""The peel test: a delamination specimen of a strip on a clamped substrate, the strip's free end pulled up."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from iga.delamination import build, solve
from iga.specimen.layout import Clamp, Layout, Load, Moduli, Rectangle
from iga.specimen.opening import OpeningProblem
from iga.specimen.ranges import require, require_positive

__all__ = ["Moduli", "Problem", "build", "solve"]


@dataclass(frozen=True, kw_only=True)
class Problem(OpeningProblem):
    """A peel test in its own frame.

    Strip (above) and substrate (below) meet on Y = 0 with their left ends flush on X = 0, and are bonded for X from 0
    to ``bond_length``. The opening is the mean displacement of the strip's right end, which carries the load, across
    the specimen.
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
        require_positive(self, *lengths)
        bond, strip, substrate = self.bond_length, self.strip_length, self.substrate_length
        rule = f"< strip_length = {strip:g} and <= substrate_length = {substrate:g}"
        require(self, "bond_length", bond < strip and bond <= substrate, rule)

    @cached_property
    def layout(self) -> Layout:
        strip = Rectangle(self.strip_length, self.strip_thickness, self.strip)
        substrate = Rectangle(self.substrate_length, self.substrate_thickness, self.substrate)
        return Layout((strip, substrate), (self.bond_length, 0.0), (Load(0, "right", 1.0),), (Clamp(1, "bottom"),))
