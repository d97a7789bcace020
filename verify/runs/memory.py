"""Memory settings of a process that repeats the same large array operations thousands of times."""

from __future__ import annotations

import ctypes

#: mallopt(3) parameters of glibc and their values: keep up to 256 MB, and serve blocks up to 32 MB from the heap.
M_TRIM_THRESHOLD, M_MMAP_THRESHOLD = (-1, 256 << 20), (-3, 32 << 20)


def keep_freed_memory() -> None:
    """Let the allocator reuse freed blocks instead of returning them to the system.

    By default glibc returns every large array when it is freed, and the next Newton iteration fetches and clears the
    same pages again, which was measured to cost five times the assembly. Without glibc this does nothing.
    """
    try:
        mallopt = ctypes.CDLL(None).mallopt
    except (OSError, AttributeError, TypeError):
        return
    for parameter, value in (M_TRIM_THRESHOLD, M_MMAP_THRESHOLD):
        mallopt(parameter, value)
