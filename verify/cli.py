"""The command line. Invalid input is refused before any work, with exit code 2."""

from __future__ import annotations

import os
import sys

from verify.runs.environment import THREADS

for _name in THREADS:
    os.environ.setdefault(_name, "1")  # before NumPy is imported, for comparable times

import argparse  # noqa: E402
import errno  # noqa: E402
from collections.abc import Sequence  # noqa: E402

from verify.command_line.answers import FAILED  # noqa: E402
from verify.command_line.parsing import parsed, parser  # noqa: E402
from verify.support import interrupts  # noqa: E402
from verify.support.refusal import NotRun, Refusal  # noqa: E402
from verify.support.say import say  # noqa: E402

__all__ = ["FAILED", "NOT_WRITTEN", "REFUSED", "main", "parser"]

#: Other exit codes than 0 and `FAILED`; 3 is that of an environment that cannot be set up.
REFUSED, NOT_WRITTEN = 2, 4


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; its exit code.

    0: fine; 1: something failed; 2: bad input; 4: the output could not be written; 130: interrupted.
    """
    options = argparse.Namespace(command=None, out=None)
    try:
        code = _outcome(options, sys.argv[1:] if arguments is None else arguments)
        if not interrupts.came():
            return code
    except BaseException as error:
        if not interrupts.is_one(error):
            raise
    interrupts.ignore_more()
    say(f"interrupted{_how_to_go_on(options)}")
    return interrupts.INTERRUPTED


def _outcome(options: argparse.Namespace, arguments: Sequence[str]) -> int:
    """The exit code of a command that is not interrupted; its options are put into ``options``."""
    try:
        os.getcwd()
    except FileNotFoundError:
        say("the working folder: must exist, it has been deleted; change to another one")
        return REFUSED
    try:
        vars(options).update(vars(parsed(arguments)))
        code: int = options.command.run(options)
        return code
    except Refusal as error:
        if not interrupts.came():
            say(str(error))
        return REFUSED
    except NotRun as error:
        say(error.sentence)
        return FAILED
    except BrokenPipeError:  # the reader of the output has closed it
        _print_no_more()
        return NOT_WRITTEN
    except OSError as error:
        from verify.runs.folder import NO_ROOM  # here, as it imports NumPy

        if error.errno not in (*NO_ROOM, errno.EACCES) or interrupts.came():
            raise
        say(f"{error.filename or 'the output'}: cannot be written: {error.strerror}{_how_to_go_on(options)}")
        if error.filename is None:  # possibly standard output itself
            _print_no_more()
        return NOT_WRITTEN


def _print_no_more() -> None:
    """Standard output must not be flushed at exit, which would be a message."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _how_to_go_on(options: argparse.Namespace) -> str:
    """The rest of a sentence: finished work, and how the same command continues."""
    keeps = getattr(options.command, "keeps", None)
    if keeps is None or options.out is None or getattr(options, "dry_run", False):
        return "; the same command again starts over"
    kept, then = keeps
    return f"; {kept} in {options.out}, and the same command again {then}"


if __name__ == "__main__":  # also `python -m verify.cli`, as programs of earlier environments start it
    raise SystemExit(main())
