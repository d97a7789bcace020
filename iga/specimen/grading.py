"""Numbers of elements along a specimen, and their boundaries."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from iga.specimen.problem import Debonding


@dataclass(frozen=True)
class Grading:
    """How much the elements of a body may differ.

    - ``coarsening``: length of elements off the crack path, where there is only bending, over that on it, at most.
    - ``grows``, ``longest``: of solids, whose unknowns are many, length of an element off the path over the one nearer
      to it, and over the thickness at most: arms bend in cubics.
    - ``pressed``: where bodies are pressed together, length of elements next to the load over the thickness, at most.
    - ``few``: a mesh of given unknowns saves them with up to so many elements on the path, see `saves`: they are halved
      for that at most as often as there are elements on the path; otherwise at most ``halvings`` times.
    - ``rounding``: part of an element that counts as rounding.
    """

    coarsening: float = 4.0
    grows: float = 1.5
    longest: float = 2.0
    pressed: float = 0.125
    few: int = 7
    halvings: int = 60
    rounding: float = 1e-9


GRADING = Grading()


def saves(problem: Debonding, path: int) -> bool:
    """Whether a mesh has so few elements on the path that it saves unknowns elsewhere: never where their length is
    given, as a short path then says nothing about the arms."""
    return problem.element is None and path <= GRADING.few


def most_halvings(problem: Debonding, path: int) -> int:
    """Largest number of halvings where bodies are pressed together, for a number of elements on the path."""
    return path if saves(problem, path) else GRADING.halvings


def largest(unknowns: Callable[[int], int], least: int, aim: int) -> int:
    """The largest number, from ``least`` on, of which ``unknowns`` (an increasing function) is at most ``aim``.

    Raises
    ------
    ValueError : ``least`` itself has more unknowns.
    """
    if unknowns(least) > aim:
        raise ValueError(f"a mesh of this basis and degree needs at least {unknowns(least)} unknowns, got {aim}")
    low, high = least, 2 * least
    while unknowns(high) <= aim:
        low, high = high, 2 * high
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if unknowns(middle) <= aim else (low, middle)
    return low


def number_along(
    problem: Debonding, length: float, unknowns: Callable[[int], int], least: int, halvings: int = 0
) -> int:
    """Elements on a length of the interface: as many as ``dofs`` allow, or so many that none is longer than
    ``element``.

    ``unknowns`` are those of a mesh by the number, which is ``least`` at the least; at the interface each element is
    halved ``halvings`` times.

    Raises
    ------
    ValueError : ``dofs`` is too small for a mesh, or several halvings make elements half as long as ``element``.
    """
    if problem.element is None:
        return largest(unknowns, least, problem.dofs)
    wanted = length / problem.element / 2**halvings
    if halvings > 1 and wanted <= 0.5 * least:
        raise ValueError(f"element: {halvings} halvings make elements shorter than half of {problem.element:g}")
    return max(least, int(np.ceil(wanted - GRADING.rounding)))


def elements_within(length: float, most: float, short: float, layers: int) -> int:
    """Number of elements of length ``short`` that fill ``length`` but leave at least one element's length of ``most``.

    It is 0 if an element, halved by each of ``layers``, is longer than ``length``.
    """
    if short / 2**layers > length * (1.0 + GRADING.rounding):
        return 0
    return max(0, min(int(np.ceil(length / short - GRADING.rounding)), int(most / short - 1.0 + GRADING.rounding)))


def part(elements: float) -> int:
    """Rounded number of elements, at least 1."""
    return max(round(elements), 1)


def unequal(elements: int, mismatch: float) -> tuple[int, int]:
    """Elements of the upper and the lower body on one length; ``elements`` is the number of the finer one.

    ``mismatch`` is the element length of the lower body over that of the upper one.
    """
    return (elements, part(elements / mismatch)) if mismatch >= 1.0 else (part(elements * mismatch), elements)


def finer_towards(breaks: np.ndarray, place: float, most: float, times: int) -> np.ndarray:
    """Element boundaries with one at a place, and with the elements on both sides halved repeatedly towards it.

    They are halved until those at the place are no longer than ``most``, and at most ``times`` times.
    """
    near = np.abs(breaks - place) < GRADING.rounding * breaks[-1]
    breaks = np.where(near, place, breaks) if near.any() else np.sort(np.append(breaks, place))
    at, parts = int(np.argmin(np.abs(breaks - place))), [breaks]
    for beside in (at - 1, at + 1):
        if 0 <= beside < len(breaks):
            away = breaks[beside] - place
            halvings = min(max(0, int(np.ceil(np.log2(abs(away) / most) - GRADING.rounding))), times)
            parts.append(place + away * 0.5 ** np.arange(1, halvings + 1))
    return np.sort(np.concatenate(parts))


def growing(length: float, short: float, longest: float) -> np.ndarray:
    """Distances (n + 1,) from a path of elements ``short``, each one longer by `Grading.grows`, up to ``longest``."""
    most = int(length / short) + 1
    ends = np.cumsum(np.minimum(short * GRADING.grows ** np.minimum(np.arange(1.0, most + 1), 60.0), longest))
    n = int(np.searchsorted(ends, length * (1.0 - GRADING.rounding))) + 1
    return length * np.concatenate([[0.0], ends[: n - 1] / ends[n - 1], [1.0]])


def pieces(*parts: tuple[float, float, int]) -> np.ndarray:
    """Element boundaries of neighbouring pieces (start, end, equal elements); an empty piece is left out."""
    breaks = [np.linspace(start, end, n + 1)[:-1] for start, end, n in parts if end > start]
    return np.concatenate([*breaks, [parts[-1][1]]])
