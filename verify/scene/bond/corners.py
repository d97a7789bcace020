"""The corners of a tabular law: pairs of opening and traction from a list in a scene, and strength and toughness."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any, TypeAlias

from pydantic import AfterValidator, BeforeValidator

from verify.scene.tables import refuse

#: What a table must be, in the words of a refusal.
CORNERS = "a list of two or more corners [opening, traction]"

_Pairs: TypeAlias = Sequence[Sequence[float]]


def _as_pairs(value: object) -> object:
    """Lists of lists as tuples; none at all stands for no table."""
    if value == ():
        return value
    if not isinstance(value, list | tuple) or len(value) < 2:
        raise refuse(CORNERS, ((), value))
    odd = [((i,), one) for i, one in enumerate(value) if not isinstance(one, list | tuple) or len(one) != 2]
    if odd:
        raise refuse("a corner [opening, traction]", *odd)
    return tuple(tuple(one) for one in value)


def _of_a_law(table: _Pairs) -> _Pairs:
    """Refuse a table that is not the envelope of a law with damage, whose secants must fall."""
    for i, (opening, traction) in enumerate(table):
        before, held = table[i - 1] if i else (0.0, 0.0)
        if opening <= before:
            raise refuse(f"> {before:g}, the opening before it" if i else "> 0", ((i, 0), opening))
        if i == len(table) - 1:
            if traction != 0:
                raise refuse("0, at the end of the law", ((i, 1), traction))
        elif traction <= 0:
            raise refuse("> 0, up to the last corner", ((i, 1), traction))
        elif i and traction >= opening * held / before:
            rule = f"< {opening * held / before:g}, as traction over opening falls from corner to corner"
            raise refuse(rule, ((i, 1), traction))
    return table


#: The type of the key; empty where it is left out.
Corners: TypeAlias = Annotated[tuple[tuple[float, float], ...], BeforeValidator(_as_pairs), AfterValidator(_of_a_law)]


def stiffness_of(table: _Pairs) -> float:
    """Slope of the first line [stress per length]."""
    opening, traction = table[0]
    return traction / opening


def numbers_of(value: Any) -> dict[str, float]:
    """Strength and toughness of a table; 1.0 for each if it is not valid, as its key is refused anyway."""
    try:
        table = [(float(opening), float(traction)) for opening, traction in value]
        lines = zip([(0.0, 0.0), *table[:-1]], table, strict=True)
        area = sum(0.5 * (g - before) * (held + p) for (before, held), (g, p) in lines)
        numbers = {"strength": max(p for _, p in table), "toughness": area}
    except (TypeError, ValueError, OverflowError):
        return {"strength": 1.0, "toughness": 1.0}
    return {name: number if 0 < number < float("inf") else 1.0 for name, number in numbers.items()}
