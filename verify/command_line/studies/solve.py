"""`debond solve`."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from verify.command_line.answers import FAILED
from verify.command_line.arguments import accuracy, count, place, positive
from verify.command_line.one_run import broken, kept, print_result, say_after, with_progress
from verify.command_line.options import NewCommand, scene_argument, set_option
from verify.command_line.refusals import known_method, output_folder
from verify.command_line.studies.accurate import accurate
from verify.support.refusal import Refusal
from verify.support.say import say

if TYPE_CHECKING:
    from verify.methods.method import Prepared


def add(command: NewCommand) -> None:
    sub = command(
        run,
        "One scene by one method: T-splines, NURBS, Lagrange or DOLFINx elements, a beam, LEFM.",
        "solve dcb-czm1 --method tspline --set discretization.adaptive=true",
        "curve.csv and result.json in debond-out/dcb-czm1-tspline",
    )
    scene_argument(sub)
    sub.add_argument("--method", metavar="M", help="tspline, nurbs (default), lagrange, dolfinx, ...")
    sub.add_argument("--dofs", type=positive, metavar="N", help="unknowns to aim at, for tspline, nurbs and lagrange")
    what = "choose method and mesh for this error of the curve, like 0.3%%, and verify it on finer meshes"
    sub.add_argument("--accuracy", type=accuracy, metavar="A", help=what)
    set_option(sub)
    sub.add_argument("--out", type=place, metavar="DIR", help="default: debond-out/SCENE-METHOD")
    what = "keep fields: of a few steps in fields.npz, and fields.pvd and interface.pvd for ParaView"
    sub.add_argument("--fields", action="store_true", help=what)
    what = "with --fields, frames for ParaView along the programme; default: 30, 0: none"
    sub.add_argument("--frames", type=count, default=30, metavar="N", help=what)
    sub.set_defaults(keeps=("what is done is valid", "starts over"))


def run(options: argparse.Namespace) -> int:
    from verify.methods.solve import prepare, require
    from verify.runs.environment import mpi_rank, mpi_size
    from verify.scene.load import load_scene

    if options.accuracy is not None:
        return accurate(options)
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
        _say_before(prepared, options.fields and options.frames > 0)
    result, checks = with_progress(prepared, out, kept(options), quiet)
    if not quiet:
        print_result(result, checks, out)
        say_after(prepared, result, checks)
    return 0 if result.complete and not broken(checks) else FAILED


def _say_before(prepared: Prepared, frames: bool) -> None:
    """Messages before a run: automatic decisions, keys without effect, and warnings of coarse meshes."""
    from verify.methods import sliding, zone_resolution
    from verify.scene.schema import DEFAULT_STEPS

    coarse = (*zone_resolution.warnings(prepared), *zone_resolution.too_few_layers(prepared))
    for remark in (*prepared.decisions, *sliding.remarks(prepared.scene), *coarse):
        say(str(remark))
    if prepared.counted:
        say(f"discretization.steps: {DEFAULT_STEPS}, as {prepared.counted}")
    if frames and not prepared.method.has_mesh:
        say(f"--fields: the method {prepared.method.name} has no bodies to draw: no frames for ParaView")
