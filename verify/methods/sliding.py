"""A bond that slides: refusals of methods that cannot solve it, and remarks on its keys."""

from __future__ import annotations

from verify.methods.method import Prepared, Unsuitable
from verify.methods.names import METHODS, have_it
from verify.scene.bond.mixed import mixed_bond
from verify.scene.effects import simulated
from verify.scene.laws import mixed
from verify.scene.schema import Scene
from verify.support.refusal import one_of
from verify.theory.mixed_toughness import off_criterion

#: The remark before a run with keys that change nothing.
NO_EFFECT = "interface.shear_strength, shear_toughness: without effect, as two equal arms open and do not slide"


def refuse_sliding(prepared: Prepared) -> None:
    """Raise Unsuitable where the bond of a scene slides and the method can only solve a bond that opens."""
    scene, method = prepared.scene, prepared.method
    if not prepared.effects["shear"]:
        return
    if not method.slides:
        able = have_it(name for name, other in METHODS.items() if other.slides)
        text = f"must be left out for {method.name}, which solves no {scene.specimen.kind} whose bond slides; {able}"
        raise Unsuitable(f"interface.shear_strength, shear_toughness: {text}")
    if scene.interface.law not in mixed():
        raise Unsuitable(f"interface.law: must be {one_of(mixed())} where it slides, got {scene.interface.law!r}")


def remarks(scene: Scene) -> tuple[str, ...]:
    """A sentence for a scene whose shear keys have no effect, or whose law does not keep its criterion."""
    bond = mixed_bond(scene)
    if bond is None:
        return ()
    return off_criterion(bond) if simulated(scene)["shear"] else (NO_EFFECT,)
