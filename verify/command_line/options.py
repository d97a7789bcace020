"""What a command is: a function of its options, which are a table of rows; its help is made from both."""

from __future__ import annotations

import argparse
import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

from verify.command_line.arguments import place, positive


class Option(NamedTuple):
    """One row: its spellings, or the name of an argument that is told by its place, and further words of argparse.

    group : its heading in the help, where it has one of its own
    """

    spellings: tuple[str, ...]
    more: Mapping[str, Any]
    group: str = ""


class Command(NamedTuple):
    """A command, named after the function that it runs.

    text : what it is for
    example, leaves : a line to type, and what it leaves behind
    keeps : what an interrupted command keeps in ``--out``, and what the same command does then
    """

    run: Callable[[argparse.Namespace], int]
    text: str
    example: str
    leaves: str
    options: tuple[Option, ...]
    keeps: tuple[str, str] | None

    @property
    def name(self) -> str:
        return self.run.__name__


def command(
    text: str, example: str, leaves: str, *options: Option, keeps: tuple[str, str] | None = None
) -> Callable[[Callable[[argparse.Namespace], int]], Command]:
    """Make a function of its parsed options a command."""
    keeps = ("the runs that are done are kept", "does the rest") if DRY_RUN in options else keeps
    return lambda run: Command(run, text, example, leaves, options, keeps)


def value(
    spellings: str,
    shown: str | None,
    text: str | None,
    kind: Callable[[str], object] = str,
    default: object = None,
    **more: Any,
) -> Option:
    """An option, or an argument, whose text ``kind`` turns into a value."""
    return Option(tuple(spellings.split()), {"metavar": shown, "help": text, "type": kind, "default": default, **more})


def several(spelling: str, shown: str, text: str, kind: Callable[[str], object] = str, **more: Any) -> Option:
    """An option that may be repeated; its values as a list."""
    return value(spelling, shown, text, kind, [], action="append", **more)


def flag(spelling: str, text: str) -> Option:
    return Option((spelling,), {"action": "store_true", "help": text})


def grouped(group: str, *options: Option) -> tuple[Option, ...]:
    """Options below a heading."""
    return tuple(option._replace(group=group) for option in options)


def folder(default: str) -> Option:
    return value("--out", "DIR", f"default: {default}", place, Path(default))


def jobs(text: str) -> Option:
    return value("--jobs", "N", text, positive, os.cpu_count() or 1)


SCENE = value("scene", "SCENE", "a packaged name or a file")
BY_METHOD = value("--method", "M", "tspline, nurbs (default), lagrange, dolfinx, ...", default="nurbs")
PEERS = value("--peers", "A,B", "codes of others that take part: debond peers lists them", default="")
SET = several("--set", "KEY=VALUE", "replace a key", dest="overrides")
SWEEP = grouped(
    "runs",
    jobs("runs at a time"),
    value("--scheduler", "ADDRESS", "let the workers of a dask cluster do the runs; they must see the same files"),
    flag("--dry-run", "print the runs and the time that they would take"),
)
DRY_RUN = SWEEP[-1]
