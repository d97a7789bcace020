"""The laws of the solvers with the numbers of a bond, and remarks on these numbers."""

from __future__ import annotations

from dataclasses import fields
from typing import TYPE_CHECKING, Any

from verify.scene.bond import plausible
from verify.scene.bond.mixed import mixed_bond
from verify.scene.effects import simulated
from verify.scene.schema import Scene
from verify.theory.bond import Bond
from verify.theory.mixed_law import MixedBond
from verify.theory.mixed_toughness import off_criterion

if TYPE_CHECKING:
    from fem_reference.problem.law import Law as ModelledLaw
    from fem_reference.problem.mixed_law import MixedLaw as ModelledMixedLaw
    from iga.laws.law import Law

#: The remark before a run with keys that change nothing.
NO_EFFECT = "interface.shear_strength, shear_toughness: without effect, as two equal arms open and do not slide"


def iga_law(bond: Bond) -> Law:
    """The law of ``iga``."""
    from iga.laws.laws import LAWS
    from iga.laws.mode_ratio import ModeRatio

    law, mixing = LAWS[bond.law], (bond.criterion, bond.exponent, _both(bond).onset_rule) if bond.slides else ()
    return law(ModeRatio(bond.toughness, bond.strength, bond.stiffness, *mixing), **_shared(bond, law))


def modelled_law(bond: Bond) -> ModelledLaw | ModelledMixedLaw:
    """The law of ``fem_reference``."""
    from fem_reference.problem.law import MODELLED_LAWS
    from fem_reference.problem.mixed_laws import MODELLED_MIXED_LAWS

    if not bond.slides:
        opening = MODELLED_LAWS[bond.law]
        return opening(bond.strength[0], bond.toughness[0], bond.ductility, **_shared(bond, opening))
    both, mixed = _both(bond), MODELLED_MIXED_LAWS[bond.law]
    modes = {"strength": both.strength, "toughness": both.toughness, "stiffness": both.slopes}
    numbers: dict[str, Any] = {name: normal for name, (normal, _) in modes.items()}
    numbers |= {f"shear_{name}": shear for name, (_, shear) in modes.items()}
    return mixed(**numbers, **{**_shared(bond, mixed), "onset": both.onset_rule})


def _both(bond: Bond) -> MixedBond:
    return bond if isinstance(bond, MixedBond) else MixedBond(**vars(bond))


def _shared(bond: Bond, law: type) -> dict[str, Any]:
    """Numbers that a law calls by the same name as the bond."""
    names = {field.name for field in fields(law)} - {"strength", "toughness", "stiffness"}
    return {name: getattr(bond, name) for name in names if name in vars(bond)}


def remarks(scene: Scene) -> tuple[str, ...]:
    """A sentence for numbers in different units, shear keys without effect, a law that does not keep its criterion."""
    bond, units = mixed_bond(scene), plausible.remarks(scene)
    if bond is None:
        return units
    return units + (off_criterion(bond) if simulated(scene)["shear"] else (NO_EFFECT,))
