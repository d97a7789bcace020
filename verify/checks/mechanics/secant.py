"""Loads on unloading: a damaged bond unloads along its secant, and so does the specimen."""

from __future__ import annotations

import numpy as np

from verify.checks.mechanics.columns import Steps, has, peak, scale, worst
from verify.methods.method import Prepared
from verify.result import Result
from verify.scene.effects import simulated
from verify.scene.schema import Scene
from verify.theory.law import KNOWN_LAWS

#: Tolerance with linear kinematics; 4e-7 was measured.
SECANT_TOLERANCE = 1e-4
#: Allowed curvature of finite kinematics, in parts of (opening / crack length)^2: 0.06 to 0.11 were measured.
CURVED = 0.15
#: Largest tolerance with which the check still detects a wrong law.
MOST = 0.03
#: Largest load of a line, over that of the run, below which it is no measure: a separated specimen bears rounding.
LEAST_LINE = 0.01
#: Growth of the dissipated energy in a step, over the largest one, that counts as zero.
NO_GROWTH = 1e-9


def secant_tolerance(prepared: Prepared, result: Result) -> float:
    """Allowed distance from the straight line: `SECANT_TOLERANCE`, or the curvature of arms that rotate."""
    return max(SECANT_TOLERANCE, _curvature(prepared.scene, result.steps))


def secant_gap(scene: Scene, steps: Steps) -> float | None:
    """Largest distance of the load from a straight line through the origin, over the largest load on that line, while
    nothing is dissipated.

    With small displacements and frozen damage all equations are positively homogeneous, those of contact between closed
    faces included: a part of the opening has the same part of the load. Every stretch of steps between which nothing is
    dissipated has such a line on either side of zero, through its step of the largest opening. With finite kinematics
    the line of faces that are pressed together is curved and does not count.

    None where a programme only opens; where the bond has another memory than its damage (friction, viscosity, laws of
    users); where arms that rotate would bend the line by more than `MOST`.
    """
    bond = scene.interface
    if not simulated(scene)["irreversible"] or bond.friction or bond.viscosity or bond.law not in KNOWN_LAWS:
        return None
    if not has(steps, "dissipated_energy", "crack_length") or not np.any(np.diff(np.abs(steps["opening"])) < 0.0):
        return None
    if _curvature(scene, steps) > MOST:
        return None
    opening, load, spent = steps["opening"], steps["load"], steps["dissipated_energy"]
    grows = np.diff(spent, prepend=spent[:1]) > NO_GROWTH * peak(spent)
    line = np.unique(2 * np.cumsum(grows) + (opening < 0.0), return_inverse=True)[1]
    by_opening = np.argsort(np.abs(opening), kind="stable")
    farthest = np.zeros(line.max() + 1, dtype=int)
    farthest[line[by_opening]] = by_opening  # the last assignment is that of the largest opening
    d, P = opening[farthest][line], load[farthest][line]
    counted = d > 0.0 if simulated(scene)["kinematics"] == "finite" else d != 0.0
    size = np.maximum(np.abs(P), LEAST_LINE * peak(load))
    return worst((load - P * opening / scale(d))[counted] / scale(size[counted]))


def _curvature(scene: Scene, steps: Steps) -> float:
    """Bound of the curvature by finite kinematics; infinite for specimens that bend or peel, where it is not known."""
    if simulated(scene)["kinematics"] == "linear":
        return 0.0
    if scene.specimen.clamped or scene.specimen.supports or any(load.couple for load in scene.specimen.loads):
        return np.inf
    return CURVED * float(np.max((steps["opening"] / scale(steps["crack_length"])) ** 2))
