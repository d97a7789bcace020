"""Whether modulus, strength, toughness and sizes of a scene are in one set of units, by ratios that have no unit.

A number in the unit of another set is off by a thousand or a million, and such a ratio with it. Slender arms take the
modulus and the toughness together, the process zone all three.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import inf

from verify.scene.materials import axial_modulus
from verify.scene.parse import SceneError, parse_scene
from verify.scene.process_zone import zone_length
from verify.scene.schema import Scene
from verify.scene.specimens.bending import bent_arms, first_opening
from verify.scene.stated.uncertainty import number_at, scaled

#: Keys of one unit, with other units that they are met in, and what takes a number to that of N and mm, or N and m.
STRESS = {"GPa": {"MPa": 1e3, "Pa": 1e9}, "MPa": {"Pa": 1e6}, "Pa": {"MPa": 1e-6}}
ENERGY = {"J/m2": {"MPa": 1e-3}, "N/mm": {"Pa": 1e3}}
OF_UNITS = (
    (("material.young", "material.E1", "material.E2", "material.G12", "strip.young", "substrate.young"), STRESS),
    (("interface.strength", "interface.shear_strength"), STRESS),
    (("interface.toughness", "interface.shear_toughness"), ENERGY),
)


def _strength(scene: Scene) -> float:
    return scene.interface.strength / min(axial_modulus(one, scene.specimen.plane) for one in scene.materials)


def _first_growth(scene: Scene) -> float:
    """Opening of beams at which the crack begins to grow, over its length; ``2/3 a^2 (12 G_Ic / (E' h^3))^(1/2)`` where
    two arms are pulled apart, and 0 of a strip, which bends as far as it likes."""
    body, law = scene.specimen, scene.interface
    if not body.slides:
        E, h = axial_modulus(scene.materials[0], body.plane), body.thicknesses[0]
        return body.free_length / 1.5 * (12.0 * law.toughness / (E * h**3)) ** 0.5 if body.arms == 2 else 0.0
    opening = first_opening(scene, bent_arms(scene), body.tip)
    return opening / body.free_length if opening < inf else 0.0


#: What is compared, in words, and where it is possible, and usual. In all packaged scenes, and 600 of random numbers
#: and of ordinary materials, the strength is 4e-7 to 1.2 of the modulus, the first growth at 0 to 0.85 of the crack,
#: the zone up to 0.24 of the length and 0.007 or more of the thickness.
RATIOS: tuple[tuple[str, Callable[[Scene], float], tuple[float, float], tuple[float, float]], ...] = (
    ("the strength is {:.2g} times the modulus", _strength, (1e-8, 3.0), (1e-6, 0.03)),
    ("the crack begins to grow at an opening of {:.2g} times its length", _first_growth, (0.0, 1.5), (0.0, 1.0)),
    (
        "the process zone is {:.2g} times as long as the specimen",
        lambda scene: zone_length(scene) / scene.specimen.extent,
        (0.0, 1.0),
        (0.0, 0.5),
    ),
    (
        "the process zone is {:.2g} times as long as an arm is thick",
        lambda scene: zone_length(scene) / scene.specimen.loaded_thickness,
        (1e-4, inf),
        (1e-3, inf),
    ),
)


def remarks(scene: Scene) -> tuple[str, ...]:
    """A sentence where the numbers do not belong together, with the unit that would explain it."""
    odd = [words.format(size) for words, of, (low, high), _ in RATIOS if not low <= (size := of(scene)) <= high]
    if not odd:
        return ()
    likely = " or ".join(_likely(scene))
    then = f"; they do with {likely}" if likely else ""
    return (f"modulus, strength and toughness seem to be in different units: {odd[0]}{then}",)


def _likely(scene: Scene) -> Iterator[str]:
    """The keys of one unit with the unit that makes every ratio a usual one."""
    own = [part.strip() for part in scene.units.split(",")][-1]
    for keys, units in OF_UNITS:
        values = {key: value for key in keys if isinstance(value := number_at(scene, key), float)}
        for unit, factors in units.items() if values else ():
            for base, factor in factors.items():
                changed = [f"{key}={scaled(value, factor)}" for key, value in values.items()]
                if own in (base, "consistent units") and _usual(scene, changed):
                    first, value = next(iter(values.items()))
                    yield f"{first} = {value * factor:.6g}, if {value:.6g} is in {unit}"


def _usual(scene: Scene, overrides: list[str]) -> bool:
    try:
        changed = parse_scene({**scene.model_dump(exclude_unset=True), "published": []}, overrides)
    except SceneError:
        return False
    return all(low <= of(changed) <= high for _, of, _, (low, high) in RATIOS)
