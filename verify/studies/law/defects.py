"""Which known defect explains tractions that deviate from the definition: each is tried on the same paths."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import exp, log

import numpy as np
from scipy.optimize import minimize_scalar

from verify.studies.law.known_defects import KnownDefect, known_defects
from verify.studies.law.laws import Answer, Case, of_bond
from verify.support.refusal import Refusal
from verify.theory.mixed_law import MixedBond

UNKNOWN = "unknown"
#: A defect is named if it leaves at most this part of the deviation, as a larger one names more defects, also wrong
#: ones; and at most this distance in parts of the strengths.
LEFT_OF_DEVIATION, LEFT_OF_STRENGTHS = 0.05, 0.01
#: A defect that explains only some paths must leave at most this part of the mean square deviation on each path on
#: which it would show.
HALVED = 0.25
#: An amount is fitted on the first path and on this many with the largest deviations.
WORST_PATHS = 2
#: Amounts in equal ratios that are tried before the best is refined, how many more for every decade, and the part of
#: the amount where the refinement ends.
LEAST_AMOUNTS, AMOUNTS_A_DECADE, DIGITS_OF_AMOUNT = 8, 2, 1e-7
#: Part of the opening at onset within which codes differ in whether a point is open.
NEITHER_OPEN = 1e-9
#: Error of an amount that no bond can have: far beyond every mean square of distances in parts of the strengths.
NO_BOND = 1e6


@dataclass(frozen=True, eq=False)
class Trial:
    """What a known defect of some amount makes of the paths, arrays (n_p,).

    Parameters
    ----------
    left, most : mean square and largest distance of the law from the definition with the defect
    shown : largest distance of the definition with the defect from that without
    """

    of: KnownDefect
    what: str
    bond: MixedBond
    left: np.ndarray
    most: np.ndarray
    shown: np.ndarray


@dataclass(frozen=True, eq=False)
class Defect:
    """A defect, and the root mean square distance of the given tractions from the law with it and without it.

    ``path`` is the path with the largest deviation. For `UNKNOWN` both distances are the same, and there is no
    ``trial``.
    """

    name: str
    path: str
    error_with: float
    error_without: float
    what: str
    trial: Trial | None = None

    @property
    def sentence(self) -> str:
        off = f"the law is off by {self.error_without:.2g} of the strengths"
        which = "both defects" if self.trial and self.name != self.trial.of.name else "it"
        left = f", with {which} by {self.error_with:.2g}" if self.trial else ""
        return f"{self.name}: {self.what}; {off}{left}, most on path {self.path}"


def defects(cases: Sequence[Case], tolerance: float) -> tuple[Defect, ...]:
    """The defects that explain the tractions, best first; none where no path is off by more than ``tolerance``.

    Defects with an amount are fitted where none without one explains everything, as that takes a second.
    """
    square, largest = np.transpose([case.apart(case.given, case.known) for case in cases])
    broken, everywhere = np.flatnonzero(~(largest <= tolerance)), np.arange(len(cases))
    if not broken.size:
        return ()
    some = [cases[i] for i in dict.fromkeys([0, *np.argsort(-square, kind="stable")[:WORST_PATHS]])]
    known, trials, partly = [*known_defects(cases[0].bond)], list[Trial](), list[Defect]()
    for fitted in (False, True):
        for one in known:
            amount = _amount(some, one) if fitted else 1.0
            if fitted == (one.span is not None) and amount is not None:
                trials.append(_trial(cases, one, amount))
        named = _named(cases, trials, square, everywhere)
        for best in [one.trial for one in named[:1] if one.trial]:
            left = np.flatnonzero(~(best.most <= tolerance))
            if not left.size:
                return tuple(named)
            partly = [*named, _unknown(cases, best.left, left)]
    pairs = [of for of in _pairs(cases[0].bond) if _root(_trial(some, of, 1.0).left) <= LEFT_OF_STRENGTHS]
    for both in _named(cases, [_trial(cases, of, 1.0) for of in pairs], square, everywhere)[:1]:
        # a second one has to explain of what the first one leaves as much as a first one of the whole
        if both.trial and not (partly and LEFT_OF_DEVIATION * partly[0].error_with < both.error_with):
            return tuple(replace(both, name=one.name, what=one.what) for one in both.trial.of.pair)
    return tuple(partly or _in_parts(cases, trials, square, broken, tolerance))


def _pairs(bond: MixedBond) -> Iterator[KnownDefect]:
    """Two defects without an amount at once, of mode ratio, contact, history or sign."""
    for first in known_defects(bond, added=True):
        if isinstance(first.made, MixedBond) and first.made.penalty:  # without any it is no bond to begin from
            for second in known_defects(first.made, added=True):
                if isinstance(second.made, MixedBond) and second.name != first.name:
                    yield replace(second, name=f"{first.name} and {second.name}", pair=(first, second))


def _trial(cases: Sequence[Case], of: KnownDefect, amount: float) -> Trial:
    bond = of.made(amount) if callable(of.made) else of.made
    answers, left, most = _apart(cases, bond)
    shown = np.array([case.apart(answer, case.known)[1] for case, answer in zip(cases, answers, strict=True)])
    return Trial(of, of.what.format(amount * of.unit), bond, left, most, shown)


def _apart(cases: Sequence[Case], bond: MixedBond) -> tuple[list[Answer], np.ndarray, np.ndarray]:
    """Answers of a bond, and mean square and largest distance (n_p,) of the given tractions from them."""
    answers = [of_bond(bond, case.way) for case in cases]
    pairs = zip(cases, answers, strict=True)
    left, most = np.transpose([case.apart(case.given, _nearest(bond, case, answer)) for case, answer in pairs])
    return answers, left, most


def _nearest(bond: MixedBond, case: Case, answer: Answer) -> Answer:
    """The answer of a bond or, on a path that slides while its faces just touch, the nearest tractions to the given
    ones between those with faces just open and just closed: codes take either from step to step."""
    near = NEITHER_OPEN * bond.strength[0] / bond.slopes[0]
    touch = (np.abs(case.way.g) <= near) & (case.way.s != 0.0)
    if not touch.any():
        return answer
    sides = [of_bond(bond, replace(case.way, g=np.where(touch, side, case.way.g))) for side in (near, -near)]
    low, high = (pick([one.tractions for one in sides], axis=0) for pick in (np.min, np.max))
    return Answer(*np.clip(case.given.tractions, low, high))


def _named(cases: Sequence[Case], trials: Sequence[Trial], square: np.ndarray, where: np.ndarray) -> list[Defect]:
    """Those that explain the deviation on the paths ``where`` together, best first, each name once."""
    without, worst = _root(square[where]), cases[where[np.argmax(square[where])]].way.name
    found: dict[str, Defect] = {}
    for one in sorted(trials, key=lambda one: _root(one.left[where])):
        error = _root(one.left[where])
        if error <= min(LEFT_OF_DEVIATION * without, LEFT_OF_STRENGTHS):
            found.setdefault(one.of.name, Defect(one.of.name, worst, error, without, one.what, one))
    return [*found.values()]


def _unknown(cases: Sequence[Case], square: np.ndarray, where: np.ndarray) -> Defect:
    error, worst = _root(square[where]), cases[where[np.argmax(square[where])]].way.name
    return Defect(UNKNOWN, worst, error, error, "the tractions differ from the definition as no known defect does")


def _in_parts(
    cases: Sequence[Case], trials: Sequence[Trial], square: np.ndarray, broken: np.ndarray, tolerance: float
) -> list[Defect]:
    """Several defects at once, each on paths of its own; what no defect explains is unknown.

    Amounts that are fitted to one path explain too much there. Of the defects that explain a path, that which explains
    the most paths is named.
    """
    steady = [one for one in trials if (one.left <= HALVED * square)[one.shown > tolerance].all()]
    found = {}
    for i in broken[np.argsort(-square[broken], kind="stable")]:
        ones = _named(cases, steady, square, np.array([i]))
        found[i] = [one for one in ones if one.trial and one.trial.of.span is None]
    explains = Counter(one.name for ones in found.values() for one in ones)
    named: dict[str, Defect] = {}
    for best in [max(ones, key=lambda one: explains[one.name]) for ones in found.values() if ones]:
        named.setdefault(best.name, best)
    unexplained = np.array([i for i, ones in found.items() if not ones])
    last = [_unknown(cases, square, unexplained)] if unexplained.size else []
    return sorted(named.values(), key=lambda one: one.error_with) + last


def _root(square: np.ndarray) -> float:
    return float(np.sqrt(np.mean(square)))


def _amount(cases: Sequence[Case], of: KnownDefect) -> float | None:
    """The amount with the smallest error on some paths; None where that is at an open end of its span."""
    made = of.made
    if of.span is None or isinstance(made, MixedBond):
        return 1.0

    def error(power: float) -> float:
        try:
            return float(_apart(cases, made(exp(power)))[1].sum())
        except Refusal:
            return NO_BOND

    low, high = map(log, of.span)
    powers = np.linspace(low, high, LEAST_AMOUNTS + round(AMOUNTS_A_DECADE * (high - low) / log(10.0)))
    tried = [error(power) for power in powers]
    best = int(np.argmin(tried))
    if not (best or of.closed) or best == powers.size - 1 or tried[best] == NO_BOND:
        return None
    bounds, options = (powers[max(best - 1, 0)], powers[best + 1]), {"xatol": DIGITS_OF_AMOUNT}
    return exp(minimize_scalar(error, bounds=bounds, method="bounded", options=options).x)
