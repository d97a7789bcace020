"""What is stated about Figure 9, each statement with its source and the verdict of the runs."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import pairwise
from math import isfinite, nan

from verify.checks.identities import ANGLE_TOLERANCE
from verify.checks.mechanics.j_integral import J_TOLERANCE
from verify.curves.curve import peak
from verify.methods.zone_resolution import ENOUGH
from verify.studies.paper.comparison import VISIBLE, Comparison, Statement, below, ratio
from verify.studies.paper.peel import BONDS, PeelCase, PeelStudy, branch_distance, identities, runs
from verify.studies.paper.statements import MEASURES, NAMES, REFINEMENT
from verify.studies.paper.study import curve, peak_load

#: Sources besides the paper, whose text does not give numbers for this figure.
READING, BEAM, J, LIMIT = "moduli read as GPa", "beam theory", "the J-integral", "LEFM, plate limit"

_CONVERGED = "converged"


def statements(study: PeelStudy) -> tuple[Statement, ...]:
    """All of them, the paper's first."""
    return tuple(_all(study)) if study.trials else ()


def _all(study: PeelStudy) -> Iterator[Statement]:
    for better, worse in pairwise(NAMES):
        for measure in MEASURES:
            yield _ranking(study, better, worse, measure)
    yield _coincide(study)
    yield _resolved(study)
    yield _printed(study)
    yield _longer(study)
    yield _below_the_limit(study)
    yield _one_branch(study)
    yield _least_load(study)
    yield _angle(study)


def _ranking(study: PeelStudy, better: str, worse: str, measure: str) -> Statement:
    name, adjective = MEASURES[measure]
    return Statement(
        f"{NAMES[better]} are {adjective} than {NAMES[worse]} at equal unknowns",
        f"{name} of {NAMES[worse]} over that of {NAMES[better]}",
        "ratio",
        tuple(
            ratio(study, case, replace(case, basis=worse), measure, _bond(study, bond))
            for bond in study.references
            for case in [PeelCase(better, bond)]
        ),
    )


def _coincide(study: PeelStudy) -> Statement:
    return Statement(
        f"Every basis draws the converged curve: less than {VISIBLE:.0%} off",
        "curve distance",
        "fraction",
        tuple(Comparison(_where(study, t.case), t.error, below(t.error)) for t in study.trials),
        REFINEMENT,
    )


def _resolved(study: PeelStudy) -> Statement:
    found = [(PeelCase(*key), n) for key, n in study.zones.items()]
    return Statement(
        f"The meshes resolve the process zone: {ENOUGH} elements or more in it",
        "elements in the zone as measured",
        "number",
        tuple(Comparison(_where(study, case), n, bool(n >= ENOUGH) if isfinite(n) else None) for case, n in found),
        READING,
    )


def _printed(study: PeelStudy) -> Statement:
    return Statement(
        f"With the moduli as printed, in MPa, they do not: fewer than {ENOUGH} elements",
        "elements in the zone as expected",
        "number",
        tuple(Comparison(NAMES[basis], n, bool(n < ENOUGH)) for basis, n in study.printed.items()),
        READING,
    )


def _longer(study: PeelStudy) -> Statement:
    """The shorter the free length, the shorter the lever arm: P = sqrt(2 G w E I) / a."""
    peaks = {(name, bond): peak_load(result) for name, bond, result in runs(study)}
    return Statement(
        "A longer bond gives a larger peak load, as it leaves a shorter lever arm",
        "peak load over that of the next shorter bond",
        "ratio",
        tuple(
            Comparison(f"{_name(name)}, bond {study.length(longer):g} over {study.length(shorter):g}", more, more > 1.0)
            for name in (*NAMES, _CONVERGED)
            for shorter, longer in pairwise(BONDS)
            if {(name, shorter), (name, longer)} <= set(peaks)
            for more in [peaks[name, longer] / peaks[name, shorter]]
        ),
        BEAM,
    )


def _below_the_limit(study: PeelStudy) -> Statement:
    """A substrate that gives way and an interface of finite strength make the strip longer than its free length."""
    limits = {bond: peak(found)[1] for bond, found in study.limits.items()}
    found = [(name, bond, peak_load(result) / limits[bond]) for name, bond, result in runs(study)]
    return Statement(
        "The peak load stays below that of a clamped plate, sqrt(2 G_Ic w E I) / a",
        "peak load over the limit",
        "ratio",
        tuple(Comparison(f"{_name(name)}, {_bond(study, bond)}", part, part < 1.0) for name, bond, part in found),
        LIMIT,
    )


def _one_branch(study: PeelStudy) -> Statement:
    """Of every basis against its own curve with the longest bond: the crack is at the same place there."""
    found = {(name, bond): result for name, bond, result in runs(study)}
    longest = next((bond for bond in reversed(BONDS) if bond in study.scenes), "")
    apart = [
        (name, bond, branch_distance(curve(result), curve(found[name, longest])) if (name, longest) in found else nan)
        for (name, bond), result in found.items()
        if bond != longest
    ]
    return Statement(
        f"All bonds share one propagation branch: less than {VISIBLE:.0%} apart",
        "distance of the branch to that of the longest bond",
        "fraction",
        tuple(Comparison(f"{_name(name)}, {_bond(study, bond)}", off, below(off)) for name, bond, off in apart),
        BEAM,
    )


def _least_load(study: PeelStudy) -> Statement:
    text = "While the crack grows the load never falls below G_Ic w"
    return _identity(study, "load", text, "least load over G_Ic w", lambda part: part >= 1.0 - J_TOLERANCE)


def _angle(study: PeelStudy) -> Statement:
    text = f"In the end load sin(theta) is G_Ic w: within {ANGLE_TOLERANCE:.0%}"
    measure = "load sin(theta) over G_Ic w at the last step"
    return _identity(study, "angle", text, measure, lambda part: abs(part - 1.0) <= ANGLE_TOLERANCE)


def _identity(study: PeelStudy, name: str, text: str, measure: str, holds: Callable[[float], bool]) -> Statement:
    found = [(who, bond, identities(study.scenes[bond], result)[name]) for who, bond, result in runs(study)]
    return Statement(
        text,
        measure,
        "ratio",
        tuple(
            Comparison(f"{_name(who)}, {_bond(study, bond)}", value, holds(value) if isfinite(value) else None)
            for who, bond, value in found
        ),
        J,
    )


def _name(basis: str) -> str:
    return NAMES.get(basis, "converged curve")


def _bond(study: PeelStudy, bond: str) -> str:
    return f"bond {study.length(bond):g}"


def _where(study: PeelStudy, case: PeelCase) -> str:
    return f"{NAMES[case.basis]}, {_bond(study, case.bond)}"
