"""Messages on stderr, beside the output."""

from __future__ import annotations

import sys
from importlib import import_module

from verify.support.progress import telling

#: Expected time of a page with its figures.
PAGE_SECONDS = 5.0


def say(text: str) -> None:
    print(f"debond: {text}", file=sys.stderr, flush=True)


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
