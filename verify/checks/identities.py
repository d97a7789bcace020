"""Checks of a single run: identities of mechanics, computed from the columns that the run wrote.

Unless its docstring says otherwise, the value of a check is the largest relative deviation over the steps. A check is
left out where a method lacks its columns.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np

from verify.checks.mechanics import balance, mixed
from verify.checks.mechanics import unresolved as resolution
from verify.checks.mechanics.columns import Steps, has, peak, scale, worst
from verify.checks.mechanics.dissipation import dissipation_gap, zone_changes
from verify.checks.mechanics.j_integral import (
    J_TOLERANCE,
    beyond_far_end,
    far_end_energy,
    far_end_loaded,
    j_deviation,
    j_gap,
    j_pressed,
)
from verify.checks.mechanics.peel_growth import growth_angle, growth_load
from verify.checks.mechanics.penetration import PENETRATION_TOLERANCE, long_elements, penetration
from verify.checks.mechanics.secant import secant_gap, secant_tolerance
from verify.methods.method import Prepared
from verify.methods.solve import prepare
from verify.result import Result
from verify.scene.effects import simulated
from verify.scene.schema import Scene
from verify.theory.law import KNOWN_LAWS
from verify.verdict import Check, Checks, Kind

#: Deviations up to 0.05 were measured, for a strip that bears on the edge of its substrate; without contact it is 1.
J_PRESSED_TOLERANCE = 0.1
ENERGY_TOLERANCE = 0.005
#: On load sin(theta) / (G_Ic w): covers the error of the mesh, and energy in the unloaded ends of strip and substrate.
ANGLE_TOLERANCE = 0.01
REST = 1e-12  # external work, over the largest one, that counts as zero
DISSIPATION_TOLERANCE = 0.02

J_OF_LAW = "The J-integral of the specimen is the area under the law."
J_OF_ANY_LAW = "The J-integral of the specimen is G_Ic once the bond has opened (of this law no check knows the shape)."


F = TypeVar("F", bound=Callable[..., float | None])


@dataclass(frozen=True)
class Identity:
    """A check of every run; the fields are described in `identity`."""

    name: str
    value: Callable[..., float | None]
    tolerance: float | Callable[[Prepared, Result], float]
    meaning: str | Callable[[Scene], str]
    kind: Kind = "exact"
    of_zone: bool = False
    of_face: bool = False
    element: bool = False


IDENTITIES: dict[str, Identity] = {}


def identity(
    name: str,
    tolerance: float | Callable[[Prepared, Result], float],
    meaning: str | Callable[[Scene], str],
    **more: Any,
) -> Callable[[F], F]:
    """Register a function of scene and columns as a check of every run, in the order of definition.

    Parameters
    ----------
    tolerance : a number, or a function of the run
    meaning : one sentence for the reader of the report, or a function of the scene
    kind : "exact" for an identity; see `verify.verdict.Check`
    of_zone : the error is that of the mesh in the process zone
    of_face : requires a load that is evenly distributed over the end face, as slopes under a point load do not converge
    element : the function has a third argument, which builds a mesh and returns the length of its longest element
    """

    def register(value: F) -> F:
        IDENTITIES[name] = Identity(name, value, tolerance, meaning, **more)
        return value

    return register


def run_checks(scene: Scene, result: Result, subject: str = "") -> Checks:
    """The checks of one run that its columns allow; ``subject`` as in `checks_of`."""
    return checks_of(prepare(scene, result.method), result, subject)


def checks_of(prepared: Prepared, result: Result, subject: str = "") -> Checks:
    """The checks of one run that its columns allow; of a run without a step only whether it is completed.

    Parameters
    ----------
    subject : name of the run in the report; default: the method
    """
    scene, checks = prepared.method.modelled(prepared.scene), []
    if scene is not prepared.scene:
        prepared = replace(prepared, scene=scene)
    without_step = result.opening.size < 2  # the first row is the unloaded specimen
    for one in IDENTITIES.values():
        if without_step and one.name != "completed":
            continue
        more = (lambda: prepared.element,) if one.element else ()
        value = 0.0 if result.separated and one.name == "completed" else one.value(scene, result.steps, *more)
        if value is None or (one.of_face and scene.load.at != "face"):
            continue
        tolerance = one.tolerance if isinstance(one.tolerance, float) else one.tolerance(prepared, result)
        meaning = one.meaning if isinstance(one.meaning, str) else one.meaning(scene)
        check = Check(one.name, subject or result.method, value, tolerance, one.kind, meaning)
        checks.append(replace(check, unresolved=_cannot_judge(prepared, result, check)))
    return Checks(checks)


def _cannot_judge(prepared: Prepared, result: Result, check: Check) -> str:
    """Why a check above its tolerance gives no verdict; empty where it gives one."""
    if not abs(check.value) > check.tolerance:
        return ""
    if not IDENTITIES[check.name].of_zone:
        return zone_changes(prepared.scene, result, check) or long_elements(prepared, result, check)
    return (
        mixed.long_zone(prepared.scene, result.steps, check)
        or resolution.too_coarse(prepared, result, check)
        or end_cannot_judge(prepared, result, check)
    )


def end_cannot_judge(prepared: Prepared, result: Result, check: Check) -> str:
    """Why the J-integral gives no verdict: the far end carries load from the start and explains the deviation."""
    scene = prepared.scene
    gap = j_gap(scene, result.steps) if check.name == "j-integral" else None
    if gap is None or not far_end_loaded(scene, result.steps):
        return ""
    held = far_end_energy(scene, result.steps)
    beyond = worst(beyond_far_end(np.abs(gap), held))
    return resolution.far_end_unresolved(prepared, float(np.nanmax(held))) if beyond <= check.tolerance else ""


@identity("completed", 1e-9, "The run reached the end of the load programme, or the specimen separated.")
def _missing_part(scene: Scene, steps: Steps) -> float:
    """Distance of the last opening from the end of the programme, over the largest opening."""
    programme = np.array(scene.load.opening)
    reached = steps["opening"][-1] if steps["opening"].size else 0.0
    return float(abs(reached - programme[-1]) / np.max(np.abs(programme)))


identity("penetration", PENETRATION_TOLERANCE, "Faces penetrate each other no deeper than the penalty explains.")(
    penetration
)


def _j_tolerance(prepared: Prepared, result: Result) -> float:
    return max(J_TOLERANCE, prepared.method.mesh_error)


def _j_meaning(scene: Scene) -> str:
    return J_OF_LAW if scene.interface.law in KNOWN_LAWS else J_OF_ANY_LAW


identity("j-integral", _j_tolerance, _j_meaning, of_zone=True, of_face=True)(j_deviation)
identity(
    "j-pressed",
    J_PRESSED_TOLERANCE,
    "The J-integral of pressed faces is the area under law and contact.",
    of_zone=True,
    of_face=True,
)(j_pressed)
identity(
    "growth-load",
    _j_tolerance,
    "While the crack grows the load is at least G_Ic times the width.",
    of_zone=True,
    of_face=True,
)(growth_load)
identity(
    "growth-angle",
    ANGLE_TOLERANCE,
    "In the end load sin(theta) is G_Ic times the width.",
    kind="analytical",
    of_zone=True,
    of_face=True,
)(growth_angle)


@identity("energy-ledger", ENERGY_TOLERANCE, "External work is stored or dissipated, nothing is lost.")
def energy_gap(scene: Scene, steps: Steps) -> float | None:
    """Largest |external work - stored - dissipated| over the largest external work up to that step.

    Both on one side of zero: what pressed faces store would hide what is lost where the bond opens.
    """
    if not has(steps, "external_work", "stored_energy", "dissipated_energy"):
        return None
    gap = steps["external_work"] - steps["stored_energy"] - steps["dissipated_energy"]
    work, above = np.abs(steps["external_work"]), steps["opening"] + np.append(0.0, steps["opening"][:-1]) >= 0.0
    most = np.zeros(work.size)
    for side in (above, ~above):
        most[side] = np.maximum.accumulate(work[side])
    crossed = np.flatnonzero(np.diff(above))  # the last step of each side
    gap = gap - np.append(0.0, gap[crossed])[np.searchsorted(crossed, np.arange(gap.size))]
    # a rotated specimen at rest stores some 1e-50 by rounding, while the external work is 0
    return worst(gap / scale(np.maximum(most, REST * np.max(work, initial=0.0))))


identity("secant", secant_tolerance, "While nothing is dissipated the load falls and rises along its secant.")(
    secant_gap
)


@identity("interface-force", balance.force_tolerance, "The interface tractions carry the load.")
def interface_gap(scene: Scene, steps: Steps) -> float | None:
    """Largest difference of load and interface force over the peak load; absolute values, as they act on either arm."""
    if scene.specimen.supports or simulated(scene)["shear"] or not has(steps, "interface_force"):
        return None
    return worst((np.abs(steps["load"]) - np.abs(steps["interface_force"])) / scale(peak(steps["load"])))


@identity("moment-balance", balance.moment_tolerance, "Load and interface tractions have equal moments.")
def moment_gap(scene: Scene, steps: Steps) -> float | None:
    """Largest sum of the moments on the upper arm over the moment of the peak load about the tip of the precrack."""
    if scene.specimen.supports or simulated(scene)["shear"] or not has(steps, "load_moment", "interface_moment"):
        return None
    lever = scene.specimen.free_length
    return worst((steps["load_moment"] + steps["interface_moment"]) / scale(lever * peak(steps["load"])))


@identity("clamp-moment", balance.moment_tolerance, "Load and clamp have equal moments.")
def clamp_gap(scene: Scene, steps: Steps) -> float | None:
    """Largest sum of the moments of load and clamp over the moment of the peak load about the flush end of a peel."""
    if not has(steps, "load_moment", "clamp_moment"):
        return None
    return worst((steps["load_moment"] + steps["clamp_moment"]) / scale(scene.specimen.extent * peak(steps["load"])))


@identity("lengthwise", balance.force_tolerance, "The anchor carries the axial resultant of tilted tractions.")
def lengthwise_gap(scene: Scene, steps: Steps) -> float | None:
    """Largest sum of the axial forces on a strip over the peak load: tractions on a tilted master, and the anchor."""
    if simulated(scene)["shear"] or not has(steps, "interface_pull", "anchor_pull"):
        return None
    return worst((steps["interface_pull"] + steps["anchor_pull"]) / scale(peak(steps["load"])))


@identity("reactions", balance.force_tolerance, "The supports carry the load and nothing else.")
def support_forces(scene: Scene, steps: Steps) -> float | None:
    """Largest resultant of the support reactions in excess of those that balance the load, over the peak load.

    Where supports carry the load only the axial resultant counts; the check `supports` judges the other reactions.
    """
    if not has(steps, "reaction_x", "reaction_y"):
        return None
    if scene.specimen.supports:
        return worst(steps["reaction_x"] / scale(mixed.size(scene.specimen) * peak(steps["load"])))
    return worst(np.hypot(steps["reaction_x"], steps["reaction_y"]) / scale(peak(steps["load"])))


def _dissipation_meaning(scene: Scene) -> str:
    """The sentence of the check: where the bond slides, the cost is the toughness of a pure mode, or J between them."""
    cost = "G_c or, between the modes, J" if simulated(scene)["shear"] else "G_Ic"
    return f"A new length of crack costs {cost} times the width."


identity("dissipation", DISSIPATION_TOLERANCE, _dissipation_meaning, element=True)(dissipation_gap)
identity("j-loads", mixed.j_tolerance, "The J-integral of loads and supports is that of the bond.", of_zone=True)(
    mixed.j_loads
)
identity("supports", balance.moment_tolerance, "Each support carries what statics gives it.")(mixed.support_gap)
identity("arm-balance", balance.moment_tolerance, "Forces and moments on the upper arm add up to nothing.")(
    mixed.arm_gap
)
identity(
    "mode-ratio",
    mixed.mode_tolerance,
    "The part of sliding in J is that of the closed form.",
    kind="analytical",
    of_zone=True,
)(mixed.mode_gap)
identity("moments", 0.003, "J is that of the end moments.", kind="analytical", of_zone=True)(mixed.moments_gap)
identity("moments-elastic", 1e-6, "Before any damage J is that of the end moments.", kind="analytical", of_zone=True)(
    mixed.elastic_moments_gap
)
identity("growth-toughness", 0.003, "While a crack grows J is the toughness.", kind="analytical", of_zone=True)(
    mixed.growth_gap
)
identity(
    "plateau", 0.005, "Between two loads a crack grows at one load.", kind="analytical", of_zone=True, element=True
)(mixed.plateau_gap)


#: Checks whose deviation depends on how well the mesh resolves the process zone.
OF_THE_ZONE = tuple(name for name, one in IDENTITIES.items() if one.of_zone)
