"""The law of a scene for opening and sliding at a point, independent of the laws of the solvers."""

from __future__ import annotations

from verify.scene.bond.bond import bond_of
from verify.scene.effects import simulated
from verify.scene.schema import Scene
from verify.theory.mixed_law import MixedBond


def mixed_bond(scene: Scene) -> MixedBond | None:
    """The bond with its law for opening and sliding; None for a scene without shear keys, whose bond only opens.

    Raises
    ------
    Refusal : at some mode ratio the energy stored at the onset of damage is not below the toughness.
    """
    if not scene.interface.slides:
        return None
    return MixedBond(**vars(bond_of(scene, {**simulated(scene), "shear": True})))
