"""Linear elastic fracture mechanics as a method: a limit that cohesive zones approach."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from verify.methods.method import Look, Method, OnFrame, OnStep, Prepared, Unsuitable, require_beams, result_of
from verify.methods.problems import arms_problem
from verify.result import Result
from verify.scene import laws
from verify.scene.effects import simulated
from verify.scene.materials import axial_modulus, elastic_constants
from verify.scene.schema import Scene, counted_steps
from verify.support.timing import Stopwatch


def lefm_problem(scene: Scene, effects: Mapping[str, Any]) -> Any:
    """The problem of a scene for ``verify.theory.lefm``, or ``verify.theory.arms.brittle`` where its bond slides; a
    strip is an arm whose precrack is the length that is not bonded."""
    from verify.theory.lefm import LefmProblem

    if effects["shear"]:
        return arms_problem(scene, effects, 1)
    specimen, material = scene.specimen, scene.materials[0]
    constants = elastic_constants(material)
    return LefmProblem(
        length=specimen.extent,
        arm_thickness=specimen.loaded_thickness,
        precrack=specimen.free_length,
        width=specimen.width,
        young=axial_modulus(material, specimen.plane),
        transverse=constants["E2"],
        shear=constants["G12"],
        toughness=scene.interface.toughness,
        opening=scene.load.opening,
        kinematics=effects["kinematics"],
        points=counted_steps(scene),
        arms=specimen.arms,
    )


def solve(prepared: Prepared, on_step: OnStep, on_frame: OnFrame | None) -> Result:
    """Solve with correction factors for large displacements, or with the elastica where these are out of range."""
    from verify.theory.arms.brittle import solve as solve_arms
    from verify.theory.lefm import LefmProblem
    from verify.theory.lefm import solve as solve_lefm

    watch, problem = Stopwatch(), prepared.problem
    with watch.phase("solve"):
        solution: Any
        if isinstance(problem, LefmProblem):
            try:
                solution = solve_lefm(problem, on_step)
            except ValueError:
                solution = solve_lefm(replace(problem, theory="elastica"), on_step)
        else:
            solution = solve_arms(problem, on_step)
    return result_of(prepared.method.name, solution, watch)


def _sharp(scene: Scene) -> Mapping[str, Any]:
    """There is no interface, and cracks do not heal; two arms that slide bend with linear kinematics."""
    if simulated(scene)["shear"]:
        return {"symmetry": False, "search": False, "irreversible": True, "kinematics": "linear"}
    return {"symmetry": True, "search": False, "contact": False, "irreversible": True}


def require(prepared: Prepared) -> None:
    programme, name = prepared.scene.load.opening, prepared.method.name
    if any(b <= a for a, b in zip((0.0, *programme), programme, strict=False)):
        raise Unsuitable(f"load.opening: must only increase for the method {name}, got {list(programme)}")
    require_beams(prepared)


LEFM = Method(
    name="lefm",
    label="LEFM",
    what="linear elastic fracture mechanics",
    solve=solve,
    problem=lefm_problem,
    require=require,
    laws=laws.known,  # it uses none of them
    fixed=_sharp,
    code="lefm",
    is_limit=True,
    equal_arms=True,
    besides=0.05,
    per_step=0.002,
    place=300,
    look=Look(("#6b7280", "#a0a9b5"), 0.8, (4.0, 3.0), 1.0, 1.5, place=5),
)
