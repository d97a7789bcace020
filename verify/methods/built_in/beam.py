"""The cohesive beam as a method."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from verify.methods.method import Look, Method, OnFrame, OnStep, Prepared, require_beams, result_of
from verify.methods.problems import analytical_keys, arms_problem, known
from verify.result import Result
from verify.scene.effects import simulated
from verify.scene.schema import Scene
from verify.support.timing import Stopwatch


def beam_problem(scene: Scene, effects: Mapping[str, Any]) -> Any:
    """The problem of a scene for ``verify.theory.beam.solve``, or for ``verify.theory.arms`` where its bond slides."""
    from verify.theory.beam.problem import BeamProblem

    if effects["shear"]:
        return arms_problem(scene, effects)
    return BeamProblem(**known(BeamProblem, analytical_keys(scene, effects)))


def solve(prepared: Prepared, on_step: OnStep, on_frame: OnFrame | None) -> Result:
    from verify.theory.arms.solve import solve as solve_arms
    from verify.theory.beam.solve import solve as solve_beam

    watch, problem = Stopwatch(), prepared.problem
    with watch.phase("solve"):
        solution = (solve_arms if prepared.effects["shear"] else solve_beam)(problem, on_step)
    return result_of(prepared.method.name, solution, watch)


def _its_effects(scene: Scene) -> Mapping[str, Any]:
    """One arm represents both equal arms; a strip is modelled with its substrate. Where the bond slides both arms are
    modelled, with linear kinematics."""
    if simulated(scene)["shear"]:
        return {"symmetry": False, "search": False, "kinematics": "linear"}
    return {"symmetry": scene.specimen.symmetric, "search": False}


BEAM = Method(
    name="beam",
    label="cohesive beam",
    what="beam on a cohesive interface",
    solve=solve,
    problem=beam_problem,
    require=require_beams,
    fixed=_its_effects,  # `laws` is left out: only the bilinear law, as its zones are linear springs
    slides=True,
    code="beam",
    equal_arms=True,
    place=200,
    look=Look(("#b0478f", "#ee9ad2"), 1.5, (1.2, 1.8), 1.0, 4.5, place=4),
)
