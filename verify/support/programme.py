"""The turns of a load programme. Needs the standard library alone, as `verify.testing` uses it."""

from __future__ import annotations

from collections.abc import Sequence


def turns(programme: Sequence[float]) -> tuple[float, ...]:
    """The openings at which a programme turns, and its last one; it begins at the opening 0."""
    way = (0.0, *programme)
    later = zip(way[:-2], way[1:-1], way[2:], strict=True)
    return (*(goal for before, goal, after in later if (goal - before) * (after - goal) < 0.0), way[-1])


def only_opens(programme: Sequence[float]) -> bool:
    """Whether the programme has one leg, on which the opening grows."""
    return len(turns(programme)) == 1 and programme[-1] > 0.0
