"""Every cause fitted to the deviation of a curve, best first."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
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
    if not 0.5 * tolerance < without < np.inf:
        return None
    width = scene.specimen.width if scene is not None else 1.0
    found = list(undone(given, reference, width))
    certain = any(one.error_with <= SETTINGS.certain * min(without, tolerance) for one in found)
    tried = certain
    if scene is not None and not certain:
        with Progress(f"diagnosis of {name}", 1.0) as progress:
            single = _in_the_scene(scene, reference, given, tolerance, out)
            progress.advance(0.5)
            tried = bool(single)
            best = _ranked(name, [*found, *single], without, tolerance, tried)
            found += single
            left, unit = (best.causes[0].error_with, best.causes[0].unit) if best.causes else (np.inf, "")
            if not best.explained or left > tolerance * (0.5 if unit == "factor" else SETTINGS.behind):
                behind = list(_behind_units(scene, reference, given, width, tolerance, out))
                found += behind
                tried = tried or bool(behind)
    return _ranked(name, found, without, tolerance, tried)


def _behind_units(
    scene: Scene, reference: Reference, given: Curve, width: float, tolerance: float, out: Path | None
) -> Iterator[Explanation]:
    """A cause in the scene behind the units that leave most room for one.

    Two things at once are named only where the curve agrees without them, as far as the solver agrees with the
    reference: units that are tried freely, and an amount that is fitted, come near most curves (toughness x 5 is
    within 7 % of loads in lbf and a thickness 45 % smaller).
    """
    without, screened = reference.error(given), []
    for name, words, _, curve in known_factors(given, reference, width):
        solved = _searcher(scene, reference, curve, tolerance, out)
        if solved is not None:
            lines = _lines(solved, reference, curve, tolerance, aligned=True)
            expected = reference.error(curve) * min((line.expected for line in lines), default=np.inf)
            allowed = tolerance + _off(solved, reference, curve)
            screened.append((expected, name, words, curve, allowed))
    for _, name, words, curve, allowed in sorted(screened, key=lambda one: one[0])[: SETTINGS.units]:
        for one in _in_the_scene(scene, reference, curve, tolerance, out):
            if one.error_with <= allowed:
                yield replace(one, name=f"{name}, {one.name}", words=f"{words}, and {one.words}", error_without=without)


def _off(solved: Solutions, reference: Reference, given: Curve) -> float:
    """Relative L2 distance of the solver from the reference, as far as the curve goes."""
    base, (_, _, right) = solved.load(), reference.deviation(given)
    assert base is not None
    return float(np.linalg.norm(base - right) / np.linalg.norm(right))


def _usable(curve: Curve) -> bool:
    """Whether squares of its numbers stay in the range, and it opens and bears something."""
    opens = float(np.max(curve[0])) >= SMALLEST_NUMBER and float(np.max(np.abs(curve[1]))) >= SMALLEST_NUMBER
    return opens and float(np.max(np.abs(curve))) <= LARGEST_NUMBER


def _limit(without: float, tolerance: float, parts: tuple[float, float]) -> float:
    """A part of the deviation, or of the tolerance; beyond 1 it is the size of a wrong unit."""
    return max(parts[0] * min(without, 1.0), parts[1] * tolerance)


def _solver(scene: Scene, reference: Reference, given: Curve, tolerance: float, out: Path | None) -> Solutions | None:
    """A solver near enough to the reference for this deviation; None where it is none of the scene's."""
    if (end := _end(reference, given)) is None:
        return None
    enough = SETTINGS.near * _limit(reference.error(given), tolerance, SETTINGS.left)
    return solutions(scene, end, reference.curve, enough, out)


def _end(reference: Reference, given: Curve) -> float | None:
    """The opening up to which a cause in the scene is looked for; None where the curve is too short or too far off."""
    end = min(reference.end, float(np.max(given[0])))
    return None if reference.error(given) > SETTINGS.far or 2.0 * end <= reference.end else end


def _searcher(scene: Scene, reference: Reference, given: Curve, tolerance: float, out: Path | None) -> Solutions | None:
    """What causes are searched on: the beam where arms slide, which takes no solution of the scene, or else the solver.

    A beam of arms that open takes 0.5 s and a coarse solution of them 0.1 s; where arms slide the beam is the quicker.
    """
    if (end := _end(reference, given)) is None:
        return None
    beam = searching(scene, end, reference.curve, out) if scene.specimen.slides else None
    return beam or _solver(scene, reference, given, tolerance, out)


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

    def followed(self, at: float, load: np.ndarray) -> Fit:
        """Go on from another solution by the secant through it and the last one."""
        given, now, last = (_seen(one, self.base, self.aligned) for one in (self.given, load, self.load))
        slope, steep = (now - last) / (at - self.at), np.inf if self.number.soft else SETTINGS.steep
        step = _least_sum(given - now, slope, _weights(self.base, self.aligned), steep)
        best = min(self.best, (at, float(np.linalg.norm(self.given - load))), key=lambda one: one[1])
        return replace(self, at=at, load=load, amount=self.number.within(at + step), best=best)

    def closer(self) -> Fit:
        """Go on by loads at equal openings, from a small step next to where it is."""
        beside = self.number.within(self.at + SETTINGS.beside * self.number.probe)
        return replace(self, amount=beside, aligned=False, settled=False)

    def taken(self, load: np.ndarray | None, enough: float) -> Fit:
        """With the load at the amount; less than ``enough`` is not worth another solution."""
        if load is None:
            return replace(self, amount=0.5 * (self.at + self.amount))
        left = float(np.linalg.norm(self.given - load))
        if abs(left - self.best[1]) >= enough and self.amount != self.at:
            return self.followed(self.amount, load)
        best = min(self.best, (self.amount, left), key=lambda one: one[1])
        return replace(self, settled=True, best=best)

    def explanation(self, more: float = 0.0) -> Explanation:
        """In words, with ``more`` left than it says."""
        amount, left = self.best
        part, size = self.number.factor(amount) - 1.0, float(np.linalg.norm(self.base))
        without, fitted = float(np.linalg.norm(self.given - self.base)) / size, not isinstance(self.number, Choice)
        unit, words = "part" if fitted else "switch", self.number.words(part)
        return Explanation(self.number.name, words, part, unit, left / size + more, without, fitted)


def _lines(solved: Solutions, reference: Reference, given: Curve, tolerance: float, aligned: bool = False) -> list[Fit]:
    """Every number that the curve shows, by a small change of it."""
    base = solved.load()
    assert base is not None
    _, off, right = reference.deviation(given)
    goal, weights = _seen(right + off, right, aligned) - _seen(right, right, aligned), _weights(right, aligned)
    found, whole = [], max(float(np.sum(np.abs(weights * goal))), 1e-300)
    for number, probe, load in probed(solved):
        change = load - base
        if np.linalg.norm(change) > SETTINGS.identified * tolerance * np.linalg.norm(base):
            slope = (_seen(load, base, aligned) - _seen(base, base, aligned)) / probe
            amount = number.within(_least_sum(goal, slope, weights))
            left = float(np.sum(np.abs(weights * (goal - amount * slope)))) / whole
            best = 0.0, float(np.linalg.norm(off))
            found.append(Fit(number, base + off, base, amount, left, 0.0, base, best, aligned))
    return found


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


def _in_the_scene(
    scene: Scene, reference: Reference, given: Curve, tolerance: float, out: Path | None
) -> list[Explanation]:
    """Causes that are another scene, by its change of the solution; the best that a beam finds are solved again."""
    solved = _searcher(scene, reference, given, tolerance, out)
    if solved is None:
        return []
    fits = _searched(solved, reference, given, tolerance)
    limit = _limit(reference.error(given), tolerance, SETTINGS.left)
    promising = [one for one in fits if one.explanation().error_with <= SETTINGS.promising * limit]
    confirming = _solver(scene, reference, given, tolerance, out) if promising else None
    if confirming is None or confirming.method == solved.method:
        return [one.explanation() for one in fits]
    found, more = list[Explanation](), 0.0
    for one in promising[: SETTINGS.confirmed]:
        on_beam = one.explanation().error_with
        if on_beam > limit and any(other.error_with <= limit for other in found):
            break  # what the beam cannot tell apart is all solved
        said = _again(one, confirming, reference, given, tolerance, SETTINGS.once * limit).explanation()
        found.append(said)
        more = max(more, said.error_with - on_beam)
    # what the beam says too little of those, it says too little of all
    return found + [one.explanation(more) for one in fits if one not in promising[: len(found)]]


def _again(one: Fit, solved: Solutions, reference: Reference, given: Curve, tolerance: float, enough: float) -> Fit:
    """A cause fitted on a beam, solved by another solver; once if it then leaves less than ``enough``."""
    base = solved.load()
    assert base is not None
    off = reference.deviation(given)[1]
    size, without = float(np.linalg.norm(base)), float(np.linalg.norm(off))
    far = without > SETTINGS.close * size
    fit = Fit(one.number, base + off, base, one.best[0], 0.0, 0.0, base, (0.0, without), aligned=far)
    for _ in range(SETTINGS.again):
        if fit.settled or fit.best[1] <= enough * size:
            break
        load = solved.load(one.number.overrides(solved.scene, one.number.factor(fit.amount)))
        fit = fit.taken(load, SETTINGS.enough * tolerance * size)
    return fit if fit.best[1] < without else one


def _searched(solved: Solutions, reference: Reference, given: Curve, tolerance: float) -> list[Fit]:
    """Choices made the other way, and the numbers that are worth it fitted, those that leave least first."""
    base = solved.load()
    assert base is not None
    _, off, right = reference.deviation(given)
    size, allowed = float(np.linalg.norm(right)), tolerance * float(np.linalg.norm(right))
    made, found = list(choices(solved.scene)), list[Fit]()
    for choice, load in zip(made, solved.loads([one.changed for one in made]), strict=True):
        if load is not None:
            left = float(np.linalg.norm(off - load + base))
            found.append(Fit(choice, base + off, base, 1.0, left, 1.0, load, (1.0, left), settled=True))
    enough = min(SETTINGS.once * _limit(reference.error(given), tolerance, SETTINGS.left), tolerance) * size
    close = reference.error(given) <= SETTINGS.close
    if close:
        found += _fits(_promising(_lines(solved, reference, given, tolerance)), solved, allowed)
    if not close or not any(one.best[1] <= enough for one in found):
        fits = _fits(_promising(_lines(solved, reference, given, tolerance, aligned=True)), solved, allowed)
        nearest = sorted(fits, key=lambda one: one.best[1])[: SETTINGS.confirmed]
        more = [one.closer() for one in nearest if one.best[1] > enough]
        found += [*fits, *_fits(more, solved, allowed)]
    best: dict[str, Fit] = {}
    for one in sorted(found, key=lambda one: one.best[1]):
        best.setdefault(one.number.name, one)
    return list(best.values())


def _promising(lines: Sequence[Fit]) -> list[Fit]:
    """Those that are expected to leave not much more than the best one."""
    least = min((one.expected for one in lines), default=0.0)
    return [one for one in lines if one.expected <= least + SETTINGS.tried]


def _fits(fits: Sequence[Fit], solved: Solutions, allowed: float) -> list[Fit]:
    """What is left without each number, fitted together; ``allowed``: norm of the deviation that is."""
    active, ended = list(fits), list[Fit]()
    for _ in range(SETTINGS.steps):
        asked = [one.number.overrides(solved.scene, one.number.factor(one.amount)) for one in active]
        pairs = zip(active, solved.loads(asked), strict=True)
        active = [one.taken(load, SETTINGS.enough * allowed) for one, load in pairs]
        near = SETTINGS.kept * max(min((one.best[1] for one in active), default=0.0), allowed)
        again = [one for one in active if not one.settled and one.best[1] <= near]
        ended += [one for one in active if one not in again]
        active = again
    return [*ended, *active]


def _ranked(name: str, found: Sequence[Explanation], without: float, tolerance: float, tried: bool = True) -> Diagnosis:
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
