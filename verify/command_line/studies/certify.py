"""`debond certify`."""

from __future__ import annotations

import argparse
from functools import partial

from verify.command_line.answers import FAILED, listed
from verify.command_line.arguments import numbers
from verify.command_line.options import NewCommand, out_option, scene_argument, set_option, sweep_options
from verify.command_line.refusals import output_folder, studied


def add(command: NewCommand) -> None:
    sub = command(
        run,
        "Values that two codes agree on, with their uncertainties, to hold other codes against.",
        "certify dcb-czm1 --out certified",
        "read certified/report.html; exit 0: every value is certified",
    )
    scene_argument(sub)
    what = "the loads at these openings; default: at every quarter of the programme"
    sub.add_argument("--at", type=numbers, default=[], metavar="D,D,...", help=what)
    set_option(sub)
    out_option(sub, "debond-certified")
    what = "in a checkout: keep the values for debond verify, in place of those that are there"
    sub.add_argument("--keep", action="store_true", help=what)
    sweep_options(sub)


def run(options: argparse.Namespace) -> int:
    from verify.studies.certified.keeping import keep, require_checkout
    from verify.studies.certified.study import judged, planned
    from verify.studies.frame import would_run
    from verify.studies.uncertainty import run_study

    scene = studied(options, "certify")
    if options.keep:
        require_checkout()
    plan = planned(options.scene, scene, options.at, options.overrides)
    if options.dry_run:
        return listed(would_run(plan.jobs, plan.left_out, options.out, options.jobs))
    output_folder(options.out)
    study = run_study(plan, partial(judged, plan), options.out, options.jobs, options.scheduler)
    if options.keep and not study.failures:
        keep(study)
    elif not all(one.doubt for one in study.found):
        print("--keep, in a checkout, keeps them: debond verify then holds every run of this problem to them")
    return 0 if study.complete else FAILED
