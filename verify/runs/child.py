"""The process of one run: ``python -m verify.runs.child MODULE ARGUMENT ...`` runs a module and ends with its parent.

When the parent is killed, the result of the run is not used, and the process would slow down the next runs.
"""

from __future__ import annotations

import ctypes
import runpy
import signal
import sys

#: prctl(2): sends a signal when the parent dies. Only on Linux; on other systems the run continues to its end.
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
