"""What the paper states about its Figures 6, 7 and 8, each statement with the verdict of the runs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise
from math import isfinite

from verify.curves.curve import curve_error
from verify.methods.zone_resolution import ENOUGH
from verify.studies.paper.comparison import VISIBLE, Comparison, Statement, below, ratio, unseen
from verify.studies.paper.plan import LAWS, Case
from verify.studies.paper.study import Study, curve

#: Source of what is expected of a finer mesh, whoever computes on it.
REFINEMENT = "convergence"

NAMES = {"tspline": "T-splines", "nurbs": "NURBS", "lagrange": "Lagrange elements"}

#: Measure of a trial -> its name, and what a basis is that has less of it.
MEASURES = {"error": ("curve distance", "closer to the converged curve"), "oscillation": ("oscillation", "smoother")}


def statements(study: Study) -> tuple[Statement, ...]:
    """All of them, in the order of the paper's argument."""
    return tuple(_all(study)) if study.trials else ()


def _all(study: Study) -> Iterator[Statement]:
    yield _zone(study)
    for better, worse in pairwise(NAMES):
        for measure in MEASURES:
            yield from _ranking(study, better, worse, measure)
    yield _strength(study)
    for basis in list(NAMES)[1:]:
        for measure in MEASURES:
            yield _points_help(study, basis, measure)
    yield _points_idle(study, next(iter(NAMES)))
    yield _penalty(study)
    for measure in MEASURES:
        yield _refinement(study, measure)
    yield _coincide(study)


def _ranking(study: Study, better: str, worse: str, measure: str) -> Iterator[Statement]:
    """As in Figures 6 and 7, and over all runs that Figure 8 and the other penalty add."""
    name, adjective = MEASURES[measure]
    few, many = _ends(study, "points")
    ends = {True: f"than {NAMES[worse]} at equal unknowns", False: f"than {NAMES[worse]} with {few} to {many} points"}
    for narrow, verb in ((True, "are"), (False, "stay")):
        names = ("law", "dofs") if narrow else ("law", "dofs", "points", "penalty")
        yield Statement(
            f"{NAMES[better]} {verb} {adjective} {ends[narrow]}",
            f"{name} of {NAMES[worse]} over that of {NAMES[better]}",
            "ratio",
            tuple(
                ratio(study, case, replace(case, basis=worse), measure, _where(case, *names))
                for case in _cases(study, basis=better)
                if case.of_the_paper or not narrow
            ),
        )


def _strength(study: Study) -> Statement:
    weak, strong = LAWS
    return Statement(
        "More strength, more oscillation",
        f"oscillation with {LAWS[strong]} over that with {LAWS[weak]}",
        "ratio",
        tuple(
            ratio(study, case, replace(case, law=strong), "oscillation", _where(case, "basis", "dofs"))
            for case in _cases(study, law=weak)
            if case.of_the_paper
        ),
    )


def _points_help(study: Study, basis: str, measure: str) -> Statement:
    few, many = _ends(study, "points")
    name, adjective = MEASURES[measure]
    return Statement(
        f"More interface points make {NAMES[basis]} {adjective}",
        f"{name} with {few} points over that with {many}",
        "ratio",
        tuple(
            ratio(study, case, replace(case, points=few), measure, _where(case, "law", "dofs", "penalty"))
            for case in _cases(study, basis=basis, points=many)
            if many > few
        ),
    )


def _points_idle(study: Study, basis: str) -> Statement:
    few, _ = _ends(study, "points")
    return Statement(
        f"More interface points hardly change {NAMES[basis]}: less than {VISIBLE:.0%}",
        f"distance of the curve to that with {few} points",
        "fraction",
        tuple(
            unseen(study, case, replace(case, points=few), _where(case, "law", "dofs", "points", "penalty"))
            for case in _cases(study, basis=basis)
            if case.points > few
        ),
    )


def _penalty(study: Study) -> Statement:
    """Of every basis, and of the converged curves: what the problem itself owes to it."""
    low, high = _ends(study, "penalty")
    converged = [
        (law, *(study.references.get((law, penalty)) for penalty in (low, high))) for law in LAWS if high > low
    ]
    true = [(law, curve_error(curve(a.result), curve(b.result))) for law, a, b in converged if a and b]
    return Statement(
        f"The penalty has no visible influence: less than {VISIBLE:.0%}",
        f"distance of the curves with {low:g} and {high:g}",
        "fraction",
        tuple(
            unseen(study, case, replace(case, penalty=high), _where(case, "basis", "law", "dofs", "points"))
            for case in _cases(study, penalty=low)
            if high > low
        )
        + tuple(Comparison(f"converged curve, {LAWS[law]}", apart, below(apart)) for law, apart in true),
    )


def _refinement(study: Study, measure: str) -> Statement:
    coarse, fine = _ends(study, "dofs")
    name, adjective = MEASURES[measure]
    return Statement(
        f"{fine} unknowns instead of {coarse} make every basis {adjective}",
        f"{name} with {coarse} over that with {fine}",
        "ratio",
        tuple(
            ratio(study, case, replace(case, dofs=coarse), measure, _where(case, "basis", "law"))
            for case in _cases(study, dofs=fine)
            if case.of_the_paper and fine > coarse
        ),
        REFINEMENT,
    )


def _coincide(study: Study) -> Statement:
    _, fine = _ends(study, "dofs")
    found = [(case, study.trial(case).error) for case in _cases(study, dofs=fine) if case.of_the_paper]
    return Statement(
        f"With {fine} unknowns every basis draws the converged curve: less than {VISIBLE:.0%} off",
        "curve distance",
        "fraction",
        tuple(Comparison(_where(case, "basis", "law"), error, below(error)) for case, error in found),
        REFINEMENT,
    )


def _zone(study: Study) -> Statement:
    coarse, _ = _ends(study, "dofs")
    law = next(iter(LAWS))
    found = [(basis, n) for (basis, of, dofs), n in study.zones.items() if (of, dofs) == (law, coarse)]
    return Statement(
        f"{coarse} unknowns just resolve the process zone of {LAWS[law]}: 1 to {ENOUGH} elements in it",
        "elements in the zone",
        "number",
        tuple(Comparison(NAMES[basis], n, bool(1.0 <= n < ENOUGH) if isfinite(n) else None) for basis, n in found),
    )


def _cases(study: Study, **fixed: object) -> Iterator[Case]:
    for trial in study.trials:
        if all(getattr(trial.case, name) == value for name, value in fixed.items()):
            yield trial.case


def _ends(study: Study, name: str) -> tuple:
    """Least and largest value of a field of the cases."""
    values = study.values(name)
    return min(values), max(values)


def _where(case: Case, *names: str) -> str:
    words = {
        "basis": NAMES[case.basis],
        "law": LAWS[case.law],
        "dofs": f"{case.dofs} unknowns",
        "points": f"{case.points} points",
        "penalty": f"penalty {case.penalty:g}",
    }
    return ", ".join(words[name] for name in names)
