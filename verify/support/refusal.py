"""The errors whose message is for the user, without a traceback, and words that they share."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

#: Letters that two words share in order, over the mean of their lengths, from which one is taken for the other: a third
#: of them may be others.
SAME_LETTERS = 2 / 3


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
    if near := difflib.get_close_matches(word, known, n=3, cutoff=SAME_LETTERS):
        return f"did you mean {one_of(near)}?"
    return f"{others} are {', '.join(known)}" if others else ""
