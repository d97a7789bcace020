"""`debond hard`."""

from __future__ import annotations

import argparse

from verify.command_line.answers import FAILED, listed
from verify.command_line.arguments import seeds
from verify.command_line.options import NewCommand, out_option, sweep_options
from verify.command_line.refusals import output_folder
from verify.support.refusal import Refusal


def add(command: NewCommand) -> None:
    sub = command(
        run,
        "The cases on which cohesive codes stop or go wrong.",
        "hard coarse-czm2 --jobs 2",
        "read debond-hard/report.html",
    )
    sub.add_argument("names", nargs="*", metavar="NAME", help="hard cases, or random for random scenes; default: all")
    what = "of random: how many scenes, or the first and the last like 40-79; default: 40"
    sub.add_argument("--seeds", type=seeds, metavar="N", help=what)
    out_option(sub, "debond-hard")
    sweep_options(sub)


def run(options: argparse.Namespace) -> int:
    from verify.studies.hard.cases import chosen
    from verify.studies.hard.suite import dry_run, hard

    if "random" in options.names:
        return _random(options)
    if options.seeds is not None:
        raise Refusal("--seeds: is for random scenes; debond hard random --seeds 40")
    cases = chosen(options.names)
    if options.dry_run:
        return listed(dry_run(cases, options.out, options.jobs))
    output_folder(options.out)
    return 0 if hard(cases, options.out, options.jobs, options.scheduler) else FAILED


def _random(options: argparse.Namespace) -> int:
    """The campaign on random scenes."""
    from verify.studies.campaign import campaign, would_run

    if options.names != ["random"]:
        raise Refusal("random: must be the only NAME, it is a campaign of its own")
    first, last = options.seeds or (0, 39)
    seeds = range(first, last + 1)
    if options.dry_run:
        return listed(would_run(seeds, options.out, options.jobs))
    output_folder(options.out)
    return 0 if campaign(seeds, options.out, options.jobs, options.scheduler) else FAILED
