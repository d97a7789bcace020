"""Which of several curves stands alone where they disagree: the others agree with each other, and it with none of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations

from verify.crosschecks import distance
from verify.result import Result

#: What a method rests on. Bases of one code confirm each other less than different codes do.
CODES = {"tspline": "iga", "nurbs": "iga", "lagrange": "iga"}


def odd_ones(results: Mapping[str, Result], end: float, tolerances: Mapping[str, float]) -> str:
    """A sentence that names the runs which agree with no other, or says that none can be named; empty where all agree.

    Two runs agree within the larger of their tolerances. The runs fall into groups whose members agree (chains of
    agreement). The group of the most codes, then of the most runs, is the one that the others are odd to; it has to be
    larger than any other.

    Parameters
    ----------
    results : runs to compare, by name
    end : largest opening of the programme
    tolerances : of each run, relative L2 distance of the load over the opening
    """
    apart = {frozenset(pair): distance(*(results[name] for name in pair), end) for pair in combinations(results, 2)}
    groups = _groups(list(results), {pair for pair, far in apart.items() if far <= max(tolerances[n] for n in pair)})
    if len(groups) < 2:
        return ""
    ranked = sorted(groups, key=_weight, reverse=True)
    if _weight(ranked[0]) == _weight(ranked[1]):
        return f"no odd one out can be named: {' and '.join(_named(group) for group in ranked)} agree among themselves"
    inside = max((apart[frozenset(pair)] for pair in combinations(ranked[0], 2)), default=0.0)
    odd = [name for group in ranked[1:] for name in group]
    nearest = min(apart[frozenset((name, one))] for name in odd for one in ranked[0])
    return (
        f"odd one out: {', '.join(odd)}, {nearest:.2%} or more from {_named(ranked[0])}, "
        f"which agree within {inside:.2%}"
    )


def _groups(names: Sequence[str], agree: set[frozenset[str]]) -> list[list[str]]:
    groups: list[list[str]] = []
    for name in names:
        near = [group for group in groups if any(frozenset((name, other)) in agree for other in group)]
        groups = [group for group in groups if group not in near] + [[one for group in near for one in group] + [name]]
    return groups


def _weight(group: Sequence[str]) -> tuple[int, int]:
    return len({CODES.get(name, name) for name in group}), len(group)


def _named(group: Sequence[str]) -> str:
    return f"{', '.join(group[:-1])} and {group[-1]}" if len(group) > 1 else group[0]
