"""A scene in the terms that several solvers share: keys of the problems that they are given."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields
from typing import Any

from verify.scene.bodies import axial_modulus, elastic_constants
from verify.scene.schema import Discretization, Effects, Pose, Scene, counted_steps

#: Fractions of the largest opening at which the fields are kept: before and near the peak, under way, at the end.
SNAPSHOT_FRACTIONS = (0.1, 0.2, 0.5, 1.0)


def common_keys(scene: Scene, effects: Mapping[str, Any]) -> dict[str, Any]:
    """Lengths, law, load and effects, which every solver calls by the same names, whatever the specimen."""
    specimen, interface = scene.specimen, scene.interface
    return {
        **specimen.model_dump(exclude={"kind", "mesh"}),
        "strength": interface.strength,
        "toughness": interface.toughness,
        "ductility": interface.ductility,
        "law_name": interface.law,
        "penalty": interface.penalty,
        "contact": effects["contact"],
        "irreversible": effects["irreversible"],
        "opening": scene.load.opening,
        "load_at": scene.load.at,
        "kinematics": effects["kinematics"],
        "snapshot_openings": tuple(f * max(0.0, *scene.load.opening) for f in SNAPSHOT_FRACTIONS),
    }


def material_keys(scene: Scene, moduli: Callable[..., Any]) -> dict[str, Any]:
    """The elastic constants: of a specimen of one material by themselves, of several in ``moduli`` of each body."""
    names = scene.specimen.materials
    found = {name: elastic_constants(getattr(scene, name)) for name in names}
    return found[names[0]] if len(names) == 1 else {name: moduli(**constants) for name, constants in found.items()}


def analytical_keys(scene: Scene, effects: Mapping[str, Any]) -> dict[str, Any]:
    """What beam and LEFM call by the same names; a strip is an arm, whose precrack is the length that is not bonded."""
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


def _support(scene: Scene) -> dict[str, Any]:
    """What is beneath a body that is pulled alone."""
    specimen = scene.specimen
    if not specimen.clamped:
        return {}
    from verify.theory.beam.substrate import Layer

    _, other = scene.materials
    layer = Layer.of((specimen.lengths[1], specimen.thicknesses[1]), plane=specimen.plane, **elastic_constants(other))
    return {"substrate": layer, "arms": specimen.arms}


def taken(problem: type, keys: Mapping[str, Any]) -> dict[str, Any]:
    """``keys`` less those that are the scene's defaults and that this solver does not have."""
    plain = {**Discretization().model_dump(), **Pose().model_dump(), **Effects().model_dump()}
    names = {field.name for field in fields(problem)}
    return {key: value for key, value in keys.items() if key in names or value != plain.get(key)}


def known(problem: type, keys: Mapping[str, Any]) -> dict[str, Any]:
    """Those of ``keys`` that a problem has."""
    return {field.name: keys[field.name] for field in fields(problem) if field.name in keys}
