"""Balances of forces and moments, and their tolerances: the residual that Newton's tolerance and rounding leave.

A solver that stops at a residual of norm R leaves sums of n forces of at most sqrt(n) R (Cauchy-Schwarz; reached where
all are equal), and sums of moments of that times the length. ``iga`` tells R of each step; those of other solvers are
estimated from the scene, as each defines them in its stopping criterion.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from verify.checks.mechanics.columns import Steps, peak, scale, size
from verify.checks.mechanics.identity import identity
from verify.methods.method import Prepared
from verify.result import Result
from verify.scene import process_zone
from verify.scene.schema import Scene


@dataclass(frozen=True)
class ResidualEstimate:
    """Constants of the estimated residual. Larger ones hide lost forces, smaller ones blame rounding on a code.

    least : smallest tolerance, also where the estimate is smaller
    most : largest tolerance; no specimen explains a larger residual
    element_rounding : rounding of an element's forces in ``iga`` in machine epsilons, as `iga.system.system.rounding`
    system_rounding : rounding of an assembled system, in machine epsilons; equal elements have equal rounding errors,
        which add up (up to 2.4 were measured)
    closed_opening : displacement of points in contact in DOLFINx, over the opening g_u that breaks the bond
    """

    least: float = 1e-8
    most: float = 1e-3
    element_rounding: float = 40.0
    system_rounding: float = 5.0
    closed_opening: float = 10.0


RESIDUAL = ResidualEstimate()


def force_tolerance(prepared: Prepared, result: Result) -> float:
    """Allowed sum of forces, over the peak load."""
    return float(np.clip(_residual(prepared, result), RESIDUAL.least, RESIDUAL.most))


def moment_tolerance(prepared: Prepared, result: Result) -> float:
    """Allowed sum of moments, over the moment of the peak load about the tip; the lever is the specimen's length."""
    lever = prepared.scene.specimen.extent / prepared.scene.specimen.free_length
    return float(np.clip(lever * _residual(prepared, result), RESIDUAL.least, RESIDUAL.most))


@identity(
    "energy-ledger",
    0.005,
    "External work is stored or dissipated, nothing is lost.",
    "external_work",
    "stored_energy",
    "dissipated_energy",
)
def energy_gap(scene: Scene, steps: Steps) -> np.ndarray:
    """External work less what is stored and dissipated, over the largest external work up to that step.

    Both on one side of zero: what pressed faces store would hide what is lost where the bond opens.
    """
    gap = steps["external_work"] - steps["stored_energy"] - steps["dissipated_energy"]
    work, above = np.abs(steps["external_work"]), steps["opening"] + np.append(0.0, steps["opening"][:-1]) >= 0.0
    most = np.zeros(work.size)
    for side in (above, ~above):
        most[side] = np.maximum.accumulate(work[side])
    crossed = np.flatnonzero(np.diff(above))  # the last step of each side
    gap = gap - np.append(0.0, gap[crossed])[np.searchsorted(crossed, np.arange(gap.size))]
    # a rotated specimen at rest stores some 1e-50 by rounding, while the external work is 0
    return gap / scale(np.maximum(most, 1e-12 * np.max(work, initial=0.0)))


@identity(
    "interface-force", force_tolerance, "The interface tractions carry the load.", "interface_force", slides=False
)
def interface_gap(scene: Scene, steps: Steps) -> np.ndarray | None:
    """Difference of load and interface force over the peak load; absolute values, as they act on either arm."""
    if scene.specimen.supports:
        return None
    return (np.abs(steps["load"]) - np.abs(steps["interface_force"])) / scale(peak(steps["load"]))


@identity(
    "moment-balance",
    moment_tolerance,
    "Load and interface tractions have equal moments.",
    "load_moment",
    "interface_moment",
    slides=False,
)
def moment_gap(scene: Scene, steps: Steps) -> np.ndarray | None:
    """Sum of the moments on the upper arm over the moment of the peak load about the tip of the precrack."""
    if scene.specimen.supports:
        return None
    lever = scene.specimen.free_length
    return (steps["load_moment"] + steps["interface_moment"]) / scale(lever * peak(steps["load"]))


@identity("clamp-moment", moment_tolerance, "Load and clamp have equal moments.", "load_moment", "clamp_moment")
def clamp_gap(scene: Scene, steps: Steps) -> np.ndarray:
    """Sum of the moments of load and clamp over the moment of the peak load about the flush end of a peel."""
    return (steps["load_moment"] + steps["clamp_moment"]) / scale(scene.specimen.extent * peak(steps["load"]))


@identity(
    "lengthwise",
    force_tolerance,
    "The anchor carries the axial resultant of tilted tractions.",
    "interface_pull",
    "anchor_pull",
    slides=False,
)
def lengthwise_gap(scene: Scene, steps: Steps) -> np.ndarray:
    """Sum of the axial forces on a strip over the peak load: tractions on a tilted master, and the anchor."""
    return (steps["interface_pull"] + steps["anchor_pull"]) / scale(peak(steps["load"]))


@identity("reactions", force_tolerance, "The supports carry the load and nothing else.", "reaction_x", "reaction_y")
def support_forces(scene: Scene, steps: Steps) -> np.ndarray:
    """Resultant of the support reactions in excess of those that balance the load, over the peak load.

    Where supports carry the load only the axial resultant counts; the check `supports` judges the other reactions.
    """
    if scene.specimen.supports:
        return steps["reaction_x"] / scale(size(scene.specimen) * peak(steps["load"]))
    return np.hypot(steps["reaction_x"], steps["reaction_y"]) / scale(peak(steps["load"]))


def _residual(prepared: Prepared, result: Result) -> float:
    """Largest sum of the residual forces of a converged step, over the peak load; 0 for a run without load, and for a
    method without mesh.

    Couples count as forces on the length of the arms (`size`), and the opening, a rotation, as their way.

    Newton's part in ``iga`` is the norm of the residual itself; half of the unknowns are forces of one direction. Of
    arms it is all there is, with their rounding in it. DOLFINx makes one iteration more than its tolerance requires,
    which leaves rounding alone.

    Rounding is ``eps K u`` with the stiffness K = M w (h / l + l / h) of an element of length l and the modulus M of a
    stretch without contraction: rounding of displacements does not keep the volume as an arm does, and near nu = 1/2 it
    makes forces that are 1 / (1 - 2 nu) times as large (0.4 of this estimate was Newton's floor in ``iga`` there, 0.9
    at nu = 0.3). In DOLFINx, and in ``iga`` with a linear bulk, u is the displacement of the whole specimen. Otherwise
    it is the displacement within an element, l times the slope of the arm. In DOLFINx points in contact add the penalty
    times their displacement.
    """
    scene, body = prepared.scene, prepared.scene.specimen
    lever = size(body) if all(load.couple for load in body.loads) else 1.0
    load, moved = (
        float(np.max(np.abs(values), initial=0.0)) for values in (result.load * lever, result.opening / lever)
    )
    if load == 0.0:
        return 0.0
    left = float(np.sqrt(0.5 * result.dofs) * np.max(result.steps.get("residual", 0.0))) / load
    if prepared.method.code == "beam":
        return left
    if not prepared.method.has_mesh or not result.elements:
        return 0.0
    length, h, eps = prepared.element, body.loaded_thickness, float(np.finfo(float).eps)
    modulus = max(process_zone.confined_modulus(material, body.plane) for material in scene.materials)
    stiffness = modulus * body.width * (h / length + length / h)
    whole = RESIDUAL.system_rounding * float(np.sqrt(result.dofs)) * eps * stiffness * moved / load
    if prepared.method.code != "iga":
        law = scene.interface
        g_open = 2.0 * law.toughness / law.strength
        closed = RESIDUAL.closed_opening * law.penalty * length * body.width * g_open
        return whole + float(np.sqrt(result.dofs)) * eps * closed / load
    slope = min(1.0, 0.75 * moved / body.free_length)  # at the end of one of two arms: 3/2 of the mean slope
    rounding = RESIDUAL.element_rounding * eps
    relative = float(np.sqrt(result.elements)) * rounding * stiffness * slope * length / load
    return left + (whole if prepared.effects["kinematics"] == "linear" else relative)
