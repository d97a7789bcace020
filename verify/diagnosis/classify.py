"""Every cause fitted to the deviation of a curve, best first."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from operator import itemgetter
from pathlib import Path

import numpy as np

from verify.curves.curve import Curve as AnyCurve
from verify.diagnosis.causes import SCALED_NUMBERS, Choice, Number, choices, percent
from verify.diagnosis.on_curve import Reference, known_factors, undone
from verify.diagnosis.solutions import Curve, Solutions, searching, solutions
from verify.scene.magnitudes import LARGEST_NUMBER, SMALLEST_NUMBER
from verify.scene.schema import Scene
from verify.support.progress import Progress
from verify.verdict import Diagnosis, Explanation


@dataclass(frozen=True)
class Settings:
    """How causes are fitted and ranked.

    least : part of the tolerance up to which a deviation has no cause
    steps : how often a cause is solved again
    close : deviation up to which most openings do not lie between the peaks of both curves
    beside : part of the probe by which a fit goes on from another place
    tried : part of the deviation by which a cause may be expected to leave more than the best one, and be solved
    kept : how many times as much as the best one a cause may leave, and be solved again
    enough : part of the tolerance by which another solution must better a fit
    identified : change of the curve by the probe, over the tolerance, below which a number is not identified
    left : part of the deviation, or of the tolerance, up to which what is left counts as explained
    same : the same, within which this curve cannot tell two causes from each other
    free : part of the tolerance that a cause with a fitted amount must be better than one without
    certain : part of deviation and tolerance up to which a cause in the curve leaves no room for one in the scene
    near : part of what counts as explained that the solver may be off the reference
    far : deviation beyond which no other number of the scene is looked for: that is another problem
    steep : slope of a logarithm by that of a number beyond which it is that of a fall: powers are smaller
    floor : part of the largest load below which loads are not told apart
    units : how many units are looked behind
    behind : times the tolerance that the best single cause may leave, so that no unit is looked behind
    listed : explanations that are kept
    confirmed : how many causes are solved that a search on a beam has found
    promising : times what counts as explained that such a cause may leave there
    once, again : part of what counts as explained that it may leave to need no other solution, and how many it gets
    """

    least: float = 0.2
    steps: int = 4
    close: float = 0.1
    beside: float = 0.4
    tried: float = 0.3
    kept: float = 4.0
    enough: float = 0.02
    identified: float = 0.02
    left: tuple[float, float] = (0.1, 0.6)
    same: tuple[float, float] = (0.02, 0.12)
    free: float = 0.1
    certain: float = 0.05
    near: float = 0.5
    far: float = 5.0
    steep: float = 2.0
    floor: float = 1e-3
    units: int = 2
    behind: float = 2.0
    listed: int = 6
    confirmed: int = 2
    promising: float = 3.0
    once: float = 0.3
    again: int = 2


SETTINGS = Settings()
#: Part of the peak load at whose opening curves are laid on each other: there a curve rises.
MOST_OF_PEAK = 0.9


def diagnose(
    name: str, curve: AnyCurve, expected: AnyCurve, scene: Scene | None, tolerance: float, out: Path | None = None
) -> Diagnosis | None:
    """Which single cause explains the deviation of a curve best, or which one behind a unit; None where there is
    hardly any.

    Parameters
    ----------
    curve, expected : opening (n,) and load (n,), of the code that is judged and of one that is right
    scene : of both; without it only causes in the curve are tried
    tolerance : relative L2 distance that the curve is allowed
    out : folder whose store keeps the solutions
    """
    reference = Reference((np.asarray(expected[0], dtype=float), np.asarray(expected[1], dtype=float)))
    given = np.asarray(curve[0], dtype=float), np.asarray(curve[1], dtype=float)
    if not (_usable(given) and _usable(reference.curve)):
        return None
    without = reference.error(given)
    if not SETTINGS.least * tolerance < without < np.inf:
        return None
    width = scene.specimen.width if scene is not None else 1.0
    found = list(undone(given, reference, width))
    tried = any(one.error_with <= SETTINGS.certain * min(without, tolerance) for one in found)
    if scene is not None and not tried:
        search = Search(scene, reference, given, tolerance, out)
        with Progress(f"diagnosis of {name}", 1.0) as progress:
            single = search.causes()
            progress.advance(0.5)
            found, tried = [*found, *single], bool(single)
            best = _ranked(name, found, without, tolerance, tried)
            left, unit = (best.causes[0].error_with, best.causes[0].unit) if best.causes else (np.inf, "")
            if not best.explained or left > tolerance * (0.5 if unit == "factor" else SETTINGS.behind):
                behind = list(search.behind_units(width))
                found, tried = [*found, *behind], tried or bool(behind)
    return _ranked(name, found, without, tolerance, tried)


def _usable(curve: Curve) -> bool:
    """Whether squares of its numbers stay in the range, and it opens and bears something."""
    opens = float(np.max(curve[0])) >= SMALLEST_NUMBER and float(np.max(np.abs(curve[1]))) >= SMALLEST_NUMBER
    return opens and float(np.max(np.abs(curve))) <= LARGEST_NUMBER


def _limit(without: float, tolerance: float, parts: tuple[float, float]) -> float:
    """A part of the deviation, or of the tolerance; beyond 1 it is the size of a wrong unit."""
    return max(parts[0] * min(without, 1.0), parts[1] * tolerance)


@dataclass(frozen=True, eq=False)
class Search:
    """A curve beside the reference that it should be, and the scene of both, in which causes are sought; ``out`` keeps
    the solutions."""

    scene: Scene
    reference: Reference
    given: Curve
    tolerance: float
    out: Path | None

    @cached_property
    def error(self) -> float:
        return self.reference.error(self.given)

    @cached_property
    def loads(self) -> tuple[np.ndarray, np.ndarray]:
        """Load (n,) of the curve minus that of the reference, and the latter."""
        return self.reference.deviation(self.given)[1:]

    @property
    def limit(self) -> float:
        """What is left, at most, of a deviation that counts as explained."""
        return _limit(self.error, self.tolerance, SETTINGS.left)

    @property
    def end(self) -> float | None:
        """The opening up to which causes are looked for; None where the curve is too short or too far off."""
        end = min(self.reference.end, float(np.max(self.given[0])))
        return None if self.error > SETTINGS.far or 2.0 * end <= self.reference.end else end

    def solver(self) -> Solutions | None:
        """A solver near enough to the reference for this deviation; None where it is none of the scene's."""
        if (end := self.end) is None:
            return None
        return solutions(self.scene, end, self.reference.curve, SETTINGS.near * self.limit, self.out)

    def searcher(self) -> Solutions | None:
        """What causes are searched on: the beam where arms slide, which takes no solution of the scene, or else the
        solver.

        A beam of arms that open takes 0.5 s and a coarse solution of them 0.1 s; where arms slide the beam is the
        quicker.
        """
        if (end := self.end) is None:
            return None
        beam = searching(self.scene, end, self.reference.curve, self.out) if self.scene.specimen.slides else None
        return beam or self.solver()

    def causes(self) -> list[Explanation]:
        """Causes that are another scene, by its change of the solution; the best that a beam finds are solved again."""
        solved, limit = self.searcher(), self.limit
        if solved is None:
            return []
        fits = self._searched(solved)
        promising = [one for one in fits if one.left <= SETTINGS.promising * limit]
        confirming = self.solver() if promising else None
        if confirming is None or confirming.method == solved.method:
            return [one.explanation() for one in fits]
        found, more = list[Explanation](), 0.0
        for one in promising[: SETTINGS.confirmed]:
            if one.left > limit and any(other.error_with <= limit for other in found):
                break  # what the beam cannot tell apart is all solved
            said = self._again(one, confirming).explanation()
            found.append(said)
            more = max(more, said.error_with - one.left)
        # what the beam says too little of those, it says too little of all
        return found + [one.explanation(more) for one in fits if one not in promising[: len(found)]]

    def behind_units(self, width: float) -> Iterator[Explanation]:
        """A cause in the scene behind the units that leave most room for one.

        Two things at once are named only where the curve agrees without them, as far as the solver agrees with the
        reference: units that are tried freely, and an amount that is fitted, come near most curves (toughness x 5 is
        within 7 % of loads in lbf and a thickness 45 % smaller).
        """
        screened = []
        for name, words, _, curve in known_factors(self.given, self.reference, width):
            other = replace(self, given=curve)
            if (solved := other.searcher()) is not None:
                least = min((line.expected for line in other._lines(solved, aligned=True)), default=np.inf)
                off, right = float(np.linalg.norm(solved.base - other.loads[1])), float(np.linalg.norm(other.loads[1]))
                screened.append((other.error * least, name, words, other, self.tolerance + off / right))
        for _, name, words, other, allowed in sorted(screened, key=itemgetter(0))[: SETTINGS.units]:
            for one in other.causes():
                if one.error_with <= allowed:
                    named, said = f"{name}, {one.name}", f"{words}, and {one.words}"
                    yield replace(one, name=named, words=said, error_without=self.error)

    def _fit(self, number: Number, solved: Solutions, amount: float, expected: float = 0.0, far: bool = False) -> Fit:
        """A number that nothing is known of but the amount that is solved first."""
        off, base = self.loads[0], solved.base
        return Fit(number, base + off, base, amount, expected, 0.0, base, (0.0, float(np.linalg.norm(off))), far)

    def _lines(self, solved: Solutions, aligned: bool = False) -> list[Fit]:
        """Every number that the curve shows, by a small change of it, and that is expected to leave not much more than
        the best one."""
        (off, right), base = self.loads, solved.base
        goal, weights = _seen(right + off, right, aligned) - _seen(right, right, aligned), _weights(right, aligned)
        found, whole = [], max(float(np.sum(np.abs(weights * goal))), 1e-300)
        for number, probe, load in probed(solved):
            if np.linalg.norm(load - base) > SETTINGS.identified * self.tolerance * np.linalg.norm(base):
                slope = (_seen(load, base, aligned) - _seen(base, base, aligned)) / probe
                amount = number.within(_least_sum(goal, slope, weights))
                left = float(np.sum(np.abs(weights * (goal - amount * slope)))) / whole
                found.append(self._fit(number, solved, amount, left, aligned))
        least = min((one.expected for one in found), default=0.0)
        return [one for one in found if one.expected <= least + SETTINGS.tried]

    def _searched(self, solved: Solutions) -> list[Fit]:
        """Choices made the other way, and the numbers that are worth it fitted, those that leave least first."""
        off, right = self.loads
        size, made, found = float(np.linalg.norm(right)), list(choices(solved.scene)), list[Fit]()
        allowed, enough = self.tolerance * size, min(SETTINGS.once * self.limit, self.tolerance) * size
        for choice, load in zip(made, solved.loads([one.changed for one in made]), strict=True):
            if load is not None:
                left = float(np.linalg.norm(off - load + solved.base))
                found.append(replace(self._fit(choice, solved, 1.0), best=(1.0, left), settled=True))
        close = self.error <= SETTINGS.close
        if close:
            found += _fits(self._lines(solved), solved, allowed)
        if not close or not any(one.best[1] <= enough for one in found):
            fits = _fits(self._lines(solved, aligned=True), solved, allowed)
            nearest = sorted(fits, key=lambda one: one.best[1])[: SETTINGS.confirmed]
            more = [one.closer() for one in nearest if one.best[1] > enough]
            found += [*fits, *_fits(more, solved, allowed)]
        best: dict[str, Fit] = {}
        for one in sorted(found, key=lambda one: one.best[1]):
            best.setdefault(one.number.name, one)
        return list(best.values())

    def _again(self, one: Fit, solved: Solutions) -> Fit:
        """A cause fitted on a beam, solved by another solver; once if it then leaves little enough."""
        size, without = float(np.linalg.norm(solved.base)), float(np.linalg.norm(self.loads[0]))
        fit = self._fit(one.number, solved, one.best[0], far=without > SETTINGS.close * size)
        stop = SETTINGS.once * self.limit * size
        (fit,) = _fits([fit], solved, self.tolerance * size, SETTINGS.again, stop)
        return fit if fit.best[1] < without else one


@dataclass(frozen=True, eq=False)
class Fit:
    """A number fitted by secants in the logarithm of the load, in which its change is about a line, half as far where
    nothing is solved.

    given, base : (n,) loads of the curve, and of the scene as it is
    amount, expected : solved next, and the part of what is seen that it would leave
    at, load : solved last, and the load (n,) with it
    best : the amount that leaves least, and the norm of that
    aligned : fitted by what is seen of curves whose peaks are laid on each other: of numbers so far off that most
        openings lie between the peaks
    """

    number: Number
    given: np.ndarray
    base: np.ndarray
    amount: float
    expected: float
    at: float
    load: np.ndarray
    best: tuple[float, float]
    aligned: bool = False
    settled: bool = False

    @property
    def left(self) -> float:
        """What the best amount leaves, relative."""
        return self.best[1] / float(np.linalg.norm(self.base))

    def closer(self) -> Fit:
        """Go on by loads at equal openings, from a small step next to where it is."""
        beside = self.number.within(self.at + SETTINGS.beside * self.number.probe)
        return replace(self, amount=beside, aligned=False, settled=False)

    def taken(self, load: np.ndarray | None, enough: float) -> Fit:
        """With the load at the amount, and the next one by the secant through it and the last one; less than ``enough``
        is not worth another solution."""
        if load is None:
            return replace(self, amount=0.5 * (self.at + self.amount))
        left = float(np.linalg.norm(self.given - load))
        best = min(self.best, (self.amount, left), key=itemgetter(1))
        if abs(left - self.best[1]) < enough or self.amount == self.at:
            return replace(self, settled=True, best=best)
        given, now, last = (_seen(one, self.base, self.aligned) for one in (self.given, load, self.load))
        slope, steep = (now - last) / (self.amount - self.at), np.inf if self.number.soft else SETTINGS.steep
        step = _least_sum(given - now, slope, _weights(self.base, self.aligned), steep)
        return replace(self, at=self.amount, load=load, amount=self.number.within(self.amount + step), best=best)

    def explanation(self, more: float = 0.0) -> Explanation:
        """In words, with ``more`` left than it says."""
        part, fitted = self.number.factor(self.best[0]) - 1.0, not isinstance(self.number, Choice)
        without = float(np.linalg.norm(self.given - self.base)) / float(np.linalg.norm(self.base))
        unit, words = "part" if fitted else "switch", self.number.words(part)
        return Explanation(self.number.name, words, part, unit, self.left + more, without, fitted)


def probed(solved: Solutions) -> Iterator[tuple[Number, float, np.ndarray]]:
    """Every number of the scene with the amount of a small change, and the load (n,) with it."""
    numbers = [one for one in SCALED_NUMBERS if one.overrides(solved.scene, 1.0)]
    for part in (1.0, -0.5):  # a bond half as stiff may break where it begins to
        asked = [one.overrides(solved.scene, one.factor(part * one.probe)) for one in numbers]
        loads = solved.loads(asked)
        yield from ((one, part * one.probe, load) for one, load in zip(numbers, loads, strict=True) if load is not None)
        numbers = [one for one, load in zip(numbers, loads, strict=True) if load is None]


def _log(load: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Its logarithm: elastic loads and those of growth are powers of nearly all numbers."""
    return np.log(np.maximum(load, SETTINGS.floor * float(np.max(np.abs(right)))))


def _seen(load: np.ndarray, right: np.ndarray, aligned: bool) -> np.ndarray:
    """What a number is fitted by, in which its change is about a line: logarithms of loads at equal openings, or of the
    opening at most of the peak load and of loads at parts and multiples of that up to the end."""
    if not aligned:
        return _log(load, right)
    peak, n = max(int(np.argmax(load)), 1), load.size - 1.0
    opening = max(float(np.interp(MOST_OF_PEAK * load[peak], load[: peak + 1], np.arange(peak + 1.0))), 1.0)
    at = np.concatenate((opening * np.array([0.3, 0.6]), np.geomspace(min(1.2 * max(peak, opening), n), n, 6)))
    return np.append(_log(np.append(np.interp(at, np.arange(n + 1.0), load), load[peak]), right), np.log(opening))


def _weights(right: np.ndarray, aligned: bool) -> np.ndarray:
    return np.ones(10) if aligned else right / max(float(np.sum(np.abs(right))), 1e-300)


def _least_sum(goal: np.ndarray, slope: np.ndarray, weights: np.ndarray, steep: float = np.inf) -> float:
    """The amount that leaves the least sum of absolute values, which the openings between two peaks hardly move;
    a slope beyond ``steep`` is that of a fall, and counts as much."""
    rows = np.abs(weights * slope) > 0.0
    if not rows.any():
        return 0.0
    ratio, size = goal[rows] / slope[rows], (weights * np.minimum(np.abs(slope), steep))[rows]
    order = np.argsort(ratio)
    total = np.cumsum(size[order])
    return float(ratio[order][int(np.searchsorted(total, 0.5 * total[-1]))])


def _fits(
    fits: Sequence[Fit], solved: Solutions, allowed: float, steps: int = SETTINGS.steps, stop: float = 0.0
) -> list[Fit]:
    """What is left without each number, fitted together; ``allowed``: norm of the deviation that is, ``stop``: of that
    which needs no other solution."""
    active, ended = list(fits), list[Fit]()
    for _ in range(steps):
        asked = [one.number.overrides(solved.scene, one.number.factor(one.amount)) for one in active]
        pairs = zip(active, solved.loads(asked), strict=True)
        active = [one.taken(load, SETTINGS.enough * allowed) for one, load in pairs]
        near = SETTINGS.kept * max(min((one.best[1] for one in active), default=0.0), allowed)
        again = [one for one in active if not one.settled and stop < one.best[1] <= near]
        ended += [one for one in active if one not in again]
        active = again
    return [*ended, *active]


def _ranked(name: str, found: Sequence[Explanation], without: float, tolerance: float, tried: bool) -> Diagnosis:
    """Best first, the best of each name; a cause without a fitted amount comes first among equals. ``tried``: whether
    causes in the scene were."""

    def rank(one: Explanation) -> float:
        return one.error_with + SETTINGS.free * tolerance * one.fitted

    best: dict[str, Explanation] = {}
    for one in sorted(found, key=rank):
        if one.error_with < one.error_without:
            best.setdefault(one.name, one)
    order = list(best.values())[: SETTINGS.listed]
    explained = bool(order) and order[0].error_with <= _limit(without, tolerance, SETTINGS.left)
    near = order[0].error_with + _limit(without, tolerance, SETTINGS.same) if order else 0.0
    same = [one for one in order[1:] if explained and one.error_with <= near]
    said = _sentence(name, order, without, explained, same)
    said += "" if tried or explained else "; causes in the scene were not tried"
    return Diagnosis(name, tuple(order), explained, tuple(one.name for one in same), said)


def _sentence(
    name: str, order: Sequence[Explanation], without: float, explained: bool, same: Sequence[Explanation]
) -> str:
    """That the curve does not agree, why, and what is left with that."""
    fails = f"{name}: does not agree"
    if not explained:
        best = [f"; the nearest is that {one.words}, which leaves {of_reference(one.error_with)}" for one in order[:1]]
        return "".join([f"{fails}, and no single cause explains the {of_reference(without)}", *best])
    words = " or ".join(one.words for one in (order[0], *same))
    left = f"with that {of_reference(order[0].error_with)} in place of {of_reference(without)}"
    return f"{fails}, because {words}; {left}" + ("; this curve cannot tell them apart" if same else "")


def of_reference(part: float) -> str:
    """A deviation of the loads, as a part of the reference."""
    if part < 5e-5:
        return "less than 0.01 %"
    if part < 10.0:
        return percent(part)
    return f"{part:.0f} times the reference" if part < 1e5 else f"{part:.0e} times the reference"
