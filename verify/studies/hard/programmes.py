"""Cases of load programmes: few and many steps, unloading, reversals, complete separation."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy.integrate import solve_bvp

from verify.scene.load import load_scene
from verify.scene.materials import Isotropic
from verify.scene.schema import Scene
from verify.studies.frame import corners
from verify.studies.hard.case import ONE_FINE_ARM, Case, Finding, Trial, Trials, equal_curves, judged_by, runs
from verify.studies.hard.criteria import distance
from verify.verdict import Check

big_steps = Case(
    "big-steps",
    "The whole programme in 5 requested steps, and in 5000.",
    runs(
        "dcb-czm1",
        {f"steps-{n}": (f"discretization.steps={n}",) for n in (5, 5000)},
        *ONE_FINE_ARM,
        "effects.kinematics=linear",
    ),
    equal_curves("steps-5000", distance, 0.002, "regression", "The envelope is that of 5000 steps."),
)

_WAYS = {"monotone": "3.0", "to-zero": "[1.5, 0.0, 1.5, 3.0]", "closing": "[1.5, -0.1, 1.5, 3.0]"}


@judged_by(
    "unload-reload",
    "The crack closes, presses, and opens again.",
    runs(
        "dcb-czm1",
        {
            f"{name}-{kinematics}": (f"effects.kinematics={kinematics}", f"load.opening={way}")
            for kinematics in ("linear", "finite")
            for name, way in _WAYS.items()
        },
        *ONE_FINE_ARM,
        "interface.penalty=1e3",  # soft enough for the mesh to resolve the penetration
    ),
)
def unload(trials: Trials) -> Iterator[Finding]:
    """Criteria of the runs ``to-zero-KINEMATICS`` and ``closing-KINEMATICS``, compared with ``monotone-KINEMATICS``."""
    for name, trial in trials.items():
        way, _, kinematics = name.rpartition("-")
        if way == "monotone":
            continue
        opening, load = trial.result.opening, trial.result.load
        at = corners(opening, trial.scene.load.opening)
        if len(at) < 3:
            yield Check("legs", name, float("nan"), 0.0, "exact", "All legs of the programme were run.")
            continue
        d, P = opening[at[0] : at[1] + 1], load[at[0] : at[1] + 1]
        if kinematics == "linear":  # with constant damage the specimen, contact included, is positively homogeneous
            off, allowed, along = float(np.max(np.abs(P / P[0] - d / d[0])[d >= 0.0])), 1e-6, " along the secant"
        else:  # of finite displacements only the load at zero opening is known, to vanish
            off, allowed, along = abs(float(np.interp(0.0, d[::-1], P[::-1]) / P[0])), 1e-3, ""
        yield Check("secant", name, off, allowed, "exact", f"It unloads{along} to the origin.")
        yield from _penetration(trial) if way == "closing" else ()
        back = load[at[2]] / load[at[0]] - 1.0
        yield Check("return", name, back, 1e-6, "exact", "Reloaded to where it unloaded, the load is what it was.")
        away = distance(trial.result, trials[f"monotone-{kinematics}"].result)
        yield Check("same-envelope", name, away, 0.002, "regression", "The envelope is that of the monotone programme.")


unload_solid = Case(
    "unload-reload-solid",
    "The curved front of a solid closes, presses, and opens again.",
    runs(
        "dcb-solid-cfrp",
        {f"{name}-linear": (f"load.opening={way}",) for name, way in _WAYS.items()},
        "specimen.length=60.0",
        "specimen.precrack=25.0",
        "specimen.width=6.0",
        "interface.strength=20.0",
        "interface.penalty=1e3",
        "discretization.in_a_zone=4",
        "discretization.degree=2",
        "discretization.layers=1",
    ),
    unload.judge,
    bases=("nurbs",),
)


def _penetration(trial: Trial) -> Iterator[Finding]:
    """Under a closing load the ends of the arms are beams on one-sided springs, which take compression only.

    The springs between the arms have the stiffness ``penalty``: k = 2 w penalty for each arm (Winkler). Each arm is a
    cantilever, free at the loaded end and clamped where the bond is intact.
    """
    scene, steps = trial.scene, trial.result.steps
    body, solid = scene.specimen, scene.material
    if "mouth_opening" not in steps or not body.symmetric or not isinstance(solid, Isotropic):
        return
    at = int(np.argmin(steps["opening"]))
    bending = solid.young * body.width * body.loaded_thickness**3 / 12.0
    k = 2.0 * body.width * scene.interface.penalty
    wanted = 2.0 * pressed_end(abs(steps["load"][at]), steps["damage_front"][at], bending, k)
    found = -float(steps["mouth_opening"][at])
    meaning = "Closed, the arms pass through each other by p / penalty, p that of beams on springs: over it, less 1."
    yield Check("contact", trial.name, found / wanted - 1.0, 0.1, "analytical", meaning)


def pressed_end(load: float, length: float, bending: float, k: float) -> float:
    """Deflection y of a cantilever on one-sided springs k under a load P at its end x = 0.

    With the derivatives y_1 to y_4: ``EI y_4 = -k max(y, 0)``, at the end ``y_2 = 0, EI y_3 = P``, at the clamp
    ``y = y_1 = 0``.
    """
    at = np.linspace(0.0, length, 200)
    found = solve_bvp(
        lambda _, y: np.stack([*y[1:], -k / bending * np.maximum(y[0], 0.0)]),
        lambda end, clamp: np.array([end[2], end[3] - load / bending, *clamp[:2]]),
        at,
        np.zeros((4, at.size)),
        tol=1e-8,
    )
    return float(found.y[0, 0])


tiny_reversals = Case(
    "tiny-reversals",
    "The programme turns back by a billionth and goes on.",
    runs(
        "dcb-czm1",
        {
            "reversals-none": ("load.opening=2.0",),
            "reversals-tiny": ("load.opening=[0.5, 0.499999999, 1.0, 0.999999, 1.5, 1.499, 2.0]",),
        },
        *ONE_FINE_ARM,
    ),
    equal_curves(
        "reversals-none", distance, 0.002, "regression", "Tiny reversals do not change the envelope.", "same-envelope"
    ),
)


def _separating() -> dict[str, Scene]:
    mesh = "discretization.dofs=1200"
    peel = load_scene("peel-60", ("specimen.bond_length=20.0", "load.opening=20.0", mesh))
    return {"dcb": load_scene("dcb-czm1", ("load.opening=8.0", mesh)), "peel": peel}


@judged_by("full-separation", "The crack runs through the whole specimen, snapping back to no load.", _separating)
def separation(trials: Trials) -> Iterator[Finding]:
    for name, trial in trials.items():
        body, result = trial.scene.specimen, trial.result
        meaning = "The run ends by itself and says separated."
        yield Check("separated", name, float(not result.separated), 0.0, "exact", meaning)
        if result.load.size < 2:
            continue
        left = abs(result.load[-1]) / np.max(np.abs(result.load))
        yield Check("no-load", name, left, 0.01, "exact", "The load at the end, over the peak load.")
        whole = trial.scene.interface.toughness * body.width * (body.extent - body.free_length)
        lost = result.steps["dissipated_energy"][-1] / whole - 1.0
        hinge = 1.0 / result.snapshots[0].s_q.size
        meaning = "The whole bond was dissipated, except for one point, about which the bodies rotate without load."
        yield Check("all-dissipated", name, lost, 0.01 + hinge, "exact", meaning)
