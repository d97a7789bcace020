"""Numerical choices at the interface that the answer must not depend on."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from verify.curves.curve import oscillation
from verify.curves.of_run import cubics
from verify.methods.solve import solve
from verify.result import Result
from verify.studies.hard.case import FINE, Case, Finding, Number, Trials, Variant, variant
from verify.studies.hard.criteria import distance
from verify.verdict import Check


def _penalties() -> Sequence[Variant]:
    """All of them where a run costs little, and the extremes, which are hardest to solve, in finite kinematics."""
    fine = (*FINE, "effects.kinematics=linear")
    sweep = [variant(f"penalty-1e{n}", "dcb-czm1", f"interface.penalty=1e{n}", *fine) for n in range(2, 11)]
    coarse = "discretization.dofs=280"
    return sweep + [variant(f"finite-1e{n}", "dcb-czm1", f"interface.penalty=1e{n}", coarse) for n in (2, 6, 8, 10)]


def _judge_penalties(trials: Trials) -> Iterator[Finding]:
    """Contact of 1e4 still gives way by as much as a beam on the same contact does, which is not for a mesh to hide."""
    stiffest = trials["penalty-1e10"]
    rigid = solve(stiffest.scene, "beam")
    for name, trial in trials.items():
        if name.startswith("finite"):
            continue
        away = distance(trial.result, stiffest.result)
        yield Number("distance", name, away, "Distance to the curve of the stiffest contact.")
        if trial.scene.interface.penalty >= 1e4:
            beam = distance(solve(trial.scene, "beam"), rigid)
            meaning = "The curve is as far from that of the stiffest contact as the beam's is."
            yield Check("same-curve", name, away - beam, 0.001, "analytical", meaning)


def _points() -> Sequence[Variant]:
    rules = [("gauss", n) for n in range(1, 13)] + [("lobatto", n) for n in range(2, 13)] + [("lumped", 2)]
    return [
        variant(
            rule if rule == "lumped" else f"{rule}-{n}",
            "dcb-czm1",
            f"discretization.interface_rule={rule}",
            f"discretization.interface_points={n}",
            "discretization.dofs=280",
        )
        for rule, n in rules
    ]


def _judge_points(trials: Trials) -> Iterator[Finding]:
    beam = solve(next(iter(trials.values())).scene, "beam")
    for name, trial in trials.items():
        found = oscillation(cubics(trial.result), (beam.opening, beam.load))
        yield Number(
            "load-oscillation", name, found["rms"], "Wiggle of the load about the beam's on the propagation branch."
        )
        yield Number("traction-variation", name, variation(trial.result), "Ups and downs of the traction over 2 p_max.")


def variation(result: Result) -> float:
    """Total variation of the traction along the bond at the last opening, over that of a single rise and fall."""
    if not result.snapshots:
        return np.nan
    p_q = result.snapshots[-1].traction_q
    return float(np.sum(np.abs(np.diff(p_q))) / (2.0 * np.max(p_q)))


def _mismatch() -> Sequence[Variant]:
    """As many points an element as let the coarser body see the zone with its few elements."""
    pairs = [(ratio, slave) for ratio in (1.37, 10.0) for slave in ("upper", "lower")]
    keys = ("load.opening=1.5", "discretization.dofs=3000", "discretization.interface_points=8")
    return [
        variant("matched", "dcb-czm1", *keys),
        *(
            variant(
                f"{ratio:g}-{slave}",
                "dcb-czm1",
                *keys,
                f"discretization.mismatch={ratio}",
                f"discretization.slave={slave}",
            )
            for ratio, slave in pairs
        ),
    ]


def _judge_mismatch(trials: Trials) -> Iterator[Finding]:
    matched = trials["matched"].result
    for name, trial in trials.items():
        if name != "matched":
            away = distance(trial.result, matched)
            yield Check("same-curve", name, away, 0.005, "regression", "The curve is that of matching meshes.")


INTERFACE_CASES = (
    Case(
        "penalty-sweep",
        "Far ahead of the crack gaps alternate in sign at a millionth of the thickness, and contact with them.",
        _penalties,
        _judge_penalties,
    ),
    Case(
        "points-sweep",
        "Few points leave modes without stiffness, many make the traction oscillate.",
        _points,
        _judge_points,
    ),
    Case("mismatch", "The two meshes along the interface do not match, up to ten to one.", _mismatch, _judge_mismatch),
)
