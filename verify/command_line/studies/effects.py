"""`debond effects`."""

from __future__ import annotations

import argparse

from verify.command_line.answers import FAILED, listed
from verify.command_line.options import NewCommand, method_option, out_option, scene_argument, set_option, sweep_options
from verify.command_line.refusals import known_method, output_folder, refuse_ranks


def add(command: NewCommand) -> None:
    sub = command(
        run,
        "What each effect changes and costs: on and off, everything else as the scene says.",
        "effects dcb-czm1 --out effects",
        "read effects/report.html",
    )
    scene_argument(sub)
    method_option(sub)
    set_option(sub)
    out_option(sub, "debond-effects")
    sweep_options(sub)


def run(options: argparse.Namespace) -> int:
    from verify.scene.load import load_scene
    from verify.studies.effects import Study, planned
    from verify.studies.pairs import compared, would_run

    known_method(options.method, None)
    refuse_ranks("effects")
    scene = load_scene(options.scene, options.overrides)
    plan = planned(options.scene, scene, options.method, options.overrides)
    if options.dry_run:
        return listed(would_run(plan, options.out))
    output_folder(options.out)
    return 0 if compared(Study, plan, options.out, options.jobs, options.scheduler).complete else FAILED
