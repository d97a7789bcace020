"""What must hold of every single run: identities of mechanics, judged from the columns that the run wrote.

Every value is a relative deviation, the worst over the steps. A column that a method cannot know leaves its check out.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from math import nan

import numpy as np

from verify.checks import balance
from verify.checks import unresolved as resolution
from verify.methods.method import Prepared
from verify.methods.solve import prepare
from verify.result import Result
from verify.scene import process_zone
from verify.scene.bodies import elastic_constants
from verify.scene.effects import simulated
from verify.scene.schema import Scene
from verify.theory.law import LAWS, Law
from verify.verdict import Check, Kind

Steps = Mapping[str, np.ndarray]

J_TOLERANCE = 0.005
#: Measured up to 0.05, of a strip that lies on the edge of its substrate; without the contact the deviation is 1.
J_PRESSED_TOLERANCE = 0.1
ENERGY_TOLERANCE = 0.005
#: Of load sin(theta) / (G_Ic w): besides the mesh, what the unloaded ends of strip and substrate hold of the energy.
ANGLE_TOLERANCE = 0.01
AT_THE_END = 1e-9  # part of the length within which the process zone has come to the far end
#: Part of G_Ic that the far end may hold for the energies there to be judged with the rest: half of J's tolerance.
HELD_AT_THE_END = 0.5 * J_TOLERANCE
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


def run_checks(scene: Scene, result: Result, subject: str = "") -> tuple[Check, ...]:
    """The checks of one run, as far as its columns go; ``subject`` as in `checks_of`."""
    return checks_of(prepare(scene, result.method), result, subject)


def checks_of(prepared: Prepared, result: Result, subject: str = "") -> tuple[Check, ...]:
    """The checks of one run, as far as its columns go.

    Parameters
    ----------
    subject : the name of the run in the report; the method's where empty
    """
    scene, j_tolerance = prepared.scene, max(J_TOLERANCE, prepared.method.mesh_error)
    force, moment = balance.force_tolerance(prepared, result), balance.moment_tolerance(prepared, result)
    dissipation = partial(dissipation_gap, element=lambda: prepared.element)
    values: list[tuple[str, Callable[[Scene, Steps], float | None], float, str]] = [
        ("completed", _missing_part, 1e-9, "The run reached the end of the load programme, or the specimen separated."),
        (
            "penetration",
            penetration,
            PENETRATION_TOLERANCE,
            "Faces are in each other by no more than contact gives way.",
        ),
        ("j-integral", j_deviation, j_tolerance, J_OF_LAW if scene.interface.law in LAWS else J_OF_ANY_LAW),
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
    spread = scene.load.at == "face"
    separated = result.complete and result.ending.startswith("separated")
    found = (
        (name, 0.0 if separated and value is _missing_part else value(scene, result.steps), tolerance, meaning)
        for name, value, tolerance, meaning in values
    )
    checks = (
        Check(name, subject or result.method, worst, tolerance, KINDS.get(name, "exact"), meaning)
        for name, worst, tolerance, meaning in found
        if worst is not None and (spread or name not in OF_THE_FACE)
    )
    return tuple(replace(check, unresolved=_cannot_judge(prepared, result, check)) for check in checks)


def _cannot_judge(prepared: Prepared, result: Result, check: Check) -> str:
    """Why a check that is beyond its tolerance cannot judge, empty where it can."""
    if check.name not in OF_THE_ZONE or not abs(check.value) > check.tolerance:
        return ""
    return resolution.too_coarse(prepared, result, check) or end_cannot_judge(prepared, result, check)


def end_cannot_judge(prepared: Prepared, result: Result, check: Check) -> str:
    """The same of the J-integral where the far end takes part from the start on and explains what it deviates by."""
    scene = prepared.scene
    gap = _j_gap(scene, result.steps) if check.name == "j-integral" else None
    if gap is None or not felt_from_the_start(scene, result.steps):
        return ""
    held = held_at_the_end(scene, result.steps)
    beyond = _worst(_beyond_the_end(np.abs(gap), held))
    return resolution.at_the_end(prepared, float(np.nanmax(held))) if beyond <= check.tolerance else ""


def law_of(scene: Scene) -> Law:
    """The scene's traction law, in the copy that only checks and beam use; what all laws have where there is none."""
    i = scene.interface
    return LAWS.get(i.law, Law)(i.strength, i.toughness, i.ductility, i.penalty, simulated(scene)["contact"])


def j_deviation(scene: Scene, steps: Steps) -> float | None:
    """Worst |J - integral of p dg| / G_Ic over the steps on the way up.

    J w = load (|s_top| + |s_bottom|) - w sum over the faces of the integral of W dY, with s the mean slope du_y/dX of
    the loaded face; it equals the area under the law up to the opening at the tip of the precrack (Rice 1968, J. Appl.
    Mech. 35, with dead tractions on the faces), less the area up to the gap at the far end, which a short ligament has
    as well. With damage it holds while the interface loads, not while it unloads. Of a law whose shape nobody has
    stated once more (`verify.theory.law`) the area is known below the strength and once the bond has opened.

    Where faces touch beyond the bond their tractions do work in the same integral, from the mouth of the crack to its
    tip: ``- integral of p dg/dX = A(g_mouth) - A(g_tip)`` with A the energy of the contact, nothing of an open gap.

    The end faces are both ends of both bodies, but for those at the far end with a minus: contact at the end of a short
    ligament squeezes them, and with a stiff penalty they hold more than the contact does. The base of a peel gives no
    term, being fixed. Once the far end holds more than HELD_AT_THE_END, on a spot that may be smaller than an element,
    only what is more than all of its energy counts (`held_at_the_end`); where it does from the start on, all counts,
    and `resolution.at_the_end` says what cannot be judged.
    """
    found = _j_gap(scene, steps)
    if found is None or not (steps["opening"] > 0.0).any():
        return None
    gap, held = np.where(steps["opening"] >= 0.0, np.abs(found), 0.0), held_at_the_end(scene, steps)
    return _worst(gap if felt_from_the_start(scene, steps) else _beyond_the_end(gap, held))


def j_pressed(scene: Scene, steps: Steps) -> float | None:
    """The same where the specimen is pressed together, over G_Ic or what the mouth of the crack holds, if that is more.

    What it holds is read off at the edge of a body, where stress varies within an element: it is known as well as the
    mesh resolves that.
    """
    gap, pressed = _j_gap(scene, steps), steps["opening"] < 0.0
    return None if gap is None or not pressed.any() else _worst(gap[pressed & far_from_end(scene, steps)])


def _beyond_the_end(gap: np.ndarray, held: np.ndarray) -> np.ndarray:
    """What of a deviation (n_steps,) the energy that the far end holds cannot explain."""
    beyond = np.where(held <= HELD_AT_THE_END, gap, np.maximum(gap - held, 0.0))
    return np.where(np.isnan(held), 0.0, beyond)


def felt_from_the_start(scene: Scene, steps: Steps) -> bool:
    """Whether the far end takes part before J has come to half of its largest value."""
    spent = np.nan_to_num(_spent(scene, steps))
    free = held_at_the_end(scene, steps) <= HELD_AT_THE_END
    return bool(np.max(spent, initial=0.0, where=free) < 0.5 * np.max(spent, initial=0.0))


def held_at_the_end(scene: Scene, steps: Steps) -> np.ndarray:
    """Part of G_Ic that the far end holds (n_steps,), NaN where the law is not known here.

    That is the area under the law there and, of a dcb, the strain energy of its faces, beside which that of the loaded
    ones is nothing. A traction p that fades through the arms gives them no more than ``p^2 h / E2``.
    """
    law, body = law_of(scene), scene.specimen
    end = steps.get("end_opening", np.zeros(steps["opening"].size))
    held = np.abs(law.area(end))
    if not body.clamped and "face_energy" in steps:
        below = law.penalty if law.contact else law.stiffness
        traction = np.where(end < 0.0, below * np.abs(end), np.minimum(law.stiffness * np.abs(end), law.strength))
        most = traction**2 * body.loaded_thickness / process_zone.across_modulus(scene.materials[0], body.plane)
        held = held + np.clip(-steps["face_energy"], 0.0, most)
    return held / scene.interface.toughness


def growth_load(scene: Scene, steps: Steps) -> float | None:
    """Largest part of G_Ic w by which the load falls short of it while the crack of a peel grows.

    ``J w = load s - w sum of the face energies = G_Ic w`` with the slope s = du_y/dX = lambda sin(theta) of the loaded
    face, but for linear kinematics: s <= 1 unless its load stretches an upright strip, lambda = 1 + load / (E h w),
    0.2 % in peel-soft; so load max(s, 1) is what may not fall short. What the gap at the far end holds is not there to
    be released (see `j_deviation`).
    """
    steady = growing(scene, steps) & out_of_reach(scene, steps)
    if not steady.any() or simulated(scene)["kinematics"] == "linear":
        return None
    pull = steps["load"] * np.maximum(np.abs(steps.get("face_slope_top", 1.0)), 1.0)
    return _worst(np.minimum(pull[steady] / _to_release(scene, steps)[steady] - 1.0, 0.0))


def growth_angle(scene: Scene, steps: Steps) -> float | None:
    """load sin(theta) / (G_Ic w) - 1 at the last step at which the crack of a peel grows out of reach of the flush end.

    Of an inextensible strip on a rigid substrate (Rivlin 1944 for theta = 90 degrees; elastica). What is left of J is
    the energy on the end faces. On the loaded one that is of the load itself, and is taken off: ``P^2 / (2 h w)
    (sin(theta)^2 / E1 + cos(theta)^2 / G12)`` (Kendall 1975 for theta = 90 degrees).
    """
    steady = growing(scene, steps) & out_of_reach(scene, steps)
    if not steady.any() or "face_slope_top" not in steps:
        return None
    last = np.flatnonzero(steady)[-1]
    load, sine = steps["load"][last], abs(steps["face_slope_top"][last])
    pull = load * sine - _end_face_energy(scene, load, sine)
    return float(pull / _to_release(scene, steps)[last] - 1.0)


def _end_face_energy(scene: Scene, load: float, sine: float) -> float:
    """Energy per length of the strip at its loaded face, whose traction is uniform and keeps its direction."""
    body, strip = scene.specimen, scene.materials[0]
    along = 0.0 if simulated(scene)["kinematics"] == "linear" else min(sine, 1.0) ** 2
    E1, G12 = process_zone.bending_modulus(strip, body.plane), elastic_constants(strip)["G12"]
    return load**2 / (2.0 * body.loaded_thickness * body.width) * (along / E1 + (1.0 - along) / G12)


def _to_release(scene: Scene, steps: Steps) -> np.ndarray:
    """G_Ic w less what the gap at the far end holds, of every step (n_steps,): what a growing crack takes."""
    end = steps.get("end_opening", np.zeros(steps["opening"].size))
    return (scene.interface.toughness - law_of(scene).area(end)) * scene.specimen.width


def growing(scene: Scene, steps: Steps) -> np.ndarray:
    """Steps (n_steps,) of a peel at which a whole process zone travels, from the open tip to its front in the bond.

    None of another specimen, or where the columns do not tell.
    """
    if not scene.specimen.clamped or not _has(steps, "tip_opening", "damage_front", "dissipated_energy"):
        return np.zeros(steps["opening"].size, dtype=bool)
    open_ = _tip_is_open(scene, steps)
    inside = steps["damage_front"] < (1.0 - AT_THE_END) * scene.specimen.extent
    pulled = (steps["opening"] > 0.0) & zone_is_new(scene, steps)
    return open_ & inside & loading(steps) & far_from_end(scene, steps) & pulled


def _j_gap(scene: Scene, steps: Steps) -> np.ndarray | None:
    """(J - integral of p dg) / G_Ic at every step (n_steps,), 0 where that need not hold.

    Where pressed faces hold more than G_Ic it is J less that, a small difference of large terms: over what they hold.
    """
    if not _has(steps, "face_slope_top", "face_slope_bottom", "face_energy", "tip_opening", "dissipated_energy"):
        return None
    J = steps["load"] * _turn(scene, steps) / scene.specimen.width - steps["face_energy"]
    law, spent, tip = law_of(scene), _spent(scene, steps), steps["tip_opening"]
    area = spent - law.area(steps.get("end_opening", np.zeros(J.size)))
    scale = np.full(J.size, scene.interface.toughness)
    if "mouth_opening" in steps:
        touching = law.area(np.minimum(steps["mouth_opening"], 0.0))
        area += touching - law.area(np.minimum(tip, 0.0))
        scale = np.maximum(scale, touching)
    irreversible = simulated(scene)["irreversible"]
    valid = loading(steps) & zone_is_new(scene, steps) if irreversible else np.ones(J.size, dtype=bool)
    valid &= ~np.isnan(spent) | np.isnan(tip)  # not on a branch that nobody has stated
    return np.where(valid, J - area, 0.0) / scale


def _spent(scene: Scene, steps: Steps) -> np.ndarray:
    """Area under the law up to the gap at the tip of the precrack (n_steps,)."""
    law = law_of(scene)
    return np.where(_tip_is_open(scene, steps), law.toughness, law.area(steps["tip_opening"]))


def out_of_reach(scene: Scene, steps: Steps) -> np.ndarray:
    """Steps (n_steps,) of a peel whose process zone does not stress the flush end: it is four decay lengths of the
    strip away, and twice the thickness of the substrate.

    Ahead of the front the strip and what is under it fade as ``exp(-x / l)``, l = (4 E I / K w)^(1/4) of a beam on the
    foundation K of bond and substrate in series, and the energy on the flush faces, which load sin(theta) lacks, as
    ``exp(-2 x / l)``: 3e-4 of G_Ic. A substrate that is clamped below fades as ``exp(-pi x / 2 t)`` by itself.
    """
    if "damage_front" not in steps or not scene.specimen.clamped:
        return np.zeros(steps["opening"].size, dtype=bool)
    body, law, plane = scene.specimen, law_of(scene), scene.specimen.plane
    (strip, substrate), (_, base) = scene.materials, body.thicknesses
    K = 1.0 / (1.0 / law.stiffness + base / process_zone.across_modulus(substrate, plane))
    bending = process_zone.bending_modulus(strip, plane) * body.loaded_thickness**3 / 12.0
    away = max(4.0 * (4.0 * bending / K) ** 0.25, 2.0 * base)
    return steps["damage_front"] <= body.extent - away


def _turn(scene: Scene, steps: Steps) -> np.ndarray:
    """How far the loaded faces turn in the sense in which the load opens the specimen, of every step (n_steps,)."""
    top, bottom = steps["face_slope_top"], steps["face_slope_bottom"]
    pressed = top if scene.specimen.clamped else bottom - top
    return np.where(steps["opening"] < 0.0, pressed, np.abs(top) + np.abs(bottom))


def zone_is_new(scene: Scene, steps: Steps) -> np.ndarray:
    """Steps (n_steps,) at which nothing in the process zone was damaged on an earlier leg of the programme.

    Pressed arms gape in another shape than opened ones: points of an old zone come back to the envelope one after the
    other, and until the zone has gone on by its own length J is not the area under the law. Of a programme that never
    goes below zero all come back at once.
    """
    if min(scene.load.opening) >= 0.0 or not _has(steps, "crack_length", "damage_front"):
        return np.ones(steps["opening"].size, dtype=bool)
    before = np.maximum.accumulate(steps["damage_front"])[_start_of_leg(scene, steps)]
    return np.where(before > scene.specimen.free_length, steps["crack_length"] >= before, True)


def _start_of_leg(scene: Scene, steps: Steps) -> np.ndarray:
    """The step (n_steps,) at which the leg of the programme began on which each step lies."""
    opening, start, reach = steps["opening"], 0, max(map(abs, scene.load.opening))
    starts = np.zeros(opening.size, dtype=int)
    for goal in scene.load.opening:
        arrived = np.flatnonzero(np.abs(opening[start:] - goal) <= 1e-9 * reach)
        if not arrived.size:
            break
        start += int(arrived[0])
        starts[start + 1 :] = start
    return starts


def _tip_is_open(scene: Scene, steps: Steps) -> np.ndarray:
    """Steps (n_steps,) at which nothing holds the tip of the bond any more; of a law that is not known, as is told."""
    if scene.interface.law in LAWS:
        return steps["tip_opening"] > law_of(scene).g_open
    return steps.get("crack_length", np.zeros(steps["opening"].size)) > scene.specimen.free_length


def far_from_end(scene: Scene, steps: Steps) -> np.ndarray:
    """Steps before the crack feels the far end: its contact holds less than a hundredth of G_Ic; bool (n_steps,).

    After that the specimen turns about its end, on a spot of contact smaller than an element.
    """
    end = steps.get("end_opening", np.zeros(steps["opening"].size))
    return np.abs(law_of(scene).area(end)) <= 0.01 * scene.interface.toughness


def loading(steps: Steps) -> np.ndarray:
    """Steps at which damage grows, and those before any: bool (n_steps,)."""
    dissipated = steps["dissipated_energy"]
    rounding = 1e-12 * np.max(dissipated, initial=0.0)
    return (np.diff(dissipated, prepend=0.0) > rounding) | (np.maximum.accumulate(dissipated) <= rounding)


def penetration(scene: Scene, steps: Steps) -> float | None:
    """Worst depth of the faces in each other over what contact gives way under its own pressure, less 1.

    The pressure over the penalty, and over the stiffness of an arm across: between the points that carry contact a
    surface bulges by a part of that. None where contact was to be left out, or the programme never goes down; not
    counted where the specimen turns about its far end (see `far_from_end`).
    """
    if not simulated(scene)["contact"] or not _has(steps, "penetration", "contact_pressure"):
        return None
    specimen, across = scene.specimen, elastic_constants(scene.materials[0])["E2"]
    gives = steps["contact_pressure"] * (1.0 / scene.interface.penalty + specimen.loaded_thickness / across)
    depth = steps["penetration"]
    deep = (depth > NO_DEPTH * specimen.loaded_thickness) & far_from_end(scene, steps)
    return _worst(np.maximum(np.where(deep, depth / _scale(gives) - 1.0, 0.0), 0.0))


def energy_gap(scene: Scene, steps: Steps) -> float | None:
    """Worst |external - stored - dissipated| over the largest external work so far in the run."""
    if not _has(steps, "external_work", "stored_energy", "dissipated_energy"):
        return None
    gap = steps["external_work"] - steps["stored_energy"] - steps["dissipated_energy"]
    work = np.maximum.accumulate(np.abs(steps["external_work"]))
    # at rest a specimen out of the axes holds some 1e-50 by rounding, against no work at all
    return _worst(gap / _scale(np.maximum(work, REST * np.max(work, initial=0.0))))


def interface_gap(scene: Scene, steps: Steps) -> float | None:
    """Worst difference of load and interface force over the peak load; both in size, whichever arm they act on."""
    if not _has(steps, "interface_force"):
        return None
    return _worst((np.abs(steps["load"]) - np.abs(steps["interface_force"])) / _scale(_peak(steps["load"])))


def moment_gap(scene: Scene, steps: Steps) -> float | None:
    """Worst sum of the moments on the upper arm over the moment of the peak load about the tip of the precrack."""
    if not _has(steps, "load_moment", "interface_moment"):
        return None
    lever = scene.specimen.free_length
    return _worst((steps["load_moment"] + steps["interface_moment"]) / _scale(lever * _peak(steps["load"])))


def clamp_gap(scene: Scene, steps: Steps) -> float | None:
    """Worst sum of the moments of load and clamp over the moment of the peak load about the flush end of a peel."""
    if not _has(steps, "load_moment", "clamp_moment"):
        return None
    return _worst((steps["load_moment"] + steps["clamp_moment"]) / _scale(scene.specimen.extent * _peak(steps["load"])))


def lengthwise_gap(scene: Scene, steps: Steps) -> float | None:
    """Worst sum of what acts lengthwise on a strip over the peak load: tractions on a tilted master, and the anchor."""
    if not _has(steps, "interface_pull", "anchor_pull"):
        return None
    return _worst((steps["interface_pull"] + steps["anchor_pull"]) / _scale(_peak(steps["load"])))


def support_forces(scene: Scene, steps: Steps) -> float | None:
    """Worst sum of the support reactions, less the load that they carry, over the peak load."""
    if not _has(steps, "reaction_x", "reaction_y"):
        return None
    return _worst(np.hypot(steps["reaction_x"], steps["reaction_y"]) / _scale(_peak(steps["load"])))


def dissipation_gap(scene: Scene, steps: Steps, element: Callable[[], float] = lambda: nan) -> float | None:
    """|slope of dissipated against crack / (G_Ic w) - 1|; none below five thicknesses or three elements of the bond.

    Counted from the first growth on, when a whole process zone is already under way: it travels with the crack and
    drops out of the slope, but for its slow change of length. It is counted until the zone reaches the far end. The
    slope is that of the straight line nearest to all that lies between (least squares over the crack): from first to
    last it would hold what the zone has spent beyond the points that see the crack, a few percent on a coarse mesh.
    ``element`` makes a mesh to tell the longest one, and is asked last.
    """
    if not _has(steps, "crack_length", "dissipated_energy"):
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


def _has(steps: Steps, *names: str) -> bool:
    return all(name in steps for name in names)


def _peak(values: np.ndarray) -> np.ndarray:
    return np.max(np.abs(values), initial=0.0, keepdims=True)


def _scale(values: np.ndarray) -> np.ndarray:
    """A divisor: where nothing has happened yet, only nothing may deviate."""
    return np.where(values == 0, np.finfo(float).tiny, values)


def _worst(deviation: np.ndarray) -> float:
    return float(np.max(np.abs(deviation), initial=0.0))  # NaN stays NaN, and fails
