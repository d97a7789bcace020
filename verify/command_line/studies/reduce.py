"""`debond reduce`."""

from __future__ import annotations

import argparse

from verify.command_line.arguments import column, columns, fraction, number, numbers, place, scale
from verify.command_line.curves import curve_options
from verify.command_line.options import NewCommand, negative_numbers, set_option
from verify.command_line.refusals import output_folder
from verify.support.refusal import Refusal


def add(command: NewCommand) -> None:
    sub = command(
        run,
        "Toughness from a delamination test, or back from a run: every scheme of the standards, with intervals.",
        "reduce test.csv --scene mine.toml --load-scale 1e3 --crack a --out reduced",
        "a table; read reduced/reduce.html",
    )
    negative_numbers(sub)
    what = "text file of a test, or folder of a run; several are coupons of one plate"
    sub.add_argument("files", metavar="FILE", nargs="*", type=place, help=what)
    what = "table (CSV) of coupons: a column file, and columns precrack, width, arm_thickness ... of each"
    sub.add_argument("--coupons", metavar="TABLE", type=place, help=what)
    what = "the specimen, a packaged name or a file, whose [interface] and [load] may be missing; of a run: its own"
    sub.add_argument("--scene", metavar="SCENE", help=what)
    set_option(sub)
    curve_options(sub)
    what = "name or number of the crack lengths, from the load line or the left support; default: crack_length"
    sub.add_argument("--crack", type=column, metavar="COLUMN", help=what)
    sub.add_argument("--crack-scale", type=scale, default=1.0, metavar="X", help="multiplies the crack lengths")
    what = "is added to the crack lengths: the precrack, where the column holds the growth"
    sub.add_argument("--crack-offset", type=number, default=0.0, metavar="A", help=what)
    what = "one or two columns: rotations of the loaded ends, for J"
    sub.add_argument("--rotations", type=columns, default=(), metavar="COLUMN,...", help=what)
    what = "multiplies the rotations, to radians"
    sub.add_argument("--rotation-scale", type=scale, default=1.0, metavar="X", help=what)
    what = "the curve is linear between these parts of the largest load; default: 0.2,0.5, of a run 0,0.2"
    sub.add_argument("--linear", type=numbers, metavar="LOW,HIGH", help=what)
    sub.add_argument("--no-toe", action="store_true", help="leave the origin where it is")
    what = "compliance of the machine, whose part of the opening is taken off"
    sub.add_argument("--machine-compliance", type=number, default=0.0, metavar="C", help=what)
    what = "dcb: factors F and N of large openings; of runs with finite rotations they always count"
    sub.add_argument("--large", action="store_true", help=what)
    what = "dcb: load blocks, from the pin to the middle of the arm and to the edge of the block"
    sub.add_argument("--block", type=numbers, default=(0.0, 0.0), metavar="L1,L2", help=what)
    what = "compliances of precracks that were not broken, for CC of an enf"
    sub.add_argument("--calibration", type=numbers, default=[], metavar="A,C,A,C,...", help=what)
    sub.add_argument("--begin", type=fraction, metavar="D", help="crack growth from which propagation counts")
    sub.add_argument("--end", type=fraction, metavar="D", help="and up to which it does")
    sub.add_argument("--fit", action="store_true", help="strength and toughness by least squares on a cohesive beam")
    sub.add_argument("--out", type=place, metavar="DIR", help="write reduce.json, reduce.csv and reduce.html")


def run(options: argparse.Namespace) -> int:
    from verify.studies.reduce import command as work
    from verify.studies.reduce.coupons import coupons_of

    coupons = coupons_of(options.files, options.coupons)
    if not coupons:
        raise Refusal("FILE: must be the file of a test or the folder of a run, got none")
    if len(coupons) > 1 or options.coupons:
        if options.out is not None:
            output_folder(options.out)
        work.of_many(options, coupons)
        return 0
    (one,) = coupons
    test, found, known, fit = work.reduced(options, one.path)
    if options.out is not None:
        output_folder(options.out)
    work.report(found, known, fit)
    if options.out is not None:
        work.write(options.out, str(one.path), test.scene, found, known, fit)
    return 0
