"""The table of known defects: a defect is the bond with other numbers, or with other functions of its own.

A solver would notice none of them. Some have an amount; several rows of one name are ways in which the same thing may
be wrong.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from copy import copy
from dataclasses import dataclass, replace
from functools import partial
from itertools import accumulate, product
from typing import Any

import numpy as np
from numpy import ndarray as Array

from verify.studies.law.definitions import DEFINITIONS, defined
from verify.support.refusal import Refusal
from verify.theory.mixed_law import ONSETS_OF, MixedBond
from verify.theory.mixed_path import Path

#: Between which amounts defects are sought. Stiffnesses that are a thousand times off are a mistake in units, and a
#: penalty that is next to nothing is none. Viscosities are in parts of the duration, or of `THOUSAND_STEPS`.
NUMBER_FACTORS, PENALTY_FACTORS, KEPT_DAMAGE = (0.1, 10.0), (1e-4, 1e4), (1e-3, 0.9999)
SOUGHT_EXPONENTS, SOUGHT_VISCOSITIES = (1.0, 20.0), (1e-6, 10.0)
THOUSAND_STEPS = 1000.0

#: Name of a wrong number -> for every way in which stiffnesses may go with it the powers of the factors of K and Ks: as
#: given; Ks consistent (`MixedBond.stiffness`); K by the ductility as well.
NUMBERS_OF_MODES = {
    "strength": ((0, 0), (0, -2), (2, 0)),
    "shear-strength": ((0, 0), (0, 2)),
    "toughness": ((0, 0), (0, 1), (-1, 0)),
    "shear-toughness": ((0, 0), (0, -1)),
    "stiffness": ((0, 0), (0, 1)),
    "shear-stiffness": ((0, 0),),
}


@dataclass(frozen=True, eq=False)
class KnownDefect:
    """A way in which a law may be wrong.

    Parameters
    ----------
    what : what is wrong, for the reader of the page, with the amount times ``unit`` in its braces
    made : the bond with the defect; with an amount a function of it, which raises `Refusal` where no bond can have it
    span : between which amounts it is fitted
    closed : the smallest amount is one that a law can have, and not an end of what is tried
    pair : the two of which it is made
    """

    name: str
    what: str
    made: MixedBond | Callable[[float], MixedBond]
    span: tuple[float, float] | None = None
    unit: float = 1.0
    closed: bool = False
    pair: tuple[KnownDefect, ...] = ()


Rows = Iterator[KnownDefect]


def known_defects(bond: MixedBond, added: bool = False) -> Rows:
    """All defects that a bond can have, or those that change no number of it, and can be added to another one."""
    if added:
        tables = [_mode_ratio, _contact, _history, _sign]
    else:
        tables = [_mode_ratio, _criterion] * bond.of_criterion + [_units] * (bond.law != "exponential")
        tables += [_numbers, _contact, _history, _sign, _definition]
    for table in tables:
        yield from table(bond)


def changed(bond: MixedBond, **values: Any) -> MixedBond:
    """The bond with other numbers, which need not be valid, or other functions ``driving``, ``critical``, ``path``."""
    found = copy(bond)
    for name, value in values.items():
        object.__setattr__(found, name, value)
    return found


def _after(bond: MixedBond, change: Callable[[Path, Array, Array], dict[str, Array]]) -> MixedBond:
    """The bond with other tractions, a function of what it does on a path and of the jumps there."""

    def path(g: Array, s: Array, time: Array) -> Path:
        found = bond.path(g, s, time)
        return replace(found, **change(found, g, s))

    return changed(bond, path=path)


def _mode_ratio(bond: MixedBond) -> Rows:
    tougher = replace(bond, toughness=_times(bond.toughness, 2.0**0.5))
    made = changed(bond, driving=lambda g, s: np.where(g > 0.0, bond.driving(g, s), tougher.driving(g, s)))
    what = "where g <= 0, the jump at failure is sqrt(2) times as large, and so is the toughness"
    yield KnownDefect("sqrt2-compressed-shear", what, made)

    def at(ratio: Callable[[Array, Array], Array]) -> MixedBond:
        """Damage of jumps of the same size lambda at other mode ratios; where pressure raises the strength, closed
        points keep their jumps."""

        def driving(g: Array, s: Array) -> Array:
            B, size, kept = ratio(g, s), bond.energy_norm(g, s), (g < 0.0) & (bond.pressure_strength > 0.0)
            opened, slid = (size * np.sqrt(part / k) for part, k in zip((1.0 - B, B), bond.slopes, strict=True))
            return bond.driving(np.where(kept, g, opened), np.where(kept, s, slid))

        return changed(bond, driving=driving)

    def lagged(rest: float) -> MixedBond:
        def before(g: Array, s: Array) -> Array:
            return np.append(rest, np.where(bond.energy_norm(g, s) > 0.0, bond.mode_ratio(g, s), rest)[:-1])

        return at(before)

    for first in (0.0, 1.0):  # mode ratio of no jump
        yield KnownDefect("lagged-mode-ratio", "the mode ratio is that of the step before", lagged(first))
    if bond.slopes[0] != bond.slopes[1]:
        what, least = "the mode ratio is s^2 / (s^2 + g^2), not Ks s^2 / (Ks s^2 + K g^2)", np.finfo(float).tiny
        by_displacement = at(lambda g, s: s**2 / np.maximum(np.maximum(g, 0.0) ** 2 + s**2, least))
        yield KnownDefect("displacement-mode-ratio", what, by_displacement)


def _criterion(bond: MixedBond) -> Rows:
    """Another onset; another exponent or criterion, of onset and toughness or of the toughness alone."""
    other = {"turon": "quadratic", "quadratic": "turon"}[bond.onset_rule]
    if other in ONSETS_OF[bond.criterion]:
        for made in _valid_or_soft(bond, onset=other):
            yield KnownDefect("onset", f'the onset is "{other}", not "{bond.onset_rule}"', made)
    (name,) = (one for one in ONSETS_OF if one != bond.criterion)
    what, (K, Ks) = "the toughness has (1 + s/g)^2 in place of 1 + (s/g)^2", bond.slopes

    def summed(B: Array) -> Array:
        opening, sliding = (1.0 - B) * Ks, B * K  # in the ratio of g^2 to s^2
        return bond.critical(B) * (1.0 + 2.0 * np.sqrt(opening * sliding) / (opening + sliding))

    yield KnownDefect("summed-ratio", what, changed(bond, critical=summed))
    amount, criterion = f"{{:.4g}}, not {bond.exponent:.4g}", f'the criterion is "{name}" of exponent {{:.4g}}'

    def whole(exponent: float, **values: Any) -> MixedBond:
        return replace(bond, exponent=exponent, **values)

    def toughness(exponent: float, **values: Any) -> MixedBond:
        return changed(bond, critical=whole(exponent, **values).critical)

    for make, of in ((whole, ""), (toughness, " of the toughness")):
        yield KnownDefect("exponent", f"the exponent{of} is {amount}", make, SOUGHT_EXPONENTS, closed=True)
        other_criterion = partial(make, criterion=name, onset=None)
        yield KnownDefect("criterion", criterion, other_criterion, SOUGHT_EXPONENTS, closed=True)


def _valid_or_soft(bond: MixedBond, **values: Any) -> Iterator[MixedBond]:
    """The bond with other numbers. Where the energy stored at onset exceeds the toughness at some mode ratios, damage
    is 0 or 1 from the onset on: a code limits a negative damage to 0, or the bond breaks."""
    try:
        yield replace(bond, **values)
    except Refusal:
        if not bond.of_criterion:
            return
        soft = changed(bond, **values)

        def driving(rest: float, g: Array, s: Array) -> Array:
            B = soft.mode_ratio(g, s)
            onset = soft.onset_norm(B)
            broken = np.where(soft.energy_norm(g, s) > onset, rest, 0.0)
            return np.where(onset**2 < 2.0 * soft.critical(B), soft.driving(g, s), broken)

        yield from (changed(soft, driving=partial(driving, rest)) for rest in (0.0, 1.0))


def _times(pair: tuple[float, float], factor: float, powers: Sequence[int] = (1, 1)) -> tuple[float, float]:
    """The numbers of both modes times powers of a factor."""
    return pair[0] * factor ** powers[0], pair[1] * factor ** powers[1]


def _units(bond: MixedBond) -> Rows:
    names, also = {(1, 0): "K", (0, 1): "Ks", (1, 1): "K and Ks"}, ("", " and the penalty")[: 1 + bond.contact]
    for (powers, name), factor, more in product(names.items(), (1e3, 1e-3), also):
        stiffness, penalty = _times(bond.slopes, factor, powers), bond.penalty * (factor if more else 1.0)
        what = f"{name}{more} times {factor:g}, as by a mistake in units"
        for made in _valid_or_soft(bond, stiffness=stiffness, penalty=penalty):
            yield KnownDefect("stiffness-unit", what, made)


def _numbers(bond: MixedBond) -> Rows:
    for made in _valid_or_soft(bond, toughness=_times(bond.toughness, 0.5)):
        yield KnownDefect("half-area", "half the toughness, as where the area of a triangle is halved twice", made)

    def wrong(key: str, mode: int, powers: Sequence[int], factor: float) -> MixedBond:
        numbers = {name: getattr(bond, name) for name in (key, "stiffness")}
        numbers[key] = _times(numbers[key], factor, (1 - mode, mode))
        return replace(bond, **numbers | {"stiffness": _times(numbers["stiffness"], factor, powers)})

    for name, ways in NUMBERS_OF_MODES.items():
        mode, key = int(name.startswith("shear-")), name.removeprefix("shear-")
        value = (bond.slopes if key == "stiffness" else getattr(bond, key))[mode]
        for powers in ways:
            also = " and the stiffnesses with it" if any(powers) else ""
            what = f"the {name.replace('-', ' ')} is {{:.4g}}, not {value:.4g}{also}"
            yield KnownDefect(name, what, partial(wrong, key, mode, powers), NUMBER_FACTORS, value)


def _contact(bond: MixedBond) -> Rows:
    """Contact and what acts under pressure."""
    if bond.contact:
        fading = _after(bond, lambda found, g, _: {"p": np.where(g < 0.0, 1.0 - found.d, 1.0) * found.p})
        yield KnownDefect("damaged-contact", "the contact traction is (1 - d) penalty g, fading with damage", fading)
        what = "nothing resists closing: the normal traction is 0 where g < 0"
        yield KnownDefect("no-contact", what, changed(bond, penalty=0.0))

    def wrong(key: str, factor: float) -> MixedBond:
        return replace(bond, **{key: factor * getattr(bond, key)})

    for key in ("penalty", "friction", "pressure_strength"):
        if value := getattr(bond, key) * (bond.contact or key != "penalty"):
            span = PENALTY_FACTORS if key == "penalty" else NUMBER_FACTORS
            what = f"the {key.replace('_', ' ')} is {{:.4g}}, not {value:.4g}"
            yield KnownDefect(key.replace("_", "-"), what, partial(wrong, key), span, value)


def _history(bond: MixedBond) -> Rows:
    """Damage that lags behind, and damage that heals."""

    def by_step(amount: float) -> MixedBond:
        """Every step takes one unit of time on every path, as in a code with a fixed time step."""
        other = replace(bond, viscosity=amount * THOUSAND_STEPS)
        return changed(bond, path=lambda g, s, time: other.path(g, s, np.arange(g.size)))

    def keeping(part: Callable[[Array], Array]) -> MixedBond:
        """A part of the damage is kept with every step, by the opening."""

        def driving(g: Array, s: Array) -> Array:
            steps = zip(part(g), bond.driving(g, s), strict=True)
            return np.array([*accumulate(steps, lambda d, step: max(step[0] * d, step[1]), initial=0.0)][1:])

        return changed(bond, irreversible=False, driving=driving)

    what = "damage lags behind as with a viscosity of {:.3g} "
    in_time, of = f"{what}of the programme's duration", lambda amount: replace(bond, viscosity=amount)
    yield KnownDefect("viscosity", in_time, of, SOUGHT_VISCOSITIES)
    yield KnownDefect("viscosity", f"{what}steps", by_step, SOUGHT_VISCOSITIES, THOUSAND_STEPS)
    if bond.irreversible:
        what = "damage heals: it is that of the present jump, and decreases on unloading"
        yield KnownDefect("healing", what, replace(bond, irreversible=False))
        yield KnownDefect("healing", "damage heals where faces close", keeping(lambda g: g >= 0.0))
        what = "damage heals: a step keeps {:.3g} of it"
        yield KnownDefect("healing", what, lambda kept: keeping(lambda g: np.full_like(g, kept)), KEPT_DAMAGE)


def _definition(bond: MixedBond) -> Rows:
    """No defect of a law, but of what it is judged by."""
    for name in DEFINITIONS:
        with suppress(Refusal):
            what = f"the tractions are those of another definition: judge by --definition {name}"
            yield KnownDefect("other-definition", what, defined(bond, name))


def _sign(bond: MixedBond) -> Rows:
    Ks, named = bond.slopes[1], partial(KnownDefect, "slip-sign")
    opposite = _after(bond, lambda found, *_: {"t": -found.t})
    yield named("the shear traction has the opposite sign, and drives the slip", opposite)
    unsigned = _after(bond, lambda found, _, s: {"t": np.where(s < 0.0, -found.t, found.t)})
    yield named("the shear traction has no sign: it is that of |s|", unsigned)
    if bond.friction:
        driven = _after(bond, lambda found, _, s: {"t": 2.0 * (1.0 - found.d) * Ks * s - found.t})
        yield named("friction acts with the slip and not against it", driven)
    for side, slip in ((-1.0, "negative slip"), (1.0, "positive slip")):
        yield from (named(*row) for row in _one_sided(bond, side, slip))


def _one_sided(bond: MixedBond, side: float, slip: str) -> Iterator[tuple]:
    """Sentences, bonds and spans of another slip, traction or damage in one direction of slip."""

    def times(factor: float, value: Array, s: Array) -> Array:
        return np.where(side * s > 0.0, factor * value, value)

    def traction(factor: float) -> MixedBond:
        return _after(bond, lambda found, _, s: {"t": times(factor, found.t, s)})

    def strength(factor: float) -> MixedBond:
        other = replace(bond, strength=_times(bond.strength, factor, (0, 1)))
        return changed(bond, driving=lambda g, s: np.where(side * s > 0.0, other.driving(g, s), bond.driving(g, s)))

    def whole(factor: float) -> MixedBond:
        return changed(bond, path=lambda g, s, time: bond.path(g, times(factor, s, s), time))

    harmless = changed(bond, driving=lambda g, s: bond.driving(g, times(0.0, s, s)))
    yield f"{slip} has no traction", traction(0.0)
    yield f"{slip} does no damage", harmless
    yield f"{slip} has no traction and does no damage", whole(0.0)
    yield f"{slip} counts {{:.4g}} times", whole, NUMBER_FACTORS
    yield f"the traction of {slip} is {{:.4g}} times as large", traction, NUMBER_FACTORS
    yield f"the shear strength of {slip} is {{:.4g}} times as large", strength, NUMBER_FACTORS
