"""Cases of numerical choices at the interface, on which the results must not depend."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from verify.curves.curve import oscillation
from verify.curves.of_run import cubics
from verify.methods.solve import solve
from verify.result import Result
from verify.studies.hard.case import ONE_FINE_ARM, Case, Finding, Number, Trials, equal_curves, judged_by, runs
from verify.studies.hard.criteria import distance
from verify.verdict import Check

#: All penalties with linear kinematics, which is cheap, and the extremes with finite kinematics.
_PENALTIES = {
    f"penalty-1e{n}": (f"interface.penalty=1e{n}", *ONE_FINE_ARM, "effects.kinematics=linear") for n in range(2, 11)
} | {f"finite-1e{n}": (f"interface.penalty=1e{n}", "discretization.dofs=280") for n in (2, 6, 8, 10)}


@judged_by(
    "penalty-sweep",
    "Far ahead of the crack gaps alternate in sign at a millionth of the thickness, and contact with them.",
    runs("dcb-czm1", _PENALTIES),
)
def penalties(trials: Trials) -> Iterator[Finding]:
    """Soft contact changes the curve of the beam as well; that distance is subtracted."""
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


_RULES = {f"gauss-{n}": ("gauss", n) for n in range(1, 13)} | {f"lobatto-{n}": ("lobatto", n) for n in range(2, 13)}


@judged_by(
    "points-sweep",
    "Few points leave modes without stiffness, many make the traction oscillate.",
    runs(
        "dcb-czm1",
        {
            name: (f"discretization.interface_rule={rule}", f"discretization.interface_points={n}")
            for name, (rule, n) in (_RULES | {"lumped": ("lumped", 2)}).items()
        },
        "discretization.dofs=280",
    ),
)
def points(trials: Trials) -> Iterator[Finding]:
    beam = solve(next(iter(trials.values())).scene, "beam")
    for name, trial in trials.items():
        found = oscillation(cubics(trial.result), (beam.opening, beam.load))
        meaning = "RMS of the load's oscillation about the beam's on the propagation branch."
        yield Number("load-oscillation", name, found["rms"], meaning)
        meaning = "Total variation of the traction over 2 p_max."
        yield Number("traction-variation", name, variation(trial.result), meaning)


def variation(result: Result) -> float:
    """Total variation of the traction along the bond in the last snapshot, over that of a single rise and fall."""
    if not result.snapshots:
        return np.nan
    p_q = result.snapshots[-1].traction_q
    return float(np.sum(np.abs(np.diff(p_q))) / (2.0 * np.max(p_q)))


mismatch = Case(
    "mismatch",
    "The two meshes along the interface do not match, up to ten to one.",
    runs(
        "dcb-czm1",
        {"matched": ()}
        | {
            f"{ratio:g}-{slave}": (f"discretization.mismatch={ratio}", f"discretization.slave={slave}")
            for ratio in (1.37, 10.0)
            for slave in ("upper", "lower")
        },
        "load.opening=1.5",
        "discretization.dofs=3000",
        "discretization.interface_points=8",  # with these the few elements of the coarser body resolve the process zone
    ),
    equal_curves("matched", distance, 0.005, "regression", "The curve is that of matching meshes."),
)
