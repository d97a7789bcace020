"""A peel test in plain numbers."""

from __future__ import annotations

from dataclasses import dataclass

from iga.specimen.problem import Debonding, Moduli, require, require_positive


@dataclass(frozen=True, kw_only=True)
class Problem(Debonding):
    """A peel test in its own frame.

    Strip (above) and substrate (below) meet on Y = 0 with their left ends flush on X = 0, and are bonded for X from 0
    to ``bond_length``. The opening is the mean displacement across the specimen of the strip's right end, which
    carries the load.
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
