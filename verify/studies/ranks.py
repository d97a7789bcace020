"""``python -m verify.studies.ranks N ARGUMENT ...``: ``debond ARGUMENT ...`` on N ranks.

mpirun replaces this process, so that ending the process ends all ranks.
"""

from __future__ import annotations

import os
import shutil
import sys
from collections.abc import Sequence

MPIRUN_MISSING = "mpirun is not installed"


def command(ranks: str, words: Sequence[str]) -> list[str]:
    """The program and its arguments."""
    return ["mpirun", "-n", ranks, sys.executable, "-P", "-m", "verify", *words]


def main(arguments: Sequence[str]) -> None:
    """Replace this process by mpirun."""
    if shutil.which("mpirun") is None:
        raise SystemExit(MPIRUN_MISSING)
    sys.stdout.flush()
    os.execvp("mpirun", command(arguments[0], arguments[1:]))


if __name__ == "__main__":
    main(sys.argv[1:])
