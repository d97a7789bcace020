"""Element boundaries along a specimen, and rectangles of either basis on them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from iga.bases.bspline import open_knots
from iga.bases.lagrange import lagrange_rectangle
from iga.bases.nurbs import nurbs_rectangle
from iga.mesh.extraction import Mesh

#: Names of the bases; T-splines have meshes of their own, `iga.specimen.tmesh_strip`.
BASES = ("nurbs", "tspline", "lagrange")


@dataclass(frozen=True)
class Grading:
    """How much the elements of a body may differ.

    Those off the crack path may be ``coarsening`` times longer than those on it: they only bend. Where bodies are
    pressed together, elements next to the load are no longer than the part ``pressed`` of the thickness; they are
    halved for that no more often than there are elements on the path where these are ``few``, and never more often
    than ``halvings``. Rounding adds or takes less than the part ``rounding`` of an element.
    """

    coarsening: float = 4.0
    pressed: float = 0.125
    few: int = 7
    halvings: int = 60
    rounding: float = 1e-9


GRADING = Grading()


def most_halvings(path: int) -> int:
    """How often an element is halved at most where bodies are pressed together, with so many elements on the path."""
    return path if path <= GRADING.few else GRADING.halvings


def columns(basis: str, degree: int, elements: int) -> int:
    """Functions of one direction."""
    return elements + degree if basis == "nurbs" else elements * degree + 1


def rectangle(basis: str, degrees: tuple[int, int], breaks_s: np.ndarray, breaks_t: np.ndarray) -> Mesh:
    """The rectangle of elements with boundaries at ``breaks_s`` x ``breaks_t``, of these degrees."""
    if basis == "lagrange":
        return lagrange_rectangle(breaks_s, breaks_t, *degrees)
    return nurbs_rectangle(*(open_knots(breaks, p) for breaks, p in zip((breaks_s, breaks_t), degrees, strict=True)))


def largest(unknowns: Callable[[int], int], least: int, aim: int) -> int:
    """The largest number from ``least`` on whose mesh has no more unknowns than aimed at; they grow with the number.

    Raises
    ------
    ValueError : even the least one has more.
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


def elements_within(length: float, most: float, short: float, layers: int) -> int:
    """Elements of length ``short`` that fill a length, and leave one of those within ``most``; 0 if they are longer.

    They are compared with the length as halved by each of ``layers``.
    """
    if short / 2**layers > length * (1.0 + GRADING.rounding):
        return 0
    return max(0, min(int(np.ceil(length / short - GRADING.rounding)), int(most / short - 1.0 + GRADING.rounding)))


def part(elements: float) -> int:
    """A number of elements from a wish: one at least."""
    return max(round(elements), 1)


def unequal(elements: int, mismatch: float) -> tuple[int, int]:
    """Elements of the upper and the lower body on one length; the finer one has so many.

    ``mismatch`` is the element length of the lower body over that of the upper one.
    """
    return (elements, part(elements / mismatch)) if mismatch >= 1.0 else (part(elements * mismatch), elements)


def finer_towards(breaks: np.ndarray, place: float, most: float, times: int) -> np.ndarray:
    """Element boundaries with one at a place, and the elements beside it halved towards it, again and again.

    That ends where those at the place are no longer than ``most``, or have been halved so many ``times``.
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


def pieces(*parts: tuple[float, float, int]) -> np.ndarray:
    """Element boundaries of neighbouring pieces (start, end, equal elements); an empty piece is left out."""
    breaks = [np.linspace(start, end, n + 1)[:-1] for start, end, n in parts if end > start]
    return np.concatenate([*breaks, [parts[-1][1]]])
