"""The law of a scene for opening and sliding at a point, independent of those of the solvers."""

from __future__ import annotations

from verify.scene.effects import simulated
from verify.scene.schema import Scene
from verify.support.refusal import Refusal
from verify.theory.mixed_law import MixedBond


def mixed_bond(scene: Scene) -> MixedBond | None:
    """The bond as it opens and slides; None for a scene without shear keys, whose bond opens alone.

    Raises
    ------
    Refusal : a bond that stores its toughness before damage begins, at some mode ratio.
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
    """A sentence for a bond whose toughness is used up before damage begins, at a mode ratio that is named."""
    try:
        mixed_bond(scene)
    except Refusal as error:
        return [f"interface.{error}"]
    return []
