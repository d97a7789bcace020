"""`debond viscosity`."""

from __future__ import annotations

import argparse

from verify.command_line.answers import FAILED, listed
from verify.command_line.options import NewCommand, method_option, out_option, scene_argument, set_option, sweep_options
from verify.command_line.refusals import known_method, output_folder, studied


def add(command: NewCommand) -> None:
    sub = command(
        run,
        "What viscosity changes in a bond that slides, and what time it saves.",
        "viscosity enf-as4peek --out viscosity",
        "read viscosity/report.html",
    )
    scene_argument(sub)
    method_option(sub)
    set_option(sub)
    out_option(sub, "debond-viscosity")
    sweep_options(sub)


def run(options: argparse.Namespace) -> int:
    from verify.studies.viscosity.plan import planned
    from verify.studies.viscosity.study import viscosity, would_run

    known_method(options.method, None)
    scene = studied(options, "viscosity")
    plan = planned(options.scene, scene, options.method, options.overrides)
    if options.dry_run:
        return listed(would_run(plan, options.out))
    output_folder(options.out)
    return 0 if viscosity(plan, options.out, options.jobs, options.scheduler).complete else FAILED
