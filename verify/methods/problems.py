"""A scene in the terms of each solver: the problem that it is given, from the keys that several of them share."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from types import ModuleType
from typing import TYPE_CHECKING, Any

from verify.scene.bodies import axial_modulus, elastic_constants
from verify.scene.effects import simulated
from verify.scene.schema import Discretization, Pose, Scene, counted_steps

if TYPE_CHECKING:
    from verify.theory.beam.problem import BeamProblem
    from verify.theory.lefm import LefmProblem


#: Fractions of the largest opening at which the fields are kept: before and near the peak, under way, at the end.
SNAPSHOT_FRACTIONS = (0.1, 0.2, 0.5, 1.0)


def iga_problem(scene: Scene, method: str) -> tuple[ModuleType, Any]:
    """The module of ``iga`` that solves a scene, and the problem that it is given."""
    if scene.specimen.kind == "peel":
        from iga import peel

        keys = _peel_keys(scene, peel.Moduli) | _common_keys(scene, method) | _iga_keys(scene, method)
        return peel, peel.Problem(**_taken(peel.Problem, keys))
    from iga import dcb

    return dcb, dcb.Problem(**_taken(dcb.Problem, problem_keys(scene, method) | _iga_keys(scene, method)))


def dolfinx_problem(scene: Scene) -> Any:
    """The problem that `fem_reference` is given; DOLFINx itself is not asked for. ValueError where it refuses it."""
    from fem_reference.problem import dcb, peel
    from fem_reference.problem.material import Moduli
    from verify.methods.reference_mesh import reference_mesh

    mesh = reference_mesh(scene)
    own: dict[str, Any] = {"degree": mesh.degree, "elements": mesh.elements, "layers": mesh.layers}
    if scene.specimen.kind == "peel":
        keys = {**_peel_keys(scene, Moduli), **_common_keys(scene, "dolfinx"), "steps": counted_steps(scene)}
        return peel.Problem(**keys, **own)
    return dcb.Problem(**_known(dcb.Problem, problem_keys(scene, "dolfinx")), **own)


def beam_problem(scene: Scene) -> BeamProblem:
    """What ``verify.theory.beam.solve`` solves of a scene."""
    from verify.theory.beam.problem import BeamProblem

    return BeamProblem(**_known(BeamProblem, _analytical_keys(scene, "beam")))


def lefm_problem(scene: Scene) -> LefmProblem:
    """What ``verify.theory.lefm`` solves of a scene."""
    from verify.theory.lefm import LefmProblem

    return LefmProblem(**_known(LefmProblem, _analytical_keys(scene, "lefm")))


def problem_keys(scene: Scene, method: str) -> dict[str, Any]:
    """What every solver's own ``Problem`` of a dcb calls by the same names: geometry, material, law, load, effects."""
    return {
        **_lengths(scene),
        **elastic_constants(scene.materials[0]),
        **_common_keys(scene, method),
        "symmetry": simulated(scene, method)["symmetry"],
        "steps": counted_steps(scene),
    }


def _common_keys(scene: Scene, method: str) -> dict[str, Any]:
    """What does not depend on the kind of the specimen."""
    specimen, interface, effects = scene.specimen, scene.interface, simulated(scene, method)
    return {
        "width": specimen.width,
        "plane": specimen.plane,
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


def _peel_keys(scene: Scene, moduli: type) -> dict[str, Any]:
    """Geometry and materials of a peel, as both field solvers call them; ``moduli`` is the solver's own type."""
    strip, substrate = (moduli(**elastic_constants(material)) for material in scene.materials)
    return {**_lengths(scene), "strip": strip, "substrate": substrate}


def _lengths(scene: Scene) -> dict[str, float]:
    """Geometry in the plane, which every solver calls as the scene does."""
    return scene.specimen.model_dump(exclude={"kind", "width", "plane", "mesh"})


def _iga_keys(scene: Scene, method: str) -> dict[str, Any]:
    """Mesh, interface rule, steps and pose, as both specimens of ``iga`` call them."""
    mesh, pose = scene.discretization, scene.pose
    return {
        "basis": method,
        "meshes": _given(scene, method),
        "degree": mesh.degree,
        "dofs": mesh.dofs,
        "interface_rule": mesh.interface_rule,
        "interface_points": mesh.interface_points,
        "adaptive": mesh.adaptive,
        "mismatch": mesh.mismatch,
        "slave": mesh.slave,
        "search": simulated(scene, method)["search"],
        "bend": mesh.bend,
        "steps": None if mesh.steps == "auto" else mesh.steps,
        "angle": pose.angle,
        "mirror": pose.mirror,
        "shift": pose.shift,
    }


def _given(scene: Scene, method: str) -> tuple:
    """The meshes of the files that a scene names, for T-splines alone: they are what such files hold."""
    if method != "tspline" or not scene.specimen.mesh:
        return ()
    from verify.methods.given_meshes import given_meshes

    return given_meshes(scene)


def _analytical_keys(scene: Scene, method: str) -> dict[str, Any]:
    """What beam and LEFM call by the same names; a strip is an arm, whose precrack is the length that is not bonded."""
    specimen, own, (material, other) = scene.specimen, {}, scene.materials
    if specimen.kind == "peel":
        from verify.theory.beam.substrate import Layer

        base = elastic_constants(other)
        layer = Layer.of((specimen.substrate_length, specimen.substrate_thickness), plane=specimen.plane, **base)
        own = {"substrate": layer, "arms": 1}
    constants = elastic_constants(material)
    return {
        **_common_keys(scene, method),
        "length": specimen.extent,
        "arm_thickness": specimen.loaded_thickness,
        "precrack": specimen.free_length,
        "young": axial_modulus(material, specimen.plane),
        "transverse": constants["E2"],
        "shear": constants["G12"],
        "points": counted_steps(scene),
        **own,
    }


def _taken(problem: type, keys: Mapping[str, Any]) -> dict[str, Any]:
    """``keys`` less those that are the scene's defaults and that this solver does not have."""
    plain = {**Discretization().model_dump(), **Pose().model_dump()}
    known = {field.name for field in fields(problem)}
    return {key: value for key, value in keys.items() if key in known or value != plain.get(key)}


def _known(problem: type, keys: Mapping[str, Any]) -> dict[str, Any]:
    """Those of ``keys`` that a problem has."""
    return {field.name: keys[field.name] for field in fields(problem) if field.name in keys}
