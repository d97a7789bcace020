"""Every cause fitted to the deviation of a curve, best first."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from verify.curves.curve import Curve as AnyCurve
from verify.diagnosis.causes import OTHER_CHOICES, SCALED_NUMBERS, Number, percent
from verify.diagnosis.on_curve import Reference, undone
from verify.diagnosis.solutions import Curve, Solutions, solutions
from verify.scene.magnitudes import LARGEST_NUMBER, SMALLEST_NUMBER
from verify.scene.schema import Scene
from verify.support.progress import Progress
from verify.verdict import Diagnosis, Explanation


@dataclass(frozen=True)
class Settings:
    """How causes are fitted and ranked.

    refined, steps : how many causes are solved again, the best of the linear ones, and how often
    enough : part of the tolerance by which another solution must better a fit
    identified : change of the curve by the probe, over the tolerance, below which a number is not identified
    left : part of the deviation, or of the tolerance, up to which what is left counts as explained
    same : the same, within which this curve cannot tell two causes from each other
    free : part of the tolerance that a cause with a fitted amount must be better than one without
    certain : part of deviation and tolerance up to which a cause in the curve leaves no room for one in the scene
    far : deviation beyond which no other number of the scene is looked for: that is another problem
    listed : explanations that are kept
    """

    refined: int = 9
    enough: float = 0.02
    steps: int = 3
    identified: float = 0.02
    left: tuple[float, float] = (0.1, 0.6)
    same: tuple[float, float] = (0.02, 0.12)
    free: float = 0.1
    certain: float = 0.05
    far: float = 5.0
    listed: int = 6


SETTINGS = Settings()


def diagnose(name: str, curve: AnyCurve, expected: AnyCurve, scene: Scene | None, tolerance: float) -> Diagnosis | None:
    """Which single cause explains the deviation of a curve best; None where there is hardly any.

    Parameters
    ----------
    curve, expected : opening (n,) and load (n,), of the code that is judged and of one that is right
    scene : of both; without it only causes in the curve are tried
    tolerance : relative L2 distance that the curve is allowed
    """
    reference = Reference((np.asarray(expected[0], dtype=float), np.asarray(expected[1], dtype=float)))
    given = np.asarray(curve[0], dtype=float), np.asarray(curve[1], dtype=float)
    if not (_usable(given) and _usable(reference.curve)):
        return None
    without = reference.error(given)
    if not 0.5 * tolerance < without < np.inf:
        return None
    found = list(undone(given, reference, scene.specimen.width if scene is not None else 1.0))
    end = min(reference.end, float(np.max(given[0])))
    certain = any(one.error_with <= SETTINGS.certain * min(without, tolerance) for one in found)
    if scene is not None and without <= SETTINGS.far and not certain and 2.0 * end > reference.end:
        found += _in_the_scene(solutions(scene, end), reference, given, without, tolerance)
    return _ranked(name, found, without, tolerance)


def _usable(curve: Curve) -> bool:
    """Whether squares of its numbers stay in the range, and it opens and bears something."""
    opens = float(np.max(curve[0])) >= SMALLEST_NUMBER and float(np.max(np.abs(curve[1]))) >= SMALLEST_NUMBER
    return opens and float(np.max(np.abs(curve))) <= LARGEST_NUMBER


def _in_the_scene(
    solved: Solutions, reference: Reference, given: Curve, without: float, tolerance: float
) -> list[Explanation]:
    """Causes that are another scene, by its change of the solution."""
    if not solved.possible or solved.load() is None:
        return []
    _, off, load = reference.deviation(given)
    size = float(np.sqrt(np.sum(load**2)))
    found = []
    numbers = [one for one in SCALED_NUMBERS if one.overrides(solved.scene, 1.0)]
    with Progress("diagnosis", len(numbers) + len(OTHER_CHOICES) + SETTINGS.steps * SETTINGS.refined) as progress:
        lines = []
        for done, number in enumerate(numbers):
            slope = sensitivity(solved, number)
            if slope is not None and np.linalg.norm(slope) * number.probe > SETTINGS.identified * tolerance * size:
                amount = number.within(float(off @ slope / (slope @ slope)))
                lines.append((float(np.linalg.norm(off - amount * slope)), number, amount))
            progress.advance(done + 1, number.name)
        for _, number, amount in sorted(lines, key=lambda one: one[0])[: SETTINGS.refined]:
            amount, left = _refined(solved, number, amount, off, tolerance * size)
            part = number.factor(amount) - 1.0
            found.append(Explanation(number.name, number.words(part), part, "part", left / size, without))
        for switch in OTHER_CHOICES:
            made = switch.made(solved.scene)
            change = solved.change([made[0]]) if made else None
            if made and change is not None:
                left = float(np.linalg.norm(off - change)) / size
                found.append(Explanation(switch.name, made[1], 1.0, "switch", left, without, fitted=False))
    return found


def sensitivity(solved: Solutions, number: Number) -> np.ndarray | None:
    """Change of the load (n,) over the amount of a number: its logarithm, or its inverse over that of the scene."""
    for probe in (number.probe, -0.5 * number.probe):  # a bond half as stiff may break where it begins to
        change = solved.change(number.overrides(solved.scene, number.factor(probe)))
        if change is not None:
            return change / probe
    return None


def _refined(solved: Solutions, number: Number, amount: float, off: np.ndarray, enough: float) -> tuple[float, float]:
    """Amount by Gauss-Newton with secants, half as far where nothing is solved, and the norm of what the best leaves.

    ``enough``: norm of the tolerance, of which a part is not worth another solution.
    """
    best, before, was = (0.0, float(np.linalg.norm(off))), 0.0, np.zeros_like(off)
    for _ in range(SETTINGS.steps + 1):
        change = solved.change(number.overrides(solved.scene, number.factor(amount)))
        if change is None:
            amount = 0.5 * (before + amount)
            continue
        left = off - change
        settled = abs(float(np.linalg.norm(left)) - best[1]) < SETTINGS.enough * enough
        best = min(best, (amount, float(np.linalg.norm(left))), key=lambda one: one[1])
        if settled or amount == before:
            break
        slope = (change - was) / (amount - before)
        before, was = amount, change
        if not slope.any():
            break
        amount = number.within(float(amount + left @ slope / (slope @ slope)))
    return best


def _ranked(name: str, found: Sequence[Explanation], without: float, tolerance: float) -> Diagnosis:
    """Best first, the best of each name; a cause without a fitted amount comes first among equals."""

    def rank(one: Explanation) -> float:
        return one.error_with + SETTINGS.free * tolerance * one.fitted

    best: dict[str, Explanation] = {}
    for one in sorted(found, key=rank):
        if one.error_with < one.error_without:
            best.setdefault(one.name, one)
    order = list(best.values())[: SETTINGS.listed]
    size = min(without, 1.0)  # beyond 1 it is the size of a wrong unit
    limit = max(SETTINGS.left[0] * size, SETTINGS.left[1] * tolerance)
    explained = bool(order) and order[0].error_with <= limit
    near = order[0].error_with + max(SETTINGS.same[0] * size, SETTINGS.same[1] * tolerance) if order else 0.0
    same = [one for one in order[1:] if explained and one.error_with <= near]
    said = _sentence(name, order, explained, same)
    return Diagnosis(name, tuple(order), explained, tuple(one.name for one in same), said)


def _sentence(name: str, order: Sequence[Explanation], explained: bool, same: Sequence[Explanation]) -> str:
    """What explains the deviation best, by how much, and what is left."""
    if not order:
        return f"{name}: no cause was found"
    first, before, left = order[0], of_reference(order[0].error_without), of_reference(order[0].error_with)
    if not explained:
        nearest = f"{first.words}, which leaves {left}"
        return f"{name}: no single cause explains the deviation of {before}; the nearest is {nearest}"
    words = " or ".join(one.words for one in (first, *same))
    text = f"{name}: best explained by {words}: the curve error is {before}, and {left} without it"
    return text + ("; this curve cannot tell them apart" if same else "")


def of_reference(part: float) -> str:
    """A deviation of the loads, as a part of the reference."""
    if part < 5e-5:
        return "less than 0.01 %"
    if part < 10.0:
        return percent(part)
    return f"{part:.0f} times the reference" if part < 1e5 else f"{part:.0e} times the reference"
