"""What must hold of every single run: identities of mechanics, judged from the columns that the run wrote.

Every value is a relative deviation, the worst over the steps. A column that a method cannot know leaves its check out.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from math import nan

import numpy as np

from verify.checks.mechanics import balance
from verify.checks.mechanics import unresolved as resolution
from verify.checks.mechanics.columns import Steps, far_from_end, has, peak, scale, worst
from verify.checks.mechanics.j_integral import (
    J_TOLERANCE,
    beyond_the_end,
    felt_from_the_start,
    held_at_the_end,
    j_deviation,
    j_gap,
    j_pressed,
)
from verify.checks.mechanics.peel_growth import growth_angle, growth_load
from verify.methods.method import Prepared
from verify.methods.solve import prepare
from verify.result import Result
from verify.scene.bodies import elastic_constants
from verify.scene.effects import simulated
from verify.scene.schema import Scene
from verify.theory.law import KNOWN_LAWS
from verify.verdict import Check, Checks, Kind

#: Measured up to 0.05, of a strip that lies on the edge of its substrate; without the contact the deviation is 1.
J_PRESSED_TOLERANCE = 0.1
ENERGY_TOLERANCE = 0.005
#: Of load sin(theta) / (G_Ic w): besides the mesh, what the unloaded ends of strip and substrate hold of the energy.
ANGLE_TOLERANCE = 0.01
REST = 1e-12  # part of the largest work below which there is none
DISSIPATION_TOLERANCE = 0.02
#: Between the points that carry contact the faces may be deeper in each other: measured up to 0.1 on coarse meshes.
PENETRATION_TOLERANCE = 0.5
NO_DEPTH = 1e-6  # part of the thickness of an arm below which faces are not in each other

J_OF_LAW = "The J-integral of the specimen is the area under the law."
J_OF_ANY_LAW = "The J-integral of the specimen is G_Ic once the bond has opened (of this law no check knows the shape)."

#: Checks that hold as well as the mesh resolves the process zone.
OF_THE_ZONE = ("j-integral", "j-pressed", "growth-angle")
#: Checks that need the load to be spread evenly over the end face: under a point load the slope is that of no mesh.
OF_THE_FACE = ("j-integral", "j-pressed", "growth-load", "growth-angle")
#: What stands behind a check that is no identity.
KINDS: Mapping[str, Kind] = {"growth-angle": "analytical"}


#: Name, value from scene and columns, tolerance, and one sentence for the reader of the report.
Identity = tuple[str, Callable[[Scene, Steps], float | None], float, str]


def run_checks(scene: Scene, result: Result, subject: str = "") -> Checks:
    """The checks of one run, as far as its columns go; ``subject`` as in `checks_of`."""
    return checks_of(prepare(scene, result.method), result, subject)


def checks_of(prepared: Prepared, result: Result, subject: str = "") -> Checks:
    """The checks of one run, as far as its columns go.

    Parameters
    ----------
    subject : the name of the run in the report; the method's where empty
    """
    scene = prepared.scene
    spread = scene.load.at == "face"
    separated = result.complete and result.ending.startswith("separated")
    found = (
        (name, 0.0 if separated and value is _missing_part else value(scene, result.steps), tolerance, meaning)
        for name, value, tolerance, meaning in _identities(prepared, result)
    )
    checks = (
        Check(name, subject or result.method, value, tolerance, KINDS.get(name, "exact"), meaning)
        for name, value, tolerance, meaning in found
        if value is not None and (spread or name not in OF_THE_FACE)
    )
    return Checks(replace(check, unresolved=_cannot_judge(prepared, result, check)) for check in checks)


def _identities(prepared: Prepared, result: Result) -> list[Identity]:
    """Name, value, tolerance and meaning of every check."""
    scene, j_tolerance = prepared.scene, max(J_TOLERANCE, prepared.method.mesh_error)
    force, moment = balance.force_tolerance(prepared, result), balance.moment_tolerance(prepared, result)
    dissipation = partial(dissipation_gap, element=lambda: prepared.element)
    return [
        ("completed", _missing_part, 1e-9, "The run reached the end of the load programme, or the specimen separated."),
        (
            "penetration",
            penetration,
            PENETRATION_TOLERANCE,
            "Faces are in each other by no more than contact gives way.",
        ),
        ("j-integral", j_deviation, j_tolerance, J_OF_LAW if scene.interface.law in KNOWN_LAWS else J_OF_ANY_LAW),
        (
            "j-pressed",
            j_pressed,
            J_PRESSED_TOLERANCE,
            "The J-integral of pressed faces is the area under law and contact.",
        ),
        ("growth-load", growth_load, j_tolerance, "While the crack grows the load is at least G_Ic times the width."),
        ("growth-angle", growth_angle, ANGLE_TOLERANCE, "In the end load sin(theta) is G_Ic times the width."),
        ("energy-ledger", energy_gap, ENERGY_TOLERANCE, "External work is stored or dissipated, nothing is lost."),
        ("interface-force", interface_gap, force, "The interface tractions carry the load."),
        ("moment-balance", moment_gap, moment, "Load and interface tractions have equal moments."),
        ("clamp-moment", clamp_gap, moment, "Load and clamp have equal moments."),
        ("lengthwise", lengthwise_gap, force, "What tilted tractions pull lengthwise, the anchor holds."),
        ("reactions", support_forces, force, "The supports carry the load and nothing else."),
        ("dissipation", dissipation, DISSIPATION_TOLERANCE, "A new length of crack costs G_Ic times the width."),
    ]


def _cannot_judge(prepared: Prepared, result: Result, check: Check) -> str:
    """Why a check that is beyond its tolerance cannot judge, empty where it can."""
    if check.name not in OF_THE_ZONE or not abs(check.value) > check.tolerance:
        return ""
    return resolution.too_coarse(prepared, result, check) or end_cannot_judge(prepared, result, check)


def end_cannot_judge(prepared: Prepared, result: Result, check: Check) -> str:
    """The same of the J-integral where the far end takes part from the start on and explains what it deviates by."""
    scene = prepared.scene
    gap = j_gap(scene, result.steps) if check.name == "j-integral" else None
    if gap is None or not felt_from_the_start(scene, result.steps):
        return ""
    held = held_at_the_end(scene, result.steps)
    beyond = worst(beyond_the_end(np.abs(gap), held))
    return resolution.at_the_end(prepared, float(np.nanmax(held))) if beyond <= check.tolerance else ""


def penetration(scene: Scene, steps: Steps) -> float | None:
    """Worst depth of the faces in each other over what contact gives way under its own pressure, less 1.

    The pressure over the penalty, and over the stiffness of an arm across: between the points that carry contact a
    surface bulges by a part of that. None where contact was to be left out, or the programme never goes down; not
    counted where the specimen turns about its far end (see `far_from_end`).
    """
    if not simulated(scene)["contact"] or not has(steps, "penetration", "contact_pressure"):
        return None
    specimen, across = scene.specimen, elastic_constants(scene.materials[0])["E2"]
    gives = steps["contact_pressure"] * (1.0 / scene.interface.penalty + specimen.loaded_thickness / across)
    depth = steps["penetration"]
    deep = (depth > NO_DEPTH * specimen.loaded_thickness) & far_from_end(scene, steps)
    return worst(np.maximum(np.where(deep, depth / scale(gives) - 1.0, 0.0), 0.0))


def energy_gap(scene: Scene, steps: Steps) -> float | None:
    """Worst |external - stored - dissipated| over the largest external work so far in the run."""
    if not has(steps, "external_work", "stored_energy", "dissipated_energy"):
        return None
    gap = steps["external_work"] - steps["stored_energy"] - steps["dissipated_energy"]
    work = np.maximum.accumulate(np.abs(steps["external_work"]))
    # at rest a specimen out of the axes holds some 1e-50 by rounding, against no work at all
    return worst(gap / scale(np.maximum(work, REST * np.max(work, initial=0.0))))


def interface_gap(scene: Scene, steps: Steps) -> float | None:
    """Worst difference of load and interface force over the peak load; both in size, whichever arm they act on."""
    if not has(steps, "interface_force"):
        return None
    return worst((np.abs(steps["load"]) - np.abs(steps["interface_force"])) / scale(peak(steps["load"])))


def moment_gap(scene: Scene, steps: Steps) -> float | None:
    """Worst sum of the moments on the upper arm over the moment of the peak load about the tip of the precrack."""
    if not has(steps, "load_moment", "interface_moment"):
        return None
    lever = scene.specimen.free_length
    return worst((steps["load_moment"] + steps["interface_moment"]) / scale(lever * peak(steps["load"])))


def clamp_gap(scene: Scene, steps: Steps) -> float | None:
    """Worst sum of the moments of load and clamp over the moment of the peak load about the flush end of a peel."""
    if not has(steps, "load_moment", "clamp_moment"):
        return None
    return worst((steps["load_moment"] + steps["clamp_moment"]) / scale(scene.specimen.extent * peak(steps["load"])))


def lengthwise_gap(scene: Scene, steps: Steps) -> float | None:
    """Worst sum of what acts lengthwise on a strip over the peak load: tractions on a tilted master, and the anchor."""
    if not has(steps, "interface_pull", "anchor_pull"):
        return None
    return worst((steps["interface_pull"] + steps["anchor_pull"]) / scale(peak(steps["load"])))


def support_forces(scene: Scene, steps: Steps) -> float | None:
    """Worst sum of the support reactions, less the load that they carry, over the peak load."""
    if not has(steps, "reaction_x", "reaction_y"):
        return None
    return worst(np.hypot(steps["reaction_x"], steps["reaction_y"]) / scale(peak(steps["load"])))


def dissipation_gap(scene: Scene, steps: Steps, element: Callable[[], float] = lambda: nan) -> float | None:
    """|slope of dissipated against crack / (G_Ic w) - 1|; none below five thicknesses or three elements of the bond.

    Counted from the first growth on, when a whole process zone is already under way: it travels with the crack and
    drops out of the slope, but for its slow change of length. It is counted until the zone reaches the far end. The
    slope is that of the straight line nearest to all that lies between (least squares over the crack): from first to
    last it would hold what the zone has spent beyond the points that see the crack, a few percent on a coarse mesh.
    ``element`` makes a mesh to tell the longest one, and is asked last.
    """
    if not has(steps, "crack_length", "dissipated_energy"):
        return None
    crack = np.maximum.accumulate(steps["crack_length"])
    counted = far_from_end(scene, steps) & (crack > scene.specimen.free_length)
    if not simulated(scene)["irreversible"] or not counted.any():
        return None
    crack, dissipated = crack[counted], steps["dissipated_energy"][counted]
    new_crack = crack[-1] - crack[0]
    if new_crack < 5 * scene.specimen.loaded_thickness or new_crack < 3 * element():
        return None
    share = np.gradient(crack)  # of the crack that a step stands for: as a whole it counts by its length
    from_mean = crack - np.average(crack, weights=share)
    slope = np.sum(share * from_mean * dissipated) / np.sum(share * from_mean**2)
    return float(abs(slope / (scene.interface.toughness * scene.specimen.width) - 1))


def _missing_part(scene: Scene, steps: Steps) -> float:
    """Distance from the end of the programme over its largest opening."""
    programme = np.array(scene.load.opening)
    reached = steps["opening"][-1] if steps["opening"].size else 0.0
    return float(abs(reached - programme[-1]) / np.max(np.abs(programme)))
