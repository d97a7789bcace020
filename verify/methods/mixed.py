"""The mixed-mode law of a scene, in the terms of the solvers."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from verify.scene.bond.mixed import mixed_bond
from verify.scene.laws import TRAPEZOIDAL
from verify.scene.schema import Scene

if TYPE_CHECKING:
    from fem_reference.problem.mixed_law import MixedLaw as ModelledLaw
    from iga.laws.mixed_law import MixedLaw
    from verify.theory.mixed_law import MixedBond


def sliding_law(scene: Scene, effects: Mapping[str, Any]) -> MixedLaw | None:
    """The law of ``iga`` for opening and sliding; None where the bond opens alone."""
    bond = mixed_bond(scene) if effects["shear"] else None
    return None if bond is None else iga_law(bond)


def iga_law(bond: MixedBond) -> MixedLaw:
    """The law of ``iga`` with the numbers of a bond."""
    from iga.laws.mixed_laws import MIXED_LAWS
    from iga.laws.mode_ratio import ModeRatio

    modes = ModeRatio(bond.toughness, bond.strength, bond.slopes, bond.criterion, bond.exponent, bond.onset_rule)
    return MIXED_LAWS[bond.law](
        modes,
        bond.penalty,
        contact=bond.contact,
        irreversible=bond.irreversible,
        friction=bond.friction,
        viscosity=bond.viscosity,
        pressure_strength=bond.pressure_strength,
        rubs=bond.rubs,
        **_own(bond),
    )


def modelled_law(bond: MixedBond) -> ModelledLaw:
    """The law of ``fem_reference`` with the numbers of a bond."""
    from fem_reference.problem.mixed_laws import MODELLED_MIXED_LAWS

    return MODELLED_MIXED_LAWS[bond.law](
        strength=bond.strength[0],
        shear_strength=bond.strength[1],
        toughness=bond.toughness[0],
        shear_toughness=bond.toughness[1],
        stiffness=bond.slopes[0],
        shear_stiffness=bond.slopes[1],
        penalty=bond.penalty,
        criterion=bond.criterion,
        exponent=bond.exponent,
        onset=bond.onset_rule,
        contact=bond.contact,
        friction=bond.friction,
        viscosity=bond.viscosity,
        pressure_strength=bond.pressure_strength,
        rubs=bond.rubs,
        **_own(bond),
    )


def _own(bond: MixedBond) -> dict[str, Any]:
    """Parameters that only this law has."""
    return {"plateau": bond.plateau} if bond.law == TRAPEZOIDAL else {}
