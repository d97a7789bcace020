"""`debond law`."""

from __future__ import annotations

import argparse
from pathlib import Path

from verify.command_line.answers import FAILED
from verify.command_line.arguments import fraction, names_of, place, scales_of
from verify.command_line.options import NewCommand, negative_numbers, scene_argument, set_option
from verify.command_line.refusals import output_folder
from verify.support.refusal import Refusal
from verify.support.say import say, write_page

#: Broken checks that are printed.
BROKEN_LINES = 12


def add(command: NewCommand) -> None:
    sub = command(
        run,
        "A traction law at one point, of the solvers or of anybody's code: judged on displacement paths.",
        "law dcb-czm1 --out law",
        "read law/law.html; exit 0: all checks hold",
    )
    negative_numbers(sub)
    scene_argument(sub)
    set_option(sub)
    what = "write the paths there, paths.csv, with input for Abaqus and MOOSE"
    sub.add_argument("--write", type=place, metavar="DIR", help=what)
    what = "judge this law: tractions on the paths in a file, or module:function; default: that of the solvers"
    sub.add_argument("--with", dest="given", metavar="LAW", help=what)
    what = "names of columns of the file, like p=S22,t=S12; of path, step, g, s, p, t, dp_dg, dp_ds, dt_dg, dt_ds"
    sub.add_argument("--columns", type=names_of, default=(), metavar="K=NAME,...", help=what)
    what = "what multiplies columns of the file: units, and signs, like g=1e3,t=-1"
    sub.add_argument("--scales", type=scales_of, default=(), metavar="K=X,...", help=what)
    what = "largest deviation of tractions, in parts of the strengths, and of energies; default: 1e-4"
    sub.add_argument("--tolerance", type=fraction, metavar="T", help=what)
    sub.add_argument("--out", type=place, metavar="DIR", help="write law.json and law.html")


def run(options: argparse.Namespace) -> int:
    from verify.checks.table import check_table
    from verify.export.point_law import write_paths
    from verify.runs.folder import write_json
    from verify.scene.load import load_scene
    from verify.studies.law.study import BUILT_IN, judge_built_in, judge_given, subject
    from verify.verdict import counted

    scene = load_scene(options.scene, options.overrides)
    of, name = subject(scene), Path(options.given or BUILT_IN).name
    if options.write is not None:
        output_folder(options.write, "--write")
        print("\n".join(f"written: {path}" for path in write_paths(of.bond, of.ways, scene.name, options.write)))
        if options.given is None and options.out is None:
            return 0
    if options.given is not None:
        found = judge_given(of, options.given, dict(options.columns), dict(options.scales), options.tolerance)
    else:
        for option in ("columns", "scales", "tolerance"):
            if getattr(options, option) not in ((), None):
                raise Refusal(f"--{option}: is only for a law that --with names, got no --with")
        found = judge_built_in(of)
    if options.out is not None:
        output_folder(options.out)
        write_json(options.out / "law.json", found.record(scene.name, name))
        write_page("verify.studies.law.page", found, scene, name, options.out / "law.html")
        print(f"written: {options.out}")
    for line in check_table(found.broken[:BROKEN_LINES]):
        print(line)
    if len(found.broken) > BROKEN_LINES:
        print(f"and {len(found.broken) - BROKEN_LINES} more")
    for defect in found.defects:
        print(f"defect: {defect.sentence}")
    for remark in found.remarks:
        say(remark)
    total = counted(found.checks)
    counts = f"{total.total} checks on {len(of.ways)} paths, {total.held} hold, {total.broken} broken"
    print(f"{name} on {scene.name}: {counts}")
    return 0 if found.passed else FAILED
