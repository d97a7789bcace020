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
    return MIXED_LAWS[bond.law](modes, irreversible=bond.irreversible, **_shared(bond))


def modelled_law(bond: MixedBond) -> ModelledLaw:
    """The law of ``fem_reference`` with the numbers of a bond."""
    from fem_reference.problem.mixed_laws import MODELLED_MIXED_LAWS

    modes = {"strength": bond.strength, "toughness": bond.toughness, "stiffness": bond.slopes}
    numbers: dict[str, Any] = {name: opening for name, (opening, _) in modes.items()}
    numbers |= {f"shear_{name}": sliding for name, (_, sliding) in modes.items()}
    return MODELLED_MIXED_LAWS[bond.law](
        **numbers,
        criterion=bond.criterion,
        exponent=bond.exponent,
        onset=bond.onset_rule,
        **_shared(bond),
    )


def _shared(bond: MixedBond) -> dict[str, Any]:
    """Numbers that both laws call by the same names; a plateau has the trapezoidal one alone."""
    names = ("penalty", "contact", "friction", "viscosity", "pressure_strength", "rubs")
    return {name: getattr(bond, name) for name in (*names, *["plateau"] * (bond.law == TRAPEZOIDAL))}
