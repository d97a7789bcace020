"""Tractions of the definition with one known defect, those that have no amount.

Defects change the damage on first loading, the parameters of the bond, or the contact traction. A solver would notice
none of them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields, replace
from itertools import accumulate, product
from typing import Any

import numpy as np

from verify.studies.law.given.answer import Answer, of_bond
from verify.studies.law.opening_bond import OpeningBond
from verify.studies.law.ways.legs import JumpPath
from verify.theory.mixed_law import MixedBond

Driving = Callable[[np.ndarray, np.ndarray], np.ndarray]
Reading = Callable[[MixedBond, JumpPath], Answer]


@dataclass(frozen=True, eq=False)
class Candidate:
    """A bond with a defect; ``reads`` makes its tractions along a path.

    ``fitted``: it has an amount that was fitted to the tractions that are judged.
    """

    name: str
    what: str  # what is wrong, for the reader of the page
    bond: MixedBond
    reads: Reading = of_bond
    fitted: bool = False

    def answer(self, path: JumpPath) -> Answer:
        """Tractions along a path."""
        return self.reads(self.bond, path)


def candidates(bond: MixedBond) -> tuple[Candidate, ...]:
    """All defects that this bond can have, except those with an amount to be fitted (`families`)."""
    makers: tuple[Callable[[MixedBond], Iterator[Candidate]], ...] = (_half, _contact, _healing, _sign)
    if isinstance(bond, OpeningBond):
        makers = (_contact, _healing)
    elif bond.law != "exponential":  # the exponential law has no criterion and no onset, and determines its stiffness
        makers = (_compressed, _lagged, _by_displacement, _onset, _stiffness, *makers)
    return tuple(one for make in makers for one in make(bond))


def _compressed(bond: MixedBond) -> Iterator[Candidate]:
    first, second = bond.toughness
    tougher = replace(bond, toughness=(2.0**0.5 * first, 2.0**0.5 * second))

    def driving(g: np.ndarray, s: np.ndarray) -> np.ndarray:
        return np.where(g > 0.0, bond.driving(g, s), tougher.driving(g, s))

    what = "where g <= 0, the jump at failure is sqrt(2) times as large, and so is the toughness"
    yield Candidate("sqrt2-compressed-shear", what, driven(bond, driving))


def _lagged(bond: MixedBond) -> Iterator[Candidate]:

    def driving(g: np.ndarray, s: np.ndarray) -> np.ndarray:
        before = np.append(0.0, bond.mode_ratio(g, s)[:-1])
        return bond.driving(*_as_if(bond, g, s, before))

    def once_moved(g: np.ndarray, s: np.ndarray) -> np.ndarray:
        now, size = bond.mode_ratio(g, s), bond.energy_norm(g, s)
        before = np.where(np.append(0.0, size[:-1]) > 0.0, np.append(0.0, now[:-1]), now)
        return bond.driving(*_as_if(bond, g, s, before))

    for one in (driving, once_moved):
        yield Candidate("lagged-mode-ratio", "the mode ratio is that of the step before", driven(bond, one))


def _by_displacement(bond: MixedBond) -> Iterator[Candidate]:
    if bond.slopes[0] != bond.slopes[1]:

        def driving(g: np.ndarray, s: np.ndarray) -> np.ndarray:
            square = np.maximum(g, 0.0) ** 2 + s**2
            ratio = np.where(square > 0.0, s**2 / np.where(square > 0.0, square, 1.0), 0.0)
            return bond.driving(*_as_if(bond, g, s, ratio))

        what = "the mode ratio is s^2 / (s^2 + g^2), not Ks s^2 / (Ks s^2 + K g^2)"
        yield Candidate("displacement-mode-ratio", what, driven(bond, driving))


def _onset(bond: MixedBond) -> Iterator[Candidate]:
    other = {"turon": "quadratic", "quadratic": "turon"}[bond.onset_rule]
    if other == "quadratic" or bond.criterion == "bk":
        yield from _made("onset", f'the onset is "{other}", not "{bond.onset_rule}"', bond, onset=other)


def _stiffness(bond: MixedBond) -> Iterator[Candidate]:
    (K, Ks), names = bond.slopes, {(1, 0): "K", (0, 1): "Ks", (1, 1): "K and Ks"}
    for (of, name), factor, pressed in product(names.items(), (1e3, 1e-3), (False, True)):
        if pressed and not bond.contact:
            continue
        changed: dict[str, Any] = {"stiffness": (K * factor ** of[0], Ks * factor ** of[1])}
        changed |= {"penalty": factor * bond.penalty} if pressed else {}
        what = f"{name}{' and the penalty' if pressed else ''} times {factor:g}, as by a mistake in units"
        yield from _made("stiffness-unit", what, bond, **changed)


def _half(bond: MixedBond) -> Iterator[Candidate]:
    first, second = bond.toughness
    what = "half the toughness, as where the area of a triangle is halved twice"
    yield from _made("half-area", what, bond, toughness=(0.5 * first, 0.5 * second))


def _contact(bond: MixedBond) -> Iterator[Candidate]:
    if bond.contact:
        what = "the contact traction is (1 - d) penalty g, fading with damage"
        yield Candidate("damaged-contact", what, bond, _fading)
        without = replace(bond, penalty=float(np.finfo(float).tiny))  # a bond with contact refuses 0
        yield Candidate("no-contact", "nothing resists closing: the normal traction is 0 where g < 0", without)


def _fading(bond: MixedBond, path: JumpPath) -> Answer:
    found = bond.path(path.g, path.s, path.time)
    return Answer(np.where(path.g < 0.0, (1.0 - found.d) * found.p, found.p), found.t)


def _healing(bond: MixedBond) -> Iterator[Candidate]:
    if bond.irreversible:
        what = "damage heals: it is that of the present jump, and decreases on unloading"
        yield Candidate("healing", what, replace(bond, irreversible=False))
        yield Candidate("healing", "damage heals where faces close", bond, _healed_by_contact)


def _healed_by_contact(bond: MixedBond, path: JumpPath) -> Answer:
    D, closed = bond.driving(path.g, path.s), path.g < 0.0
    d = list(accumulate(zip(D, closed, strict=True), lambda d, now: now[0] if now[1] else max(d, now[0]), initial=0.0))
    return with_damage(bond, path, np.array(d[1:]))


def with_damage(bond: MixedBond, path: JumpPath, d: np.ndarray) -> Answer:
    """Tractions with another damage (n,) than that of the bond's own history."""
    known = bond.path(path.g, path.s, path.time)
    (K, Ks), closed = bond.slopes, (path.g < 0.0) & bond.contact
    rubbed = known.t - (1.0 - known.d) * Ks * path.s
    return Answer(np.where(closed, known.p, (1.0 - d) * K * path.g), (1.0 - d) * Ks * path.s + rubbed)


def _sign(bond: MixedBond) -> Iterator[Candidate]:
    yield _sheared(bond, "the shear traction has the opposite sign, and drives the slip", lambda t, _: -t)
    yield _sheared(bond, "the shear traction has no sign: it is that of |s|", lambda t, s: np.where(s < 0.0, -t, t))
    if bond.friction:
        yield Candidate("slip-sign", "friction acts with the slip and not against it", bond, _driven_by_friction)
    yield from (*_one_sided(bond, -1.0), *_one_sided(bond, 1.0))


def _one_sided(bond: MixedBond, side: float) -> Iterator[Candidate]:
    """Slip of one sign without traction, without damage, or without both."""
    slip = f"{'positive' if side > 0.0 else 'negative'} slip"

    def mute(t: np.ndarray, s: np.ndarray) -> np.ndarray:
        return np.where(side * s > 0.0, 0.0, t)

    harmless = driven(bond, lambda g, s: bond.driving(g, mute(s, s)))
    yield _sheared(bond, f"{slip} has no traction", mute)
    yield Candidate("slip-sign", f"{slip} does no damage", harmless)
    yield _sheared(harmless, f"{slip} has no traction and does no damage", mute)


def _sheared(bond: MixedBond, what: str, change: Driving) -> Candidate:
    """A bond whose shear traction (n,) is changed along with the slip (n,)."""

    def reads(bond: MixedBond, path: JumpPath) -> Answer:
        known = of_bond(bond, path)
        return Answer(known.p, change(known.t, path.s))

    return Candidate("slip-sign", what, bond, reads)


def _driven_by_friction(bond: MixedBond, path: JumpPath) -> Answer:
    found = bond.path(path.g, path.s, path.time)
    return Answer(found.p, 2.0 * (1.0 - found.d) * bond.slopes[1] * path.s - found.t)


def _made(name: str, what: str, bond: MixedBond, **changed: Any) -> Iterator[Candidate]:
    """The candidate with changed parameters; two candidates where these are not valid for a law, see `_soft`."""
    try:
        yield Candidate(name, what, replace(bond, **changed))
    except ValueError:
        if bond.law != "exponential":
            yield from (Candidate(name, what, _soft(bond, rest, changed)) for rest in (0.0, 1.0))


def driven(bond: MixedBond, driving: Driving) -> MixedBond:
    """The bond with another damage on first loading, (n,) at openings and slips (n,) of a path."""
    return changed(bond, driving=lambda _, g, s: driving(np.asarray(g), np.asarray(s)))


def changed(bond: MixedBond, **methods: Callable) -> MixedBond:
    """The bond with other methods, each with the bond as first argument."""
    found: MixedBond = type("Changed", (_Unchecked,), dict(methods))(**_numbers(bond))
    return found


class _Unchecked(MixedBond):
    """A bond with parameters that are not valid for a law."""

    def __post_init__(self) -> None:
        """Accept all parameters."""


def _numbers(bond: MixedBond) -> dict[str, Any]:
    return {field.name: getattr(bond, field.name) for field in fields(MixedBond)}


def _soft(bond: MixedBond, rest: float, changed: dict[str, Any]) -> MixedBond:
    """The bond with parameters for which the energy stored at onset exceeds the toughness at some mode ratios.

    At these the damage is ``rest`` from the onset on: 0 if a code limits a negative damage to 0, 1 if the bond breaks.
    """
    soft = _Unchecked(**_numbers(bond) | changed)

    def driving(g: np.ndarray, s: np.ndarray) -> np.ndarray:
        B = soft.mode_ratio(g, s)
        onset = soft.onset_norm(B)
        broken = np.where(soft.energy_norm(g, s) > onset, rest, 0.0)
        return np.where(onset**2 < 2.0 * soft.critical(B), soft.driving(g, s), broken)

    return driven(soft, driving)


def _as_if(bond: MixedBond, g: np.ndarray, s: np.ndarray, ratio: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Jumps of the same size lambda at other mode ratios (n,); where pressure raises the strength, closed points keep
    their jumps."""
    size, (K, Ks) = bond.energy_norm(g, s), bond.slopes
    opened, slid = size * np.sqrt((1.0 - ratio) / K), size * np.sqrt(ratio / Ks)
    kept = (g < 0.0) & (bond.pressure_strength > 0.0)
    return np.where(kept, g, opened), np.where(kept, s, slid)
