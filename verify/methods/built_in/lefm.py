"""Linear elastic fracture mechanics as a method: a limit that cohesive zones approach."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from verify.methods.method import Look, Method, OnFrame, OnStep, Prepared, require_beams, result_of
from verify.methods.problems import analytical_keys, arms_problem, known
from verify.result import Result
from verify.scene import laws
from verify.scene.effects import simulated
from verify.scene.schema import Scene
from verify.support.timing import Stopwatch


def lefm_problem(scene: Scene, effects: Mapping[str, Any]) -> Any:
    """What ``verify.theory.lefm`` solves of a scene, or ``verify.theory.arms.brittle`` where its bond slides."""
    from verify.theory.lefm import LefmProblem

    if effects["shear"]:
        return arms_problem(scene, effects)
    return LefmProblem(**known(LefmProblem, analytical_keys(scene, effects)))


def solve(prepared: Prepared, on_step: OnStep, on_frame: OnFrame | None) -> Result:
    """By the factors for large displacements, or by the elastica where the programme leaves their range."""
    from verify.theory.arms.brittle import solve as solve_arms
    from verify.theory.lefm import solve as solve_lefm

    watch, problem = Stopwatch(), prepared.problem
    with watch.phase("solve"):
        if prepared.effects["shear"]:
            return result_of(prepared.method.name, solve_arms(problem, on_step), watch)
        try:
            solution = solve_lefm(problem, on_step)
        except ValueError:
            solution = solve_lefm(replace(problem, theory="elastica"), on_step)
    return result_of(prepared.method.name, solution, watch)


def _sharp(scene: Scene) -> Mapping[str, Any]:
    """It has no interface, and its crack never heals; two arms that slide bend with linear kinematics."""
    if simulated(scene)["shear"]:
        return {"symmetry": False, "search": False, "irreversible": True, "kinematics": "linear"}
    return {"symmetry": True, "search": False, "contact": False, "irreversible": True}


LEFM = Method(
    name="lefm",
    label="LEFM",
    what="linear elastic fracture mechanics",
    solve=solve,
    problem=lefm_problem,
    require=require_beams,
    laws=laws.known,  # it asks for none
    fixed=_sharp,
    code="lefm",
    is_limit=True,
    equal_arms=True,
    slides=True,
    per_step=0.001,
    place=300,
    look=Look(("#6b7280", "#a0a9b5"), 0.8, (4.0, 3.0), 1.0, 1.5, place=5),
)
