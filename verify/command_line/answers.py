"""How commands end: exit code 1, lists, and what they have in common before that."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence

from verify.command_line.refusals import output_folder

#: The exit code of a command that found something wrong.
FAILED = 1


def listed(lines: Sequence[str]) -> int:
    print("\n".join(lines))
    return 0


def ended(options: argparse.Namespace, would_run: Callable[[], Sequence[str]], work: Callable[[], bool]) -> int:
    """List the runs where only they are asked for, else make the output folder and do the work."""
    if options.dry_run:
        return listed(would_run())
    output_folder(options.out)
    return 0 if work() else FAILED
