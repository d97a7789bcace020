"""A scene without its mesh, as plain numbers: materials, law, programme, sets, and omissions."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from verify.checks.load_introduction import sentence
from verify.export.mesh import LoadedFace, SceneMesh
from verify.scene.effects import simulated
from verify.scene.materials import elastic_constants, plane_strain_constants
from verify.scene.schema import Scene, counted_steps
from verify.theory.law import Softened

#: Exported laws, each described.
LAW_NOTES: Mapping[str, str] = {"bilinear": "bilinear, mode I: the gap along the normal alone bears traction"}

WHOLE_WIDTH = "the load of the curve is the force on one loaded face, of the whole width"

#: The same law of a bond that slides as well.
SLIDING_LAW = "bilinear, of opening and sliding with one damage; mode ratio by energy"


def law(scene: Scene) -> Softened:
    """The scene's traction law."""
    i = scene.interface
    return Softened(i.strength, i.toughness, i.ductility, i.penalty, effects(scene)["contact"])


def sliding(scene: Scene) -> dict[str, float | str]:
    """The keys of shear; nothing for a bond that opens alone."""
    i = scene.interface
    keys = ("shear_strength", "shear_toughness", "shear_stiffness", "criterion", "exponent", "onset")
    beside = ("friction", "viscosity", "pressure_strength")
    return {key: getattr(i, key) for key in (*keys, *beside)} if i.slides else {}


def effects(scene: Scene) -> dict[str, Any]:
    """The simulated effects; always with both bodies."""
    return {key: value for key, value in simulated(scene).items() if key != "symmetry"}


def numbers(scene: Scene, mesh: SceneMesh) -> dict[str, Any]:
    """The content of ``scene.json``. Nodes are counted from 1 there; components are 1 for x and 2 for y."""
    bond, specimen = law(scene), scene.specimen
    constants = plane_strain_constants if specimen.plane == "strain" else elastic_constants
    return {
        "scene": scene.name,
        "units": scene.units,
        "specimen": specimen.model_dump(exclude={"mesh"}),
        "bodies": {
            name: {**constants(material), "isotropic": hasattr(material, "young")}
            for name, material in zip(mesh.names, scene.materials, strict=True)
        },
        "law": {
            "kind": SLIDING_LAW if scene.interface.slides else LAW_NOTES[scene.interface.law],
            "strength": bond.strength,
            "toughness": bond.toughness,
            "stiffness": bond.stiffness,
            "g_max": bond.g_peak,
            "g_u": bond.g_open,
            "ductility": bond.ductility,
            "penalty": bond.penalty,
            **sliding(scene),
        },
        "effects": effects(scene),
        "programme": {"opening": list(scene.load.opening), "steps": counted_steps(scene)},
        "mesh": {
            "degree": mesh.degree,
            "nodes": len(mesh.X_nI),
            "elements": len(mesh.conn_ea),
            "pairs": len(mesh.pair_kb),
        },
        "loaded": {
            face.name: {"part_of_the_load" if specimen.slides else "part_of_the_opening": face.factor, **_means(face)}
            for face in mesh.loaded
        },
        "supported": {face.name: {"support": face.action, **_means(face)} for face in mesh.resting},
        "held": {
            part.name: {"components": [i + 1 for i in part.components], "nodes": _numbers(part.node_n)}
            for part in mesh.supports
        },
        "pairs": [_numbers(pair) for pair in mesh.pair_kb],
        "crack_pairs": [_numbers(pair) for pair in mesh.crack_kb],
        "notes": notes(scene),
    }


def notes(scene: Scene) -> list[str]:
    """Conventions for a code that solves the scene."""
    simulate, bond = effects(scene), law(scene)
    closing = (
        f"a closed gap has the stiffness {bond.penalty:g}" if bond.contact else "a closed gap has that of the bond"
    )
    damage = "damage stays" if simulate["irreversible"] else "there is no history: traction follows the gap"
    posed = scene.pose != type(scene.pose)()
    beyond = ["debond presses faces beyond the bond together as well, below zero: contact that is not in this file"]
    return [
        f"{simulate['kinematics']} kinematics; {closing}; {damage}",
        *(beyond if bond.contact and min(scene.load.opening) < 0.0 else []),
        *(_rollers(scene) if scene.specimen.slides else _load(scene)),
        "the pose of the scene is left out, as no answer depends on it"
        if posed
        else "the mesh stands as the scene says: X along the specimen, the bond on Y = 0",
    ]


def _load(scene: Scene) -> list[str]:
    """The place of the load, and the effect of another place."""
    free = "free to turn and to move along x; its load"
    if scene.load.at != "face":
        where = "corner away from the bond" if scene.load.at == "node" else "middle"
        force = f"{free} is a force that keeps its direction"
        return [f"the {where} of a loaded face moves up by its part of the opening, {force}", WHOLE_WIDTH]
    return [
        "a loaded face moves up by its part of the opening in the mean (weights times u_y), "
        f"{free} is a uniform traction that keeps its direction",
        sentence(scene),
        WHOLE_WIDTH,
    ]


def _rollers(scene: Scene) -> list[str]:
    """Loads and supports of arms whose bond slides."""
    friction = scene.interface.friction
    rub = f"with friction of {friction:g}" if friction else "without friction"
    return [
        "a patch carries its part of the load as a uniform traction that keeps its direction; the opening is the sum "
        "of these parts times the mean displacements (weights times u_y; of a couple, weights times u_x: a rotation)",
        "a supported patch has the mean displacement zero, two patches of one support in the sum, and is free otherwise"
        if scene.specimen.supports
        else "the loads balance each other, and nothing holds the rotation of the whole: hold it where no force arises",
        f"the faces of the precrack, crack_pairs, touch {rub}",
        "the load of the curve is the one that the parts multiply, of the whole width",
    ]


def header(scene: Scene, mesh: SceneMesh) -> Mapping[str, str]:
    """The first lines of a file for people."""
    return {
        "scene": f"{scene.name} ({scene.units})",
        "mesh": f"{len(mesh.X_nI)} nodes, {len(mesh.conn_ea)} elements of degree {mesh.degree}",
        **{f"note {i}": note for i, note in enumerate(notes(scene), 1)},
    }


def _means(face: LoadedFace) -> dict[str, Any]:
    return {
        "component": face.component + 1,
        "nodes": _numbers(face.node_n),
        "weights": [float(weight) for weight in face.weight_n],
    }


def _numbers(node_n: np.ndarray) -> list[int]:
    return [int(node) + 1 for node in node_n]
