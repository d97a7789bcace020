"""Cases of what a mesh resolves: process zones shorter than an element, choices at the interface, locking bodies."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from iga.bases.names import BASES
from verify.curves.curve import PROPAGATION, load_at, oscillation, peak
from verify.curves.of_run import cubics
from verify.methods.solve import prepare, solve
from verify.methods.zone_resolution import warnings
from verify.result import Result
from verify.studies.hard.case import ONE_FINE_ARM, Case, Finding, Number, Trial, Trials, equal_curves, judged_by, runs
from verify.studies.hard.criteria import cost_of_damage, distance, point_areas
from verify.verdict import Check

coarse = Case(
    "coarse-czm2",
    "The mesh only just resolves the process zone: the load-opening path snaps back at every element.",
    runs("dcb-czm2", {"d0-280": ("discretization.dofs=280",)}),
)


@judged_by(
    "under-resolved",
    "The process zone is a half, a quarter and a tenth of an element long.",
    runs(
        "dcb-czm1",
        {f"strength-{p}": (f"interface.strength={p}.0",) for p in (10, 20, 40)},
        "discretization.dofs=280",
    ),
)
def under_resolved(trials: Trials) -> Iterator[Finding]:
    """Where the zone is shorter than the distance of two points, the crack jumps from point to point, and its length
    between them is undefined: the new crack is the area of the points that are fully open."""
    for name, trial in trials.items():
        yield warned(trial)
        areas, damage, bond = point_areas(trial), trial.result.snapshots[-1].damage_q, trial.scene.interface
        yield Number("broken", name, float(areas @ (damage >= 1.0)), "Area of the points that broke.")
        if paid := cost_of_damage(areas, damage, bond.toughness, bond.ductility):
            steps = trial.result.steps
            spent = steps["external_work"][-1] - steps["stored_energy"][-1]
            meaning = "External work less stored energy, over G_Ic times the new area of crack."
            yield Check("crack-cost", name, spent / paid - 1.0, 0.02, "exact", meaning)


def warned(trial: Trial) -> Check:
    """Whether a warning before the run says that the mesh is too coarse for the process zone."""
    silent = float(not warnings(prepare(trial.scene, trial.result.method)))
    return Check("warned", trial.name, silent, 0.0, "exact", "An under-resolved process zone is announced.")


#: Pairs of a strength and the unknowns with which every basis resolves its process zone.
_STRENGTHS = ((4, 5000), (8, 7000), (15, 9000), (30, 13000), (60, 18000))
#: Distance below which curves of different meshes coincide.
_SAME = 0.002


@judged_by(
    "toward-lefm",
    "Stronger and stronger interfaces on meshes that resolve them tend to fracture mechanics.",
    runs(
        "dcb-czm1",
        {f"strength-{p}": (f"interface.strength={p}.0", f"discretization.dofs={dofs}") for p, dofs in _STRENGTHS},
        "effects.kinematics=linear",
        "effects.symmetry=true",
    ),
)
def toward_lefm(trials: Trials) -> Iterator[Finding]:
    """Distances on the propagation branch; before it the curves differ by the effect of the finite strength.

    On that branch corrected beam theory is P = (2/3)^(1/2) (G w)^(3/4) (E I)^(1/4) opening^(-1/2) for any correction.
    """
    limit = solve(next(iter(trials.values())).scene, "lefm")
    begin, end = PROPAGATION * peak((limit.opening, limit.load))[0], limit.opening[-1]
    grid = np.linspace(begin, end, 400)
    wanted = load_at((limit.opening, limit.load), grid)
    away = []
    for name, trial in trials.items():
        ratio = load_at(cubics(trial.result), grid) / wanted - 1.0
        away.append(float(np.sqrt(np.mean(ratio**2))))
        yield Number("distance", name, away[-1], "Distance to corrected beam theory on the propagation branch (RMS).")
    ratios = np.divide(away[1:], np.maximum(away[:-1], _SAME))
    meaning = f"Largest ratio of successive distances, down to {_SAME:.1%}: each strength comes closer to the limit."
    yield Check("monotone", "all", float(np.max(ratios)), 1.0, "analytical", meaning)


brittle = Case(
    "brittle-ratio",
    "Softening that is almost vertical, and an initial slope that is.",
    runs("dcb-czm1", {f"ductility-{r:g}": (f"interface.ductility={r}",) for r in (1.01, 1e4)}, *ONE_FINE_ARM),
)


@judged_by(
    "peel-as-printed",
    "The strength is above the modulus and the process zone a fiftieth of an element.",
    runs("peel-as-printed", {"mpa": ("discretization.dofs=1200",)}),
    may_stop=True,
)
def as_printed(trials: Trials) -> Iterator[Finding]:
    for trial in trials.values():
        status = trial.result.status
        fine = trial.result.complete or (status.startswith("stopped: process zone") and trial.result.load.size > 1)
        meaning = "The run completes, or stops and says that the process zone is shorter than an element."
        yield Check("honest-end", trial.name, float(not fine), 0.0, "exact", meaning)
        yield warned(trial)


# --- numerical choices at the interface, on which the results must not depend

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


# --- the bodies

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
