"""Which effects a scene needs: what ``auto`` means."""

from __future__ import annotations

from math import degrees, sqrt
from typing import Any

from verify.schema import Scene

FINITE_ABOVE_DEGREES = 5.0

#: What a method cannot choose: the DOLFINx model has both arms, the beam one; LEFM has no interface.
_FIXED: dict[str, dict[str, Any]] = {
    "dolfinx": {"symmetry": False},
    "beam": {"symmetry": True},
    "lefm": {"symmetry": True, "contact": False},
}


def end_rotation(scene: Scene) -> float:
    """Largest rotation of a loaded end face over the programme, in radians, by simple beam theory.

    With Delta = 2 P a^3 / (3 E I), P_c = sqrt(w G E I) / a and theta = P a^2 / (2 E I), so theta = 3 Delta / (4 a),
    where the crack is the precrack or, if larger, what holds Delta in equilibrium, a^2 = 3/2 Delta sqrt(E I / (w G)).
    """
    specimen, material = scene.specimen, scene.material
    young = getattr(material, "young", None) or material.E1
    stiffness = young * specimen.width * specimen.arm_thickness**3 / 12
    opening = max(map(abs, scene.load.opening))
    grown = sqrt(1.5 * opening * sqrt(stiffness / (specimen.width * scene.interface.toughness)))
    crack = min(max(specimen.precrack, grown), specimen.length)
    return 0.75 * opening / crack


def simulated(scene: Scene, method: str) -> dict[str, Any]:
    """The effects as a method simulates them: ``auto`` replaced by what it stands for, the rest as far as it has it."""
    asked = scene.effects.model_dump()
    if asked["kinematics"] == "auto":
        asked["kinematics"] = "finite" if degrees(end_rotation(scene)) > FINITE_ABOVE_DEGREES else "linear"
    return asked | _FIXED.get(method, {})
