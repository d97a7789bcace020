"""Curves of other codes on the command line: their options, and what is read."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from verify.command_line.arguments import column, scale
from verify.command_line.options import Parser, negative_numbers
from verify.support.refusal import Refusal
from verify.support.say import say

if TYPE_CHECKING:
    from verify.checks.foreign_curves import Curve


def with_options(sub: Parser) -> None:
    negative_numbers(sub)
    what = "judge this load-opening curve of another code, a file or NAME=FILE, like one of the methods"
    sub.add_argument("--with", dest="curves", action="append", default=[], metavar="FILE", help=what)
    curve_options(sub)


def curve_options(sub: Parser) -> None:
    for key in ("opening", "load"):
        sub.add_argument(f"--{key}", type=column, metavar="COLUMN", help=f"name or number of the curve's {key}")
        what = f"multiplies the curve's {key}: units, and signs"
        sub.add_argument(f"--{key}-scale", type=scale, default=1.0, metavar="X", help=what)


def foreign_curves(options: argparse.Namespace, scenes: int) -> tuple[Curve, ...]:
    """The curves of other codes, read with the options for their columns."""
    from verify.checks.foreign_curves import read_curves
    from verify.curves.read import Reading

    keys = ("opening", "load", "opening_scale", "load_scale")
    reading = Reading(**{key: getattr(options, key) for key in keys})
    if options.curves and scenes != 1:
        raise Refusal(f"--with: needs one SCENE, which its curve is of, got {scenes}")
    if not options.curves and reading != Reading():
        raise Refusal("--with: is missing, its FILE is what --opening, --load and their scales are about")
    curves = read_curves(options.curves, reading)
    say_changed(*(curve.path for curve in curves))
    for curve in curves:
        if not max(curve.result.load) > 0.0:
            say(f"--with: no load of {curve.name} is above 0: --load-scale -1 turns its sign")
    return curves


def say_changed(*paths: Path) -> None:
    """A remark on every folder of a run whose curve is not the one that the run wrote."""
    from verify.runs.folder import changed

    for path in filter(Path.is_dir, paths):
        if said := changed(path):
            say(said)
