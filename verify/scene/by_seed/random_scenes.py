"""Random double cantilever beams, from slender to stocky, in any units; a seed gives the same scene everywhere."""

from __future__ import annotations

from math import ceil, sqrt
from typing import Any

import numpy as np
from scipy.optimize import brentq

from verify.scene.parse import parse_scene
from verify.scene.process_zone import bulk_length, slender_length
from verify.scene.schema import Scene

#: Elements that a mesh has in the process zone.
PER_ZONE = 5.0
#: Process zones along the specimen, at most: a longer one would take minutes to solve.
ZONES = 90.0


def name_of(seed: int) -> str:
    """The name of the scene of a seed, also in commands."""
    return f"random-{seed}"


def random_scene(seed: int) -> Scene:
    """A scene of the family that every code has to solve.

    The slenderness a0/h goes from 4 to 85, the process zone from 0.3 to 10 arm thicknesses, both evenly in their
    logarithms; isotropic and orthotropic arms, plane stress and strain, small and large displacements, ductility from
    1.5 to 50, lengths and forces in units between 1/1000 and 1000. Combinations with more than `ZONES` process zones
    along the specimen are drawn again. The bond is long enough for the crack to grow by three zones.
    """
    rng = np.random.default_rng(seed)
    while True:
        slenderness, zone = 4.0 * (85.0 / 4.0) ** rng.random(), 0.3 * (10.0 / 0.3) ** rng.random()
        bond = max(6.0 * zone, 6.0, 0.6 * slenderness)
        if (slenderness + bond) / zone <= ZONES:
            return _scene(rng, seed, slenderness, zone, bond)


def _scene(rng: np.random.Generator, seed: int, slenderness: float, zone: float, bond: float) -> Scene:
    """``zone`` and ``bond`` in arm thicknesses."""
    length_unit, force_unit = 10.0 ** rng.uniform(-3.0, 3.0, 2)
    stress_unit = force_unit / length_unit**2
    h, a0, modulus = length_unit, slenderness * length_unit, 1e4 * stress_unit
    plane = str(rng.choice(["stress", "strain"]))
    kinematics = str(rng.choice(["linear", "finite"]))
    material = _material(rng, modulus)
    width = h * rng.uniform(0.5, 20.0)
    rotation = rng.uniform(0.01, 0.05 if kinematics == "linear" else 0.4)
    toughness = modulus * h**3 / 12.0 * (2.0 * rotation / a0) ** 2  # the crack grows at this rotation of the end
    growth = a0 * rotation * 4.0 / 3.0  # opening at which the crack grows
    scene: dict[str, Any] = {
        "name": name_of(seed),
        "specimen": {
            "kind": "dcb", "length": a0 + bond * h, "arm_thickness": h, "precrack": a0, "width": width, "plane": plane,
        },
        "material": material,
        "interface": {"toughness": toughness, "ductility": 1.5 * (50.0 / 1.5) ** rng.random()},
        "load": {"opening": growth * rng.uniform(1.4, 2.2)},
        "effects": {"kinematics": kinematics},
    }  # fmt: skip
    guess = sqrt(modulus * toughness / (zone * h))
    scene["interface"] |= {"strength": guess, "penalty": modulus / h}
    tried = parse_scene(scene)
    bulk, slender = bulk_length(tried), slender_length(tried)  # proportional to strength^-2 and strength^(-1/2)
    strength = guess * brentq(lambda x: x**2 / bulk + x**0.5 / slender - 1.0 / (zone * h), 0.0, 1e3)
    stiffness = strength**2 * scene["interface"]["ductility"] / (2.0 * toughness)
    scene["interface"] |= {"strength": strength, "penalty": 10.0 * stiffness}
    along = (slenderness + bond) / zone * PER_ZONE
    scene["dolfinx"] = {"elements": max(40, ceil(along))}
    scene["discretization"] = {"dofs": max(600, ceil(16.0 * (along + 6.0)))}
    return parse_scene(scene)


def _material(rng: np.random.Generator, modulus: float) -> dict[str, float]:
    if rng.random() < 0.5:
        return {"young": modulus, "poisson": rng.uniform(0.0, 0.45)}
    across = 1.5 * (20.0 / 1.5) ** rng.random()
    nu12 = rng.uniform(0.0, min(0.35, 0.5 * sqrt(across)))
    return {"E1": modulus, "E2": modulus / across, "G12": modulus / across * rng.uniform(0.35, 0.7), "nu12": nu12}
