"""Deviations that the mesh explains: where the process zone is not resolved, a check gives no verdict on the solver."""

from __future__ import annotations

from math import isfinite, isnan, sqrt

import numpy as np

from verify.checks.mechanics.columns import has
from verify.checks.mechanics.j_integral import far_end_energy, far_end_loaded
from verify.methods import zone_resolution
from verify.methods.method import Prepared
from verify.methods.reference_mesh import reference_mesh
from verify.methods.zone_resolution import measured
from verify.result import Result
from verify.scene.process_zone import fading_length
from verify.verdict import Check


def explained(prepared: Prepared, elements: float) -> float:
    """Largest deviation of the J-integral, over G_Ic, that is explained by so many ``elements`` in the process zone.

    It falls with the square of their number n, as the law holds at the integration points only. For cubic and higher
    bases with 0.5 to 8 elements in the zone 0.14 to 0.43 over n^2 were measured (0.55 where the zone is shorter than
    the arms are thick, while it forms beside longer elements of the free arms), for quadratic ones 0.12 to 0.70, for
    DOLFINx 0.03 to 0.06 (0.28 with linear elements). Linear elements of ``iga`` lock in bending, however many.
    """
    if prepared.method.code != "iga":
        return (0.15 if reference_mesh(prepared.scene).degree > 1 else 0.5) / elements**2
    degree = prepared.scene.discretization.degree
    return 1.0 if degree == 1 else 3.0 / min(degree, 3) / elements**2


def too_coarse(prepared: Prepared, result: Result, check: Check) -> str:
    """Why a check that uses the J-integral gives no verdict, and the remedy; empty where the mesh does not explain the
    deviation."""
    deviation = abs(check.value)
    zone = prepared.zone
    length = measured(result)
    if isnan(length):  # no crack has grown, and what the mesh resolves least is how tractions fade on an intact bond
        slides = prepared.effects["shear"]
        length = min(zone.length, fading_length(prepared.scene)) if slides else zone.length
    elements = length / zone.element
    if not isfinite(elements) or not deviation <= explained(prepared, elements):
        return ""
    if prepared.method.code == "iga" and prepared.scene.discretization.degree == 1:
        return "linear elements lock in bending; discretization.degree = 2 resolves it"
    finer = zone.elements * 1.1 * sqrt(deviation / check.tolerance)
    remedy = zone_resolution.remedy(prepared, finer)
    return f"the process zone spans {elements:.2g} elements of the mesh; {remedy}"


def far_end_unresolved(prepared: Prepared, held: float) -> str:
    """The same where the far end carries load from the start and its energy ``held``, over G_Ic, explains it.

    Empty for a method without a mesh, whose far end is exact.
    """
    if isnan(prepared.element):
        return ""
    return (
        f"the far end takes part from the start on and holds up to {held:.2g} of G_Ic, on a spot of contact that the "
        f"mesh does not resolve; a larger specimen.{prepared.scene.specimen.bond_key} resolves it"
    )


def far_end_beside_beam(prepared: Prepared, beam: Result, check: Check) -> str:
    """The same of a curve against that of the beam, whose far end is exact; empty where that explains no such distance.

    A mesh finds the spot of contact at the far end to an element of length l. The specimen is longer or shorter by as
    much, which at each opening changes its energy by ``q w l``, with the energy q of the far end per area, and the load
    by the derivative: of the work W that is the part ``q w l / W``. A sixth and less was measured, falling with l.
    """
    scene, steps = prepared.scene, beam.steps
    if not has(steps, "tip_opening", "end_opening", "external_work") or not far_end_loaded(scene, steps):
        return ""
    held, work = float(np.nanmax(far_end_energy(scene, steps))), float(np.max(steps["external_work"]))
    explains = held * scene.interface.toughness * scene.specimen.width * prepared.element
    return far_end_unresolved(prepared, held) if abs(check.value) * work <= explains else ""
