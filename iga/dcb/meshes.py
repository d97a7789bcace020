"""Meshes of the arms of a double cantilever beam, of any basis, from the number of unknowns.

The same rule for every basis: one interface element length all along the crack path, as short as the unknowns allow, so
that it divides the process zone as often as possible; elements up to `coarsening` times longer before and beyond.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from iga.mesh.extraction import Mesh
from iga.specimen.grading import GRADING, columns, elements_within, largest, most_halvings, pieces, rectangle, unequal
from iga.specimen.problem import presses
from iga.specimen.tmesh_strip import Strip, functions_of_halves, strip_tmesh
from iga.tsplines.tmesh import DEGREE, TMesh
from iga.tsplines.tspline import tspline_rectangle

if TYPE_CHECKING:
    from iga.dcb.problem import Problem


@dataclass(frozen=True)
class CrackPath:
    """How the crack path of an arm is divided.

    Elements off it may be ``coarsening`` times longer where the material is incompressible (measured: with equal
    elements those on the path become too few), and `Grading.coarsening` times where Poisson's ratio is zero. The path
    goes on beyond the crack of beam theory, which is ahead of the true one, by the part ``margin`` of a process zone.
    A mesh may miss the unknowns aimed at by the part ``missed`` of them.
    """

    coarsening: float = 1.25
    margin: float = 0.4
    missed: float = 0.02


CRACK_PATH = CrackPath()

#: Elements (before, on, beyond) the crack path.
Division = tuple[int, int, int]

#: Elements on the crack path of an arm, and elements before it beyond those that its length asks for.
Arm = tuple[int, int]


def arm_meshes(problem: Problem) -> tuple[Mesh, ...]:
    """The arms, upper first: equal elements on the crack path, longer ones before and beyond it.

    An element boundary lies at the end of the precrack. The model of one arm gets half of ``dofs``. NURBS and
    Lagrange meshes are one element thick; one with few elements on the path (`Grading.few`) is quadratic through the
    arms, all that bending needs, and spends the rest along them. Where two equal arms would miss ``dofs`` by more than
    `CrackPath.missed`, the lower one has one element more, or there are more elements before the path. T-splines halve
    the elements towards the interface (see `iga.specimen.tmesh_strip`). Arms that are pressed together have shorter
    elements at the loaded end.

    Raises
    ------
    ValueError : ``dofs`` is too small for a mesh, or T-splines of another degree than 3.
    """
    if problem.basis == "tspline":
        meshes = tuple(tspline_rectangle(mesh) for mesh in tmeshes(problem))
    else:
        meshes = _rectangles(problem)
    return meshes[:1] if problem.symmetry else meshes


def tmeshes(problem: Problem) -> tuple[TMesh, TMesh]:
    """T-meshes of the upper and the lower arm; refusals as those of `arm_meshes`."""
    if problem.degree != DEGREE:
        raise ValueError(f"degree must be {DEGREE} for T-splines, got {problem.degree}")
    both = _strips(problem, 1)
    for layers in range(2, 20):
        try:
            more = _strips(problem, layers)
        except ValueError:
            break
        if not all(strip.stocky(problem.arm_thickness) for strip in more):
            break
        both = more
    return arm_tmeshes(problem, both)


def crack_path(problem: Problem) -> float:
    """Where the crack path ends: beyond the crack at the largest opening, and part of a process zone, or with the bond.

    Beam theory without shear or root rotation has the crack at ``a^2 = 3/2 opening sqrt(E h^3 / (12 G))`` in slender
    arms; an arm that is deflected far is longer than it reaches. Soft contact gives way over the length
    ``(E h^3 / (3 penalty))^(1/4)`` of a beam on springs (Hetenyi 1946).
    """
    h, opening = problem.arm_thickness, max(0.0, *problem.opening)
    crack = (1.5 * opening * (problem.E1 * h**3 / (12.0 * problem.toughness)) ** 0.5) ** 0.5
    soft = (problem.E1 * h**3 / (3.0 * problem.law.penalty)) ** 0.25
    ahead = max(CRACK_PATH.margin * zone_length(problem), soft if problem.contact else 0.0)
    return min(max(np.hypot(crack, 0.5 * opening), problem.precrack) + ahead, problem.length)


def zone_length(problem: Problem) -> float:
    """Length of the process zone of slender arms, ``(E G / p_max^2)^(1/4) h^(3/4)`` (Williams and Hadavinia 2002)."""
    return (problem.E1 * problem.toughness / problem.strength**2) ** 0.25 * problem.arm_thickness**0.75


def lead(problem: Problem) -> float:
    """How far before the tip of the precrack elements are as short as on the path, where so short ones are on it.

    The traction begins at the tip with a jump, beside which the surface has an infinite slope (as the log of the
    distance, Flamant), as far as an arm is thick. Long elements there smooth it over: J comes out 3 to 10 % off until
    the tip is open, with a strong bond of thick arms.
    """
    return min(problem.arm_thickness, CRACK_PATH.margin * zone_length(problem))


def coarsening(problem: Problem) -> float:
    """How much longer elements off the crack path may be than those on it.

    A bent arm is no polynomial where its rotation is finite. What a cubic leaves of it is a spurious change of volume,
    which grows with the cube of the length of an element, and costs stress ``1 / (1 - D12^2 / (D11 D22))`` times that
    of bending: an arm that is nearly incompressible locks in long elements.
    """
    D = problem.elasticity
    return max(CRACK_PATH.coarsening, GRADING.coarsening * (1.0 - D[0, 1] ** 2 / (D[0, 0] * D[1, 1])) ** (1.0 / 3.0))


def division(
    problem: Problem, path: int, spare: int = 0, layers: int = 0
) -> tuple[Division, tuple[float, float, float, float]]:
    """Elements before, on and beyond the crack path with so many on it, and where these parts begin and end.

    Those on the path, which ``layers`` halve at the interface, begin before it by as many whole elements as fill the
    `lead`, if they are no longer there than that. There are ``spare`` more elements before them
    than their length asks for. Where there are few on the path there are no more of them elsewhere. One cubic element
    stands before the path in place of two: the bending line of an unloaded beam is a cubic. What is left beyond the
    path is part of it where that is shorter than half an element.
    """
    end = crack_path(problem)
    if problem.length - end < 0.5 * (end - problem.precrack) / path:
        end = problem.length
    short = (end - problem.precrack) / path
    ahead = elements_within(lead(problem), problem.precrack, short, layers)
    start = problem.precrack - ahead * short
    longest = coarsening(problem) * short
    before, beyond = (int(np.ceil(length / longest - GRADING.rounding)) for length in (start, problem.length - end))
    if path <= GRADING.few:
        before, beyond = min(before, path), min(beyond, path)
    if before == 2 and problem.degree >= 3:
        before = 1
    return (before + spare, ahead + path, beyond), (0.0, start, end, problem.length)


def lines(problem: Problem, path: int, spare: int = 0, layers: int = 0) -> np.ndarray:
    """Element boundaries along an arm that is divided like this; parameters as those of `division`.

    Where arms are pressed together the first element is halved towards the loaded end, again and again, down to
    `Grading.pressed`: load and contact balance each other within about the thickness of an arm from there.
    """
    parts, x = division(problem, path, spare, layers)
    breaks = pieces(*((start, end, n) for start, end, n in zip(x[:-1], x[1:], parts, strict=True)))
    if not presses(problem):
        return breaks
    halvings = np.log2(x[1] / (parts[0] - spare) / (GRADING.pressed * problem.arm_thickness)) - GRADING.rounding
    number = min(max(0, int(np.ceil(halvings))), most_halvings(path))
    return np.concatenate([breaks[:1], breaks[1] * 0.5 ** np.arange(number, 0, -1), breaks[1:]])


def _rectangles(problem: Problem) -> tuple[Mesh, ...]:
    basis, p = problem.basis, problem.degree

    def arms(path: int, *spare: int) -> tuple[Arm, Arm]:
        upper, lower = zip(unequal(path, problem.mismatch), spare or (0, 0), strict=True)
        return upper, lower

    @cache
    def along(arm: Arm) -> int:
        return columns(basis, p, len(lines(problem, *arm)) - 1)

    def unknowns(both: tuple[Arm, Arm], q: int) -> int:
        return 2 * (q + 1) * sum(along(arm) for arm in both)

    def chosen(q: int) -> tuple[Arm, Arm]:
        n = largest(lambda n: unknowns(arms(n), q), 1, problem.dofs)
        least = unknowns(arms(n), q)
        spare = (problem.dofs - least) // (unknowns(arms(n, 1, 1), q) - least)
        options = [arms(n), arms(n + 1), arms(n, spare, spare), arms(n, spare + 1, spare + 1)]
        if not problem.symmetry:
            alike = abs(problem.mismatch - 1.0) < 1e-9 and problem.interface_rule != "lumped"
            options[2:2] = [((n, 0), (n + 1, 0))] if alike else []
            options += [arms(n, spare, spare + 1)] if alike else []
        missed = [abs(unknowns(option, q) - problem.dofs) for option in options]
        near = [
            option for option, by in zip(options[:2], missed, strict=False) if by <= CRACK_PATH.missed * problem.dofs
        ]
        return near[0] if near else options[int(np.argmin(missed))]

    q = p
    both = chosen(q)
    if q > 2 and min(path for path, _ in both) <= GRADING.few:
        q = 2
        both = chosen(q)
    through = problem.arm_thickness * np.linspace(0.0, 1.0, 2)

    @cache
    def drawn(arm: Arm) -> Mesh:
        return rectangle(basis, (p, q), lines(problem, *arm), through)

    upper, lower = (drawn(arm) for arm in both)
    return upper, replace(lower, P_AI=lower.P_AI - [0.0, lower.P_AI[-1, 1]])  # its top on Y = 0, to the last digit


def arm_tmeshes(problem: Problem, strips: tuple[Strip, Strip]) -> tuple[TMesh, TMesh]:
    """T-meshes of the upper and the lower arm."""
    h = problem.arm_thickness
    upper, lower = strips
    return strip_tmesh(upper, (0.0, h), top=False), strip_tmesh(lower, (-h, 0.0), top=True)


def _strips(problem: Problem, layers: int) -> tuple[Strip, Strip]:
    """Both arms with so many layers: all elements on the path halved, or what meets ``dofs`` better.

    That may be one element more, of which the last ones are not halved, or more elements before the path.
    """
    column, halves = layers + DEGREE, functions_of_halves(layers)

    def strip(path: int, halved: int, spare: int) -> Strip:
        parts, breaks_c = division(problem, path, spare, layers)[0], lines(problem, path, spare, layers)
        number = np.arange(len(breaks_c) - 1) - (len(breaks_c) - 1 - sum(parts[1:]))
        return Strip(breaks_c, (number >= 0) & (number < parts[1] - path + min(halved, path)), layers)

    def unknowns(path: int, halved: int, spare: int = 0) -> int:
        paths = unequal(path, problem.mismatch)
        parts = [division(problem, n, spare, layers)[0] for n in paths]
        columns = sum(len(lines(problem, n, spare, layers)) - 1 + DEGREE for n in paths)
        cut = sum(min(halved, n) + part[1] - n for n, part in zip(paths, parts, strict=True))
        return 2 * (columns * column + cut * halves)

    path = largest(lambda n: unknowns(n, n), 1, problem.dofs)
    missing = (problem.dofs - unknowns(path, path)) // 4
    options = [(path, path, 0)]
    if 4 * missing > CRACK_PATH.missed * problem.dofs:
        spare, fewer = missing // column, -(-(column - missing % column) // halves)
        longer = (problem.dofs - unknowns(path + 1, 0)) // (4 * halves)
        options += [(path + 1, longer, 0), (path, path, spare), (path, path - fewer, spare + 1)]
        options = [option for option in options if option[1] > 0]
    best = min(options, key=lambda option: abs(problem.dofs - unknowns(*option)))
    upper, lower = (strip(n, *best[1:]) for n in unequal(best[0], problem.mismatch))
    return upper, lower
