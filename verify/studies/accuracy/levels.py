"""Successive levels of a solution: their distance, the bound of the error, the next mesh and its time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, inf, isfinite

import numpy as np

from iga.bases.names import BASES
from verify.curves.curve import Curve, peak
from verify.curves.leg_checks import leg_differences
from verify.curves.legs import path
from verify.curves.of_run import POINTS_PER_STEP, cubics, distance
from verify.methods.mesh_choice import size
from verify.methods.names import WITH_DOFS
from verify.methods.reference_mesh import reference_mesh
from verify.methods.solve import prepare
from verify.methods.zone_resolution import expected
from verify.result import Result
from verify.runs import estimate
from verify.scene.schema import Scene, bend, counted_steps
from verify.studies.accuracy.choice import with_elements
from verify.support.programme import only_opens, turns

#: Highest degree of a method.
HIGHEST = {**{name: max(basis.degrees) for name, basis in BASES.items()}, "dolfinx": 4}


@dataclass(frozen=True)
class Refinement:
    """Constants of the refinement and of the error bound.

    ratio, levels : ratio of the elements along the specimen of successive levels, and largest number of levels
    straight, more_steps, most_steps : allowed error of straight lines between the steps, over the accuracy; the next
        level has ``more_steps`` times the steps, so that they end elsewhere, and up to ``most_steps`` times where the
        allowed error is exceeded
    caution, slowest : smallest and largest ratio of the error bound of the finer level to the distance of two levels.
        On random scenes the error was up to 1.33 times the distance, where the ripple of the integration points on the
        peak dominates, and 0.3 times in the median
    gain : largest factor by which the error falls from one level to the next; up to 57 on random scenes
    condensed : exponent of the time over the unknowns where a linear bulk is condensed
    """

    ratio: float = 1.5
    levels: int = 4
    straight: float = 0.25
    more_steps: float = 1.1
    most_steps: float = 3.0
    caution: float = 1.5
    slowest: float = 5.0
    gain: float = 60.0
    condensed: float = 0.3


REFINEMENT = Refinement()


def apart(fine: Result, coarse: Result, programme: Sequence[float]) -> float:
    """Relative distance of the curve of a run, with straight lines between the steps, from the path of another.

    The largest of the L2 distance of the loads, leg by leg for a programme with reversals, and of the difference of the
    peak loads. Infinite where they cannot be compared.
    """
    if min(len(fine.load), len(coarse.load)) < 2:
        return inf
    curve, known = (fine.opening, fine.load), _curved(coarse, programme)
    d, P = (np.asarray(values) for values in known)
    size = float(np.max(np.abs(P[d >= 0.0] if max(programme) > 0.0 else P)))  # pressed faces have no peak
    found = [abs(peak(curve)[1] - peak(known)[1]) / size if size > 0.0 else inf]
    if only_opens(programme):
        found.append(distance(curve, coarse))
    else:
        legs = leg_differences(path(curve, programme), path(known, programme))
        found += [leg.error for leg in legs] if len(legs) == len(turns(programme)) else [inf]
    return max(one if isfinite(one) else inf for one in found)


def _curved(result: Result, programme: Sequence[float]) -> Curve:
    """The path of a run, with points between its steps.

    In a programme with reversals, steps at which faces come into contact are straight lines: the slopes at both ends
    are unrelated, and a cubic would overshoot the reversal.
    """
    (d, P), ends = map(np.asarray, cubics(result)), result.opening
    if only_opens(programme) or len(d) == len(ends):
        return d, P
    at = np.linspace(0.0, len(ends) - 1.0, len(d))
    low, high = (np.repeat(of(ends[:-1], ends[1:]), POINTS_PER_STEP) for of in (np.minimum, np.maximum))
    trifle = 1e-9 * float(np.max(np.abs(ends)))
    beyond = np.maximum(low - d[1:], d[1:] - high) > trifle
    straight = np.append(False, np.repeat(beyond.reshape(-1, POINTS_PER_STEP).any(axis=1), POINTS_PER_STEP))
    steps = np.arange(len(ends))
    return np.where(straight, np.interp(at, steps, ends), d), np.where(straight, np.interp(at, steps, result.load), P)


def bound(distance: float, before: float = inf) -> float:
    """Bound of the error of the finer one of two levels, from their distance and from the previous distance.

    ``caution`` times the distance is a bound where the error of the coarser level is at least 5/3 of that of the
    finer one, with ``ratio`` 1.5 for orders above 1.3. Where the distances have fallen more slowly, by the factor f,
    the following ones add up to f / (1 - f) of the last one, as a geometric series; at most ``slowest`` is used.
    """
    f = distance / before if before > 0.0 else 0.0
    return distance * min(max(REFINEMENT.caution, f / (1.0 - f) if f < 1.0 else inf), REFINEMENT.slowest)


def finer(scene: Scene, method: str, overrides: Sequence[str], more: float = REFINEMENT.more_steps) -> tuple[str, ...]:
    """Overrides of the next level.

    Parameters
    ----------
    scene, overrides : the scene of this level, which contains its overrides, and these overrides
    more : ratio of the numbers of steps

    Raises
    ------
    Refusal : no finer mesh is possible.
    """
    asked = scene.discretization
    if method in WITH_DOFS:
        degree = min(asked.degree + 1, HIGHEST[method])
        mesh = with_elements(scene, method, degree, REFINEMENT.ratio * expected(scene, method).elements)
    else:
        own = reference_mesh(scene)
        degree = min(own.degree + 1, HIGHEST[method])
        layers = own.layers + (degree == own.degree)
        along = size(scene, splines=False).times(REFINEMENT.ratio).override
        mesh = (f"dolfinx.degree={degree}", along, f"dolfinx.layers={layers}")
    counted, closer = ceil(more * counted_steps(scene)), max(bend(scene) / more**2, 1e-5)
    chooses = prepare(scene, method).by_accuracy
    pace = f"discretization.bend={closer!r}" if chooses else f"discretization.steps={counted}"
    found = {one.partition("=")[0]: one for one in (*overrides, pace, *mesh)}
    return tuple(found.values())


def more_steps(result: Result, programme: Sequence[float], accuracy: float) -> float:
    """Factor on the number of steps for which straight lines between them are accurate enough."""
    straight = apart(result, result, programme)
    wanted = (straight / (REFINEMENT.straight * accuracy)) ** 0.5 if isfinite(straight) else REFINEMENT.most_steps
    return min(max(wanted, REFINEMENT.more_steps), REFINEMENT.most_steps)


def growth(scene: Scene, following: Scene, method: str) -> float:
    """Ratio of the times of runs on a finer mesh and on this one: proportional to steps and unknowns.

    With a linear bulk, which is condensed onto the interface, the time grows more slowly: 1.1 to 1.6 times for twice
    the unknowns on random scenes.
    """
    unknowns, steps = (of(following, method) / of(scene, method) for of in (estimate.unknowns, estimate.steps))
    condensed = method in WITH_DOFS and prepare(scene, method).effects["kinematics"] == "linear"
    return steps * unknowns ** (REFINEMENT.condensed if condensed else 1.0)
