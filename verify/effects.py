"""Which effects a scene needs: what ``auto`` means."""

from __future__ import annotations

from math import degrees, sqrt
from typing import Any

from verify.schema import Scene

FINITE_ABOVE_DEGREES = 5.0


def end_rotation(scene: Scene) -> float:
    """Largest rotation of a loaded end face over the programme, in radians, by simple beam theory.

    With Delta = 2 P a^3 / (3 E I), P_c = sqrt(w G E I) / a and theta = P a^2 / (2 E I), so theta = 3 Delta / (4 a),
    where the crack is the larger of the precrack and what holds Delta in equilibrium, a^2 = 3/2 Delta sqrt(E I / (w G)).
    """
    specimen, material = scene.specimen, scene.material
    young = getattr(material, "young", None) or material.E1
    stiffness = young * specimen.width * specimen.arm_thickness**3 / 12
    opening = max(map(abs, scene.load.opening))
    grown = sqrt(1.5 * opening * sqrt(stiffness / (specimen.width * scene.interface.toughness)))
    crack = min(max(specimen.precrack, grown), specimen.length)
    return 0.75 * opening / crack


def simulated(scene: Scene) -> dict[str, Any]:
    """The effects as they are simulated: ``auto`` replaced by what it stands for."""
    asked = scene.effects.model_dump()
    finite = degrees(end_rotation(scene)) > FINITE_ABOVE_DEGREES
    return asked | {"kinematics": "finite" if finite else "linear"} if asked["kinematics"] == "auto" else asked
