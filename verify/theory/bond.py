"""A bond in plain numbers, from which each code makes its own traction law."""

from __future__ import annotations

from dataclasses import dataclass

from verify.theory.shapes import Keys


@dataclass(frozen=True)
class Bond(Keys):
    """A cohesive bond at one point; one that opens alone has the numbers of mode I and none of mode II.

    Parameters
    ----------
    law : one of `verify.theory.shapes.KNOWN_SHAPES`, whose keys are those of `Keys`, "exponential", or one that a
        single code has
    strength : (p_max,), or (p_max, t_max) in modes I and II (stress)
    toughness : (G_I,) or (G_I, G_II) (energy per area)
    stiffness : (K,) or (K, Ks) (stress per length)
    penalty : stiffness against closing (stress per length)
    criterion, exponent, onset : how both modes mix, see `verify.theory.mixed_law`; None: the onset of the criterion
    contact : if False, (1 - d) K continues into closing, from which no damage comes
    friction : Coulomb's mu on the part of the bond that ``rubs``
    viscosity : a time; damage follows what the jumps ask for by d' = <D - d> / viscosity
    pressure_strength : strength in mode II gained for each unit of contact pressure, at the same toughness
    irreversible : if False, d is what the present jump asks for
    rubs : the part of the bond that friction acts on, "damage" or "area"
    """

    law: str
    strength: tuple[float, ...]
    toughness: tuple[float, ...]
    stiffness: tuple[float, ...]
    penalty: float
    criterion: str = "bk"
    exponent: float = 2.0
    onset: str | None = None
    contact: bool = True
    friction: float = 0.0
    viscosity: float = 0.0
    pressure_strength: float = 0.0
    irreversible: bool = True
    rubs: str = "damage"

    @property
    def slides(self) -> bool:
        """Whether there is a law of sliding."""
        return len(self.strength) > 1

    @property
    def ductility(self) -> float:
        """2 K G_I / p_max^2, the opening at failure over that at the strength of a bilinear law."""
        return 2.0 * self.stiffness[0] * self.toughness[0] / self.strength[0] ** 2
