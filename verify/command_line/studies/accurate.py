"""`debond solve --accuracy`: method and mesh are chosen, and the solution is verified on finer meshes."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from verify.command_line.answers import FAILED
from verify.command_line.one_run import kept, print_result, say_after, with_progress
from verify.command_line.refusals import output_folder
from verify.support.refusal import Refusal
from verify.support.say import say

if TYPE_CHECKING:
    from verify.result import Result
    from verify.scene.schema import Scene
    from verify.verdict import Check


def accurate(options: argparse.Namespace) -> int:
    """Solve to an accuracy: choose and announce method and mesh, verify the solution."""
    from verify.methods import zone_resolution
    from verify.methods.solve import prepare
    from verify.runs.environment import mpi_size
    from verify.runs.run import NO_FIELDS
    from verify.scene.load import load_scene
    from verify.scene.parse import parse_scene
    from verify.studies.accuracy.choice import choose
    from verify.studies.accuracy.verified import percent, verified

    given = {"--method": options.method, "--dofs": options.dofs}
    for name, value in given.items():
        if value is not None:
            raise Refusal(f"{name}: must be left out with --accuracy, which chooses it, got {value!r}")
    if mpi_size() > 1:
        raise Refusal(f"--accuracy: must be asked for in 1 process, without mpirun, got {mpi_size()}")
    scene = load_scene(options.scene, options.overrides)
    first = choose(scene, options.accuracy, Path("debond-cost") / "cost.json")
    say(f"{first.why}; then a second run on a finer mesh, to verify it, whose time the first one tells")
    out = options.out or Path("debond-out") / f"{scene.name}-{first.method}"
    output_folder(out)
    for decision in prepare(parse_scene(scene.model_dump(), first.overrides), first.method).decisions:
        say(str(decision))

    def solved(level: Scene, method: str, folder: Path, delivers: bool) -> tuple[Result, tuple[Check, ...]]:
        return with_progress(prepare(level, method), folder, kept(options) if delivers else NO_FIELDS, False)

    found = verified(scene, first, options.accuracy, out, solved)
    last = found.delivered
    prepared = prepare(last.scene, first.method)
    print_result(last.result, last.checks, out)
    print(found.sentence)
    for remark in zone_resolution.warnings(prepared):
        say(remark)
    say_after(prepared, last.result, last.checks)
    if not found.holds:
        remedy = "ask for less, or refine with --dofs and discretization.steps"
        say(f"--accuracy: {percent(found.asked)} has not been reached: {found.why}; {found.sentence}; {remedy}")
    return 0 if found.holds else FAILED
