"""Conditions between a bond that slides, the specimen and the effects."""

from __future__ import annotations

from verify.scene.bond.interface import Interface
from verify.scene.specimens.delamination import Delamination
from verify.scene.tables import refuse


def require_shear(specimen: Delamination, bond: Interface, shear: bool | str, symmetry: bool | str) -> None:
    """Raise where ``effects.shear`` is true without the keys of shear, or false although specimen or bond need it."""
    if shear is True and not bond.slides:
        why = "without interface.shear_strength and interface.shear_toughness"
        raise refuse(f'false or "auto" {why}', (("shear",), True))
    needed = [f"for the kind {specimen.kind}, whose arms nothing else holds"] * bool(specimen.supports)
    needed += [f"with interface.{key}" for key in ("friction", "viscosity") if getattr(bond, key)]
    if shear is False and needed:
        raise refuse(f'true or "auto" {needed[0]}', (("shear",), False))
    if symmetry is True and (shear is True or bond.viscosity):
        raise refuse("false with a law of sliding, which acts between two arms", (("symmetry",), True))
