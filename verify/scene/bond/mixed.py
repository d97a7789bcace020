"""The law of a scene for opening and sliding at a point, independent of the laws of the solvers."""

from __future__ import annotations

from verify.scene.effects import simulated
from verify.scene.schema import Scene
from verify.theory.mixed_law import MixedBond

#: Keys of the bond that its law takes as they are.
SAME_IN_BOTH = "law penalty criterion exponent onset friction rubs viscosity pressure_strength plateau".split()


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
        strength=(bond.strength, bond.shear_strength),
        toughness=(bond.toughness, bond.shear_toughness),
        stiffness=(bond.bond_stiffness, bond.shear_stiffness),
        contact=effects["contact"],
        irreversible=effects["irreversible"],
        **{key: getattr(bond, key) for key in SAME_IN_BOTH},
    )
