"""`debond hard`."""

from __future__ import annotations

import argparse

from verify.command_line.answers import FAILED, listed
from verify.command_line.arguments import seeds
from verify.command_line.options import NewCommand, out_option, sweep_options
from verify.command_line.refusals import output_folder
from verify.support.refusal import Refusal

#: Families of scenes that are made by their seeds.
OF_SEEDS = ("random", "plain")


def add(command: NewCommand) -> None:
    sub = command(
        run,
        "The cases on which cohesive codes stop or go wrong.",
        "hard coarse-czm2 --jobs 2",
        "read debond-hard/report.html",
    )
    sub.add_argument(
        "names", nargs="*", metavar="NAME", help="hard cases, or random or plain for scenes by seed; default: all"
    )
    what = "of random and plain: how many scenes, or the first and the last like 40-79; default: 40"
    sub.add_argument("--seeds", type=seeds, metavar="N", help=what)
    out_option(sub, "debond-hard")
    sweep_options(sub)


def run(options: argparse.Namespace) -> int:
    from verify.studies.hard.cases import chosen
    from verify.studies.hard.suite import dry_run, hard

    if set(OF_SEEDS) & set(options.names):
        return _by_seed(options)
    if options.seeds is not None:
        raise Refusal("--seeds: is for random and plain scenes; debond hard random --seeds 40")
    cases = chosen(options.names)
    if options.dry_run:
        return listed(dry_run(cases, options.out, options.jobs))
    output_folder(options.out)
    return 0 if hard(cases, options.out, options.jobs, options.scheduler) else FAILED


def _by_seed(options: argparse.Namespace) -> int:
    """The campaign on random scenes, or on those of ordinary materials."""
    from verify.studies.campaign import campaign, would_run

    family = next(name for name in options.names if name in OF_SEEDS)
    if options.names != [family]:
        raise Refusal(f"{family}: must be the only NAME, it is a campaign of its own")
    first, last = options.seeds or (0, 39)
    names = [f"{family}-{seed}" for seed in range(first, last + 1)]
    if options.dry_run:
        return listed(would_run(names, options.out, options.jobs))
    output_folder(options.out)
    return 0 if campaign(family, names, options.out, options.jobs, options.scheduler) else FAILED
