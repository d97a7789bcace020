"""Scenes as practitioners write them: ordinary materials, proportions of standards, three systems of units, no numbers
for meshes or steps; a seed gives the same scene everywhere.

Proportions are those of ASTM D5528 (double cantilever beam), D7905 (end-notched flexure) and D6671 (mixed-mode bending)
for laminates, and of the usual tests of wood, metals and polymers; moduli are handbook values.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from math import sqrt
from pathlib import Path
from typing import Any

import numpy as np

from verify.scene.materials import elastic_constants
from verify.scene.parse import parse_scene
from verify.scene.schema import Scene
from verify.scene.specimens.bending import bent_arms, first_opening

#: Systems of units: what a millimetre and a newton are in them.
SYSTEMS: Mapping[str, tuple[float, float]] = {
    "N, mm, MPa": (1.0, 1.0),
    "N, m, Pa": (1e-3, 1.0),
    "lbf, in, psi": (1 / 25.4, 1 / 4.448222),
}
#: Solids in N and mm: ``material``, ranges of ``toughness`` and ``strength``, of isotropic ones of the ``thickness``.
PLAIN_SOLIDS: Mapping[str, Mapping[str, Any]] = tomllib.loads(Path(__file__).with_name("solids.toml").read_text())
WOODS = ("spruce", "beech")
PLAIN_KINDS, OFTEN = ("dcb", "enf", "mmb", "slb"), (0.5, 0.2, 0.2, 0.1)
#: Crack lengths that are tried for the opening at which a crack has grown to its goal.
TRIED = 60
#: Powers of the units of length and force in a key of a scene.
DIMENSIONS: Mapping[str, tuple[int, int]] = {
    **dict.fromkeys(("length", "arm_thickness", "precrack", "width", "lever", "opening"), (1, 0)),
    **dict.fromkeys(("E1", "E2", "G12", "young", "strength", "shear_strength"), (-2, 1)),
    **dict.fromkeys(("toughness", "shear_toughness"), (-1, 1)),
}


def plain_scene(seed: int) -> Scene:
    """The scene ``plain-SEED``."""
    rng = np.random.default_rng([7, seed])
    units, kind = str(rng.choice(list(SYSTEMS), p=(0.6, 0.25, 0.15))), str(rng.choice(PLAIN_KINDS, p=OFTEN))
    laminate = rng.random() < (0.5 if kind == "dcb" else 0.8)
    name = str(
        rng.choice(sorted(name for name, solid in PLAIN_SOLIDS.items() if laminate is ("thickness" not in solid)))
    )
    material, law = _material(rng, PLAIN_SOLIDS[name], kind != "dcb")
    specimen = _specimen(rng, name, kind)
    table: dict[str, Any] = {"specimen": specimen, "material": material, "interface": law, "load": {"opening": 1.0}}
    mine = parse_scene(table)
    grown = specimen["precrack"] + rng.uniform(0.1, 0.5) * (0.9 * specimen["length"] - specimen["precrack"])
    table["load"] = {"opening": _pulled_apart(mine, grown) if kind == "dcb" else _bent(mine, grown)}
    of_units = SYSTEMS[units]
    tables = {key: {k: _in_units(k, v, of_units) for k, v in one.items()} for key, one in table.items()}
    return parse_scene({"name": f"plain-{seed}", "units": units, **tables})


def _material(
    rng: np.random.Generator, solid: Mapping[str, Any], slides: bool
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Material and bond in N and mm."""
    material = dict(solid["material"])
    if "E1" in material:
        material["E1"] *= rng.uniform(0.9, 1.1)
    law: dict[str, Any] = {key: _log(rng, *solid[key]) for key in ("strength", "toughness")}
    if slides:
        law |= {
            "shear_strength": law["strength"] * rng.uniform(1.1, 2.2),
            "shear_toughness": law["toughness"] * rng.uniform(1.5, 4.0),
            "criterion": "bk",
            "exponent": rng.uniform(1.5, 2.6),
        }
    return material, law


def _specimen(rng: np.random.Generator, name: str, kind: str) -> dict[str, Any]:
    """Sizes in mm."""
    wood, thick = name in WOODS, PLAIN_SOLIDS[name].get("thickness")
    thin = not wood and thick is None
    plane = str(rng.choice(["stress", "strain"]))
    if kind == "dcb":
        h = rng.uniform(*(10.0, 14.0) if wood else thick or (1.4, 2.6))
        precrack = rng.uniform(*(60.0, 110.0) if wood else (25.0, 55.0))
        sizes = {"length": precrack + rng.uniform(60.0, 110.0), "precrack": precrack}
    else:
        h = rng.uniform(*(1.5, 2.4) if thin else (4.0, 8.0))
        half = 50.0 if thin else rng.uniform(80.0, 150.0)
        sizes = {"length": 2.0 * half, "precrack": half * rng.uniform(0.5, 0.78)}
        if kind == "mmb":
            sizes["lever"] = half * rng.uniform(0.6, 1.6)
    return {"kind": kind, "arm_thickness": h, **sizes, "width": rng.uniform(15.0, 26.0), "plane": plane}


def _pulled_apart(scene: Scene, grown: float) -> float:
    """Opening of slender arms whose crack has this length, d = 2/3 a^2 (12 G / (E h^3))^(1/2)."""
    E, h = elastic_constants(scene.materials[0])["E1"], scene.specimen.thicknesses[0]
    return min(grown**2 / 1.5 * sqrt(12.0 * scene.interface.toughness / (E * h**3)), 0.9 * grown)


def _bent(scene: Scene, grown: float) -> float:
    """Largest opening on the way of a crack in arms on rollers to this length."""
    arms, tips = bent_arms(scene), np.linspace(scene.specimen.tip, grown, TRIED)
    return max(first_opening(scene, arms, float(tip)) for tip in tips)


def _log(rng: np.random.Generator, low: float, high: float) -> float:
    return float(low * (high / low) ** rng.random())


def _in_units(key: str, value: Any, units: tuple[float, float]) -> Any:
    """A value in N and mm in other units, to three digits."""
    if not isinstance(value, float):
        return value
    of_length, of_force = DIMENSIONS.get(key, (0, 0))
    return float(f"{value * units[0] ** of_length * units[1] ** of_force:.3g}")
