"""Defects with an amount that is fitted: numbers of the bond that are wrong, a viscosity, damage that heals by steps.

Each family has one amount; several families of one name are the ways in which the same number may be wrong.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from itertools import accumulate
from math import exp, log

import numpy as np
from scipy.optimize import minimize_scalar

from verify.studies.law.candidates import Candidate, changed, with_damage
from verify.studies.law.given.answer import Answer, of_bond
from verify.studies.law.opening_bond import OpeningBond
from verify.studies.law.ways.legs import JumpPath
from verify.support.refusal import Refusal
from verify.theory.mixed_law import ONSETS_OF, MixedBond

Make = Callable[[float], Candidate]

#: Name of a wrong number -> its field, its mode, and for every way in which stiffnesses may go with it the exponents of
#: the factors of K and Ks: as given; Ks consistent (`MixedBond.stiffness`); K by the ductility as well.
NUMBERS_OF_MODES: Mapping[str, tuple[str, int, tuple[tuple[float, float], ...]]] = {
    "strength": ("strength", 0, ((0, 0), (0, -2), (2, 0))),
    "shear-strength": ("strength", 1, ((0, 0), (0, 2))),
    "toughness": ("toughness", 0, ((0, 0), (0, 1), (-1, 0))),
    "shear-toughness": ("toughness", 1, ((0, 0), (0, -1))),
    "stiffness": ("stiffness", 0, ((0, 0), (0, 1))),
    "shear-stiffness": ("stiffness", 1, ((0, 0),)),
}

#: Numbers without a mode: key of the bond -> its name as a defect.
PLAIN_NUMBERS = {"penalty": "penalty", "friction": "friction", "pressure_strength": "pressure-strength"}


@dataclass(frozen=True)
class Span:
    """Between which amounts a family is fitted, and how finely.

    Stiffnesses that are a thousand times off are a mistake in units, and a penalty that is next to nothing is none.
    """

    factor: tuple[float, float] = (0.1, 10.0)
    penalty: tuple[float, float] = (1e-4, 1e4)
    exponent: tuple[float, float] = (1.0, 20.0)
    viscosity: tuple[float, float] = (1e-6, 10.0)  # in parts of the duration, or of a thousand steps
    kept: tuple[float, float] = (1e-3, 0.9999)
    least: int = 8  # amounts in equal ratios that are tried before the best is refined, and
    decade: int = 2  # how many more for every decade
    digits: float = 1e-7  # of the amount, where the refinement ends


SPAN = Span()

#: Unit of a viscosity in steps [steps].
STEPS = 1000.0

#: Error of an amount that no bond can have: far beyond every mean square of distances in parts of the strengths.
NO_BOND = 1e6


@dataclass(frozen=True)
class Family:
    """Candidates that differ by one amount; ``make`` raises `Refusal` for an amount that no bond can have.

    ``closed``: the smallest amount is one that a law can have, and not an end of what is tried.
    """

    make: Make
    span: tuple[float, float]
    closed: bool = False


def families(bond: MixedBond, slides: bool) -> Iterator[Family]:
    """The families that a bond can have; those of sliding only where a path ``slides``."""
    for by_step in (False, True):
        yield Family(partial(_viscous, bond, by_step), SPAN.viscosity)
    if bond.irreversible:
        yield Family(partial(_healing, bond), SPAN.kept)
    for key, name in PLAIN_NUMBERS.items():
        if value := getattr(bond, key) * (bond.contact or key != "penalty"):
            span = SPAN.penalty if key == "penalty" else SPAN.factor
            yield Family(partial(_plain, bond, name, key, value), span)
    if isinstance(bond, OpeningBond):
        return
    for name, (key, mode, ways) in NUMBERS_OF_MODES.items():
        if slides or not mode:
            for way in ways:
                yield Family(partial(_number, bond, name, key, mode, way), SPAN.factor)
    if slides:
        yield from _criteria(bond)
        for side in (-1.0, 1.0):
            for make in (_scaled_slip, _scaled_traction, _other_side):
                yield Family(partial(make, bond, side), SPAN.factor)


def fitted(family: Family, error: Callable[[Candidate], float]) -> Candidate | None:
    """The candidate of a family with the smallest error; None where that is at an open end of its span."""

    def of(power: float) -> float:
        try:
            return error(family.make(exp(power)))
        except Refusal:
            return NO_BOND

    low, high = map(log, family.span)
    powers = np.linspace(low, high, SPAN.least + round(SPAN.decade * (high - low) / log(10.0)))
    tried = [of(power) for power in powers]
    best = int(np.argmin(tried))
    if not (best or family.closed) or best == powers.size - 1 or tried[best] == NO_BOND:
        return None
    found = minimize_scalar(
        of, bounds=(powers[max(best - 1, 0)], powers[best + 1]), method="bounded", options={"xatol": SPAN.digits}
    )
    return replace(family.make(exp(found.x)), fitted=True)


def _viscous(bond: MixedBond, by_step: bool, amount: float) -> Candidate:
    """The bond with another viscosity, in parts of the programme's duration or in thousands of steps."""
    viscosity = amount * STEPS if by_step else amount
    unit = "steps" if by_step else "of the programme's duration"
    what = f"damage lags behind as with a viscosity of {viscosity:.3g} {unit}"
    return Candidate("viscosity", what, replace(bond, viscosity=viscosity), _by_step if by_step else of_bond)


def _by_step(bond: MixedBond, path: JumpPath) -> Answer:
    """Every step takes one unit of time on every path, as in a code with a fixed time step."""
    found = bond.path(path.g, path.s, np.arange(path.g.size))
    return Answer(found.p, found.t)


def _healing(bond: MixedBond, kept: float) -> Candidate:
    def reads(bond: MixedBond, path: JumpPath) -> Answer:
        d = accumulate(bond.driving(path.g, path.s), lambda d, now: max(kept * d, now))
        return with_damage(bond, path, np.fromiter(d, float, path.g.size))

    return Candidate("healing", f"damage heals: a step keeps {kept:.3g} of it", bond, reads)


def _plain(bond: MixedBond, name: str, key: str, value: float, factor: float) -> Candidate:
    what = f"the {key.replace('_', ' ')} is {factor * value:.4g}, not {value:.4g}"
    return Candidate(name, what, replace(bond, **{key: factor * value}))  # type: ignore[arg-type]


def _number(bond: MixedBond, name: str, key: str, mode: int, way: tuple[float, float], factor: float) -> Candidate:
    pair = list(getattr(bond, key))
    known = bond.slopes[mode] if key == "stiffness" else pair[mode]
    pair[mode] *= factor
    K, Ks = pair if key == "stiffness" else bond.stiffness
    more = {"stiffness": (K * factor ** way[0], Ks * factor ** way[1])}
    also = " and the stiffnesses with it" if any(way) else ""
    what = f"the {name.replace('-', ' ')} is {factor * known:.4g}, not {known:.4g}{also}"
    return Candidate(name, what, replace(bond, **{key: tuple(pair)} | more))  # type: ignore[arg-type]


def _criteria(bond: MixedBond) -> Iterator[Family]:
    """Another exponent, of onset and toughness or of the toughness alone, or another criterion of the toughness."""
    if bond.law == "exponential":
        return

    def exponent(a: float) -> Candidate:
        return Candidate("exponent", f"the exponent is {a:.4g}, not {bond.exponent:.4g}", replace(bond, exponent=a))

    def of_toughness(a: float) -> Candidate:
        other = replace(bond, exponent=a)
        what = f"the exponent of the toughness is {a:.4g}, not {bond.exponent:.4g}"
        return Candidate("exponent", what, changed(bond, critical=lambda _, B: other.critical(B)))

    def criterion(a: float, with_onset: bool) -> Candidate:
        (name,) = (one for one in ONSETS_OF if one != bond.criterion)
        other = replace(bond, criterion=name, exponent=a, onset=None)
        made = other if with_onset else changed(bond, critical=lambda _, B: other.critical(B))
        return Candidate("criterion", f'the criterion is "{name}" of exponent {a:.4g}', made)

    either: list[Make] = [partial(criterion, with_onset=one) for one in (True, False)]
    for make in [exponent, of_toughness, *either]:
        yield Family(make, SPAN.exponent, closed=True)


def _side(side: float) -> str:
    return "positive" if side > 0.0 else "negative"


def _scaled_slip(bond: MixedBond, side: float, factor: float) -> Candidate:
    def reads(bond: MixedBond, path: JumpPath) -> Answer:
        return of_bond(bond, replace(path, s=np.where(side * path.s > 0.0, factor * path.s, path.s)))

    return Candidate("slip-sign", f"{_side(side)} slip counts {factor:.4g} times", bond, reads)


def _scaled_traction(bond: MixedBond, side: float, factor: float) -> Candidate:
    def reads(bond: MixedBond, path: JumpPath) -> Answer:
        known = of_bond(bond, path)
        return Answer(known.p, np.where(side * path.s > 0.0, factor * known.t, known.t))

    return Candidate("slip-sign", f"the traction of {_side(side)} slip is {factor:.4g} times as large", bond, reads)


def _other_side(bond: MixedBond, side: float, factor: float) -> Candidate:
    """The shear strength, or with it the toughness, of one direction of slip."""
    other = replace(bond, strength=(bond.strength[0], factor * bond.strength[1]))

    def driving(_: MixedBond, g: np.ndarray, s: np.ndarray) -> np.ndarray:
        return np.where(side * np.asarray(s) > 0.0, other.driving(g, s), bond.driving(g, s))

    return Candidate(
        "slip-sign",
        f"the shear strength of {_side(side)} slip is {factor:.4g} times as large",
        changed(bond, driving=driving),
    )
