"""The law of a scene for opening, independent of the laws of the solvers."""

from __future__ import annotations

from dataclasses import fields

from verify.scene.bond.bond import bond_of
from verify.scene.effects import simulated
from verify.scene.schema import Scene
from verify.theory.bond import Bond
from verify.theory.law import KNOWN_LAWS, Law
from verify.theory.shapes import Keys


def law_of(scene: Scene) -> Law:
    """The traction law as checks and beam implement it, independently of the solvers; `Law` itself for unknown laws."""
    return opening_law(bond_of(scene, {**simulated(scene), "shear": False, "irreversible": True}))


def opening_law(bond: Bond) -> Law:
    """The law of a bond in mode I."""
    law = KNOWN_LAWS.get(bond.law, Law)
    own = {one.name: getattr(bond, one.name) for one in fields(Keys) if one in fields(law)}
    numbers = bond.strength[0], bond.toughness[0], bond.ductility, bond.penalty, bond.contact, bond.irreversible
    return law(*numbers, **own)
