"""The J-integral of a run from its loaded faces, compared with the area under the law of its bond."""

from __future__ import annotations

import numpy as np

from verify.checks.mechanics.columns import (
    Steps,
    end_area,
    far_from_end,
    has,
    law_of,
    loading,
    tip_is_open,
    zone_is_new,
)
from verify.checks.mechanics.identity import identity
from verify.methods.method import Prepared
from verify.result import Result
from verify.scene import process_zone
from verify.scene.effects import simulated
from verify.scene.schema import Scene
from verify.theory.law import KNOWN_LAWS

#: Relative tolerance on a mesh that resolves the process zone.
J_TOLERANCE = 0.005
#: Energy at the far end, over G_Ic, up to which the whole deviation counts: half of the tolerance of J.
FAR_END_SHARE = 0.5 * J_TOLERANCE

J_OF_LAW = "The J-integral of the specimen is the area under the law."
J_OF_ANY_LAW = "The J-integral of the specimen is G_Ic once the bond has opened (of this law no check knows the shape)."


def j_tolerance(prepared: Prepared, result: Result) -> float:
    return max(J_TOLERANCE, prepared.method.mesh_error)


def _meaning(scene: Scene) -> str:
    return J_OF_LAW if scene.interface.law in KNOWN_LAWS else J_OF_ANY_LAW


@identity("j-integral", j_tolerance, _meaning, of_zone=True, of_face=True)
def j_deviation(scene: Scene, steps: Steps) -> np.ndarray | None:
    """|J - integral of p dg| / G_Ic at the steps with a positive opening.

    J w = load (|s_top| + |s_bottom|) - w sum over the end faces of the integral of W dY, with s the mean slope du_y/dX
    of the loaded face. It equals the area under the law up to the opening at the tip of the precrack (Rice 1968, J.
    Appl. Mech. 35, with dead tractions on the faces), less the area up to the gap at the far end, which is not 0 in a
    short ligament. With damage the identity holds while the interface loads, not while it unloads. For a law that
    `verify.theory.law` does not implement, the area is known below the strength and once the bond is fully open.

    Where faces touch beyond the bond, their tractions contribute from the mouth of the crack to its tip:
    ``- integral of p dg/dX = A(g_mouth) - A(g_tip)`` with the energy A of the contact, 0 for an open gap.

    The end faces are those of both bodies; the ones at the far end count negatively. They matter in a short ligament,
    where contact compresses them: with a stiff penalty they store more energy than the contact. The fixed base of a
    peel contributes nothing. Where the energy at the far end (`far_end_energy`) exceeds FAR_END_SHARE, on a spot
    that may be smaller than an element, only the deviation beyond that energy counts. Where it does so from the start,
    the whole deviation counts, and `unresolved.far_end_unresolved` explains a check without a verdict.
    """
    found = j_gap(scene, steps)
    if found is None or not (steps["opening"] > 0.0).any():
        return None
    gap, held = np.where(steps["opening"] >= 0.0, np.abs(found), 0.0), far_end_energy(scene, steps)
    return gap if far_end_loaded(scene, steps) else beyond_far_end(gap, held)


@identity(
    "j-pressed", 0.1, "The J-integral of pressed faces is the area under law and contact.", of_zone=True, of_face=True
)
def j_pressed(scene: Scene, steps: Steps) -> np.ndarray | None:
    """|J - integral of p dg| at negative openings, over the larger one of G_Ic and the contact energy at the
    mouth of the crack.

    The contact energy is computed at the edge of a body, where the stress varies within an element, and is only as
    accurate as the mesh there.
    """
    gap, pressed = j_gap(scene, steps), steps["opening"] < 0.0
    return None if gap is None or not pressed.any() else gap[pressed & far_from_end(scene, steps)]


def beyond_far_end(gap: np.ndarray, held: np.ndarray) -> np.ndarray:
    """The part of a deviation (n_steps,) beyond the energy at the far end."""
    beyond = np.where(held <= FAR_END_SHARE, gap, np.maximum(gap - held, 0.0))
    return np.where(np.isnan(held), 0.0, beyond)


def far_end_loaded(scene: Scene, steps: Steps) -> bool:
    """Whether the far end carries load before J has reached half of its largest value."""
    spent = np.nan_to_num(_area_at_tip(scene, steps))
    free = far_end_energy(scene, steps) <= FAR_END_SHARE
    return bool(np.max(spent, initial=0.0, where=free) < 0.5 * np.max(spent, initial=0.0))


def far_end_energy(scene: Scene, steps: Steps) -> np.ndarray:
    """Energy at the far end over G_Ic (n_steps,), NaN where the law is unknown.

    It is the area under the law there and, for a DCB, the strain energy of the end faces; that of the loaded faces is
    negligible in comparison. A traction p that decays through the arms stores at most ``p^2 h / E2`` in them.
    """
    law, body = law_of(scene), scene.specimen
    held = np.abs(end_area(scene, steps))
    if not body.clamped and "face_energy" in steps:
        below = law.penalty if law.contact else law.stiffness
        end = steps.get("end_opening", np.zeros(steps["opening"].size))
        traction = np.where(end < 0.0, below * np.abs(end), np.minimum(law.stiffness * np.abs(end), law.strength))
        most = traction**2 * body.loaded_thickness / process_zone.across_modulus(scene.materials[0], body.plane)
        held = held + np.clip(-steps["face_energy"], 0.0, most)
    return held / scene.interface.toughness


def j_gap(scene: Scene, steps: Steps) -> np.ndarray | None:
    """(J - integral of p dg) / G_Ic at every step (n_steps,), 0 where the identity does not hold; None without columns.

    Across the width of a solid the gap differs: its integral is that of p dg/dX over the bond, at any history.

    Where the contact energy exceeds G_Ic, it is the divisor: the gap is a small difference of large energies.
    """
    if not has(steps, "face_slope_top", "face_slope_bottom", "face_energy", "tip_opening", "dissipated_energy"):
        return None
    if simulated(scene)["shear"]:  # the work of sliding is not the area under the law of opening
        return None
    top, bottom, pressed = steps["face_slope_top"], steps["face_slope_bottom"], steps["opening"] < 0.0
    closing = top if scene.specimen.clamped else bottom - top
    turned = np.where(pressed, closing, np.abs(top) + np.abs(bottom))  # the loaded faces, in the sense of opening
    J = steps["load"] * turned / scene.specimen.width - steps["face_energy"]
    if scene.specimen.plane == "solid":
        return (J - steps["J_bond"]) / scene.interface.toughness if has(steps, "J_bond") else None
    law, spent, tip = law_of(scene), _area_at_tip(scene, steps), steps["tip_opening"]
    area = spent - end_area(scene, steps)
    scale = np.full(J.size, scene.interface.toughness)
    if "mouth_opening" in steps:
        touching = law.area(np.minimum(steps["mouth_opening"], 0.0))
        area += touching - law.area(np.minimum(tip, 0.0))
        scale = np.maximum(scale, touching)
    irreversible = simulated(scene)["irreversible"]
    valid = loading(steps) & zone_is_new(scene, steps) if irreversible else np.ones(J.size, dtype=bool)
    valid &= ~np.isnan(spent) | np.isnan(tip)  # not on a branch of a law that is not implemented here
    return np.where(valid, J - area, 0.0) / scale


def _area_at_tip(scene: Scene, steps: Steps) -> np.ndarray:
    """Area under the law up to the gap at the tip of the precrack (n_steps,)."""
    law = law_of(scene)
    return np.where(tip_is_open(scene, steps), law.toughness, law.area(steps["tip_opening"]))
