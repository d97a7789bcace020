"""How commands end: exit code 1, lists, a method that cannot run."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from verify.support.say import say

if TYPE_CHECKING:
    from verify.methods.method import NotRun

#: The exit code of a command that found something wrong.
FAILED = 1


def listed(lines: Sequence[str]) -> int:
    print("\n".join(lines))
    return 0


def not_run(error: NotRun) -> int:
    ways = [". Ways to get it:", *(f"\n  {way}" for way in error.ways)] if error.ways else []
    say("".join([str(error), *ways]))
    return FAILED
