"""The same work on several items, on all cores."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import TypeVar

Item = TypeVar("Item")
Found = TypeVar("Found")


def at_once(work: Callable[[Item], Found], items: Sequence[Item]) -> tuple[Found, ...]:
    """``work`` of every item, each in a copy of this process where the system is Linux and has more than one core.

    Copies need no imports and know what was registered here; on other systems a process must not be copied.
    """
    cores = len(os.sched_getaffinity(0)) if sys.platform == "linux" else 1
    if min(len(items), cores) < 2:
        return tuple(map(work, items))
    with ProcessPoolExecutor(min(len(items), cores), get_context("fork")) as pool:
        return tuple(pool.map(work, items))
