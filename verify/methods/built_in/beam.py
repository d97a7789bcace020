"""Arms on a cohesive bond as a method: the cohesive beam and, of a higher order, plane arms."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from verify.methods.method import Look, Method, OnFrame, OnStep, Prepared, require_beams, result_of
from verify.methods.problems import arms_problem, with_contact_of_arms
from verify.result import Result
from verify.scene.effects import simulated
from verify.scene.schema import Scene
from verify.support.timing import Stopwatch
from verify.theory.law import KNOWN_LAWS


def problem(scene: Scene, effects: Mapping[str, Any]) -> Any:
    """The problem of a scene for ``verify.theory.arms``."""
    return arms_problem(scene, effects, scene.beam.order)


def solve(prepared: Prepared, on_step: OnStep, on_frame: OnFrame | None) -> Result:
    from verify.theory.arms.solve import solve as solve_arms

    watch, arms = Stopwatch(), prepared.problem
    with watch.phase("solve"):
        solution = solve_arms(arms, on_step)
    return result_of(prepared.method.name, solution, watch)


def _its_effects(scene: Scene) -> Mapping[str, Any]:
    """One arm represents both equal arms whose bond opens alone; pairs of points are kept."""
    return {"symmetry": scene.specimen.symmetric and not simulated(scene)["shear"], "search": False}


BEAM = Method(
    name="beam",
    label="cohesive beam",
    what="beam on a cohesive interface",
    solve=solve,
    problem=problem,
    require=require_beams,
    laws=lambda: tuple(KNOWN_LAWS),
    fixed=_its_effects,
    modelled=with_contact_of_arms,
    slides=True,
    code="beam",
    equal_arms=True,
    place=200,
    look=Look(("#b0478f", "#ee9ad2"), 1.5, (1.2, 1.8), 1.0, 4.5, place=4),
)
