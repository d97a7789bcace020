"""Where curves disagree: the run that agrees with no other, while the others agree with each other."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations

import numpy as np

from verify.checks.between_codes import CODE_TOLERANCE, CROSS_CODE, distance
from verify.checks.orders import ARMS, ARMS_SECOND, BEAM_RUN
from verify.checks.proof import LIMIT_METHODS, MATCHED, NOTHING, REFERENCE, RUNS, SECOND, Proof, proof, sampled
from verify.curves.leg_checks import programme_checks
from verify.methods.second_meshes import SECONDS, SINGLE
from verify.result import Result
from verify.scene.schema import Scene
from verify.verdict import Check

#: The code of every run. Agreement of different codes counts more than agreement of bases of one code.
CODE_OF_RUN = {name: method.code for name, method in RUNS.items()} | {SECOND: RUNS[REFERENCE].code}
#: The sentences of this module begin with this, so that they can be found among remarks.
ODD = "odd one out"
#: And so where no run is outside the group that is taken to be right.
NOT_BY_MUCH = f"{ODD}, though not by much"
#: Runs with fixed pairs of interface points.
FIXED_PAIRS = {MATCHED, REFERENCE, SECOND, BEAM_RUN, ARMS}
#: Distance within which two runs agree.
AGREE = CODE_TOLERANCE


def odd_one_out(scene: Scene, checks: Sequence[Check], results: Mapping[str, Result]) -> tuple[str, ...]:
    """A sentence that names the odd one out where a check of two curves is not passed; else empty.

    Where none is broken, runs that agree within the errors of their meshes are not told apart.

    Parameters
    ----------
    results : the runs of the scene, by name
    """
    pairs = [check.subject.split(" / ") for check in checks if not check.passed and " / " in check.subject]
    left_out = LIMIT_METHODS | {*SECONDS.values(), SINGLE, ARMS_SECOND} - {SECOND}
    left_out |= {BEAM_RUN} if ARMS in results else set()  # plane arms take the place of beam theory
    usable = {name: run for name, run in results.items() if run.load.size > 1}
    compared = {name: run for name, run in usable.items() if name not in left_out}
    if not pairs or len(compared) < 2 or max(scene.load.opening) <= 0.0:
        return ()
    programme = scene.load.opening
    said = odd_one(compared, programme, proof(usable, programme))
    broken = any(check.state == "broken" and " / " in check.subject for check in checks)
    return (said,) if broken or not said.startswith(NOT_BY_MUCH) else ()


def odd_one(results: Mapping[str, Result], programme: Sequence[float], known: Proof | None = None) -> str:
    """A sentence that names the runs which no other code confirms.

    Two runs agree if their distance is at most `AGREE`, plus the difference of models where only one of them has fixed
    pairs of points, and on the legs of a programme plus the errors of their meshes. Chains of agreement form groups.
    The group with the most codes, then with the most runs, is taken to be right; runs outside it are odd, unless they
    are within their own tolerance of it. Where the two largest groups are equal, or all runs form one group, the run
    with the largest mean distance is named.

    Parameters
    ----------
    results : runs to compare, by name
    programme : openings at which the load turns, and the last one; legs count as well as the envelope
    known : change of the curve by fixed pairs of points, and errors of the meshes
    """
    known = known or Proof(NOTHING, NOTHING)
    apart = {frozenset(pair): _distance(results, pair, programme, known) for pair in combinations(results, 2)}
    ranked = sorted(_groups(list(results), {pair for pair, far in apart.items() if far <= AGREE}), key=_weight)[::-1]
    main = ranked[0]
    if len(ranked) > 1 and _weight(main) > _weight(ranked[1]):
        nearest = {name: min(apart[frozenset((name, one))] for one in main) for name in results if name not in main}
        odd = {name: far for name, far in nearest.items() if far > CROSS_CODE.get(name, AGREE) and name != SECOND}
        if odd:
            inside = max((apart[frozenset(pair)] for pair in combinations(main, 2)), default=0.0)
            confirmed = f"{_listed(main)}, which agree within {inside:.2%}" if len(main) > 1 else main[0]
            return f"{ODD}: {_listed(list(odd))}, {min(odd.values()):.2%} or more from {confirmed}"
    mean = {name: float(np.mean([far for pair, far in apart.items() if name in pair])) for name in results}
    far = max(mean, key=lambda name: mean[name])
    rest = float(np.mean([mean[name] for name in results if name != far]))
    return f"{NOT_BY_MUCH}: {far}, on average {mean[far]:.2%} from the other runs, those {rest:.2%}"


def _distance(results: Mapping[str, Result], pair: tuple[str, str], programme: Sequence[float], known: Proof) -> float:
    """Distance of the second run to the first, less the difference of their models; infinite instead of NaN."""
    first, second = (results[name] for name in pair)
    with np.errstate(all="ignore"):  # a curve of another code may be zero
        envelopes = distance(second, first, max(programme))
        found = programme_checks("", sampled(second), sampled(first), programme, 1.0)
    legs = [leg for leg in found if leg.name.startswith("curve-leg")]
    beyond = [leg.value - sum(known.errors(pair, leg).values()) for leg in legs if not np.isnan(leg.value)]
    far = max(envelopes, *beyond, 0.0) - known.models["curve"] * (len(FIXED_PAIRS & set(pair)) == 1)
    return max(0.0, far) if np.isfinite(far) else np.inf


def _groups(names: Sequence[str], agree: set[frozenset[str]]) -> list[list[str]]:
    groups: list[list[str]] = []
    for name in names:
        near = [group for group in groups if any(frozenset((name, other)) in agree for other in group)]
        groups = [group for group in groups if group not in near] + [[one for group in near for one in group] + [name]]
    return groups


def _weight(group: Sequence[str]) -> tuple[int, int]:
    return len({CODE_OF_RUN.get(name, name) for name in group}), len(group)


def _listed(group: Sequence[str]) -> str:
    return f"{', '.join(group[:-1])} and {group[-1]}" if len(group) > 1 else group[0]
