"""Elements along the arms: fine about the process zone, where loads act and where faces touch, and coarse elsewhere.

The finest mesh has elements of the size that the process zone needs on its whole way. What is solved on at any time has
some of its element ends: all about the zone, few elsewhere. Points of the interface stay where they are while the
elements about them do.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from verify.theory.arms.problem import ArmsProblem, Load, Support
from verify.theory.arms.splines import Fine, Splines

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

    Length of the waves: (4 / (k sum of 1 / E I))^(1/4), Winkler.
    """
    arms = (*problem.arms, *problem.arms) if problem.mirrored else problem.arms
    limp = sum(12.0 / (arm.young * arm.thickness**3) for arm in arms)
    waves = (4.0 / (problem.bond.slopes[0] * limp)) ** 0.25
    size = max(min(problem.zone, WAVES * waves), problem.zone / AT_MOST_FINER) / problem.in_a_zone
    return max(size, min(problem.zone, waves / (IN_A_WAVE * problem.in_a_zone)))


def _in_contact(problem: ArmsProblem) -> float:
    """Length over which shear of the arms takes up contact at their end: (penalty sum of 6 / (5 G h))^(-1/2)."""
    arms = (*problem.arms, *problem.arms) if problem.mirrored else problem.arms
    limp = sum(1.2 / (arm.shear * arm.thickness) for arm in arms)
    return max(float((problem.bond.law.penalty * limp) ** -0.5), LEAST_CONTACT * arms[0].thickness)
