"""What is said beside the output: on stderr, at once."""

from __future__ import annotations

import sys
from importlib import import_module

from verify.support.progress import telling

#: About how long a page with its figures takes.
PAGE_SECONDS = 5.0


def say(text: str) -> None:
    print(f"debond: {text}", file=sys.stderr, flush=True)


def write_page(module: str, *what: object) -> bool:
    """Call ``write`` of a module; False where a package that pages need is missing: the numbers stand without."""
    try:
        write = import_module(module).write
    except ModuleNotFoundError as error:
        say(f"no report: {error.name} is missing; pip install 'debond[report]'")
        return False
    with telling("report", PAGE_SECONDS):
        write(*what)
    return True
