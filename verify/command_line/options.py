"""Options that several commands have."""

from __future__ import annotations

import argparse
import os
import re
from collections.abc import Callable
from pathlib import Path

from verify.command_line.arguments import place, positive

Parser = argparse.ArgumentParser

#: Begins the command that a module is named after: what it runs, its help, an example to type, what that leaves.
NewCommand = Callable[[Callable[[argparse.Namespace], int], str, str, str], Parser]

#: The beginning of a negative number: argparse takes -1 and -0.5 for numbers, but -1e-3 for an option.
NEGATIVE = re.compile(r"-\.?\d")


def scene_argument(sub: Parser) -> None:
    sub.add_argument("scene", metavar="SCENE", help="a packaged name or a file")


def method_option(sub: Parser) -> None:
    sub.add_argument("--method", default="nurbs", metavar="M", help="tspline, nurbs (default), lagrange, dolfinx, ...")


def set_option(sub: Parser) -> None:
    sub.add_argument("--set", dest="overrides", action="append", default=[], metavar="KEY=VALUE", help="replace a key")


def out_option(sub: Parser, default: str) -> None:
    sub.add_argument("--out", type=place, default=Path(default), metavar="DIR", help=f"default: {default}")


def jobs_option(sub: Parser, what: str) -> None:
    sub.add_argument("--jobs", type=positive, default=os.cpu_count() or 1, metavar="N", help=what)


def dry_run_option(sub: Parser) -> None:
    sub.add_argument("--dry-run", action="store_true", help="print the runs and the time that they would take")
    sub.set_defaults(keeps=("the runs that are done are kept", "does the rest"))


def sweep_options(sub: Parser) -> None:
    jobs_option(sub, "runs at a time")
    where = "let the workers of a dask cluster do the runs; they must see the same files"
    sub.add_argument("--scheduler", metavar="ADDRESS", help=where)
    dry_run_option(sub)


def negative_numbers(sub: Parser) -> None:
    """Let values of options be like -1e-3 as well."""
    sub._negative_number_matcher = NEGATIVE
