"""`debond cost`."""

from __future__ import annotations

import argparse

from verify.command_line.answers import FAILED, listed
from verify.command_line.options import NewCommand, dry_run_option, jobs_option, out_option, scene_argument, set_option
from verify.command_line.refusals import output_folder, studied


def add(command: NewCommand) -> None:
    sub = command(
        run,
        "What accuracy costs in time: every method on ever finer meshes, one chart.",
        "cost dcb-czm1 --out cost",
        "read cost/report.html",
    )
    scene_argument(sub)
    set_option(sub)
    out_option(sub, "debond-cost")
    jobs_option(sub, "runs of the reference at a time; what is timed runs alone")
    dry_run_option(sub)


def run(options: argparse.Namespace) -> int:
    from verify.studies.cost.study import cost, would_run

    scene = studied(options, "cost")
    if options.dry_run:
        return listed(would_run(options.scene, scene, options.overrides, options.out, options.jobs))
    output_folder(options.out)
    study = cost(options.scene, scene, options.overrides, options.out, options.jobs)
    return 0 if study is not None and study.complete else FAILED
