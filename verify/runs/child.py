"""The process of one run: ``python -m verify.runs.child MODULE ARGUMENT ...`` runs a module and dies with its parent.

Nobody waits for a run whose engine was killed; its folder is not kept, and it would slow down the next runs.
"""

from __future__ import annotations

import ctypes
import runpy
import signal
import sys

#: prctl(2): the signal to get when the parent dies. Linux alone has it; elsewhere the run goes on to its end.
PR_SET_PDEATHSIG = 1


def die_with_parent() -> None:
    """Ask the system to end this process when its parent ends, in whatever way."""
    try:
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGTERM)
    except (OSError, AttributeError, TypeError):
        return


if __name__ == "__main__":
    die_with_parent()
    module, sys.argv[:] = sys.argv[1], sys.argv[1:]
    runpy.run_module(module, run_name="__main__", alter_sys=True)
