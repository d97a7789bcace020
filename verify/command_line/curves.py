"""Curves of other codes on the command line: their options, and what is read."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from verify.command_line.arguments import column, scale
from verify.command_line.options import Option, grouped, several, value
from verify.support.refusal import Refusal
from verify.support.say import say

if TYPE_CHECKING:
    from verify.checks.foreign_curves import Curve
    from verify.curves.read import Reading
    from verify.scene.schema import Scene

KEYS = ("opening", "load")


def column_options(end: str = "", of: str = "the curve's {}") -> tuple[Option, ...]:
    """Which columns are opening and load, and what multiplies them; ``end`` of the spellings says of which curve."""
    rows = (
        (
            value(f"--{key}{end}", "COLUMN", f"name or number of {of.format(key)}", column),
            value(f"--{key}-scale{end}", "X", f"multiplies {of.format(key)}: units, and signs", scale, 1.0),
        )
        for key in KEYS
    )
    return tuple(option for row in rows for option in row)


CURVES = grouped(
    "a curve of another code",
    several(
        "--with",
        "FILE",
        "judge this load-opening curve of another code, a file or NAME=FILE, like one of the methods",
        dest="curves",
    ),
    *column_options(),
)


def reading(options: argparse.Namespace, end: str = "") -> Reading:
    """What `column_options` say."""
    from verify.curves.read import Reading

    return Reading(**{key: getattr(options, key + end) for key in (*KEYS, *(f"{key}_scale" for key in KEYS))})


def foreign_curves(options: argparse.Namespace, scenes: Sequence[Scene]) -> tuple[Curve, ...]:
    """The curves of other codes, read with the options for their columns, in the units of the scene."""
    from verify.checks.foreign_curves import read_curves
    from verify.curves.read import Reading
    from verify.curves.units import units_of

    if not options.curves:
        if reading(options) != Reading():
            raise Refusal("--with: is missing, its FILE is what --opening, --load and their scales are about")
        return ()
    if len(scenes) != 1:
        raise Refusal(f"--with: needs one SCENE, which its curve is of, got {len(scenes)}")
    curves = read_curves(options.curves, replace(reading(options), units=units_of(scenes[0].units)))
    say_changed(*(curve.path for curve in curves))
    for curve in curves:
        if not max(curve.result.load) > 0.0:
            way = ": --load-scale -1 turns its sign" if min(curve.result.load) < 0.0 else ""
            say(f"--with: no load of {curve.name} is above 0{way}")
    return curves


def say_changed(*paths: Path) -> None:
    """A remark on every folder of a run whose curve is not the one that the run wrote."""
    from verify.runs.folder import changed

    for path in filter(Path.is_dir, paths):
        if said := changed(path):
            say(said)
