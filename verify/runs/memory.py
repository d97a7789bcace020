"""Memory settings of a process that repeats the same large array operations thousands of times."""

from __future__ import annotations

import ctypes

#: mallopt(3) parameters of glibc and their values: keep up to 256 MB, and serve blocks up to 32 MB from the heap.
M_TRIM_THRESHOLD, M_MMAP_THRESHOLD = (-1, 256 << 20), (-3, 32 << 20)


def keep_freed_memory() -> None:
    """Let freed blocks be used again instead of going back to the system.

    By default glibc returns every large array when it is freed, and the next Newton iteration has the same pages
    fetched and cleared anew: measured at five times the cost of assembling. Elsewhere than on glibc nothing is done.
    """
    try:
        mallopt = ctypes.CDLL(None).mallopt
    except (OSError, AttributeError, TypeError):
        return
    for parameter, value in (M_TRIM_THRESHOLD, M_MMAP_THRESHOLD):
        mallopt(parameter, value)
