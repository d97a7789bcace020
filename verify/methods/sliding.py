"""A bond that slides: remarks on its keys."""

from __future__ import annotations

from verify.scene.bond.mixed import mixed_bond
from verify.scene.effects import simulated
from verify.scene.schema import Scene
from verify.theory.mixed_toughness import off_criterion

#: The remark before a run with keys that change nothing.
NO_EFFECT = "interface.shear_strength, shear_toughness: without effect, as two equal arms open and do not slide"


def remarks(scene: Scene) -> tuple[str, ...]:
    """A sentence for a scene whose shear keys have no effect, or whose law does not keep its criterion."""
    bond = mixed_bond(scene)
    if bond is None:
        return ()
    return off_criterion(bond) if simulated(scene)["shear"] else (NO_EFFECT,)
