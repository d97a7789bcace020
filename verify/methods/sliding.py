"""What methods make of a bond that slides: they solve its opening, which is all there is between two equal arms."""

from __future__ import annotations

from verify.methods.method import Unsuitable
from verify.scene.schema import Scene

#: Said before a run with keys that change nothing.
NO_EFFECT = "interface.shear_strength, shear_toughness: without effect, as two equal arms open and do not slide"


def refuse_sliding(scene: Scene, who: str) -> None:
    """Raise Unsuitable where the shear keys of a scene would change the answer, which no method knows yet."""
    bond, wrong = scene.interface, []
    if not bond.slides:
        return
    if not scene.specimen.symmetric:
        found = f"got {bond.shear_strength:g} and {bond.shear_toughness:g}"
        left_out = f"must be left out for {who}, as no method solves a {scene.specimen.kind} whose bond slides"
        wrong.append(f"interface.shear_strength, shear_toughness: {left_out}, {found}")
    for key in ("friction", "viscosity"):
        if value := getattr(bond, key):
            wrong.append(f"interface.{key}: must be 0 for {who}, as no method has it, got {value:g}")
    if wrong:
        raise Unsuitable("\n".join(wrong))


def remarks(scene: Scene) -> tuple[str, ...]:
    """A sentence for a scene whose shear keys have no effect."""
    return (NO_EFFECT,) if scene.interface.slides and scene.specimen.symmetric else ()
