"""`debond doctor`."""

from __future__ import annotations

import argparse

from verify.command_line.answers import FAILED
from verify.command_line.options import NewCommand


def add(command: NewCommand) -> None:
    command(run, "What is installed, what works, how to get the rest.", "doctor", "one line a package, then what works")


def run(options: argparse.Namespace) -> int:
    from verify.command_line.doctor import examine

    lines, works = examine()
    print("\n".join(lines))
    return 0 if works else FAILED
