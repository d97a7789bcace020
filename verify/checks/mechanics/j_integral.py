"""The J-integral of a run: the load's against the bond's."""

from __future__ import annotations

import numpy as np

from verify.checks.mechanics.columns import Steps, far_from_end, has, law_of, loading, tip_is_open, worst, zone_is_new
from verify.scene import process_zone
from verify.scene.effects import simulated
from verify.scene.schema import Scene

#: Relative, of a mesh that resolves the process zone.
J_TOLERANCE = 0.005
#: Part of G_Ic that the far end may hold for the energies there to be judged with the rest: half of J's tolerance.
HELD_AT_THE_END = 0.5 * J_TOLERANCE


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
    found = j_gap(scene, steps)
    if found is None or not (steps["opening"] > 0.0).any():
        return None
    gap, held = np.where(steps["opening"] >= 0.0, np.abs(found), 0.0), held_at_the_end(scene, steps)
    return worst(gap if felt_from_the_start(scene, steps) else beyond_the_end(gap, held))


def j_pressed(scene: Scene, steps: Steps) -> float | None:
    """The same where the specimen is pressed together, over G_Ic or what the mouth of the crack holds, if that is more.

    What it holds is read off at the edge of a body, where stress varies within an element: it is known as well as the
    mesh resolves that.
    """
    gap, pressed = j_gap(scene, steps), steps["opening"] < 0.0
    return None if gap is None or not pressed.any() else worst(gap[pressed & far_from_end(scene, steps)])


def beyond_the_end(gap: np.ndarray, held: np.ndarray) -> np.ndarray:
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


def j_gap(scene: Scene, steps: Steps) -> np.ndarray | None:
    """(J - integral of p dg) / G_Ic at every step (n_steps,), 0 where that need not hold.

    Where pressed faces hold more than G_Ic it is J less that, a small difference of large terms: over what they hold.
    """
    if not has(steps, "face_slope_top", "face_slope_bottom", "face_energy", "tip_opening", "dissipated_energy"):
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
    return np.where(tip_is_open(scene, steps), law.toughness, law.area(steps["tip_opening"]))


def _turn(scene: Scene, steps: Steps) -> np.ndarray:
    """How far the loaded faces turn in the sense in which the load opens the specimen, of every step (n_steps,)."""
    top, bottom = steps["face_slope_top"], steps["face_slope_bottom"]
    pressed = top if scene.specimen.clamped else bottom - top
    return np.where(steps["opening"] < 0.0, pressed, np.abs(top) + np.abs(bottom))
