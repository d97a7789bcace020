"""Checks of a law on all paths: properties that every law of its kind must have, and comparison with the definition."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from verify.studies.law import tangents
from verify.studies.law.consistency import inconsistent
from verify.studies.law.defects import Defect, defects
from verify.studies.law.distance import apart, work
from verify.studies.law.given.answer import Answer, Answers, of_bond
from verify.studies.law.ways.legs import JumpPath
from verify.theory.mixed_law import MixedBond
from verify.theory.mixed_toughness import off_criterion
from verify.verdict import Check, Kind


@dataclass(frozen=True)
class Tolerances:
    """Relative deviations that are allowed: of tractions and energies, and of tangents."""

    tractions: float = 1e-4  # numbers of a file with six digits pass, half a per cent does not
    tangent: float = 1e-3

    @staticmethod
    def exact() -> Tolerances:
        """Tolerances for a law in double precision that should be the definition itself."""
        return Tolerances(1e-10, 1e-5)


@dataclass(frozen=True)
class Judgement:
    """The checks of a law, the defects that explain what is broken, and what could not be judged."""

    bond: MixedBond
    ways: tuple[JumpPath, ...]
    given: Answers
    expected: Answers
    checks: tuple[Check, ...]
    defects: tuple[Defect, ...]
    remarks: tuple[str, ...]

    @property
    def passed(self) -> bool:
        return all(check.passed for check in self.checks)


@dataclass(frozen=True, eq=False)
class _Case:
    """One path, with the tractions of the law and of the definition."""

    bond: MixedBond
    way: JumpPath
    given: Answer
    known: Answer
    tolerances: Tolerances

    def check(self, name: str, value: float, kind: Kind, meaning: str, tolerance: float | None = None) -> Check:
        limit = self.tolerances.tractions if tolerance is None else tolerance
        return Check(name, self.way.name, float(value), limit, kind, meaning)


def judge(bond: MixedBond, ways: Sequence[JumpPath], given: Answers, tolerances: Tolerances | None = None) -> Judgement:
    """The verdict on tractions ``given`` on the paths ``ways`` of a bond."""
    tolerances = tolerances or Tolerances()
    expected = {way.name: of_bond(bond, way) for way in ways}
    cases = {way.name: _Case(bond, way, given[way.name], expected[way.name], tolerances) for way in ways}
    checks = [check for case in cases.values() for check in _of_a_path(case)]
    checks += [check for case in cases.values() if (check := _odd(case, cases)) is not None]
    found = defects(bond, ways, given, tolerances.tractions)
    return Judgement(bond, tuple(ways), given, expected, tuple(checks), found, tuple(_remarks(bond, ways, given)))


def _remarks(bond: MixedBond, ways: Sequence[JumpPath], given: Answers) -> Iterator[str]:
    if any(way.s.any() for way in ways):
        yield from (*inconsistent(bond), *off_criterion(bond))
    if bond.viscosity:
        yield "energies and peaks are held against the definition with its viscosity, not against the criterion"
    if bond.friction:
        yield "work under pressure contains friction, and is held against that of the definition"
    if all(answer.tangent is None for answer in given.values()):
        yield "no tangent is given: none is judged"


def _of_a_path(case: _Case) -> Iterator[Check]:
    distance = apart(case.bond, case.given, case.known)
    meaning = "Largest distance of the tractions from the definition, in parts of the strengths."
    yield case.check("reference", distance.max(), "analytical", meaning)
    for judged in (_energy, _pressed, _unloading, _dissipation, _continuity, _contact, _rest, _tangent):
        yield from judged(case)


def _energy(case: _Case) -> Iterator[Check]:
    """Toughness and onset at a constant mode ratio."""
    way, B = case.way, case.way.ratio
    if B is None:
        return
    named = f"{100.0 * B:g} % of the energy in sliding"
    whole = float(case.bond.critical(np.array(B)))
    off = work(way.g, way.s, case.given) - work(way.g, way.s, case.known)
    yield case.check(
        "toughness", off / whole, "analytical", f"Work to failure over the criterion's toughness, {named}."
    )
    peak, known = (_energy_norm(case.bond, answer).max() for answer in (case.given, case.known))
    text = f"Peak of the tractions in the energy norm, where damage begins, {named}."
    yield case.check("strength", peak / known - 1.0, "analytical", text)


def _energy_norm(bond: MixedBond, answer: Answer) -> np.ndarray:
    """``sqrt(p^2 / K + t^2 / Ks)`` (n,), which is (1 - d) lambda."""
    K, Ks = bond.slopes
    return np.sqrt(answer.p**2 / K + answer.t**2 / Ks)


def _pressed(case: _Case) -> Iterator[Check]:
    if case.way.pressure is None:
        return
    way, still = case.way, np.zeros_like(case.way.g)
    whole = case.bond.toughness[1]
    given, known = (work(still, way.s, answer) for answer in (case.given, case.known))
    text = "Work of sliding to failure under pressure, over the toughness of mode II, which pressure does not change."
    yield case.check("compressed-toughness", (given - known) / whole, "analytical", text)
    peak, at = (np.abs(answer.t).max() for answer in (case.given, case.known))
    text = "Largest shear traction under pressure, over the shear strength."
    yield case.check("compressed-strength", (peak - at) / case.bond.strength[1], "analytical", text)


def _unloading(case: _Case) -> Iterator[Check]:
    """Between the turn and the return to it, tractions are proportional to the jump."""
    if not case.way.name.startswith("unload-reload") or case.bond.viscosity:  # damage goes on with viscosity
        return
    size = np.hypot(case.way.g, case.way.s)
    turn = int(np.argmax(np.diff(size) < 0.0))
    back = turn + 1 + int(np.argmax(size[turn + 1 :] >= size[turn] * (1.0 - 1e-12)))
    share = size[turn : back + 1] / size[turn]
    p, t = (
        np.abs(one[turn : back + 1] - share * one[turn]).max() / strength
        for one, strength in zip((case.given.p, case.given.t), case.bond.strength, strict=True)
    )
    text = "Tractions on unloading and reloading, off the line through the origin, in parts of the strengths."
    yield case.check("unloading", max(p, t), "exact", text)


def _dissipation(case: _Case) -> Iterator[Check]:
    """Energy lost in a step, with linear tractions along it: the work less the growth of ``(p g + t s) / 2``, which is
    a cross product."""
    way, p, t = case.way, case.given.p, case.given.t
    if way.name == "turned-frame":
        return
    lost = 0.5 * (p[:-1] * way.g[1:] - p[1:] * way.g[:-1] + t[:-1] * way.s[1:] - t[1:] * way.s[:-1])
    if case.bond.friction:  # the energy stored by friction does not follow from its traction
        lost = lost[(way.g[1:] >= 0.0) & (way.g[:-1] >= 0.0)]
    text = "Largest energy that a step gains by damage that heals, over the toughness of mode I."
    yield case.check("dissipation", max(0.0, -float(lost.min(initial=0.0))) / case.bond.toughness[0], "exact", text)


def _continuity(case: _Case) -> Iterator[Check]:
    """At equal slip, closed faces and faces that are open or pressed by at most 1e-9 of the onset have the same
    tractions."""
    if not case.way.name.startswith("closed-") or case.bond.viscosity:  # damage goes on with viscosity
        return
    s, t = case.way.s[1:], case.given.t[1:]
    same = np.diff(s) == 0.0
    stiffest = max(*case.bond.slopes, case.bond.penalty)
    jump = float(np.abs(np.diff(t))[same].max()) / case.bond.strength[1]
    normal = float(np.abs(case.given.p).max()) / case.bond.strength[0]
    allowed = 4.0 * stiffest * float(np.abs(case.way.g).max()) / min(case.bond.strength)
    text = "Jump of the tractions between faces just closed and just open, sliding, in parts of the strengths."
    yield case.check("continuity", max(jump, normal), "exact", text, max(case.tolerances.tractions, allowed))


def _contact(case: _Case) -> Iterator[Check]:
    g = case.way.g
    closed = g < -1e-6 * np.abs(g).max()
    if not (case.bond.contact and closed.any()) or case.way.name.startswith("closed-"):
        return
    expected = case.bond.penalty * g[closed]
    off = float(np.abs(case.given.p[closed] / expected - 1.0).max())
    text = "Contact traction over penalty times g: damage does not weaken it."
    yield case.check("contact", off, "analytical", text)


def _rest(case: _Case) -> Iterator[Check]:
    if case.way.name != "zero":
        return
    p, t = (
        np.abs(one).max() / strength
        for one, strength in zip((case.given.p, case.given.t), case.bond.strength, strict=True)
    )
    yield case.check("rest", max(p, t), "exact", "Tractions where next to nothing moves, in parts of the strengths.")


def _tangent(case: _Case) -> Iterator[Check]:
    off = tangents.off(case.bond, case.way, case.given)
    if off is not None:
        how = "differences of the law" if case.given.differences is not None else "differences along the path"
        text = f"Tangent against {how}, over the initial stiffness."
        yield case.check("tangent", off, "exact", text, case.tolerances.tangent)


def _odd(case: _Case, cases: dict[str, _Case]) -> Check | None:
    other = cases.get(case.way.name.removesuffix("-negative"))
    if other is None or other is case:
        return None
    p, t = case.given.p - other.given.p, case.given.t + other.given.t
    off = max(np.abs(p).max() / case.bond.strength[0], np.abs(t).max() / case.bond.strength[1])
    text = f"Against {other.way.name}: p is even and t is odd in the slip, in parts of the strengths."
    return case.check("odd-in-slip", off, "exact", text)


def worst_first(checks: Sequence[Check]) -> list[Check]:
    """Broken checks first, those furthest beyond their tolerance at the top."""
    return sorted(checks, key=lambda check: (check.passed, -abs(check.value) / (check.tolerance or 1.0)))
