"""Statements of the paper about its figures, and further expectations, each tested by the runs."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from itertools import pairwise
from math import isfinite, nan
from typing import Any

import numpy as np

from verify.checks.identities import ANGLE_TOLERANCE
from verify.checks.mechanics.j_integral import J_TOLERANCE, j_deviation
from verify.checks.mechanics.peel_growth import growing, growth_angle
from verify.curves.curve import PROPAGATION, Curve, curve_error, load_at, peak
from verify.curves.of_run import peak_load
from verify.methods.zone_resolution import ENOUGH
from verify.result import Result
from verify.scene.schema import Scene
from verify.studies.paper.plan import BEAMS, BONDS, PAPER_LAWS, Case
from verify.studies.paper.statement import (
    CONVERGENCE,
    J_INTEGRAL,
    LIMIT,
    PAPER,
    READING,
    THEORY,
    Comparison,
    Statement,
    each,
)
from verify.studies.paper.study import Study, apart, curve

#: Relative L2 distance of curves below which they coincide within the line width of a figure.
VISIBLE = 0.01

PLURALS = {"tspline": "T-splines", "nurbs": "NURBS", "lagrange": "Lagrange elements"}

#: Measure of a trial -> its name, and the comparative for a basis with a smaller value.
MEASURES = {"error": ("curve distance", "closer to the converged curve"), "oscillation": ("oscillation", "smoother")}

#: Comparisons: subject, the run that is expected to be better, the other run.
Pairs = list[tuple[str, Case, Case]]


def statements(study: Study) -> tuple[Statement, ...]:
    """All statements, those of the paper first and in its order."""
    if not study.trials:
        return ()
    return tuple(_of_beams(study) if study.figures is BEAMS else _of_strips(study))


def lines(title: str, study: Study) -> list[str]:
    """One line per statement for the terminal, or the reason why there are none."""
    if study.left_out:
        return [f"{title} of the paper: {study.left_out}"]
    return [f"{s.verdict:18} {s.text}: {s.extent}" for s in statements(study)]


def _of_beams(study: Study) -> Iterator[Statement]:
    coarse, _ = _ends(study, "dofs")
    law = next(iter(PAPER_LAWS))
    said = f"{coarse} unknowns just resolve the process zone of {PAPER_LAWS[law]}: 1 to {ENOUGH} elements in it"
    zones = [(PLURALS[case.basis], n) for case, n in study.zones.items() if (case.scene, case.dofs) == (law, coarse)]
    yield each((said, "elements in the zone"), "number", zones, lambda n: 1.0 <= n < ENOUGH)
    for better, worse in pairwise(PLURALS):
        for measure in MEASURES:
            yield from _rankings(study, better, worse, measure)
    yield _strength(study)
    for basis in list(PLURALS)[1:]:
        for measure in MEASURES:
            yield _points_help(study, basis, measure)
    yield _points_idle(study, next(iter(PLURALS)))
    yield _penalty(study)
    for measure in MEASURES:
        yield _refinement(study, measure)
    yield _beams_coincide(study)


def _rankings(study: Study, better: str, worse: str, measure: str) -> Iterator[Statement]:
    """For the runs of Figures 6 and 7, and for all runs, with those of Figure 8 and of the other penalty."""
    few, many = _ends(study, "points")
    every = _cases(study, basis=better)
    paper = [case for case in every if case.of_the_paper]
    span = f"stay {{}} than {{}} with {few} to {many} points"
    for text, cases, names in (
        ("are {} than {} at equal unknowns", paper, ("law", "dofs")),
        (span, every, ("law", "dofs", "points", "penalty")),
    ):
        yield _ranking(study, text, measure, _pairs(study, cases, {"basis": worse}, *names), (better, worse))


def _strength(study: Study) -> Statement:
    weak, strong = PAPER_LAWS
    cases = [case for case in _cases(study, scene=weak) if case.of_the_paper]
    pairs = _pairs(study, cases, {"scene": strong}, "basis", "dofs")
    said = "More strength, more oscillation", f"oscillation with {PAPER_LAWS[strong]} over that with {PAPER_LAWS[weak]}"
    return _ratios(study, said, "oscillation", pairs)


def _points_help(study: Study, basis: str, measure: str) -> Statement:
    few, many = _ends(study, "points")
    name, adjective = MEASURES[measure]
    cases = _cases(study, basis=basis, points=many) if many > few else []
    said = f"More interface points make {PLURALS[basis]} {adjective}", f"{name} with {few} points over that with {many}"
    return _ratios(study, said, measure, _pairs(study, cases, {"points": few}, "law", "dofs", "penalty"))


def _points_idle(study: Study, basis: str) -> Statement:
    few, _ = _ends(study, "points")
    cases = [case for case in _cases(study, basis=basis) if case.points > few]
    off = _distances(study, _pairs(study, cases, {"points": few}, "law", "dofs", "points", "penalty"))
    said = f"More interface points hardly change {PLURALS[basis]}: less than {VISIBLE:.0%}"
    return each((said, f"distance of the curve to that with {few} points"), "fraction", off, _unseen)


def _penalty(study: Study) -> Statement:
    """For every basis, and for the converged curves, whose distance is the influence on the problem itself."""
    low, high = _ends(study, "penalty")
    cases = _cases(study, penalty=low) if high > low else []
    off = _distances(study, _pairs(study, cases, {"penalty": high}, "basis", "law", "dofs", "points"))
    for law, name in PAPER_LAWS.items() if high > low else ():
        a, b = (study.references.get((law, penalty)) for penalty in (low, high))
        off += [(f"converged curve, {name}", curve_error(curve(a.result), curve(b.result)))] if a and b else []
    said = f"The penalty has no visible influence: less than {VISIBLE:.0%}"
    return each((said, f"distance of the curves with {low:g} and {high:g}"), "fraction", off, _unseen)


def _refinement(study: Study, measure: str) -> Statement:
    coarse, fine = _ends(study, "dofs")
    name, adjective = MEASURES[measure]
    cases = [case for case in _cases(study, dofs=fine) if case.of_the_paper and fine > coarse]
    said = (
        f"{fine} unknowns instead of {coarse} make every basis {adjective}",
        f"{name} with {coarse} over that with {fine}",
    )
    return _ratios(study, said, measure, _pairs(study, cases, {"dofs": coarse}, "basis", "law"), CONVERGENCE)


def _beams_coincide(study: Study) -> Statement:
    _, fine = _ends(study, "dofs")
    trials = [t for t in study.trials if t.case.of_the_paper and t.case.dofs == fine]
    found = [(_where(study, trial.case, "basis", "law"), trial.error) for trial in trials]
    said = f"With {fine} unknowns every basis draws the converged curve: less than {VISIBLE:.0%} off"
    return each((said, "curve distance"), "fraction", found, _unseen, CONVERGENCE)


def _of_strips(study: Study) -> Iterator[Statement]:
    for better, worse in pairwise(PLURALS):
        pairs = _pairs(study, [Case(better, bond) for bond, _ in study.references], {"basis": worse}, "bond")
        for measure in MEASURES:
            yield _ranking(study, "are {} than {} at equal unknowns", measure, pairs, (better, worse))
    found = [(_where(study, trial.case, "basis", "bond"), trial.error) for trial in study.trials]
    said = f"Every basis draws the converged curve: less than {VISIBLE:.0%} off"
    yield each((said, "curve distance"), "fraction", found, _unseen, CONVERGENCE)
    zones = [(_where(study, case, "basis", "bond"), n) for case, n in study.zones.items()]
    said = f"The meshes resolve the process zone: {ENOUGH} elements or more in it"
    yield each((said, "elements in the zone as measured"), "number", zones, lambda n: n >= ENOUGH, READING)
    printed = [(PLURALS[basis], n) for basis, n in study.printed.items()]
    said = f"With the moduli as printed, in MPa, they do not: fewer than {ENOUGH} elements"
    yield each((said, "elements in the zone as expected"), "number", printed, lambda n: n < ENOUGH, READING)
    yield from _peaks(study)
    yield _one_branch(study)
    yield from _growth(study)


def _peaks(study: Study) -> Iterator[Statement]:
    """The peak load is inversely proportional to the lever arm, the free length a: P = sqrt(2 G w E I) / a.

    The compliance of the substrate and a finite strength make the effective length larger than a.
    """
    peaks = {(name, bond): peak_load(result) for name, bond, result in study.complete_runs()}
    known = [
        (f"{_name(name)}, bond {study.bond(longer):g} over {study.bond(shorter):g}", peaks[name, longer] / shorter_peak)
        for name in (*PLURALS, "converged")
        for shorter, longer in pairwise(BONDS)
        if (name, longer) in peaks and (shorter_peak := peaks.get((name, shorter)))
    ]
    said = "A longer bond gives a larger peak load, as it leaves a shorter lever arm"
    yield each((said, "peak load over that of the next shorter bond"), "ratio", known, lambda more: more > 1.0, THEORY)
    limits = {bond: peak(limit)[1] for bond, limit in study.limits.items()}
    parts = [(_of(study, name, bond), top / limits[bond]) for (name, bond), top in peaks.items()]
    said = "The peak load stays below that of a clamped plate, sqrt(2 G_Ic w E I) / a"
    yield each((said, "peak load over the limit"), "ratio", parts, lambda part: part < 1.0, LIMIT)


def _one_branch(study: Study) -> Statement:
    """For every basis: the curves on the propagation branch against that with the longest bond, as the crack is at the
    same place there."""
    curves = {(name, bond): curve(result) for name, bond, result in study.complete_runs()}
    longest = next((bond for bond in reversed(BONDS) if bond in study.scenes), "")
    off = [
        (_of(study, name, bond), branch_distance(one, curves[name, longest]) if (name, longest) in curves else nan)
        for (name, bond), one in curves.items()
        if bond != longest
    ]
    said = f"All bonds share one propagation branch: less than {VISIBLE:.0%} apart"
    return each((said, "distance of the branch to that of the longest bond"), "fraction", off, _unseen, THEORY)


def branch_distance(one: Curve, other: Curve) -> float:
    """Relative L2 distance of two curves where both are on their propagation branch; NaN if they never are."""
    begin = PROPAGATION * max(peak(one)[0], peak(other)[0])
    end = min(float(np.max(one[0])), float(np.max(other[0])))
    if not end > begin:
        return nan
    grid = np.linspace(begin, end, 401)[:-1]
    wanted = load_at(other, grid)
    return float(np.sqrt(np.sum((load_at(one, grid) - wanted) ** 2) / np.sum(wanted**2)))


def _growth(study: Study) -> Iterator[Statement]:
    found = [(_of(study, *run), identities(study.scenes[run[1]], result)) for *run, result in study.complete_runs()]
    load, angle = ([(who, known[name]) for who, known in found] for name in ("load", "angle"))
    said = "While the crack grows the load never falls below G_Ic w", "least load over G_Ic w"
    yield each(said, "ratio", load, lambda part: part >= 1.0 - J_TOLERANCE, J_INTEGRAL)
    text = f"In the end load sin(theta) is G_Ic w: within {ANGLE_TOLERANCE:.0%}"
    said = text, "load sin(theta) over G_Ic w at the last step"
    yield each(said, "ratio", angle, lambda part: abs(part - 1.0) <= ANGLE_TOLERANCE, J_INTEGRAL)


def identities(scene: Scene, result: Result) -> dict[str, float]:
    """During crack growth: deviation of J, least load over G_Ic w, and final load sin(theta) over G_Ic w."""
    j, angle, steady = j_deviation(scene, result.steps), growth_angle(scene, result.steps), growing(scene, result.steps)
    least = float(np.min(result.load[steady])) if steady.any() else nan
    return {
        "j": nan if j is None else j,
        "load": least / (scene.interface.toughness * scene.specimen.width),
        "angle": nan if angle is None else 1.0 + angle,
    }


def _ranking(study: Study, text: str, measure: str, pairs: Pairs, bases: tuple[str, str]) -> Statement:
    better, worse = (PLURALS[basis] for basis in bases)
    name, adjective = MEASURES[measure]
    said = f"{better} {text.format(adjective, worse)}", f"{name} of {worse} over that of {better}"
    return _ratios(study, said, measure, pairs)


def _ratios(study: Study, said: tuple[str, str], measure: str, pairs: Pairs, source: str = PAPER) -> Statement:
    """The ratio of a measure, other run over expected better run, for each pair."""
    return Statement(*said, "ratio", tuple(_ratio(study, measure, *pair) for pair in pairs), source)


def _ratio(study: Study, measure: str, subject: str, better: Case, worse: Case) -> Comparison:
    """The ratio of one pair; undecided where the difference is smaller than the error of the reference."""
    low, high = (nan if t is None else getattr(t, measure) for t in map(study.trial, (better, worse)))
    if not (isfinite(low) and isfinite(high)):
        return Comparison(subject, nan, None)
    floor = max(getattr(study.references[case.problem], measure) for case in (better, worse))
    holds = None if abs(high - low) <= floor else high > low
    return Comparison(subject, high / low if low > 0.0 else nan, holds)


def _distances(study: Study, pairs: Pairs) -> list[tuple[str, float]]:
    return [(subject, apart(study.trial(one), study.trial(other))) for subject, one, other in pairs]


def _unseen(distance: float) -> bool:
    return distance < VISIBLE


def _pairs(study: Study, cases: Iterable[Case], other: Mapping[str, Any], *names: str) -> Pairs:
    """Every case and the case with ``other`` values; the subject consists of the fields ``names``."""
    return [(_where(study, case, *names), case, replace(case, **other)) for case in cases]


def _cases(study: Study, **fixed: object) -> list[Case]:
    cases = (trial.case for trial in study.trials)
    return [case for case in cases if all(getattr(case, name) == value for name, value in fixed.items())]


def _ends(study: Study, name: str) -> tuple[Any, Any]:
    """Smallest and largest value of a field of the cases."""
    values = study.values(name)
    return min(values), max(values)


def _where(study: Study, case: Case, *names: str) -> str:
    words = {
        "basis": _name(case.basis),
        "law": PAPER_LAWS.get(case.scene),
        "bond": f"bond {study.bond(case.scene):g}",
        "dofs": f"{case.dofs} unknowns",
        "points": f"{case.points} points",
        "penalty": f"penalty {case.penalty:g}",
    }
    return ", ".join(str(words[name]) for name in names)


def _of(study: Study, name: str, bond: str) -> str:
    return f"{_name(name)}, bond {study.bond(bond):g}"


def _name(basis: str) -> str:
    return PLURALS.get(basis, "converged curve")
