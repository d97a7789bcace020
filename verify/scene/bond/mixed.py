"""The law of a scene for opening and sliding at a point, independent of the laws of the solvers."""

from __future__ import annotations

from verify.scene.effects import simulated
from verify.scene.schema import Scene
from verify.support.refusal import Refusal
from verify.theory.mixed_law import MixedBond


def mixed_bond(scene: Scene) -> MixedBond | None:
    """The bond with its law for opening and sliding; None for a scene without shear keys, whose bond only opens.

    Raises
    ------
    Refusal : at some mode ratio the energy stored at the onset of damage is not below the toughness.
    """
    bond, effects = scene.interface, simulated(scene)
    if bond.shear_strength is None or bond.shear_toughness is None or bond.shear_stiffness is None:
        return None
    return MixedBond(
        law=bond.law,
        strength=(bond.strength, bond.shear_strength),
        toughness=(bond.toughness, bond.shear_toughness),
        stiffness=(bond.bond_stiffness, bond.shear_stiffness),
        penalty=bond.penalty,
        criterion=bond.criterion,
        exponent=bond.exponent,
        onset=bond.onset,
        contact=effects["contact"],
        friction=bond.friction,
        rubs=bond.rubs,
        viscosity=bond.viscosity,
        pressure_strength=bond.pressure_strength,
        plateau=bond.plateau,
        irreversible=effects["irreversible"],
    )


def without_strength(scene: Scene) -> list[str]:
    """A sentence for a bond whose energy at the onset of damage is not below the toughness; it names a mode ratio."""
    try:
        mixed_bond(scene)
    except Refusal as error:
        return [f"interface.{error}"]
    return []
