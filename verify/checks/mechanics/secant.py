"""Loads on unloading: a damaged bond unloads along its secant, and so does the specimen."""

from __future__ import annotations

import numpy as np

from verify.checks.mechanics.columns import Steps, has, peak, scale
from verify.checks.mechanics.identity import identity
from verify.methods.method import Prepared
from verify.result import Result
from verify.scene.effects import STANDING, simulated
from verify.scene.schema import Scene
from verify.theory.law import KNOWN_LAWS

#: Tolerance of a straight line: what Newton's iterations leave; 4e-7 was measured.
SECANT_TOLERANCE = 1e-4
#: Largest tolerance with which the check still detects a wrong law.
MOST = 0.03
#: The geometric term at an opening, over that of the undamaged specimen: bonds from soft (10 N/mm^3) to rigid (1e6) on
#: arms of 1/20 to 1/4 of the crack, isotropic and orthotropic, change it by a factor of at most 2.1 in either sense.
SOFTER = 2.1
#: The cubic ``x - x^3`` of the opening x on a line over the largest one is at most this.
ON_A_LINE = 2.0 / 27.0**0.5
#: Largest load of a line, over that of the run, below which it is no measure: a separated specimen bears rounding.
LEAST_LINE = 0.01
#: Growth of the dissipated energy in a step, over the largest one, that counts as zero.
NO_GROWTH = 1e-9


def secant_tolerance(prepared: Prepared, result: Result) -> float:
    """Allowed distance from the line: `SECANT_TOLERANCE`, and what rotations change in the next order.

    The elastica states the term of second order in the rotation theta of a clamped arm (`STANDING`); roots that rotate
    take a part of it, which is not known. Half of the term is left by the stored energy (see `_geometric`).
    """
    if simulated(prepared.scene)["kinematics"] == "linear":
        return SECANT_TOLERANCE
    return SECANT_TOLERANCE + _next_order(result.steps)


@identity(
    "secant",
    secant_tolerance,
    "While nothing is dissipated the load falls and rises along its secant.",
    "dissipated_energy",
    "crack_length",
)
def secant_gap(scene: Scene, steps: Steps) -> np.ndarray | None:
    """Distance of the load from its line through the origin, over the largest load on that line, while nothing
    is dissipated.

    With small displacements and frozen damage all equations are positively homogeneous, those of contact between closed
    faces included: a part of the opening has the same part of the load. Every stretch of steps between which nothing is
    dissipated has such a line on either side of zero, through its step of the largest opening. With finite kinematics
    it is bent by the geometric term (`_geometric`), and that of faces that are pressed together does not count.

    None where a programme only opens; where the bond has another memory than its damage (friction, viscosity, laws of
    users); with finite kinematics for specimens that bend or peel, whose rotations are not those of `STANDING`, and
    where arms rotate so far that the tolerance exceeds `MOST`.
    """
    bond, finite = scene.interface, simulated(scene)["kinematics"] == "finite"
    if not simulated(scene)["irreversible"] or bond.friction or bond.viscosity or bond.law not in KNOWN_LAWS:
        return None
    if not np.any(np.diff(np.abs(steps["opening"])) < 0.0) or finite and not _opens_as_a_beam(scene, steps):
        return None
    opening, load, spent = steps["opening"], steps["load"], steps["dissipated_energy"]
    grows = np.diff(spent, prepend=spent[:1]) > NO_GROWTH * peak(spent)
    line = np.unique(2 * np.cumsum(grows) + (opening < 0.0), return_inverse=True)[1]
    by_opening = np.argsort(np.abs(opening), kind="stable")
    farthest = np.zeros(line.max() + 1, dtype=int)
    farthest[line[by_opening]] = by_opening  # the last assignment is that of the largest opening
    top, bent = farthest[line], _geometric(steps) if finite else np.zeros(opening.size)
    d, P = opening[top], load[top]
    counted = d > 0.0 if finite else d != 0.0
    size = np.maximum(np.abs(P), LEAST_LINE * peak(load))
    expected = P * opening / scale(d) * (1.0 + bent - bent[top])
    return (load - expected)[counted] / scale(size[counted])


def _geometric(steps: Steps) -> np.ndarray:
    """Relative change of load over opening by finite kinematics with frozen damage (n_steps,), from the stored energy.

    The energy is ``E = K d^2/2 + C d^3/3 + D d^4/4 + ..`` in the opening d, the load ``P = dE/dd``, so that ``P d - 2 E
    = C d^3/3 + D d^4/2``, which vanishes with small displacements (Clapeyron): ``P/d - K = C d + D d^2 = 3 (P d - 2 E)
    / d^2 - D d^2/2``. C is that of the root of the arms, D that of the elastica, ``D d^2 / K = STANDING theta^2``.

    An energy that lacks more than such terms is a fault and no geometry: the term C d is no larger than `SOFTER` times
    that of the first step, over its opening.
    """
    d, P, E = (steps[name] for name in ("opening", "load", "stored_energy"))
    fourth = STANDING * _rotation(steps) ** 2
    third = 3.0 * (1.0 - 2.0 * E / scale(P * d)) - 1.5 * fourth
    first = int(np.argmax(d != 0.0))
    most = SOFTER * np.abs(third[first] * d / scale(d[first])) + _next_order(steps)
    return np.where(d > 0.0, np.clip(third, -most, most) + fourth, 0.0)


def _next_order(steps: Steps) -> float:
    """Largest distance from a line that half the term of second order in the rotations makes."""
    return float(ON_A_LINE * 0.5 * STANDING * np.max(_rotation(steps) ** 2, initial=0.0))


def _rotation(steps: Steps) -> np.ndarray:
    """Larger rotation of the two loaded faces (n_steps,)."""
    return np.maximum(np.abs(steps["face_slope_top"]), np.abs(steps["face_slope_bottom"]))


def _opens_as_a_beam(scene: Scene, steps: Steps) -> bool:
    """Whether two free arms are pulled apart, and their rotations leave a tolerance of at most `MOST`."""
    body = scene.specimen
    if body.clamped or body.supports or any(load.couple for load in body.loads):
        return False
    known = has(steps, "face_slope_top", "face_slope_bottom", "stored_energy")
    return known and _next_order(steps) <= MOST
