"""`debond completion`."""

from __future__ import annotations

import argparse

from verify.command_line.options import NewCommand
from verify.support.refusal import Refusal


def add(command: NewCommand) -> None:
    sub = command(
        run,
        "What completes commands, options, scenes, methods and keys at the tab key of a shell.",
        "completion bash > ~/.debond-completion",
        "source it in ~/.bashrc",
    )
    sub.add_argument("shell", metavar="SHELL", help="bash, zsh or fish")


def run(options: argparse.Namespace) -> int:
    from verify.command_line.completion import SHELLS, script
    from verify.support.refusal import one_of

    if options.shell not in SHELLS:
        raise Refusal(f"SHELL: must be {one_of(SHELLS)}, got {options.shell!r}")
    print(script(options.parser, options.shell), end="")
    return 0
