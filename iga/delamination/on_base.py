"""Meshes of a strip on a substrate with a clamped base, of any basis, from the number of unknowns."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from iga.bases.names import find
from iga.mesh.extraction import Mesh
from iga.specimen.grading import (
    GRADING,
    elements_within,
    finer_towards,
    most_halvings,
    number_along,
    part,
    pieces,
    unequal,
)
from iga.specimen.problem import Debonding, presses
from iga.specimen.ranges import require
from iga.specimen.tmesh_strip import Strip, strip_tmesh
from iga.tsplines.tmesh import DEGREE, TMesh


@dataclass(frozen=True)
class Layers:
    """Layers of the substrate: at most ``most``, each ``thickening`` times as thick as the one above.

    The top one is no thinner than the part ``flattest`` of the length of its elements.
    """

    most: int = 3
    thickening: float = 2.0
    flattest: float = 0.5


LAYERS_BELOW = Layers()


def rectangles(problem: Debonding) -> tuple[Mesh, Mesh]:
    """Meshes of strip and substrate: equal elements along the bond and just beyond, then longer ones; the substrate has
    layers that are thinnest at its top.

    Raises
    ------
    ValueError : ``dofs`` is too small for a mesh, or the bond is longer than a body.
    """
    _require_bodies(problem)
    (strip, substrate), (end, _) = problem.layout.bodies, problem.layout.bonded
    for layers in range(LAYERS_BELOW.most, 0, -1):
        tops = np.concatenate([[0.0], np.cumsum(LAYERS_BELOW.thickening ** np.arange(layers))])
        try:
            (bonded, beyond), (below, rest) = _elements(problem, layers)
        except ValueError:
            if layers == 1:
                raise
            continue
        if tops[1] / tops[-1] * substrate.thickness >= LAYERS_BELOW.flattest * end / below:
            break
    upper_s = _breaks(problem, strip.length, bonded, beyond)
    lower_s = _breaks(problem, substrate.length, below, rest)
    lower_t = -substrate.thickness * tops[::-1] / tops[-1]
    rectangle, degrees = find(problem.basis).rectangle, (problem.degree,) * 2
    return (
        rectangle(degrees, upper_s, np.array([0.0, strip.thickness])),
        rectangle(degrees, lower_s, lower_t),
    )


def _elements(problem: Debonding, layers: int) -> tuple[tuple[int, int], tuple[int, int]]:
    """Elements on and beyond the bond, of strip and substrate; remaining unknowns go to the overhang of the strip."""
    columns, p = find(problem.basis).columns, problem.degree
    lengths = [body.length for body in problem.layout.bodies]

    def numbers(along: int) -> tuple[tuple[int, int], ...]:
        both = zip(unequal(along, problem.mismatch), lengths, strict=True)
        return tuple((path, _beyond(problem, length, path)) for path, length in both)

    def unknowns(along: int) -> int:
        both = zip(numbers(along), lengths, strict=True)
        strip, substrate = (columns(p, len(_breaks(problem, length, *pair)) - 1) for pair, length in both)
        return 2 * ((p + 1) * strip + columns(p, layers) * substrate)

    along = number_along(problem, problem.layout.bonded[0], unknowns, 2)
    (bonded, beyond), below = numbers(along)
    if problem.element is not None:
        return (bonded, beyond), below
    an_element = 2 * (p + 1) * (columns(p, 2) - columns(p, 1))
    return (bonded, beyond + (problem.dofs - unknowns(along)) // an_element), below


def tmeshes(problem: Debonding) -> tuple[TMesh, TMesh]:
    """T-meshes of strip and substrate: as many layers as stay thick enough, and as many elements as ``dofs`` allow.

    Raises
    ------
    ValueError : ``dofs`` is too small for a mesh, the degree is not 3, or the bond is longer than a body.
    """
    _require_bodies(problem)
    if problem.degree != DEGREE:
        raise ValueError(f"degree must be {DEGREE} for T-splines, got {problem.degree}")
    thickness = [body.thickness for body in problem.layout.bodies]
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
        strip_tmesh(both[0], (0.0, thickness[0]), top=False),
        strip_tmesh(both[1], (-thickness[1], 0.0), top=True),
    )


def _strips(problem: Debonding, layers: tuple[int, int]) -> tuple[Strip, Strip]:
    """Both bodies with these layers and with equal elements at the interface; remaining unknowns go to the overhang of
    the strip."""
    lengths = [body.length for body in problem.layout.bodies]

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

    along = number_along(problem, problem.layout.bonded[0], lambda n: unknowns(strips(n)), 1, max(layers))
    if problem.element is not None:
        return strips(along)
    return strips(along, (problem.dofs - unknowns(strips(along))) // (2 * (layers[0] + DEGREE)))


def _ahead(problem: Debonding, length: float, path: int, layers: int = 0) -> int:
    """Number of elements beyond the bond that are as short as those on it (``path`` elements), over a length of the
    strip's thickness. ``layers`` halve them at the interface.

    The traction ends there with a jump. Near it the slope of the surface is infinite (like the logarithm of the
    distance, Flamant). Until the tip is open J is 0.4 to 0.9 % off with long elements, 0.03 to 0.15 % with short ones.
    """
    (strip, _), (bond, _) = problem.layout.bodies, problem.layout.bonded
    return elements_within(strip.thickness, length - bond, bond / path, layers)


def _beyond(problem: Debonding, length: float, path: int, layers: int = 0) -> int:
    """Longer elements beyond the short ones; 0 for a body that ends with the bond."""
    bond, _ = problem.layout.bonded
    rest, short = length - bond, bond / path
    return (
        part((rest - _ahead(problem, length, path, layers) * short) / (GRADING.coarsening * short)) if rest > 0.0 else 0
    )


def _breaks(problem: Debonding, length: float, path: int, beyond: int, layers: int = 0) -> np.ndarray:
    """Element boundaries along a body with ``path`` elements on the bond and ``beyond`` long ones beyond it.

    A strip that is pressed down bears on the end of the substrate, or ends on it: elements are shorter there.
    """
    layout, ahead = problem.layout, _ahead(problem, length, path, layers)
    bond, face = layout.bonded[0], layout.facing[0]
    start = bond * (path + ahead) / path
    breaks = pieces((0.0, bond, path), (bond, start, ahead), (start, length, beyond))
    if not presses(problem) or face <= bond:
        return breaks
    return finer_towards(breaks, face, GRADING.pressed * layout.bodies[0].thickness, most_halvings(problem, path))


def _require_bodies(problem: Debonding) -> None:
    require(problem, "layers", problem.layers == 1, "1 on a base, which has layers of its own")
    layout = problem.layout
    (bond, start), (strip, substrate) = layout.bonded, (body.length for body in layout.bodies)
    if start != 0.0 or not 0.0 < bond < strip or bond > substrate or layout.loaded_at != strip:
        rule = "begin at X = 0, end before the strip, which is loaded at its right end, and not beyond the substrate"
        raise ValueError(f"bond must {rule}, got {layout.bonded}")
