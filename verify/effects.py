"""Which effects a scene needs: what ``auto`` means."""

from __future__ import annotations

from math import degrees, sqrt
from typing import Any

from verify.schema import Scene

FINITE_ABOVE_DEGREES = 5.0

#: What a method cannot choose: the DOLFINx model has both arms, the beam one; LEFM has no interface. Beneath the strip
#: of a peel test the beam has its substrate, too.
_FIXED: dict[str, dict[str, Any]] = {
    "dolfinx": {"symmetry": False},
    "beam": {"symmetry": True},
    "lefm": {"symmetry": True, "contact": False},
}


def end_rotation(scene: Scene) -> float:
    """Largest rotation of a loaded end face over the programme, in radians, by simple beam theory.

    An arm of bending stiffness E I, bent to the deflection d over a free length a, turns by theta = 3 d / (2 a). The
    free length is that before any growth or, if larger, that at the end.
    """
    specimen = scene.specimen
    length = specimen.strip_length if specimen.kind == "peel" else specimen.length
    free = min(max(specimen.free_length, specimen.loaded_thickness, crack_at_the_end(scene)), length)
    return 1.5 * _deflection(scene) / free


def crack_at_the_end(scene: Scene) -> float:
    """Free length that holds the largest opening in equilibrium, by simple beam theory, however long the specimen is.

    d = a^2/3 sqrt(c w G / (E I)). Of a dcb d is half the opening and c = 1, as two arms share G; a strip is peeled
    alone, and c = 2.
    """
    specimen = scene.specimen
    material, share = (scene.strip, 2.0) if specimen.kind == "peel" else (scene.material, 1.0)
    young = getattr(material, "young", None) or material.E1
    bending = young * specimen.width * specimen.loaded_thickness**3 / 12
    return sqrt(3 * _deflection(scene) * sqrt(bending / (share * specimen.width * scene.interface.toughness)))


def _deflection(scene: Scene) -> float:
    """Largest deflection of an arm."""
    opening = max(map(abs, scene.load.opening))
    return opening if scene.specimen.kind == "peel" else opening / 2


def simulated(scene: Scene, method: str) -> dict[str, Any]:
    """The effects as a method simulates them: ``auto`` replaced by what it stands for, the rest as far as it has it."""
    asked = scene.effects.model_dump()
    if asked["kinematics"] == "auto":
        asked["kinematics"] = "finite" if degrees(end_rotation(scene)) > FINITE_ABOVE_DEGREES else "linear"
    fixed = _FIXED.get(method, {})
    return asked | ({**fixed, "symmetry": False} if method == "beam" and scene.specimen.kind == "peel" else fixed)
