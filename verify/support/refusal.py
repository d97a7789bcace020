"""The errors whose message is for the user, without a traceback, and words that they share."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

#: Letters that two words share in order, over the mean of their lengths, from which slips are counted.
SAME_LETTERS = 2 / 3
#: Slips of the keyboard by which a word of up to this many letters may be another one; a longer one by one more.
SLIPS, SHORT_WORD = 1, 7


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
    close, most = difflib.get_close_matches(word, known, n=3, cutoff=SAME_LETTERS), SLIPS + (len(word) > SHORT_WORD)
    if near := [one for one in close if one.startswith(word) or slips(word, one) <= most]:
        return f"did you mean {one_of(near)}?"
    return f"{others} are {', '.join(known)}" if others else ""


def slips(word: str, meant: str) -> int:
    """Letters left out, added, taken for another, or exchanged with the next one, between two words (Damerau 1964)."""
    before, rows = [0] * (len(meant) + 1), list(range(len(meant) + 1))
    for i, letter in enumerate(word):
        now = [i + 1]
        for j, other in enumerate(meant):
            now.append(min(rows[j + 1] + 1, now[j] + 1, rows[j] + (letter != other)))
            if i and j and letter == meant[j - 1] and word[i - 1] == other:
                now[j + 1] = min(now[j + 1], before[j - 1] + 1)
        before, rows = rows, now
    return rows[-1]
