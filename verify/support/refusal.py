"""The errors whose message is for the user, without a traceback, and words that they share."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cache


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
    known = list(known)
    distance = {other: typing_distance(word.casefold(), other.casefold()) for other in known}
    near = [other for other in sorted(known, key=distance.__getitem__) if distance[other] <= max(1, len(other) // 3)]
    if near:
        return f"did you mean {one_of(near[:3])}?"
    return f"{others} are {', '.join(known)}" if others else ""


@cache
def typing_distance(a: str, b: str) -> int:
    """Letters left out, added, exchanged for another one or with their neighbour (Damerau 1964, Commun. ACM 7, 171)."""
    if not a or not b or abs(len(a) - len(b)) > len(b):
        return len(a) + len(b)
    ways = [
        typing_distance(a[1:], b) + 1,
        typing_distance(a, b[1:]) + 1,
        typing_distance(a[1:], b[1:]) + (a[0] != b[0]),
    ]
    return min(*ways, typing_distance(a[2:], b[2:]) + 1 if a[1:2] + a[:1] == b[:2] else ways[0])
