"""The errors whose message is for the user, without a traceback."""

from __future__ import annotations

from collections.abc import Sequence


class Refusal(ValueError):
    """Invalid input; the message is for the user, with key, allowed range and value."""


class NotRun(Exception):
    """A method that this machine cannot run; the message says why, ``ways`` how to get it."""

    def __init__(self, why: str, ways: Sequence[str] = ()) -> None:
        super().__init__(why)
        self.ways = tuple(ways)

    @property
    def sentence(self) -> str:
        """The message and the ways, a line each."""
        return "".join([str(self), *([". Ways to get it:", *(f"\n  {way}" for way in self.ways)] if self.ways else [])])
