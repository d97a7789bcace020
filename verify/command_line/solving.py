"""`debond solve`: one run of a scene, or with an accuracy the runs on ever finer meshes that verify it."""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

from verify.command_line.answers import FAILED, known_method, output_folder
from verify.command_line.arguments import accuracy, count, place, positive
from verify.command_line.options import SCENE, SET, command, flag, value
from verify.support.refusal import Refusal
from verify.support.say import say

if TYPE_CHECKING:
    from verify.methods.method import Prepared
    from verify.result import Result
    from verify.runs.run import Keep
    from verify.scene.schema import Scene
    from verify.verdict import Check


@command(
    "One scene by one method: T-splines, NURBS, Lagrange or DOLFINx elements, a beam, LEFM.",
    "solve dcb-czm1 --method tspline --set discretization.adaptive=true",
    "curve.csv and result.json in debond-out/dcb-czm1-tspline",
    SCENE,
    value("--method", "M", "tspline, nurbs (default), lagrange, dolfinx, ..."),
    value("--dofs", "N", "unknowns to aim at, for tspline, nurbs and lagrange", positive),
    value(
        "--accuracy",
        "A",
        "choose method and mesh for this error of the curve, like 0.3%%, and verify it on finer meshes",
        accuracy,
    ),
    SET,
    value("--out", "DIR", "default: debond-out/SCENE-METHOD", place),
    flag("--fields", "keep fields: of a few steps in fields.npz, and fields.pvd and interface.pvd for ParaView"),
    value("--frames", "N", "with --fields, frames for ParaView along the programme; default: 30, 0: none", count, 30),
    keeps=("what is done is valid", "starts over"),
)
def solve(options: argparse.Namespace) -> int:
    from verify.methods.solve import prepare, require
    from verify.runs.environment import mpi_rank, mpi_size
    from verify.runs.run import Keep
    from verify.scene.load import load_scene

    keep = Keep(options.fields, options.frames if options.fields else 0)
    if options.accuracy is not None:
        return _accurate(options, keep)
    name = options.method or "nurbs"
    known_method(name, options.dofs)
    dofs = [f"discretization.dofs={options.dofs}"] if options.dofs else []
    prepared = prepare(load_scene(options.scene, [*dofs, *options.overrides]), name)
    if mpi_size() > 1 and not prepared.method.ranks:
        raise Refusal(f"--method: must be dolfinx under mpirun, the others run in one process, got {name!r}")
    out = options.out = options.out or Path("debond-out") / f"{prepared.scene.name}-{name}"
    require(prepared)
    output_folder(out)
    quiet = mpi_rank() > 0
    if not quiet:
        _say_before(prepared, keep.frames > 0)
    result, checks = with_progress(prepared, out, keep, quiet)
    if not quiet:
        print_result(result, checks, out)
        _say_after(prepared, result, checks)
    return 0 if result.complete and not _broken(checks) else FAILED


def _accurate(options: argparse.Namespace, keep: Keep) -> int:
    """Solve to an accuracy: choose and announce method and mesh, verify the solution."""
    from verify.methods import zone_resolution
    from verify.methods.solve import prepare
    from verify.runs.environment import mpi_size
    from verify.runs.run import NO_FIELDS
    from verify.scene.load import load_scene
    from verify.scene.parse import parse_scene
    from verify.studies.accuracy.choice import choose
    from verify.studies.accuracy.verified import percent, verified

    for name in ("method", "dofs"):
        if (given := getattr(options, name)) is not None:
            raise Refusal(f"--{name}: must be left out with --accuracy, which chooses it, got {given!r}")
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
        return with_progress(prepare(level, method), folder, keep if delivers else NO_FIELDS, False)

    found = verified(scene, first, options.accuracy, out, solved)
    last = found.delivered
    prepared = prepare(last.scene, first.method)
    print_result(last.result, last.checks, out)
    print(found.sentence)
    for remark in zone_resolution.warnings(prepared):
        say(remark)
    _say_after(prepared, last.result, last.checks)
    if not found.holds:
        remedy = "ask for less, or refine with --dofs and discretization.steps"
        say(f"--accuracy: {percent(found.asked)} has not been reached: {found.why}; {found.sentence}; {remedy}")
    return 0 if found.holds else FAILED


def with_progress(prepared: Prepared, folder: Path, keep: Keep, quiet: bool) -> tuple[Result, tuple[Check, ...]]:
    """Run with a progress bar over the programme."""
    from verify.runs.run import run
    from verify.support.progress import Progress

    scene = prepared.scene
    turns = (0.0, *scene.load.opening)
    legs = [abs(b - a) for a, b in pairwise(turns)]
    leg, gone = 0, 0.0
    with Progress(f"{scene.name} {prepared.method.name}", sum(legs), quiet) as progress:

        def advance(row: Mapping[str, float]) -> None:
            """The farthest opening of each leg counts: a path that snaps back goes many ways."""
            nonlocal leg, gone
            left = abs(turns[leg + 1] - row["opening"])
            gone = max(gone, sum(legs[: leg + 1]) - left)
            leg += left <= 1e-9 * legs[leg] and leg + 1 < len(legs)
            progress.advance(gone, f"opening {row['opening']:.4g} load {row['load']:.4g}")

        return run(prepared, folder, keep, advance)


def print_result(result: Result, checks: Sequence[Check], folder: Path) -> None:
    from verify.checks.table import check_table

    if result.load.size:
        peak = result.load.argmax()
        print(f"peak load {result.load[peak]:.6g} at opening {result.opening[peak]:.6g}, {result.load.size - 1} steps")
    if result.seconds:
        print("seconds: " + ", ".join(f"{name} {value:.2f}" for name, value in result.seconds.items()))
    print("\n".join(check_table(checks)))
    if not result.complete:
        say(f"{result.method} {result.status}")
    print(f"{', '.join(filter(None, (result.status, result.ending)))}: {folder}")


def _say_before(prepared: Prepared, frames: bool) -> None:
    """Messages before a run: automatic decisions, keys without effect, and warnings of coarse meshes."""
    from verify.methods import bonds, zone_resolution
    from verify.scene.schema import DEFAULT_STEPS

    coarse = (*zone_resolution.warnings(prepared), *zone_resolution.too_few_layers(prepared))
    for remark in (*bonds.remarks(prepared.scene), *prepared.decisions, *coarse):
        say(str(remark))
    if prepared.counted:
        say(f"discretization.steps: {DEFAULT_STEPS}, as {prepared.counted}")
    if frames and not prepared.framed:
        say("--fields: a solid of DOLFINx is drawn in the middle of its width (fields.npz): no frames for ParaView")
    elif frames and not prepared.method.has_mesh:
        say(f"--fields: the method {prepared.method.name} has no bodies to draw: no frames for ParaView")


def _say_after(prepared: Prepared, result: Result, checks: Sequence[Check]) -> None:
    from verify.checks import neglected
    from verify.scene.schema import DEFAULT_STEPS

    for remark in neglected.warnings(prepared, result):
        say(remark)
    if result.counted_steps:
        say(f"discretization.steps: {DEFAULT_STEPS} {result.counted_steps}")
    if result.complete and (wrong := _broken(checks)):
        why = "look at the numbers of the scene and their units first: the mesh does not explain it"
        say(f"{result.method}: broken: {', '.join(wrong)}; {why}")


def _broken(checks: Sequence[Check]) -> list[str]:
    return [check.name for check in checks if check.state == "broken"]
