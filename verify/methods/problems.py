"""A scene in the terms that several solvers share: keys of their problems."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields
from typing import Any

from verify.methods.method import Unsuitable
from verify.scene.materials import axial_modulus, elastic_constants
from verify.scene.schema import Scene, counted_steps

#: Fractions of the largest opening at which fields are stored: before and near the peak, during growth, at the end.
SNAPSHOT_FRACTIONS = (0.1, 0.2, 0.5, 1.0)


def common_keys(scene: Scene, effects: Mapping[str, Any]) -> dict[str, Any]:
    """Width, plane, law, load and effects, which every solver calls by the same names, whatever the specimen."""
    specimen, interface = scene.specimen, scene.interface
    return {
        "width": specimen.width,
        "plane": specimen.plane,
        "strength": interface.strength,
        "toughness": interface.toughness,
        "ductility": interface.ductility,
        "law_name": interface.law,
        **interface.numbers_of_the_law,
        "penalty": interface.penalty,
        "contact": effects["contact"],
        "irreversible": effects["irreversible"],
        "opening": scene.load.opening,
        "load_at": scene.load.at,
        "kinematics": effects["kinematics"],
        "snapshot_openings": tuple(f * max(0.0, *scene.load.opening) for f in SNAPSHOT_FRACTIONS),
    }


def rectangles(scene: Scene, rectangle: Callable[..., Any], moduli: Callable[..., Any]) -> tuple[Any, ...]:
    """The upper and the lower body in a solver's own terms: length, thickness and elastic constants."""
    sizes, constants = scene.specimen, [elastic_constants(material) for material in scene.materials]
    return tuple(map(rectangle, sizes.lengths, sizes.thicknesses, (moduli(**one) for one in constants)))


def analytical_keys(scene: Scene, effects: Mapping[str, Any]) -> dict[str, Any]:
    """Keys that beam and LEFM share; a strip is an arm whose precrack is the length that is not bonded."""
    specimen, material = scene.specimen, scene.materials[0]
    constants = elastic_constants(material)
    return {
        **common_keys(scene, effects),
        "length": specimen.extent,
        "arm_thickness": specimen.loaded_thickness,
        "precrack": specimen.free_length,
        "young": axial_modulus(material, specimen.plane),
        "transverse": constants["E2"],
        "shear": constants["G12"],
        "points": counted_steps(scene),
        **_support(scene),
    }


def arms_problem(scene: Scene, effects: Mapping[str, Any]) -> Any:
    """The problem of a scene whose bond slides for ``verify.theory.arms``."""
    from verify.scene.bond.mixed import mixed_bond
    from verify.theory.arms.problem import Arm, ArmsProblem, Load, Support

    specimen, keys, law = scene.specimen, common_keys(scene, effects), mixed_bond(scene)
    if law is None:
        raise Unsuitable("interface.shear_strength, shear_toughness: must be given where the bond slides")
    arms = [
        Arm(thickness, axial_modulus(material, specimen.plane), constants["E2"], constants["G12"])
        for thickness, material in zip(specimen.thicknesses, (*scene.materials, *scene.materials)[:2], strict=True)
        for constants in (elastic_constants(material),)
    ]
    return ArmsProblem(
        arms=(arms[0], arms[1]),
        length=specimen.lengths[0],
        bonded=specimen.bonded,
        loads=tuple(Load(*load) for load in specimen.loads),
        supports=tuple(Support(*support) for support in specimen.supports),
        law=law,
        loaded_at=specimen.loaded_at,
        points=counted_steps(scene),
        **{name: keys[name] for name in ("width", "opening", "snapshot_openings")},
    )


def _support(scene: Scene) -> dict[str, Any]:
    """Keys of the substrate under a strip."""
    specimen = scene.specimen
    if not specimen.clamped:
        return {}
    from verify.theory.beam.substrate import Layer

    _, other = scene.materials
    layer = Layer.of((specimen.lengths[1], specimen.thicknesses[1]), plane=specimen.plane, **elastic_constants(other))
    return {"substrate": layer, "arms": specimen.arms}


def known(problem: type, keys: Mapping[str, Any]) -> dict[str, Any]:
    """The part of ``keys`` that a problem has."""
    return {field.name: keys[field.name] for field in fields(problem) if field.name in keys}
