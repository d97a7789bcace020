"""Messages on stderr, beside the output."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from functools import cache
from importlib import import_module

from verify.support.progress import telling

#: Expected time of a page with its figures.
PAGE_SECONDS = 5.0


def say(text: str) -> None:
    print(f"debond: {text}", file=sys.stderr, flush=True)


@cache
def say_once(text: str) -> None:
    """`say`, but in one process no more than once."""
    say(text)


def write_page(module: str, *what: object) -> bool:
    """Call ``write`` of a module; False if a package for pages is missing, which is reported and no error."""
    try:
        write = import_module(module).write
    except ModuleNotFoundError as error:
        say(f"no report: {error.name} is missing; pip install 'debond[report]'")
        return False
    with telling("report", PAGE_SECONDS):
        write(*what)
    return True


def aligned(rows: Sequence[Sequence[str]], left: Sequence[int] = (0,)) -> list[str]:
    """Lines of a table of cells: columns of one width, those of ``left`` to the left, all others to the right."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [
        "  ".join(
            cell.ljust(width) if i in left else cell.rjust(width)
            for i, (cell, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in rows
    ]
