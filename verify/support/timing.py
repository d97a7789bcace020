"""Time of a run by phase, and its peak memory."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from time import perf_counter

#: Phases in the order of a run.
PHASES = ("mesh", "basis", "assembly", "factor", "solve")

#: Compilation of DOLFINx forms at run time, or reading of compiled ones. It is a part of "basis" and also reported
#: separately, as it is needed once per machine.
COMPILE = "compile"


class Stopwatch:
    """Seconds by phase. The time of a nested phase does not count for the outer one."""

    def __init__(self) -> None:
        self._start = self._mark = perf_counter()
        self._open: list[str] = []
        self._seconds = dict.fromkeys((*PHASES, COMPILE), 0.0)

    @contextmanager
    def phase(self, name: str) -> Iterator[None]:
        """Time the body as ``name``; names other than ``PHASES`` and ``COMPILE`` count as "other"."""
        self._book()
        self._open.append(name)
        try:
            yield
        finally:
            self._book()
            self._open.pop()

    def seconds(self) -> dict[str, float]:
        """Seconds of every phase so far, of the rest ("other"), and their sum ("total")."""
        self._book()
        total, named = self._mark - self._start, {name: self._seconds[name] for name in PHASES}
        named["basis"] += self.compile
        return {**named, "other": max(total - sum(named.values()), 0.0), "total": total}

    @property
    def compile(self) -> float:
        """Seconds of the phase ``COMPILE`` so far, which "basis" includes."""
        return self._seconds[COMPILE]

    def _book(self) -> None:
        now = perf_counter()
        if self._open and self._open[-1] in self._seconds:
            self._seconds[self._open[-1]] += now - self._mark
        self._mark = now


def peak_memory_mb() -> float:
    """Largest resident size of this process so far, in megabytes (1e6 bytes); 0 where the system does not tell.

    On Linux getrusage(2) includes the memory that the parent process had at the fork; proc(5) does not.
    """
    try:
        status = Path("/proc/self/status").read_text()
    except OSError:
        status = ""
    own = re.search(r"^VmHWM:\s*(\d+) kB$", status, re.MULTILINE)
    if own:
        return int(own[1]) * 1024 / 1e6
    try:
        import resource
    except ImportError:  # Windows
        return 0.0
    unit = 1 if sys.platform == "darwin" else 1024  # bytes there, kilobytes elsewhere
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit / 1e6
