"""`debond validate`."""

from __future__ import annotations

import argparse
from functools import partial

from verify.command_line.answers import FAILED, listed
from verify.command_line.arguments import numbers
from verify.command_line.curves import foreign_curves, with_options
from verify.command_line.options import NewCommand, method_option, out_option, scene_argument, set_option, sweep_options
from verify.command_line.refusals import known_method, output_folder, studied
from verify.support.refusal import Refusal


def add(command: NewCommand) -> None:
    text = "A statement of ASME V&V 20 on the error of the model: a measured curve against a scene, with uncertainties."
    sub = command(
        run,
        text,
        "validate dcb-czm1 --with lab.csv --out validation",
        "read validation/report.html; exit 0: a statement could be made",
    )
    scene_argument(sub)
    with_options(sub)
    sub.add_argument("--at", type=numbers, default=[], metavar="D,D,...", help="the loads at these openings as well")
    method_option(sub)
    set_option(sub)
    out_option(sub, "debond-validation")
    sweep_options(sub)


def run(options: argparse.Namespace) -> int:
    from verify.studies.frame import would_run
    from verify.studies.uncertainty import run_study
    from verify.studies.validation.study import judged, planned

    known_method(options.method, None)
    scene = studied(options, "validate")
    curves = foreign_curves(options, 1)
    if len(curves) != 1:
        raise Refusal(f"--with: must name one curve that the scene is held against, got {len(curves)}")
    plan = planned(options.scene, scene, options.method, options.overrides, options.at)
    if options.dry_run:
        return listed(would_run(plan.jobs, plan.left_out, options.out, options.jobs))
    output_folder(options.out)
    study = run_study(plan, partial(judged, plan, curves[0]), options.out, options.jobs, options.scheduler)
    return 0 if study.complete else FAILED
