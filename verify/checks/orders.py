"""Arms of several orders as judges that know their own errors, by each other.

Order 1 is beam theory; displacements of the order 3 through the thickness are those of plane arms. The distance of
order 3 from order 5, on another mesh and with other steps, is its error on the scene, and the distance of order 1 from
order 3 that of beam theory. Every code is held against both, with these errors and that of its own mesh; where all
plane codes and order 3 agree, beam theory is what does not hold.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from verify.checks import load_introduction
from verify.checks.proof import RUNS, sampled
from verify.curves.curve import curve_error, from_origin
from verify.curves.leg_checks import worst_leg
from verify.curves.of_run import onward
from verify.result import Result
from verify.scene.schema import Scene
from verify.verdict import Check

#: Names of runs: order 1, order 3, and order 5 on a second mesh.
BEAM_RUN, ARMS, ARMS_SECOND = "beam", "beam-3", "beam-5"
#: The run by which one of arms knows its error.
NEXT_ORDER = {BEAM_RUN: ARMS, ARMS: ARMS_SECOND}
#: Largest error of a judge.
NO_JUDGE = 0.03
#: Distance of beam theory from plane arms that is said.
SAID = 0.005


@dataclass(frozen=True)
class Judge:
    """A run of arms that judges codes, the name of its check, and its own error (relative, of the curve)."""

    run: str
    check: str
    result: Result
    error: float
    meaning: str


def second_order(scene: Scene) -> tuple[tuple[str, tuple[str, ...]], ...]:
    """Names and overrides of the runs of the orders 3 and 5."""
    return (
        (ARMS, ("beam.order=3",)),
        (ARMS_SECOND, ("beam.order=5", "beam.in_a_zone=6", "discretization.steps=80")),
    )


def judges(scene: Scene, results: Mapping[str, Result]) -> tuple[Judge, ...]:
    """The runs of arms that can judge the codes of a scene."""
    known = errors(results, scene.load.opening)
    if why_none(scene, results):
        return ()
    found = []
    meaning = "The load follows that of plane arms whose displacements are cubic through the thickness"
    if known[ARMS] <= NO_JUDGE:
        own = f"its own error is {100.0 * known[ARMS]:.2g} %, by order 5 on another mesh"
        found.append(Judge(ARMS, "plane-curve", results[ARMS], known[ARMS], f"{meaning} ({_HOW}): {own}."))
    meaning = "The load follows that of a shear-flexible beam on the same law"
    if known.get(BEAM_RUN, NO_JUDGE + 1.0) <= NO_JUDGE:
        own = f"the error of beam theory is {100.0 * known[BEAM_RUN]:.2g} % here, by plane arms"
        found.append(Judge(BEAM_RUN, "beam-curve", results[BEAM_RUN], known[BEAM_RUN], f"{meaning} ({_HOW}): {own}."))
    return tuple(found)


_HOW = "relative L2 over the opening, and of every leg"


def errors(results: Mapping[str, Result], programme: Sequence[float]) -> dict[str, float]:
    """Errors of orders 1 and 3 by their names, where the runs are there and complete."""
    runs = {name: run for name, run in results.items() if name in (BEAM_RUN, ARMS, ARMS_SECOND) and run.complete}
    if not {ARMS, ARMS_SECOND} <= runs.keys():
        return {}
    found = {ARMS: whole(runs[ARMS], runs[ARMS_SECOND], programme)}
    if BEAM_RUN in runs:
        found[BEAM_RUN] = whole(runs[BEAM_RUN], runs[ARMS], programme) + found[ARMS]
    return found


def why_none(scene: Scene, results: Mapping[str, Result]) -> str:
    """Why arms cannot judge a scene; empty where they can."""
    if scene.load.at == "node" and load_introduction.matters(scene):
        return "the load acts at a corner, which deforms locally and moves towards the crack; a beam has no corner"
    for run in (ARMS, ARMS_SECOND):
        if run not in results:
            return f"{run} was not solved, by which the beam knows its error"
        if not results[run].complete:
            return f"{run} {results[run].status}; it judges nothing"
    return ""


def remarks(scene: Scene, results: Mapping[str, Result]) -> tuple[str, ...]:
    """Where arms judge no code, or beam theory does not hold."""
    if BEAM_RUN not in results or not any(RUNS[name].code != BEAM_RUN for name in results if name in RUNS):
        return ()
    if why := why_none(scene, results):
        return (f"beam: held against no code: {why}",)
    known, said = errors(results, scene.load.opening), []
    if known[ARMS] > NO_JUDGE:
        said.append(f"beam: held against no code: its orders 3 and 5 differ by {known[ARMS]:.2g}")
    if not results[BEAM_RUN].complete:
        said.append(f"beam: {results[BEAM_RUN].status}; it judges nothing")
    elif known[BEAM_RUN] > SAID:
        away = f"{100.0 * known[BEAM_RUN]:.2g} % from plane arms of order 3"
        said.append(f"beam: beam theory does not hold here, its curve is {away}; no code is judged by less")
    return tuple(said)


def held(judge: Judge, name: str, result: Result, allowed: float, programme: Sequence[float]) -> Check:
    """The curve of a run against a judge's, within what is ``allowed`` of the run and the error of the judge."""
    value, tolerance = whole(result, judge.result, programme), allowed + judge.error
    pair = f"{name} / {judge.run}"
    return Check(judge.check, pair, value, tolerance, "analytical", judge.meaning, judge.error)


def whole(a: Result, b: Result, programme: Sequence[float]) -> float:
    """Distance of the curve of ``a`` from that of ``b``: of the envelope, and of the worst leg."""
    far = worst_leg(sampled(a), sampled(b), programme)
    if max(programme) <= 0.0:
        return far
    one, other = (onward(sampled(run), max(programme) if run.separated else 0.0) for run in (a, b))
    end = min(max(programme), float(np.max(one[0])), float(np.max(other[0])))
    return max(curve_error(from_origin(*one), from_origin(*other), end, drops=True), far)
