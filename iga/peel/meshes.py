"""Meshes of strip and substrate of a peel test, of any basis, from the number of unknowns."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from iga.mesh.extraction import Mesh
from iga.specimen.grading import (
    GRADING,
    columns,
    elements_within,
    finer_towards,
    largest,
    most_halvings,
    part,
    pieces,
    rectangle,
    unequal,
)
from iga.specimen.problem import presses
from iga.specimen.tmesh_strip import Strip, strip_tmesh
from iga.tsplines.tmesh import DEGREE, TMesh

if TYPE_CHECKING:
    from iga.peel.problem import Problem


@dataclass(frozen=True)
class Layers:
    """Layers of the substrate: at most ``most``, each ``thickening`` times as thick as the one above.

    The top one is no thinner than the part ``flattest`` of the length of its elements.
    """

    most: int = 3
    thickening: float = 2.0
    flattest: float = 0.5


LAYERS_BELOW = Layers()


def meshes(problem: Problem) -> tuple[Mesh, Mesh]:
    """Strip and substrate: equal elements along the bond and just beyond, then longer ones; thin layers on top below.

    Raises
    ------
    ValueError : ``dofs`` is too small for a mesh.
    """
    end, depth = problem.bond_length, problem.substrate_thickness
    for layers in range(LAYERS_BELOW.most, 0, -1):
        tops = np.concatenate([[0.0], np.cumsum(LAYERS_BELOW.thickening ** np.arange(layers))])
        try:
            (bonded, beyond), (below, rest) = _elements(problem, layers)
        except ValueError:
            if layers == 1:
                raise
            continue
        if tops[1] / tops[-1] * depth >= LAYERS_BELOW.flattest * end / below:
            break
    strip = _breaks(problem, problem.strip_length, bonded, beyond)
    substrate = _breaks(problem, problem.substrate_length, below, rest)
    through = np.array([0.0, problem.strip_thickness])
    return (
        rectangle(problem.basis, (problem.degree,) * 2, strip, through),
        rectangle(problem.basis, (problem.degree,) * 2, substrate, -depth * tops[::-1] / tops[-1]),
    )


def _elements(problem: Problem, layers: int) -> tuple[tuple[int, int], tuple[int, int]]:
    """Elements on and beyond the bond, of strip and substrate; what is left of the unknowns goes to the overhang."""
    basis, p = problem.basis, problem.degree
    lengths = problem.strip_length, problem.substrate_length

    def numbers(along: int) -> tuple[tuple[int, int], ...]:
        both = zip(unequal(along, problem.mismatch), lengths, strict=True)
        return tuple((path, _beyond(problem, length, path)) for path, length in both)

    def unknowns(along: int) -> int:
        both = zip(numbers(along), lengths, strict=True)
        strip, substrate = (columns(basis, p, len(_breaks(problem, length, *pair)) - 1) for pair, length in both)
        return 2 * ((p + 1) * strip + columns(basis, p, layers) * substrate)

    along = largest(unknowns, 2, problem.dofs)
    (bonded, beyond), below = numbers(along)
    an_element = 2 * (p + 1) * (1 if basis == "nurbs" else p)
    return (bonded, beyond + (problem.dofs - unknowns(along)) // an_element), below


def tmeshes(problem: Problem) -> tuple[TMesh, TMesh]:
    """T-meshes of strip and substrate: layers as many as are thick enough, then elements as the unknowns allow.

    Raises
    ------
    ValueError : ``dofs`` is too small for a mesh, or the degree is not 3.
    """
    if problem.degree != DEGREE:
        raise ValueError(f"degree must be {DEGREE} for T-splines, got {problem.degree}")
    thickness = problem.strip_thickness, problem.substrate_thickness
    layers, both = (1, 1), _strips(problem, (1, 1))
    for body in (1, 0):
        while True:
            more = (layers[0] + 1, layers[1]) if body == 0 else (layers[0], layers[1] + 1)
            try:
                strips = _strips(problem, more)
            except ValueError:
                break
            if not strips[body].stocky(thickness[body]):
                break
            layers, both = more, strips
    return (
        strip_tmesh(both[0], (0.0, problem.strip_thickness), top=False),
        strip_tmesh(both[1], (-problem.substrate_thickness, 0.0), top=True),
    )


def _strips(problem: Problem, layers: tuple[int, int]) -> tuple[Strip, Strip]:
    """Both bodies with so many layers, elements at the interface alike; what is left goes to the overhang."""
    lengths = problem.strip_length, problem.substrate_length

    def strips(along: int, spare: int = 0) -> tuple[Strip, Strip]:
        made = []
        for number, k, length in zip(unequal(along, problem.mismatch), layers, lengths, strict=True):
            path = number * 2 ** (max(layers) - k)
            breaks_c = _breaks(problem, length, path, _beyond(problem, length, path, k) + spare, k)
            made.append(Strip(breaks_c, np.arange(len(breaks_c) - 1) < path + _ahead(problem, length, path, k), k))
            spare = 0
        return made[0], made[1]

    def unknowns(both: tuple[Strip, Strip]) -> int:
        return 2 * sum(strip.functions for strip in both)

    along = largest(lambda n: unknowns(strips(n)), 1, problem.dofs)
    return strips(along, (problem.dofs - unknowns(strips(along))) // (2 * (layers[0] + DEGREE)))


def _ahead(problem: Problem, length: float, path: int, layers: int = 0) -> int:
    """Elements beyond the bond of a body that are as short as the ``path`` on it: as far as the strip is thick.

    ``layers`` halve them at the interface.

    The traction ends there with a jump, beside which the surface has an infinite slope (as the log of the distance,
    Flamant). Long elements smooth it over: J comes out 0.4 to 0.9 % off until the tip is open, not 0.03 to 0.15 %.
    """
    rest = length - problem.bond_length
    return elements_within(problem.strip_thickness, rest, problem.bond_length / path, layers)


def _beyond(problem: Problem, length: float, path: int, layers: int = 0) -> int:
    """Longer elements beyond the short ones; 0 for a body that ends with the bond."""
    rest = length - problem.bond_length
    short = problem.bond_length / path
    return (
        part((rest - _ahead(problem, length, path, layers) * short) / (GRADING.coarsening * short)) if rest > 0.0 else 0
    )


def _breaks(problem: Problem, length: float, path: int, beyond: int, layers: int = 0) -> np.ndarray:
    """Element boundaries along a body with so many elements on and beyond the bond.

    A strip that is pressed down lies on the end of the substrate, or ends on it: there they are shorter.
    """
    bond, ahead = problem.bond_length, _ahead(problem, length, path, layers)
    start = bond * (path + ahead) / path
    breaks = pieces((0.0, bond, path), (bond, start, ahead), (start, length, beyond))
    face = min(problem.strip_length, problem.substrate_length)
    if not presses(problem) or face <= bond:
        return breaks
    return finer_towards(breaks, face, GRADING.pressed * problem.strip_thickness, most_halvings(path))
