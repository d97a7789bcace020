"""Cases of strong and brittle interfaces: process zones shorter than an element, and the limit of LEFM."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from verify.curves.curve import PROPAGATION, load_at, peak
from verify.curves.of_run import cubics
from verify.methods.solve import prepare, solve
from verify.methods.zone_resolution import warnings
from verify.studies.hard.case import ONE_FINE_ARM, Case, Finding, Number, Trial, Trials, judged_by, runs
from verify.studies.hard.criteria import cost_of_damage, point_areas
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
