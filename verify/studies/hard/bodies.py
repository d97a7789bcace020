"""Cases of the bodies: locking, large rotations, extreme ratios of stiffness and length."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from iga.bases.names import BASES
from verify.methods.solve import solve
from verify.studies.hard.case import Case, Finding, Number, Trials, Variant, variant, variants
from verify.verdict import Check

_slender = variants(
    "dcb-czm1",
    {"1-1000": ("specimen.length=200.0", "specimen.precrack=180.0")},
    "interface.toughness=0.001",
    "interface.strength=1.0",
    "load.opening=90.0",
    "discretization.dofs=2400",
)


def _judge_slender(trials: Trials) -> Iterator[Finding]:
    for name, trial in trials.items():
        beam = solve(trial.scene, "beam")
        error = trial.result.steps["load_slope"][0] / (beam.load[1] / beam.opening[1]) - 1.0
        yield Check("compliance", name, error, 0.005, "analytical", "The initial stiffness is that of the beam.")


_incompressible = variants(
    "dcb-czm1",
    {"coarse": ("discretization.dofs=1200",), "fine": ("discretization.dofs=2400", "load.opening=0.1")},
    "specimen.plane=strain",
    "material.poisson=0.4999",
)


def _judge_incompressible(trials: Trials) -> Iterator[Finding]:
    coarse, fine = (trials[name].result.steps["load_slope"][0] for name in ("coarse", "fine"))
    meaning = "The initial stiffness of a fine mesh."
    yield Check("compliance", "coarse", coarse / fine - 1.0, 0.02, "regression", meaning)


_large_rotation = variants("peel-soft", {"upright": ("discretization.dofs=5000", "discretization.interface_points=4")})


def _judge_large_rotation(trials: Trials) -> Iterator[Finding]:
    for name, trial in trials.items():
        steps, scene = trial.result.steps, trial.scene
        sine = float(np.abs(steps["face_slope_top"][-1]))
        yield Number("slope", name, sine, "Sine of the rotation of the strip's end, 1 where it is upright.")
        meaning = "At the end the load is G_Ic w / sin(theta)."
        griffith = scene.interface.toughness * scene.specimen.width
        yield Check("end-load", name, steps["load"][-1] * sine / griffith - 1.0, 0.01, "analytical", meaning)


_contrast = variants("peel-60", {"million": ("strip.young=5e9", "discretization.dofs=1200")})


def _judge_contrast(trials: Trials) -> Iterator[Finding]:
    for name, trial in trials.items():
        condition = trial.result.condition
        yield Number("condition", name, condition, "Largest condition number of the tangents.")
        known = 0.0 if condition > 0.0 else 1.0
        yield Check("condition-known", name, known, 0.0, "exact", "The condition number is reported.")


_short_ligament = variants(
    "dcb-czm1", {"ligament-0.5": ("specimen.precrack=13.5", "load.opening=10.0", "discretization.dofs=480")}
)


#: Unknowns by the degree; T-splines are cubic.
DOFS_OF_DEGREE = {1: 640, 2: 2400, 4: 640, 5: 640}
OF_ALL_DEGREES = tuple(name for name, basis in BASES.items() if {*DOFS_OF_DEGREE} <= {*basis.degrees})


def _degrees() -> Sequence[Variant]:
    return [
        variant(f"degree-{p}", "dcb-czm1", f"discretization.degree={p}", f"discretization.dofs={dofs}")
        for p, dofs in DOFS_OF_DEGREE.items()
    ]


BODY_CASES = (
    Case("slender", "Arms a thousand times as long as thick lock where shear does.", _slender, _judge_slender),
    Case("incompressible", "Plane strain at Poisson's ratio 0.4999 locks.", _incompressible, _judge_incompressible),
    Case("large-rotation", "A soft strip is peeled until its end is vertical.", _large_rotation, _judge_large_rotation),
    Case("stiffness-contrast", "A strip a million times stiffer than its substrate.", _contrast, _judge_contrast),
    Case("short-ligament", "The precrack is nearly as long as the specimen: the zone never fits.", _short_ligament),
    Case("degrees", "Elements of degree 1 lock, those of degree 5 overshoot.", _degrees, bases=OF_ALL_DEGREES),
)
