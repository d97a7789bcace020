"""`debond test`."""

from __future__ import annotations

import argparse
import subprocess
import sys
from pathlib import Path

from verify.command_line.options import NewCommand
from verify.support.refusal import Refusal


def add(command: NewCommand) -> None:
    sub = command(run, "Run the tests; arguments go to pytest.", "test -k curve", "the tests of curves")
    sub.add_argument("rest", nargs=argparse.REMAINDER, metavar="ARG")


def run(options: argparse.Namespace) -> int:
    tests = Path(__file__).resolve().parents[3] / "tests"
    if not tests.is_dir():
        raise Refusal("test: the tests are not installed; run it in a copy of the repository")
    return subprocess.call([sys.executable, "-m", "pytest", *options.rest], cwd=tests.parent)
