"""The verdict on a law: the checks on all paths, what explains the broken ones, and what could not be judged."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from verify.studies.law.defects import Defect, defects
from verify.studies.law.laws import Answer, Case, Far, of_bond, unfinished
from verify.studies.law.paths import OPPOSITES, PRESSURES, JumpPath
from verify.theory.mixed_law import MixedBond
from verify.theory.mixed_toughness import off_criterion
from verify.verdict import Check, Kind, counted, of_state
from verify.version import __version__

#: Part of the steps of a path whose tangent is judged in a file; the others count as next to a kink.
NOT_AT_KINKS = 0.85
#: A step is at a kink of the law if forward and backward differences differ by more than this part of the stiffness.
KINK = 1e-3
NOT_COMPARED = (
    "no definition was compared: what any law keeps is judged, and the numbers of the scene scale paths and deviations "
    "alone"
)
IN_PARTS = "in parts of the strengths"
#: Relative difference from which two stiffnesses count as different.
OTHER_STIFFNESS = 1e-6


Finding = tuple[str, float, str]  # name, value and meaning of a check


@dataclass(frozen=True)
class Tolerances:
    """Relative deviations that are allowed: of tractions and energies, and of tangents."""

    tractions: float = 1e-4  # numbers of a file with six digits pass, half a per cent does not
    tangent: float = 1e-3


#: Of a law in double precision that should be the definition itself.
EXACT = Tolerances(1e-10, 1e-5)


@dataclass(frozen=True)
class Judgement:
    """The checks of a law, the defects that explain what is broken, and what could not be judged."""

    bond: MixedBond
    cases: tuple[Case, ...]
    checks: tuple[Check, ...]
    defects: tuple[Defect, ...]
    remarks: tuple[str, ...]
    compared: bool = True

    @property
    def toughness(self) -> dict[float, float]:
        """Mode ratio by energy -> work to failure, where the path did not end before."""
        ways = {case.way.ratio: case.whole for case in self.cases if case.way.ratio is not None}
        return {B: ways[B][1].work(ways[B][0]) for B in sorted(ways) if _failed(ways[B])}

    @property
    def passed(self) -> bool:
        return not self.broken

    @property
    def broken(self) -> list[Check]:
        """Those furthest beyond their tolerance first."""
        return worst_first(check for check in self.checks if not check.passed)

    def record(self, scene: str, law: str) -> dict[str, Any]:
        """The content of ``law.json``, for other programs, with the names of the scene and of the law."""
        of_check = ("subject", "name", "value", "tolerance", "kind", "meaning")
        of_defect = ("name", "path", "error_with", "error_without", "what")

        def told(one: object, names: Sequence[str]) -> dict[str, Any]:
            return {name: getattr(one, name) for name in names}

        return {
            "scene": scene,
            "law": law,
            "passed": self.passed,
            "counts": asdict(counted(self.checks)),
            "checks": [{"scene": scene, **told(check, of_check), **of_state(check)} for check in self.checks],
            "compared": self.compared,
            "toughness": [{"mode_ratio": B, "work": G} for B, G in self.toughness.items()],
            "defects": [told(one, of_defect) for one in self.defects],
            "remarks": list(self.remarks),
            "bond": asdict(self.bond),
            "paths": {case.way.name: {"steps": case.way.g.size, "what": case.way.what} for case in self.cases},
            "version": __version__,
        }


def _failed(far: Far) -> bool:
    """Whether no more than a `Tolerances.tractions` of the work can be missing; of no numbers nothing is missing."""
    return not unfinished(far) > Tolerances.tractions


def worst_first(checks: Iterable[Check]) -> list[Check]:
    """Broken checks first, those furthest beyond their tolerance at the top."""
    return sorted(checks, key=lambda check: (check.passed, -abs(check.value) / (check.tolerance or 1.0)))


def judge(
    bond: MixedBond,
    ways: Sequence[JumpPath],
    given: Mapping[str, Answer],
    limits: Tolerances | None = None,
    far: Mapping[str, Far] | None = None,
    compared: bool = True,
) -> Judgement:
    """The verdict on tractions ``given`` on the paths ``ways`` of a bond, and on longer ones to failure, ``far``.

    Where it is not ``compared`` with a definition, what any law keeps is judged alone.
    """
    limits, far = limits or Tolerances(), far or {}
    cases, checks = list[Case](), list[Check]()
    for way in ways:
        own, other = given[way.name], given.get(OPPOSITES.get(way.name, ""))
        case = Case(bond, way, own, of_bond(bond, way) if compared else own, other, far.get(way.name))
        cases.append(case)
        of_a_gap = 4.0 * max(*bond.slopes, bond.penalty) * np.abs(way.g).max() / min(bond.strength)
        allowed = {"tangent": limits.tangent, "continuity": max(limits.tractions, of_a_gap)}
        kinds: dict[Kind, Iterable[Finding]] = {"analytical": _of_the_definition(case) if compared else ()}
        for kind, findings in (kinds | {"exact": _of_any_law(case)}).items():
            for name, value, text in findings:
                limit = allowed.get(name, limits.tractions)
                checks.append(Check(name, way.name, float(value), limit, kind, text))
    found = defects(cases, limits.tractions) if compared else ()
    return Judgement(bond, tuple(cases), tuple(checks), found, tuple(_remarks(bond, cases, compared)), compared)


def _of_the_definition(case: Case) -> Iterator[Finding]:
    """What follows from the numbers of the bond."""
    bond, way, given, known = case.bond, case.way, case.given, case.known
    text = f"Largest distance of the tractions from the definition, {IN_PARTS}."
    yield "reference", case.apart(given, known)[1], text
    if way.ratio is not None:
        at, root = f"{100.0 * way.ratio:g} % of the energy in sliding", np.sqrt(bond.slopes)[:, None]
        if _failed(case.whole):
            along, answer = case.whole
            more = answer.work(along) - (known if along is way else of_bond(bond, along)).work(along)
            text = f"Work to failure over the criterion's toughness, {at}."
            yield "toughness", more / float(bond.critical(way.ratio)), text
        peak, right = (np.hypot(*(one.tractions / root)).max() for one in (given, known))  # (1 - d) lambda
        text = f"Peak of the tractions in the energy norm, where damage begins, {at}."
        yield "strength", peak / right - 1.0, text
    if way.name in PRESSURES:
        more = np.trapezoid(given.t - known.t, way.s)
        text = "Work of sliding under pressure, over the toughness of mode II, which pressure does not change."
        yield "compressed-toughness", more / bond.toughness[1], text
        more = np.abs(given.t).max() - np.abs(known.t).max()
        text = "Largest shear traction under pressure, over the shear strength."
        yield "compressed-strength", more / bond.strength[1], text
    closed = way.g < -1e-6 * np.abs(way.g).max()
    if bond.contact and closed.any() and not way.name.startswith("closed-"):
        off = np.abs(given.p[closed] / (bond.penalty * way.g[closed]) - 1.0)
        yield "contact", off.max(), "Contact traction over penalty times g: damage does not weaken it."


def _of_any_law(case: Case) -> Iterator[Finding]:
    """What every law of this kind keeps; with viscosity not where a path rests or returns, as damage goes on there."""
    bond, name, (g, s), tractions = case.bond, case.way.name, case.way.jump, case.given.tractions
    p, t = tractions
    strengths = np.array(bond.strength)[:, None]
    if name.startswith("unload-reload") and not bond.viscosity:
        size = np.hypot(g, s)
        turn = int(np.argmax(np.diff(size) < 0.0))
        back = turn + 1 + int(np.argmax(size[turn + 1 :] >= size[turn] * (1.0 - 1e-12)))
        within = tractions[:, turn : back + 1]
        off = (within - size[turn : back + 1] / size[turn] * within[:, :1]) / strengths
        text = f"Tractions on unloading and reloading, off the line through the origin, {IN_PARTS}."
        yield "unloading", np.abs(off).max(), text
    if name != "turned-frame":  # the work of a step less the growth of (p g + t s) / 2, with linear tractions along it
        lost = 0.5 * (p[:-1] * g[1:] - p[1:] * g[:-1] + t[:-1] * s[1:] - t[1:] * s[:-1])
        if bond.friction:  # the energy stored by friction does not follow from its traction
            lost = lost[(g[1:] >= 0.0) & (g[:-1] >= 0.0)]
        text = "Largest energy that a step gains by damage that heals, over the toughness of mode I."
        yield "dissipation", max(0.0, -lost.min(initial=0.0)) / bond.toughness[0], text
    if name.startswith("closed-") and not bond.viscosity:
        jump = np.diff(t[1:])[np.diff(s[1:]) == 0.0]
        text = f"Jump of the tractions between faces just closed and just open, sliding, {IN_PARTS}."
        yield "continuity", max(np.abs(jump).max() / bond.strength[1], np.abs(p).max() / bond.strength[0]), text
    if name == "zero":
        yield "rest", np.abs(tractions / strengths).max(), f"Tractions where next to nothing moves, {IN_PARTS}."
    if case.opposite is not None:
        off = (tractions - case.opposite.tractions * [[1.0], [-1.0]]) / strengths
        text = f"Against the path of the opposite slip: p is even and t is odd in the slip, {IN_PARTS}."
        yield "odd-in-slip", np.abs(off).max(), text
    if (deviation := _tangent(case)) is not None:
        how = "the law" if case.given.differences is not None else "tractions along the path"
        yield "tangent", deviation, f"Tangent against differences of {how}, over the initial stiffness."


def _tangent(case: Case) -> float | None:
    """Deviation of the tangent from differences; None where there is nothing to judge.

    The scales are the stiffness of opening, of sliding, and their geometric mean, or the tangent itself where that is
    larger, as in contact.
    """
    tangent, differences, root = case.given.tangent, case.given.differences, np.sqrt(case.bond.slopes)
    if tangent is None:
        return None
    scale = np.maximum(np.outer(root, root), np.abs(tangent))
    return _along(case, tangent, scale) if differences is None else _at_points(differences, tangent, scale)


def _at_points(differences: np.ndarray, tangent: np.ndarray, scale: np.ndarray) -> float | None:
    """From differences, central or, at a kink too small to be told, of one side, with the step size that fits best, at
    steps that are not at a kink."""
    (forward, backward), scale = np.moveaxis(differences, 2, 0), scale[:, None]
    bent = (np.abs(forward - backward) / scale).max(axis=(-2, -1)).min(axis=1)  # NaN without differences
    quotients = np.stack([0.5 * (forward + backward), forward, backward])[:, bent <= KINK]
    off = (np.abs(quotients - tangent[bent <= KINK, None]) / scale[bent <= KINK]).max(axis=-2).min(axis=0).max(axis=-1)
    return float(off.min(axis=1).max()) if off.size else None


def _along(case: Case, tangent: np.ndarray, scale: np.ndarray) -> float | None:
    """The mean of both tangents times the change of the jump, from the change of the tractions, on straight parts.

    The steps with the largest deviations are left out, as they are at kinks.
    """
    step, change = np.diff(case.way.jump).T, np.diff(case.given.tractions).T
    mean, scale = (0.5 * (one[1:] + one[:-1]) for one in (tangent, scale))
    left = np.abs(change - np.einsum("nij,nj->ni", mean, step))
    size = np.einsum("nij,nj->ni", scale, np.abs(step))
    ahead, aside = (step[1:] * step[:-1]).sum(axis=1), np.linalg.det(np.stack([step[1:], step[:-1]], axis=1))
    through = (ahead > 0.0) & (np.abs(aside) <= 1e-6 * ahead)  # whether the path goes straight through a step
    inside = np.append(False, through) & np.append(through, False)
    if inside.sum() < 4:
        return None
    found = (left[inside] / np.maximum(size[inside], np.finfo(float).tiny)).max(axis=1)
    return float(np.sort(found)[int(NOT_AT_KINKS * (found.size - 1))])


def _remarks(bond: MixedBond, cases: Sequence[Case], compared: bool) -> Iterator[str]:
    for name, left in ((case.way.name, unfinished(case.whole)) for case in cases if case.way.ratio is not None):
        if left > Tolerances.tractions:
            yield (
                f"the path {name} ended before failure: its last tractions would do {100.0 * left:.2g} % of the work "
                "on as long a way again; its toughness is not judged"
            )
    if not compared:
        yield NOT_COMPARED
    elif any(case.way.s.any() for case in cases):
        yield from (*inconsistent(bond), *off_criterion(bond))
    if bond.viscosity and compared:
        yield "energies and peaks are held against the definition with its viscosity, not against the criterion"
    if bond.friction and compared:
        yield "work under pressure contains friction, and is held against that of the definition"
    if all(case.given.tangent is None for case in cases):
        yield "no tangent is given: none is judged"


def inconsistent(bond: MixedBond) -> Iterator[str]:
    """A sentence where the shear stiffness is not ``K (G_I / G_II) (t_max / p_max)^2`` (Turon et al. 2010), with the
    energy per area that is released on opening to the middle of the law and sliding from there to failure."""
    (K, Ks), (G_I, G_II), (p, t) = bond.slopes, bond.toughness, bond.strength
    consistent = K * G_I / G_II * (t / p) ** 2
    if bond.law == "exponential" or abs(Ks / consistent - 1.0) < OTHER_STIFFNESS:
        return
    half, end, part = G_I / p, 4.0 * max(G_I, G_II) / min(p, t), np.linspace(0.0, 1.0, 20_001)
    g, s = half * np.append(part, np.ones(20_000)), end * np.append(np.zeros(20_001), part[1:])
    plain = replace(bond, viscosity=0.0, friction=0.0)
    found, right = (replace(plain, stiffness=(K, one)).path(g, s).released[-1] for one in (Ks, consistent))
    yield (
        f"the shear stiffness is {Ks / consistent:.3g} of the consistent one, so that the same damage means different "
        f"things in opening and sliding: opened half way and then slid to failure, the bond takes up {found:.6g}, with "
        f"the consistent one {right:.6g} ({found / right - 1.0:+.1%})"
    )
