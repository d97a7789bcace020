"""`debond vary`."""

from __future__ import annotations

import argparse

from verify.command_line.answers import FAILED, listed
from verify.command_line.arguments import positive
from verify.command_line.options import NewCommand, method_option, out_option, scene_argument, sweep_options
from verify.command_line.refusals import known_method, output_folder, refuse_ranks


def add(command: NewCommand) -> None:
    sub = command(
        run,
        "What any key changes and costs: the scene with each of its values, held against the first.",
        "vary enf-as4peek --set interface.viscosity=0,0.001,0.01,0.1 --out vary",
        "read vary/report.html",
    )
    scene_argument(sub)
    method_option(sub)
    what = "a key and its values, each in turn; several keys: every combination"
    sub.add_argument("--set", dest="overrides", action="append", default=[], metavar="KEY=A,B,C", help=what)
    ranks = "MPI ranks of DOLFINx, each in turn"
    sub.add_argument("--ranks", type=_ranks, default=[1], metavar="1,2,4", help=ranks)
    out_option(sub, "debond-vary")
    sweep_options(sub)


def _ranks(text: str) -> list[int]:
    return [positive(part) for part in text.split(",")]


def run(options: argparse.Namespace) -> int:
    from verify.studies.pairs import compared, would_run
    from verify.studies.vary import Study, planned

    known_method(options.method, None)
    refuse_ranks("vary")
    plan = planned(options.scene, options.overrides, options.method, options.ranks)
    if options.dry_run:
        return listed(would_run(plan, options.out))
    output_folder(options.out)
    return 0 if compared(Study, plan, options.out, options.jobs, options.scheduler).complete else FAILED
