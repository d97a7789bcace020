"""Which known defect explains tractions that deviate from the definition: each is tried on the same paths."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from verify.studies.law.candidates import Candidate, candidates
from verify.studies.law.distance import apart, mean_square
from verify.studies.law.families import families, fitted
from verify.studies.law.given.answer import Answer, Answers, of_bond
from verify.studies.law.ways.legs import JumpPath
from verify.theory.mixed_law import MixedBond

UNKNOWN = "unknown"
#: A defect that explains only some paths must leave at most this part of the mean square deviation on each path on
#: which it would show.
HALVED = 0.25


@dataclass(frozen=True)
class Search:
    """When a defect is named, and on how many paths an amount is fitted."""

    share: float = 0.05  # part of the deviation that may be left; a larger one names more defects, also wrong ones
    most: float = 0.01  # largest deviation that a defect may leave, in parts of the strengths
    paths: int = 2  # number of paths with the largest deviations to which an amount is fitted, besides the first path


@dataclass(frozen=True)
class Defect:
    """A defect, and the root mean square distance of the given tractions from the law with it and without it.

    ``path`` is the path with the largest deviation. For `UNKNOWN` both distances are the same.
    """

    name: str
    path: str
    error_with: float
    error_without: float
    what: str
    candidate: Candidate | None = None


def defects(
    bond: MixedBond, ways: Sequence[JumpPath], given: Answers, tolerance: float, search: Search | None = None
) -> tuple[Defect, ...]:
    """The defects that explain ``given``, best first; none where no path is off by more than ``tolerance``.

    Defects with an amount are fitted where none without one explains everything, as that takes a second.
    """
    search = search or Search()
    expected = {way.name: of_bond(bond, way) for way in ways}
    off = {way.name: apart(bond, given[way.name], expected[way.name]) for way in ways}
    broken = [way for way in ways if not off[way.name].max() <= tolerance]
    if not broken:
        return ()
    square = {name: mean_square(distance) for name, distance in off.items()}
    left: dict[Candidate, dict[str, float]] = {}
    for tried in (candidates(bond), _fitted(bond, ways, given, expected, square, search)):
        left |= {one: _left(bond, one, ways, given, expected) for one in tried}
        everywhere = _named(left, square, [way.name for way in ways], search)
        unexplained = tuple(_left_over(bond, everywhere[0], ways, given, expected, tolerance)) if everywhere else ()
        if everywhere and not unexplained:
            return everywhere
    if everywhere:
        return (*everywhere, *unexplained)
    steady = {
        one: of
        for one, of in left.items()
        if all(of[name] <= HALVED * square[name] for name in _shows(bond, one, ways, expected, tolerance))
    }
    return _in_parts(steady, square, [way.name for way in broken], search)


def _shows(
    bond: MixedBond, one: Candidate, ways: Sequence[JumpPath], expected: Mapping[str, Answer], tolerance: float
) -> list[str]:
    """The paths on which a defect would show."""
    return [way.name for way in ways if apart(bond, one.answer(way), expected[way.name]).max() > tolerance]


def _named(
    left: Mapping[Candidate, Mapping[str, float]], off: Mapping[str, float], names: Sequence[str], search: Search
) -> tuple[Defect, ...]:
    """Candidates that explain the deviation on the paths ``names`` together, best first, each name once."""
    without, worst = _root(off, names), max(names, key=off.__getitem__)
    found = [
        Defect(one.name, worst, _root(of, names), without, one.what, one)
        for one, of in left.items()
        if _root(of, names) <= min(search.share * without, search.most)
    ]
    best: dict[str, Defect] = {}
    for one in sorted(found, key=lambda one: one.error_with):
        best.setdefault(one.name, one)
    return tuple(best.values())


def _in_parts(
    left: Mapping[Candidate, Mapping[str, float]], off: Mapping[str, float], names: Sequence[str], search: Search
) -> tuple[Defect, ...]:
    """Several defects at once, each on paths of its own; what no defect explains is unknown.

    Amounts that are fitted to one path explain too much there. Of the defects that explain a path, that which explains
    the most paths is named.
    """
    found = {name: [one for one in _named(left, off, [name], search) if not _is_fitted(one)] for name in names}
    explains = Counter(one.name for ones in found.values() for one in ones)
    best: dict[str, list[Defect]] = {}
    for ones in found.values():
        for one in sorted(ones, key=lambda one: -explains[one.name])[:1]:
            best.setdefault(one.name, []).append(one)
    unexplained = [name for name, ones in found.items() if not ones]
    shown = [max(ones, key=lambda one: one.error_without) for ones in best.values()]
    if unexplained:
        shown.append(_unknown(unexplained, off))
    return tuple(sorted(shown, key=lambda one: (one.name == UNKNOWN, one.error_with)))


def _unknown(names: Sequence[str], off: Mapping[str, float]) -> Defect:
    """The deviation on paths ``names``, with mean square distances ``off``, as an unknown defect."""
    error, worst = _root(off, names), max(names, key=off.__getitem__)
    return Defect(UNKNOWN, worst, error, error, "the tractions differ from the definition as no known defect does")


def _left_over(
    bond: MixedBond,
    best: Defect,
    ways: Sequence[JumpPath],
    given: Answers,
    expected: Mapping[str, Answer],
    tolerance: float,
) -> Iterator[Defect]:
    """An unknown defect, where the best defect leaves more than the tolerance on a path."""
    assert best.candidate is not None
    left = {way.name: _apart(bond, best.candidate, way, given, expected) for way in ways}
    names = [name for name, distance in left.items() if not distance.max() <= tolerance]
    if names:
        yield _unknown(names, {name: mean_square(left[name]) for name in names})


def _left(
    bond: MixedBond, one: Candidate, ways: Sequence[JumpPath], given: Answers, expected: Mapping[str, Answer]
) -> dict[str, float]:
    """Path -> mean square distance from the law with a defect, in the scales of the law without it."""
    return {way.name: mean_square(_apart(bond, one, way, given, expected)) for way in ways}


def _apart(
    bond: MixedBond, one: Candidate, way: JumpPath, given: Answers, expected: Mapping[str, Answer]
) -> np.ndarray:
    found, known, asked = one.answer(way), expected[way.name], given[way.name]
    shifted = replace(known, p=known.p + asked.p - found.p, t=known.t + asked.t - found.t)
    return apart(bond, shifted, known)


def _root(square: Mapping[str, float], names: Sequence[str]) -> float:
    return float(np.sqrt(np.mean([square[name] for name in names])))


def _is_fitted(one: Defect) -> bool:
    return one.candidate is not None and one.candidate.fitted


def _fitted(
    bond: MixedBond,
    ways: Sequence[JumpPath],
    given: Answers,
    expected: Mapping[str, Answer],
    square: Mapping[str, float],
    search: Search,
) -> Iterator[Candidate]:
    """Of every family the candidate that fits best, on the first path and on those with the largest deviations."""
    worst = sorted(ways, key=lambda way: -square[way.name])[: search.paths]
    some, slides = list(dict.fromkeys((ways[0], *worst))), any(way.s.any() for way in ways)

    def error(one: Candidate) -> float:
        return sum(_left(bond, one, some, given, expected).values())

    found = (fitted(family, error) for family in families(bond, slides))
    return (one for one in found if one is not None)
