"""Cases of the bodies: locking, large rotations, extreme ratios of stiffness and length."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from iga.bases.names import BASES
from verify.methods.solve import solve
from verify.studies.hard.case import Case, Finding, Number, Trials, judged_by, runs
from verify.verdict import Check

_long = ("specimen.length=200.0", "specimen.precrack=180.0", "interface.toughness=0.001", "interface.strength=1.0")


@judged_by(
    "slender",
    "Arms a thousand times as long as thick lock where shear does.",
    runs("dcb-czm1", {"1-1000": (*_long, "load.opening=90.0", "discretization.dofs=2400")}),
)
def slender(trials: Trials) -> Iterator[Finding]:
    for name, trial in trials.items():
        beam = solve(trial.scene, "beam")
        error = trial.result.steps["load_slope"][0] / (beam.load[1] / beam.opening[1]) - 1.0
        yield Check("compliance", name, error, 0.005, "analytical", "The initial stiffness is that of the beam.")


@judged_by(
    "incompressible",
    "Plane strain at Poisson's ratio 0.4999 locks.",
    runs(
        "dcb-czm1",
        {"coarse": ("discretization.dofs=1200",), "fine": ("discretization.dofs=2400", "load.opening=0.1")},
        "specimen.plane=strain",
        "material.poisson=0.4999",
    ),
)
def incompressible(trials: Trials) -> Iterator[Finding]:
    coarse, fine = (trials[name].result.steps["load_slope"][0] for name in ("coarse", "fine"))
    meaning = "The initial stiffness of a fine mesh."
    yield Check("compliance", "coarse", coarse / fine - 1.0, 0.02, "regression", meaning)


@judged_by(
    "large-rotation",
    "A soft strip is peeled until its end is vertical.",
    runs("peel-soft", {"upright": ("discretization.dofs=5000", "discretization.interface_points=4")}),
)
def large_rotation(trials: Trials) -> Iterator[Finding]:
    for name, trial in trials.items():
        steps, scene = trial.result.steps, trial.scene
        sine = float(np.abs(steps["face_slope_top"][-1]))
        yield Number("slope", name, sine, "Sine of the rotation of the strip's end, 1 where it is upright.")
        meaning = "At the end the load is G_Ic w / sin(theta)."
        griffith = scene.interface.toughness * scene.specimen.width
        yield Check("end-load", name, steps["load"][-1] * sine / griffith - 1.0, 0.01, "analytical", meaning)


@judged_by(
    "stiffness-contrast",
    "A strip a million times stiffer than its substrate.",
    runs("peel-60", {"million": ("strip.young=5e9", "discretization.dofs=1200")}),
)
def contrast(trials: Trials) -> Iterator[Finding]:
    for name, trial in trials.items():
        condition = trial.result.condition
        yield Number("condition", name, condition, "Largest condition number of the tangents.")
        unknown = float(not condition > 0.0)
        yield Check("condition-known", name, unknown, 0.0, "exact", "The condition number is reported.")


short_ligament = Case(
    "short-ligament",
    "The precrack is nearly as long as the specimen: the zone never fits.",
    runs("dcb-czm1", {"ligament-0.5": ("specimen.precrack=13.5", "load.opening=10.0", "discretization.dofs=480")}),
)

#: Unknowns by the degree; T-splines are cubic.
DOFS_OF_DEGREE = {1: 640, 2: 2400, 4: 640, 5: 640}

degrees = Case(
    "degrees",
    "Elements of degree 1 lock, those of degree 5 overshoot.",
    runs(
        "dcb-czm1",
        {
            f"degree-{p}": (f"discretization.degree={p}", f"discretization.dofs={dofs}")
            for p, dofs in DOFS_OF_DEGREE.items()
        },
    ),
    bases=tuple(name for name, basis in BASES.items() if {*DOFS_OF_DEGREE} <= {*basis.degrees}),
)
