"""Linear elastic fracture mechanics as a method: a limit that cohesive zones approach."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from verify.methods.method import Look, Method, OnFrame, OnStep, Prepared, require_growing, result_of
from verify.methods.problems import analytical_keys, known
from verify.result import Result
from verify.scene import laws
from verify.scene.schema import Scene
from verify.support.timing import Stopwatch


def lefm_problem(scene: Scene, effects: Mapping[str, Any]) -> Any:
    """What ``verify.theory.lefm`` solves of a scene."""
    from verify.theory.lefm import LefmProblem

    return LefmProblem(**known(LefmProblem, analytical_keys(scene, effects)))


def solve(prepared: Prepared, on_step: OnStep, on_frame: OnFrame | None) -> Result:
    """By the factors for large displacements, or by the elastica where the programme leaves their range."""
    from verify.theory.lefm import solve as solve_lefm

    watch, problem = Stopwatch(), prepared.problem
    with watch.phase("solve"):
        try:
            solution = solve_lefm(problem, on_step)
        except ValueError:
            solution = solve_lefm(replace(problem, theory="elastica"), on_step)
    return result_of(prepared.method.name, solution, watch)


def _sharp(scene: Scene) -> Mapping[str, Any]:
    """It has no interface, and its crack never heals."""
    return {"symmetry": True, "search": False, "contact": False, "irreversible": True}


LEFM = Method(
    name="lefm",
    label="LEFM",
    what="linear elastic fracture mechanics",
    solve=solve,
    problem=lefm_problem,
    require=require_growing,
    laws=laws.known,  # it asks for none
    fixed=_sharp,
    code="lefm",
    is_limit=True,
    equal_arms=True,
    per_step=0.001,
    place=300,
    look=Look(("#6b7280", "#a0a9b5"), 0.8, (4.0, 3.0), 1.0, 1.5, place=5),
)
