"""`debond scaling`."""

from __future__ import annotations

import argparse

from verify.command_line.answers import FAILED, listed
from verify.command_line.options import NewCommand, dry_run_option, out_option, scene_argument, set_option
from verify.command_line.refusals import output_folder, studied


def add(command: NewCommand) -> None:
    sub = command(
        run,
        "How time and memory grow up to 100,000 unknowns, what more ranks gain, what to expect of many.",
        "scaling dcb-czm1 --out scaling",
        "read scaling/report.html",
    )
    scene_argument(sub)
    set_option(sub)
    out_option(sub, "debond-scaling")
    dry_run_option(sub)


def run(options: argparse.Namespace) -> int:
    from verify.studies.scaling.study import scaling, would_run

    scene = studied(options, "scaling")
    if options.dry_run:
        return listed(would_run(options.scene, scene, options.overrides, options.out))
    output_folder(options.out)
    return 0 if scaling(options.scene, scene, options.overrides, options.out).complete else FAILED
