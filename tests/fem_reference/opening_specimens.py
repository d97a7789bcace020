"""Specimens whose bond opens alone, by their sizes and the numbers of their law."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from fem_reference.problem.delamination import free_arms, strip_on_base
from fem_reference.problem.law import MODELLED_LAWS, Law, Shaped
from fem_reference.problem.material import Moduli, Rectangle
from fem_reference.problem.problem import Debonding
from fem_reference.problem.specimen import Specimen


@dataclass(frozen=True, kw_only=True)
class Opening(Debonding, Shaped):
    """The bond: p_max, G_Ic, 2 G_Ic / (p_max g_max), the law by name and its stiffness against closing."""

    strength: float
    toughness: float
    ductility: float
    law_name: str = "bilinear"
    penalty: float = 1e5
    contact: bool = True
    irreversible: bool = True

    def __post_init__(self) -> None:
        super().__post_init__()
        self.specimen()

    @property
    def law(self) -> Law:
        shape = MODELLED_LAWS[self.law_name]
        own = {one.name: getattr(self, one.name) for one in fields(Shaped) if one in fields(shape)}
        numbers = self.strength, self.toughness, self.ductility, self.penalty, self.contact, self.irreversible
        return shape(*numbers, **own)


@dataclass(frozen=True, kw_only=True)
class Dcb(Opening):
    """Two equal arms, bonded on ``precrack <= X <= length`` and pulled apart at X = 0."""

    length: float
    arm_thickness: float
    precrack: float
    E1: float
    E2: float
    G12: float
    nu12: float

    @property
    def moduli(self) -> Moduli:
        return Moduli(self.E1, self.E2, self.G12, self.nu12)

    @property
    def elasticity_IJ(self) -> np.ndarray:
        """In-plane stiffness D (3, 3) of the arms."""
        return self.moduli.stiffness_IJ(self.plane)

    def specimen(self) -> Specimen:
        arm = Rectangle(self.length, self.arm_thickness, self.moduli)
        return free_arms(self, (arm, arm), (self.precrack, self.length))


@dataclass(frozen=True, kw_only=True)
class Peel(Opening):
    """A strip on a clamped substrate, left ends flush, bonded up to ``bond_length`` and pulled up at its right end."""

    strip_length: float
    strip_thickness: float
    substrate_length: float
    substrate_thickness: float
    bond_length: float
    strip: Moduli
    substrate: Moduli

    def specimen(self) -> Specimen:
        strip = Rectangle(self.strip_length, self.strip_thickness, self.strip)
        substrate = Rectangle(self.substrate_length, self.substrate_thickness, self.substrate)
        return strip_on_base(self, (strip, substrate), (self.bond_length, 0.0))
