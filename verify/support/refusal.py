"""The errors whose message is for the user, without a traceback, and words that they share."""

from __future__ import annotations

from collections.abc import Iterable, Sequence


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


def one_of(options: Iterable[str]) -> str:
    """Readable alternatives: ``"a"``, ``"a" or "b"``, ``"a", "b" or "c"``."""
    *head, last = (f'"{option}"' for option in options)
    return f"{', '.join(head)} or {last}" if head else last


def suggestion(word: str, known: Iterable[str], others: str = "") -> str:
    """``did you mean "x" or "y"?``, else all that are known: ``others are x, y``; without ``others`` nothing."""
    import difflib  # here, as few messages need it

    known = list(known)
    if near := difflib.get_close_matches(word, known, n=3, cutoff=0.6):
        return f"did you mean {one_of(near)}?"
    return f"{others} are {', '.join(known)}" if others else ""
