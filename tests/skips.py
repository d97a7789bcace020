"""Which tests may be skipped under ``./debond test``, which installs what tests need: any other skip is a failure.

Under a plain ``pytest``, in whatever environment, every test may be.
"""

from __future__ import annotations

import os
import re
from dataclasses import dataclass
from pathlib import Path

#: "root" or "venv": the environment that the launcher has set up for the tests; empty where it has not.
SET_UP = os.environ.get("DEBOND_TESTS_IN", "")
SHARED = Path(__file__).resolve().parents[2] / "shared"


@dataclass(frozen=True)
class Skip:
    """What a reason must contain (a regular expression), why such a test cannot run, and whether it may be so here."""

    reason: str
    why: str
    here: bool


LISTED = (
    Skip(r"is not (at hand|there)\b", "files of ../shared belong to no clone", not SHARED.is_dir()),
    Skip(r"no right to mount", "containers and ordinary users may not mount a disk", True),
    Skip(r"(DOLFINx|mpirun) is not installed", "DOLFINx is not on PyPI", SET_UP == "venv"),
    Skip(
        r"cannot be had for this Python, or from here$",
        "other codes come from PyPI, some of them for few Pythons",
        True,
    ),
    Skip(r"there is no Chromium|needs (bash|fish|zsh)$", "programs of the machine", SET_UP == "venv"),
    Skip(r"OpenGL|could not import '.*': lib.*: cannot open shared", "libraries of the machine", SET_UP == "venv"),
)


def complaint(reason: str) -> str:
    """Why no test may be skipped here for this reason; empty where one may."""
    if not SET_UP or any(one.here and re.search(one.reason, reason) for one in LISTED):
        return ""
    known = next((f"; it is listed for where {one.why}" for one in LISTED if re.search(one.reason, reason)), "")
    return f"skipped, which tests/skips.py does not allow here: {reason}{known}"
