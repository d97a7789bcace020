"""Arms on a cohesive bond as a method: the cohesive beam and, of a higher order, plane arms."""

from __future__ import annotations

from verify.methods.method import Look, Method, OnFrame, OnStep, Prepared, require_beams, result_of
from verify.methods.problems import arms_problem, with_contact_of_arms
from verify.result import Result
from verify.scene.effects import simulated
from verify.support.timing import Stopwatch
from verify.theory.law import KNOWN_LAWS


def solve(prepared: Prepared, on_step: OnStep, on_frame: OnFrame | None) -> Result:
    from verify.theory.arms.solve import solve as solve_arms

    watch, arms = Stopwatch(), prepared.problem
    with watch.phase("solve"):
        solution = solve_arms(arms, on_step)
    return result_of(prepared.method.name, solution, watch)


BEAM = Method(
    name="beam",
    label="cohesive beam",
    what="beam on a cohesive interface",
    solve=solve,
    problem=lambda scene, effects: arms_problem(scene, effects, scene.beam.order),
    require=require_beams,
    laws=lambda: tuple(KNOWN_LAWS),
    # one arm represents both equal arms whose bond opens alone
    fixed=lambda scene: {"symmetry": scene.specimen.symmetric and not simulated(scene)["shear"], "search": False},
    modelled=with_contact_of_arms,
    code="beam",
    equal_arms=True,
    besides=0.1,
    per_step=0.005,
    place=200,
    look=Look(("#b0478f", "#ee9ad2"), 1.5, (1.2, 1.8), 1.0, 4.5, place=4),
)
