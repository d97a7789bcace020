"""Splines along the arms: element ends graded by a size, functions and their derivatives in every element.

The finest mesh has elements of the size that the process zone needs on its whole way. What is solved on at any time has
some of its element ends: all about the zone, few elsewhere. Points of the interface stay where they are while the
elements about them do.

Source: de Boor (1978), A Practical Guide to Splines, ch. IX and X (recurrence and derivatives).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy.interpolate import BSpline
from scipy.sparse.linalg import spsolve

from verify.theory.arms.problem import ArmsProblem, Load, Support

#: Degree of the splines. With 4 shear does not lock, and a cubic deflection is exact.
ARM_DEGREE = 4

#: Growth of the element size with the distance from where it is prescribed.
ELEMENT_GROWTH = 0.35

#: Part of a size asked for that keeps every element end of a mesh which was made for that size.
ALL_KEPT = 0.8

#: Elements in a thickness at ends, tip and patches, where plane arms have edge effects; and at the far end, on which
#: two arms that are nearly separated turn about a small spot of contact, and in its length.
IN_A_THICKNESS, AT_FAR_END, IN_CONTACT = 6.0, 24.0, 40.0

#: Part of a thickness of which the length of contact is at least, however stiff it is.
LEAST_CONTACT = 0.01

#: Lengths of waves that need the elements of a process zone, and by how much finer these may get for them.
WAVES, AT_MOST_FINER = 2.5, 4.0

#: Elements in the length of a wave, by those in a zone, that are enough in a zone which is much shorter.
IN_A_WAVE = 4.0

#: Process zones beyond the estimated end of the crack with elements as fine.
ZONES_BEYOND = 4.0


class Fine(NamedTuple):
    """Elements of at most ``size`` on the range of X from ``low`` to ``high``, and growing ones away from it."""

    low: float
    high: float
    size: float


class Shapes(NamedTuple):
    """Functions, first and second derivatives (E, q, a) at points of every element, and the weights (E, q) there."""

    N: np.ndarray
    dN: np.ndarray
    ddN: np.ndarray
    weight: np.ndarray

    @property
    def both(self) -> np.ndarray:
        """Values and slopes, (E, q, 2, a)."""
        return np.stack((self.N, self.dN), axis=2)


@dataclass(frozen=True)
class Splines:
    """Functions that are smooth but at the ``kinks``, where only their slopes are continuous.

    ``ends`` (E + 1,) : of the elements
    ``knots`` : with multiplicities
    """

    ends: np.ndarray
    knots: np.ndarray

    @staticmethod
    def graded(kinks: Iterable[float], fine: Iterable[Fine]) -> Splines:
        """With element ends at all ``kinks``, of which the outermost are the ends of the arms, and sizes as asked."""
        places = np.unique(np.asarray(tuple(kinks), dtype=float))
        kept = np.diff(places, prepend=-np.inf) > 1e-9 * (places[-1] - places[0])
        corners, wanted = places[kept], list(fine)
        pieces = [_split(low, high, wanted) for low, high in zip(corners[:-1], corners[1:], strict=True)]
        return Splines._on(np.append(np.concatenate([piece[:-1] for piece in pieces]), corners[-1]), corners)

    @staticmethod
    def _on(ends: np.ndarray, corners: np.ndarray) -> Splines:
        times = np.where(np.isin(ends, corners), ARM_DEGREE - 1, 1)
        times[[0, -1]] = ARM_DEGREE + 1
        return Splines(ends, np.repeat(ends, times))

    def coarser(self, fine: Iterable[Fine]) -> Splines:
        """With some of the element ends: all that the sizes asked for need, and the kinks."""
        wanted = _sizes(0.5 * (self.ends[1:] + self.ends[:-1]), list(fine))
        number = np.floor(np.concatenate(([0.0], np.cumsum(self.sizes / (ALL_KEPT * wanted)))))
        times = np.searchsorted(self.knots, self.ends, side="right") - np.searchsorted(self.knots, self.ends)
        return Splines._on(self.ends[(times > 1) | (np.diff(number, prepend=-1.0) > 0.0)], self.ends[times > 1])

    def carried(self, c: np.ndarray, to: Splines) -> np.ndarray:
        """Coefficients (n', ...) of splines (n, ...) on another mesh with the same kinks, equal at the places of its
        functions: what both can be is kept."""
        old, new = (BSpline.design_matrix(to.places, one.knots, ARM_DEGREE) for one in (self, to))
        return np.asarray(spsolve(new.tocsc(), old @ c))

    @property
    def sizes(self) -> np.ndarray:
        return np.diff(self.ends)

    @cached_property
    def _span(self) -> np.ndarray:
        """Index (E,) of the knot at which an element begins."""
        return np.searchsorted(self.knots, self.ends[:-1], side="right") - 1

    @property
    def first(self) -> np.ndarray:
        """The first function (E,) of every element."""
        return self._span - ARM_DEGREE

    @property
    def count(self) -> int:
        """Number of functions."""
        return len(self.knots) - ARM_DEGREE - 1

    @property
    def places(self) -> np.ndarray:
        """Coefficients (n,) of the function X."""
        windows = np.lib.stride_tricks.sliding_window_view(self.knots[1:-1], ARM_DEGREE)
        return windows.mean(axis=1)

    def x(self, at: np.ndarray) -> np.ndarray:
        """X (E, q) at points on [0, 1] of every element."""
        return self.ends[:-1, None] + self.sizes[:, None] * at

    def gauss(self, n: int) -> Shapes:
        """At ``n`` Gauss points of every element."""
        at, weight = np.polynomial.legendre.leggauss(n)
        return self.shapes(0.5 * (1.0 + at), 0.5 * weight)

    def shapes(self, at: np.ndarray, weight: np.ndarray) -> Shapes:
        """At points on [0, 1] of every element."""
        x, p = self.x(at), ARM_DEGREE
        inside = np.clip(x, self.ends[:-1, None], np.nextafter(self.ends[1:, None], -np.inf))
        cubic, quartic, low = (
            BSpline.design_matrix(inside.ravel(), self.knots, d).data.reshape(*x.shape, d + 1)
            for d in (p - 1, p, p - 2)
        )
        second = self._slope(self._slope(low, p - 1), p)
        return Shapes(quartic, self._slope(cubic, p), second, weight * self.sizes[:, None])

    def _slope(self, low: np.ndarray, d: int) -> np.ndarray:
        """Derivatives of functions of degree ``d`` by those of degree d - 1, or one derivative more of both."""
        i, k = self._span, np.arange(d)
        width = (self.knots[i[:, None] + 1 + k] - self.knots[i[:, None] + 1 - d + k])[:, None]
        part = d * low / width
        return np.pad(part, ((0, 0), (0, 0), (1, 0))) - np.pad(part, ((0, 0), (0, 0), (0, 1)))

    def at(self, x: float) -> tuple[int, Shapes]:
        """The element at X, the one before it where X is the last end, and its functions there."""
        e = min(max(int(np.searchsorted(self.ends, x * (1.0 + 1e-12), side="right")) - 1, 0), len(self.sizes) - 1)
        part = np.clip((x - self.ends[e]) / self.sizes[e], 0.0, 1.0)
        found = self.shapes(np.array([part]), np.ones(1))
        return e, Shapes(*(values[e] for values in found))


def _split(low: float, high: float, fine: list[Fine]) -> np.ndarray:
    """Ends of elements from ``low`` to ``high``."""
    near = (high - low) * np.geomspace(1e-9, 1.0, 400)  # of ends, where sizes may be small
    x = np.unique(np.concatenate((np.linspace(low, high, 2001), low + near, high - near)))
    dense = 1.0 / _sizes(x, fine)
    number = np.concatenate(([0.0], np.cumsum(0.5 * (dense[1:] + dense[:-1]) * np.diff(x))))
    n = max(1, int(np.ceil(number[-1] - 1e-6)))
    ends = np.interp(np.linspace(0.0, number[-1], n + 1), number, x)
    ends[[0, -1]] = low, high
    return ends


def _sizes(x: np.ndarray, fine: list[Fine]) -> np.ndarray:
    """Sizes of elements asked for at places."""
    away = [np.maximum(np.maximum(one.low - x, x - one.high), 0.0) for one in fine]
    return np.minimum.reduce([one.size + ELEMENT_GROWTH * far for one, far in zip(fine, away, strict=True)])


@dataclass(frozen=True)
class Meshes:
    """Of a problem, with element ends at ``places``, too, and elements of ``size`` along the bond, by default
    those that the process zone needs."""

    problem: ArmsProblem
    places: Sequence[float] = ()
    size: float | None = None

    @cached_property
    def finest(self) -> Splines:
        """With fine elements on the whole way of the process zone."""
        return Splines.graded(self._kinks, self._fine(*self.crossed))

    def about(self, low: float, high: float) -> Splines:
        """With fine elements on a range of X alone."""
        return self.finest.coarser(self._fine(low, high))

    @cached_property
    def crossed(self) -> tuple[float, float]:
        """The part of the bond that the process zone crosses, with a margin."""
        problem = self.problem
        low, high = sorted(problem.bonded)
        beyond = ZONES_BEYOND * problem.zone
        reach = 1.1 * problem.reach + beyond
        if problem.loaded_at < 0.5 * problem.length:
            return low, float(np.clip(problem.loaded_at + reach, low + beyond, high))
        return float(np.clip(problem.loaded_at - reach, low, high - beyond)), high

    @cached_property
    def _kinks(self) -> tuple[float, ...]:
        placed: list[Load | Support] = [*self.problem.loads, *self.problem.supports]
        patches = [x for one in placed for x in one.extent or ()]
        return 0.0, *self.problem.lengths, *sorted(self.problem.bonded), *patches, *self.places

    def _fine(self, low: float, high: float) -> list[Fine]:
        problem, size = self.problem, self.size or _along_the_bond(self.problem)
        found = [Fine(low, high, size), Fine(0.0, problem.length, max(problem.length / 24.0, size))]
        h, free = max(arm.thickness for arm in problem.arms), len(problem.arms) == len(problem.bodies)
        if free or problem.order > 1:
            found += [Fine(x, x, h / IN_A_THICKNESS) for x in self._kinks]
        far = (min if problem.loaded_at > 0.5 * problem.length else max)(problem.bonded)
        if free and (not problem.bond.slides or far in self.crossed):
            found.append(Fine(far, far, min(h / AT_FAR_END, _in_contact(problem) / IN_CONTACT)))
        return found


def _along_the_bond(problem: ArmsProblem) -> float:
    """Size of elements along the bond, which resolves the process zone and the arms' waves on the intact bond. For a
    zone that is much shorter than the waves the points of one element are enough: the arms do not bend within it.
    Where the traction falls steeply, as behind a plateau, the zone is shorter: in thick arms E' over the slope.

    Length of the waves: (4 / (k sum of 1 / E I))^(1/4), Winkler.
    """
    arms = (*problem.arms, *problem.arms) if problem.mirrored else problem.arms
    limp = sum(12.0 / (arm.young * arm.thickness**3) for arm in arms)
    waves = (4.0 / (problem.bond.slopes[0] * limp)) ** 0.25
    zone = problem.zone / max(problem.bond.steepness, 1.0)
    size = max(min(zone, WAVES * waves), zone / AT_MOST_FINER) / problem.in_a_zone
    return max(size, min(zone, waves / (IN_A_WAVE * problem.in_a_zone)))


def _in_contact(problem: ArmsProblem) -> float:
    """Length over which shear of the arms takes up contact at their end: (penalty sum of 6 / (5 G h))^(-1/2)."""
    arms = (*problem.arms, *problem.arms) if problem.mirrored else problem.arms
    limp = sum(1.2 / (arm.shear * arm.thickness) for arm in arms)
    return max(float((problem.bond.penalty * limp) ** -0.5), LEAST_CONTACT * arms[0].thickness)
