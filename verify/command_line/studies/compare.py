"""`debond compare`."""

from __future__ import annotations

import argparse

from verify.command_line.answers import FAILED
from verify.command_line.arguments import column, fraction, number, numbers, place, scale
from verify.command_line.curves import say_changed
from verify.command_line.options import NewCommand, negative_numbers
from verify.command_line.refusals import output_folder
from verify.support.say import say


def add(command: NewCommand) -> None:
    sub = command(
        run,
        "Two load-opening curves: error, peak, energy; of runs, or of anybody's code.",
        "compare my.csv run --opening-a U2 --load-a RF2 --curve-tol 0.01",
        "a table; exit 1: my.csv is more than 1 % off the run",
    )
    negative_numbers(sub)
    sub.add_argument("a", metavar="A", type=place, help="CSV file or folder of a run")
    sub.add_argument("b", metavar="B", type=place, help="what A is held against")
    for side in "ab":
        own = f"of {side.upper()}"
        sub.add_argument(f"--opening-{side}", type=column, metavar="COLUMN", help=f"name or number {own}'s opening")
        sub.add_argument(f"--load-{side}", type=column, metavar="COLUMN", help=f"name or number {own}'s load")
        for key in ("opening", "load"):
            what = f"multiplies the {key} {own}: units, and signs"
            sub.add_argument(f"--{key}-scale-{side}", type=scale, default=1.0, metavar="X", help=what)
    sub.add_argument("--end", type=number, metavar="D", help="compare up to this opening; default: the last of B")
    sub.add_argument("--begin", type=number, metavar="D", help="compare from this opening on; default: 0")
    what = "the load programme, where B does not show its turns: 1.5,0.2,3"
    sub.add_argument("--programme", type=numbers, metavar="D,D,...", help=what)
    sub.add_argument("--at", type=numbers, default=[], metavar="D,D,...", help="print the loads at these openings")
    limit = "fail where the curve error is larger, e.g. 0.01"
    sub.add_argument("--curve-tol", "--tolerance", type=fraction, metavar="T", help=limit)
    sub.add_argument("--peak-tol", type=fraction, metavar="T", help="and where the peak loads differ by more")
    sub.add_argument("--energy-tol", type=fraction, metavar="T", help="and where the works differ by more")
    sub.add_argument("--out", type=place, metavar="DIR", help="write comparison.json and comparison.html")


def run(options: argparse.Namespace) -> int:
    from verify.command_line import compare as work
    from verify.curves.compare import checks
    from verify.curves.read import Reading
    from verify.curves.wording import complaints, remarks, table

    keys = ("opening", "load", "opening_scale", "load_scale")
    a, b = (
        work.Source(getattr(options, side), Reading(**{key: getattr(options, f"{key}_{side}") for key in keys}))
        for side in "ab"
    )
    say_changed(options.a, options.b)
    comparison, loads = work.held_against(a, b, options.end, options.at, options.begin, options.programme)
    if options.out is not None:
        output_folder(options.out)
    found = checks(comparison, options.curve_tol, options.peak_tol, options.energy_tol)
    print("\n".join(table(comparison, loads, found)), flush=True)
    for remark in remarks(comparison):
        say(remark)
    if options.out is not None:
        work.write(options.out, (a, b), comparison, loads, found)
        print(f"written: {options.out}")
    for complaint in complaints(comparison, found):
        say(complaint)
    if not all(check.passed for check in found):
        work.explain((a, b), options.curve_tol)
        return FAILED
    return 0
