"""Meshes of two free arms, of any basis, from the number of unknowns.

The rule is the same for every basis: elements of one length all along the crack path, as short as the unknowns allow,
so that the process zone has as many as possible; elements up to `coarsening` times longer before and beyond.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from iga.bases.names import find
from iga.delamination.bent import crack_end
from iga.mesh.extraction import Mesh
from iga.specimen.grading import GRADING, elements_within, growing, most_halvings, number_along, pieces, saves, unequal
from iga.specimen.problem import Debonding, presses
from iga.specimen.tmesh_strip import Strip, functions_of_halves, strip_tmesh
from iga.tsplines.tmesh import DEGREE, TMesh


@dataclass(frozen=True)
class CrackPath:
    """How the crack path of an arm is divided.

    - ``coarsening``: length of elements off the path over that on it for incompressible materials (measured: with equal
      lengths too few elements are on the path). With Poisson's ratio zero it is `Grading.coarsening`.
    - ``margin``: part of a process zone by which the path extends beyond the crack of beam theory, which is ahead of
      the true one.
    - ``missed``: part of ``dofs`` by which the unknowns of a mesh may miss them.
    """

    coarsening: float = 1.25
    margin: float = 0.4
    missed: float = 0.02


CRACK_PATH = CrackPath()

#: Elements (before, on, beyond) the crack path.
Division = tuple[int, int, int]

#: Elements on the crack path of an arm, and spare elements before it, in addition to those that its length requires.
Arm = tuple[int, int]


def rectangles(problem: Debonding) -> tuple[Mesh, Mesh]:
    """NURBS or Lagrange meshes of both arms: equal elements on the crack path, longer ones before and beyond it.

    An element boundary lies at the end of the precrack, and there are ``layers`` elements through each arm. A mesh of
    given unknowns with few elements on the path (`saves`) is quadratic through the arms, which is enough for bending,
    and has more elements along them instead. If the arms would miss ``dofs`` by more than `CrackPath.missed`, one arm
    has one more element (the lower one; on rollers the more flexible one), or there are more elements before the path.
    Arms that are pressed together have shorter elements at the loaded end.

    Raises
    ------
    ValueError : ``dofs`` is too small for a mesh, or the arms are not those of `require_arms`.
    """
    require_arms(problem)
    q = problem.degree
    both = _chosen(problem, q)
    if q > 2 and saves(problem, min(path for path, _ in both)):
        q = 2
        both = _chosen(problem, q)

    @cache
    def drawn(arm: Arm, thickness: float) -> Mesh:
        through = thickness * np.linspace(0.0, 1.0, problem.layers + 1)
        return find(problem.basis).rectangle((problem.degree, q), lines(problem, *arm), through)

    upper, lower = (drawn(arm, body.thickness) for arm, body in zip(both, problem.layout.bodies, strict=True))
    return upper, replace(lower, P_AI=lower.P_AI - [0.0, lower.P_AI[-1, 1]])  # its top on Y = 0, to the last digit


def tmeshes(problem: Debonding) -> tuple[TMesh, TMesh]:
    """T-meshes of the upper and the lower arm, halved towards the interface (see `iga.specimen.tmesh_strip`).

    Raises
    ------
    ValueError : as `rectangles`, and for another degree than 3.
    """
    require_arms(problem)
    if problem.degree != DEGREE:
        raise ValueError(f"degree must be {DEGREE} for T-splines, got {problem.degree}")
    both = _strips(problem, 1)
    for layers in range(2, 20):
        try:
            more = _strips(problem, layers)
        except ValueError:
            break
        if not all(strip.stocky(arm.thickness) for strip, arm in zip(more, problem.layout.bodies, strict=True)):
            break
        both = more
    return arm_tmeshes(problem, both)


def require_arms(problem: Debonding) -> None:
    """Raise ValueError where the arms are not equally long, opened at X = 0 and bonded up to their far ends."""
    layout = problem.layout
    (precrack, end), lengths = layout.bonded, [body.length for body in layout.bodies]
    opened = bool(layout.supports) or layout.loaded_at == 0.0
    if lengths != [end, end] or not opened or not 0.0 < precrack < end:
        raise ValueError(f"arms must end with the bond and be opened at X = 0, got {lengths} and {layout.bonded}")


def _turned(problem: Debonding) -> bool:
    """Whether couples act on the faces at the left ends, and arms turn far."""
    couples = any(load.couple and load.side == "left" for load in problem.layout.loads)
    return couples and problem.kinematics == "finite"


def _thinner(problem: Debonding) -> float:
    return min(body.thickness for body in problem.layout.bodies)


def crack_path(problem: Debonding) -> float:
    """X where the crack path ends: a part of a process zone beyond the crack at the largest opening, at most the bond's
    end.

    Beam theory of slender arms, without shear or root rotation, has the crack at
    ``a^2 = 3/2 opening sqrt(E h^3 / (12 G))``, with the harmonic mean of the ``E h^3`` of both arms and E the axial
    modulus of the plane. A deflected arm is longer than its reach along X: its length is ``hypot(a, opening / 2)``.
    Soft contact deforms over the length ``(E h^3 / (3 penalty))^(1/4)`` of a beam on springs (Hetenyi 1946).
    """
    (precrack, end), opening = problem.layout.bonded, max(0.0, *problem.opening)
    if problem.layout.supports:
        return min(crack_end(problem) + zone_length(problem), end)
    one, other = (body.moduli.axial(problem.plane) * body.thickness**3 for body in problem.layout.bodies)
    mean = one * (2.0 * other / (one + other))
    crack = (1.5 * opening * (mean / (12.0 * problem.law.pure_modes[0][1])) ** 0.5) ** 0.5
    soft = (max(one, other) / (3.0 * problem.law.penalty)) ** 0.25
    ahead = max(CRACK_PATH.margin * zone_length(problem), soft if problem.law.contact else 0.0)
    return min(max(np.hypot(crack, 0.5 * opening), precrack) + ahead, end)


def zone_length(problem: Debonding) -> float:
    """Length of the process zone of slender arms, ``(E G / p_max^2)^(1/4) h^(3/4)`` (Williams and Hadavinia 2002). For
    unequal arms it is the smaller of both values, which is at most 2^(1/4) times too short.

    For arms that slide it is ``(E G_IIc h / t_max^2)^(1/2)`` where that is longer (Yang and Cox 2005).
    """
    bodies, plane, ((p, G_I), *sliding) = problem.layout.bodies, problem.plane, problem.law.pure_modes
    opening = min((body.moduli.axial(plane) * G_I / p**2) ** 0.25 * body.thickness**0.75 for body in bodies)
    along = [min((body.moduli.axial(plane) * G * body.thickness) ** 0.5 / t for body in bodies) for t, G in sliding]
    return max(opening, *along) if along and problem.layout.supports else opening


def lead(problem: Debonding) -> float:
    """Length before the tip of the precrack on which elements are as short as on the path.

    The traction begins at the tip with a jump. Near a jump, within about the thickness of an arm, the slope of the
    surface is infinite (like the logarithm of the distance, Flamant). Long elements smooth this over: with thick arms
    and a strong bond J is 3 to 10 % off until the tip is open.
    """
    return min(_thinner(problem), CRACK_PATH.margin * zone_length(problem))


def coarsening(problem: Debonding) -> float:
    """How much longer elements off the crack path may be than those on it.

    With finite rotations the shape of a bent arm is no polynomial. Its approximation by a cubic leaves a spurious
    change of volume, which grows with the cube of the element length. The stress of it is
    ``1 / (1 - D12^2 / (D11 D22))`` times that of bending: a nearly incompressible arm locks in long elements.
    """
    matrices = [body.moduli.stiffness(problem.plane) for body in problem.layout.bodies]
    free = min((1.0 - D[0, 1] ** 2 / (D[0, 0] * D[1, 1])) ** (1.0 / 3.0) for D in matrices)
    return max(CRACK_PATH.coarsening, GRADING.coarsening * free)


def division(
    problem: Debonding, path: int, spare: int = 0, layers: int = 0
) -> tuple[Division, tuple[float, float, float, float]]:
    """Numbers of elements before, on and beyond a crack path with ``path`` elements, and the boundaries of these parts.

    - The short elements of the path, which ``layers`` halve at the interface, begin before the tip by as many whole
      elements as fill the `lead`, unless one is longer than the `lead`.
    - Before them come as many elements as the length requires, and ``spare`` more.
    - Where few elements on the path save unknowns (`saves`) neither other part has more.
    - Two elements before the path become one if they are cubic: the bending line of an unloaded beam is a cubic.
    - The path extends to the end of the bond if less than half an element would be left.
    """
    end, (precrack, length) = crack_path(problem), problem.layout.bonded
    if length - end < 0.5 * (end - precrack) / path:
        end = length
    short = (end - precrack) / path
    ahead = elements_within(lead(problem), precrack, short, layers)
    start = precrack - ahead * short
    longest = coarsening(problem) * short
    before, beyond = (int(np.ceil(part / longest - GRADING.rounding)) for part in (start, length - end))
    if saves(problem, path):
        before, beyond = min(before, path), min(beyond, path)
    if before == 2 and problem.degree >= 3:
        before = 1
    return (before + spare, ahead + path, beyond), (0.0, start, end, length)


def lines(problem: Debonding, path: int, spare: int = 0, layers: int = 0) -> np.ndarray:
    """Element boundaries along an arm; parameters as those of `division`.

    Where arms are pressed together, or turned far by couples on their faces, the first element is halved repeatedly
    towards the loaded end, down to `Grading.pressed`: load and contact balance each other within about the thickness of
    an arm from there, and the J-integral of couples comes from the strains at the face.
    """
    parts, x = division(problem, path, spare, layers)
    breaks = pieces(*((start, end, n) for start, end, n in zip(x[:-1], x[1:], parts, strict=True)))
    first = x[1] / (parts[0] - spare) if parts[0] > spare else 0.0
    if problem.solid and problem.element is not None:
        _, start, end, length = x
        short = (end - start) / parts[1]
        longest = max(short, GRADING.longest * _thinner(problem))
        before, beyond = growing(start, short, longest), end + growing(length - end, short, longest)
        breaks = np.unique(
            np.concatenate([start - before, pieces((start, end, parts[1])), beyond if end < length else []])
        )
        first, breaks[-1] = breaks[1], length
    if not (presses(problem) or _turned(problem)):
        return breaks
    halvings = np.log2(first / (GRADING.pressed * _thinner(problem))) - GRADING.rounding
    number = min(max(0, int(np.ceil(halvings))), most_halvings(problem, path))
    return np.concatenate([breaks[:1], breaks[1] * 0.5 ** np.arange(number, 0, -1), breaks[1:]])


def _chosen(problem: Debonding, q: int) -> tuple[Arm, Arm]:
    """Elements of both arms, with degree ``q`` through them, whose unknowns are closest to ``dofs``.

    Preferred are meshes without spare elements if they miss ``dofs`` by at most `CrackPath.missed`.
    """

    def arms(path: int, *spare: int) -> tuple[Arm, Arm]:
        upper, lower = zip(unequal(path, problem.mismatch), spare or (0, 0), strict=True)
        return upper, lower

    columns = find(problem.basis).columns
    rows = columns(q, problem.layers)

    @cache
    def along(arm: Arm) -> int:
        return columns(problem.degree, len(lines(problem, *arm)) - 1)

    def unknowns(both: tuple[Arm, Arm]) -> int:
        return 2 * rows * sum(along(arm) for arm in both)

    length = crack_path(problem) - problem.layout.bonded[0]
    n = number_along(problem, length, lambda n: unknowns(arms(n)), 1)
    if problem.element is not None:
        return arms(n)
    least = unknowns(arms(n))
    spare = (problem.dofs - least) // (unknowns(arms(n, 1, 1)) - least)
    options = [arms(n), arms(n + 1), arms(n, spare, spare), arms(n, spare + 1, spare + 1)]
    if not problem.symmetry and abs(problem.mismatch - 1.0) < 1e-9 and problem.interface_rule != "lumped":
        more, longer = ((n, 0), (n + 1, 0)), arms(n, spare, spare + 1)
        upper, lower = (body.moduli.axial(problem.plane) * body.thickness**3 for body in problem.layout.bodies)
        if problem.layout.supports and upper < lower:
            more, longer = more[::-1], longer[::-1]
        options = [*options[:2], more, *options[2:], longer]
    missed = [abs(unknowns(option) - problem.dofs) for option in options]
    near = [option for option, by in zip(options[:2], missed, strict=False) if by <= CRACK_PATH.missed * problem.dofs]
    return near[0] if near else options[int(np.argmin(missed))]


def arm_tmeshes(problem: Debonding, strips: tuple[Strip, Strip]) -> tuple[TMesh, TMesh]:
    """T-meshes of the upper and the lower arm."""
    (upper, lower), (above, below) = strips, (body.thickness for body in problem.layout.bodies)
    return strip_tmesh(upper, (0.0, above), top=False), strip_tmesh(lower, (-below, 0.0), top=True)


def _strips(problem: Debonding, layers: int) -> tuple[Strip, Strip]:
    """Both arms with ``layers`` layers and all elements on the path halved, or an option closer to ``dofs``.

    The options are one more element on the path, with the last ones not halved, or more elements before the path.
    Several layers are for arms that do not save unknowns (`saves`), which the layers would take from those beyond the
    path.

    Raises
    ------
    ValueError : ``dofs`` is too small for such a mesh.
    """
    column, halves = layers + DEGREE, functions_of_halves(layers)
    coarser = max(problem.mismatch, 1.0 / problem.mismatch)
    few = GRADING.few if problem.element is None else 1
    least = 1 if layers == 1 else int(np.ceil((few + 0.5) * coarser))  # rounded by `unequal`

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

    length = crack_path(problem) - problem.layout.bonded[0]
    path = number_along(problem, length, lambda n: unknowns(n, n), least, layers)
    missing = (problem.dofs - unknowns(path, path)) // 4
    options = [(path, path, 0)]
    if problem.element is None and 4 * missing > CRACK_PATH.missed * problem.dofs:
        spare, fewer = missing // column, -(-(column - missing % column) // halves)
        longer = (problem.dofs - unknowns(path + 1, 0)) // (4 * halves)
        options += [(path + 1, longer, 0), (path, path, spare), (path, path - fewer, spare + 1)]
        options = [option for option in options if option[1] > 0]
    best = min(options, key=lambda option: abs(problem.dofs - unknowns(*option)))
    upper, lower = (strip(n, *best[1:]) for n in unequal(best[0], problem.mismatch))
    return upper, lower
