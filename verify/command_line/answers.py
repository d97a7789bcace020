"""How commands end: exit code 1, lists."""

from __future__ import annotations

from collections.abc import Sequence

#: The exit code of a command that found something wrong.
FAILED = 1


def listed(lines: Sequence[str]) -> int:
    print("\n".join(lines))
    return 0
