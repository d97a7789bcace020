"""The law of a scene for opening, independent of the laws of the solvers."""

from __future__ import annotations

from dataclasses import fields

from verify.scene.effects import simulated
from verify.scene.schema import Scene
from verify.theory.law import KNOWN_LAWS, Law


def law_of(scene: Scene) -> Law:
    """The traction law as checks and beam implement it, independently of the solvers; `Law` itself for unknown laws."""
    i = scene.interface
    law = KNOWN_LAWS.get(i.law, Law)
    own = {field.name: i.numbers_of_the_law[field.name] for field in fields(law) if field.name in i.numbers_of_the_law}
    return law(i.strength, i.toughness, i.ductility, i.penalty, simulated(scene)["contact"], **own)
