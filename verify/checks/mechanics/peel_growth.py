"""Identities of load and peel angle while a strip is peeled off a clamped substrate."""

from __future__ import annotations

import numpy as np

from verify.checks.mechanics.columns import (
    Steps,
    end_area,
    far_from_end,
    has,
    law_of,
    loading,
    tip_is_open,
    zone_is_new,
)
from verify.checks.mechanics.identity import identity
from verify.checks.mechanics.j_integral import j_tolerance
from verify.scene import process_zone
from verify.scene.effects import simulated
from verify.scene.materials import axial_modulus, elastic_constants
from verify.scene.schema import Scene

#: Distance of the damage front from the far end, over the length, within which the zone counts as at the end.
AT_THE_END = 1e-9


@identity(
    "growth-load",
    j_tolerance,
    "While the crack grows the load is at least G_Ic times the width.",
    of_zone=True,
    of_face=True,
)
def growth_load(scene: Scene, steps: Steps) -> np.ndarray | None:
    """Relative amount by which the load falls below G_Ic w while the crack of a peel grows.

    With finite kinematics ``J w = load s - w sum of the face energies = G_Ic w``, with the slope s = du_y/dX =
    lambda sin(theta) of the loaded face. The slope s is at most 1, unless the load stretches an upright strip: lambda =
    1 + load / (E h w), 0.2 % in peel-soft. So load max(s, 1) is at least G_Ic w, less the energy at the far end, which
    is not released (see `j_deviation`).
    """
    steady = growing(scene, steps) & away_from_flush_end(scene, steps)
    if not steady.any() or simulated(scene)["kinematics"] == "linear":
        return None
    pull = steps["load"] * np.maximum(np.abs(steps.get("face_slope_top", 1.0)), 1.0)
    return np.minimum(pull[steady] / _available_energy(scene, steps)[steady] - 1.0, 0.0)


@identity(
    "growth-angle",
    0.01,
    "In the end load sin(theta) is G_Ic times the width.",
    "face_slope_top",
    kind="analytical",
    of_zone=True,
    of_face=True,
)
def growth_angle(scene: Scene, steps: Steps) -> float | None:
    """load sin(theta) / (G_Ic w) - 1 at the last step at which the crack of a peel grows away from the flush end.

    It is 0 for an inextensible strip on a rigid substrate (Rivlin 1944 for theta = 90 degrees; elastica). Otherwise J
    also contains the energy on the end faces. That on the loaded face is due to the load alone and is subtracted:
    ``P^2 / (2 h w) (sin(theta)^2 / E1 + cos(theta)^2 / G12)`` (Kendall 1975 for theta = 90 degrees).
    """
    steady = growing(scene, steps) & away_from_flush_end(scene, steps)
    if not steady.any():
        return None
    last = np.flatnonzero(steady)[-1]
    load, sine = steps["load"][last], abs(steps["face_slope_top"][last])
    body, strip = scene.specimen, scene.materials[0]
    along = 0.0 if simulated(scene)["kinematics"] == "linear" else min(sine, 1.0) ** 2
    E1, G12 = axial_modulus(strip, body.plane), elastic_constants(strip)["G12"]
    on_face = load**2 / (2.0 * body.loaded_thickness * body.width) * (along / E1 + (1.0 - along) / G12)
    pull = load * sine - on_face
    return float(pull / _available_energy(scene, steps)[last] - 1.0)


def _available_energy(scene: Scene, steps: Steps) -> np.ndarray:
    """Energy per length that a crack needs to grow, at every step (n_steps,): G_Ic w less the energy at the far end."""
    return (scene.interface.toughness - end_area(scene, steps)) * scene.specimen.width


def growing(scene: Scene, steps: Steps) -> np.ndarray:
    """Steps (n_steps,) of a peel with a complete process zone: the tip is open and the damage front is in the bond.

    All False for another specimen, a bond that slides, or without the columns.
    """
    if (
        not scene.specimen.clamped
        or simulated(scene)["shear"]
        or not has(steps, "tip_opening", "damage_front", "dissipated_energy")
    ):
        return np.zeros(steps["opening"].size, dtype=bool)
    open_ = tip_is_open(scene, steps)
    inside = steps["damage_front"] < (1.0 - AT_THE_END) * scene.specimen.extent
    pulled = (steps["opening"] > 0.0) & zone_is_new(scene, steps)
    return open_ & inside & loading(steps) & far_from_end(scene, steps) & pulled


def away_from_flush_end(scene: Scene, steps: Steps) -> np.ndarray:
    """Steps (n_steps,) of a peel whose process zone does not stress the flush end: the distance is at least four decay
    lengths of the strip and twice the thickness of the substrate.

    Ahead of the front the stresses in strip and substrate decay as ``exp(-x / l)``, l = (4 E I / K w)^(1/4) for a beam
    on the foundation K of bond and substrate in series. The energy on the flush faces, which load sin(theta) does not
    contain, decays as ``exp(-2 x / l)``: 3e-4 of G_Ic at four lengths. Those in a substrate that is clamped below decay
    as ``exp(-pi x / 2 t)``.
    """
    if "damage_front" not in steps or not scene.specimen.clamped:
        return np.zeros(steps["opening"].size, dtype=bool)
    body, law, plane = scene.specimen, law_of(scene), scene.specimen.plane
    (strip, substrate), (_, base) = scene.materials, body.thicknesses
    K = 1.0 / (1.0 / law.stiffness + base / process_zone.across_modulus(substrate, plane))
    bending = axial_modulus(strip, plane) * body.loaded_thickness**3 / 12.0
    away = max(4.0 * (4.0 * bending / K) ** 0.25, 2.0 * base)
    return steps["damage_front"] <= body.extent - away
