"""The cohesive beam as a method."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from verify.methods.method import Look, Method, OnFrame, OnStep, Prepared, require_growing, result_of
from verify.methods.problems import analytical_keys, known
from verify.result import Result
from verify.scene.schema import Scene
from verify.support.timing import Stopwatch


def beam_problem(scene: Scene, effects: Mapping[str, Any]) -> Any:
    """What ``verify.theory.beam.solve`` solves of a scene."""
    from verify.theory.beam.problem import BeamProblem

    return BeamProblem(**known(BeamProblem, analytical_keys(scene, effects)))


def solve(prepared: Prepared, on_step: OnStep, on_frame: OnFrame | None) -> Result:
    from verify.theory.beam.solve import solve as solve_beam

    watch, problem = Stopwatch(), prepared.problem
    with watch.phase("solve"):
        solution = solve_beam(problem, on_step)
    return result_of(prepared.method.name, solution, watch)


def _one_arm(scene: Scene) -> Mapping[str, Any]:
    """One arm stands for both; beneath a strip the beam has its substrate, too."""
    return {"symmetry": scene.specimen.symmetric, "search": False}


BEAM = Method(
    name="beam",
    label="cohesive beam",
    what="beam on a cohesive interface",
    solve=solve,
    problem=beam_problem,
    require=require_growing,
    fixed=_one_arm,  # of the laws it has the bilinear one: its zones are linear springs
    code="beam",
    equal_arms=True,
    place=200,
    look=Look(("#b0478f", "#ee9ad2"), 1.5, (1.2, 1.8), 1.0, 4.5, place=4),
)
