"""Deviations that the mesh explains: a check gives no verdict on the solver where the process zone is not resolved."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite, isnan, sqrt

import numpy as np

from verify.checks.mechanics.columns import has
from verify.checks.mechanics.j_integral import far_end_energy, far_end_loaded
from verify.methods import zone_resolution
from verify.methods.mesh_choice import of_stiffness
from verify.methods.method import Prepared
from verify.methods.reference_mesh import reference_mesh
from verify.methods.zone_resolution import measured
from verify.result import Result
from verify.scene.process_zone import fading_length
from verify.verdict import Check

#: Deviation of J, over G_Ic, times the square of the number of elements in the process zone: of arms, and by the degree
#: of the elements of the plane codes.
LEFT_BY_ARMS = 0.25
LEFT_BY_IGA, LEFT_BY_DOLFINX = {1: 1.0, 2: 1.5, 3: 1.0}, {1: 1.0, 2: 0.5, 3: 0.15}


def explained(prepared: Prepared, elements: float) -> float:
    """Largest deviation of the J-integral, over G_Ic, that ``elements`` elements in the process zone explain.

    It falls with the square of their number n, as the law holds at the integration points only. For cubic and higher
    bases with 0.5 to 8 elements in the zone 0.14 to 0.43 over n^2 were measured (0.55 where the zone is shorter than
    the arms are thick, while it forms beside longer elements of the free arms), for quadratic ones 0.12 to 0.70. Of
    DOLFINx, on slender and stocky arms with 0.2 to 14 elements, 0.2 to 0.71 were measured with linear, 0.02 to 0.39
    with quadratic and 0.01 to 0.11 with cubic elements, the largest with stiff bonds (a ductility of 28,000). Linear
    elements of ``iga`` lock in bending, however many. A lumped rule has one point for each element where Gauss rules
    have two or more: with the square of the distance of points, four times as much (0.5 to 1.1 over n^2 were measured).
    """
    if prepared.method.code != "iga":
        return LEFT_BY_DOLFINX[min(reference_mesh(prepared.scene).degree, 3)] / elements**2
    mesh = prepared.scene.discretization
    sparse = 4.0 if mesh.interface_rule == "lumped" else 1.0
    return sparse * LEFT_BY_IGA[min(mesh.degree, 3)] / (1.0 if mesh.degree == 1 else elements**2)


def too_coarse(prepared: Prepared, result: Result, check: Check) -> str:
    """Why a check that uses the J-integral gives no verdict, and the remedy; empty where the mesh does not explain the
    deviation.

    The zone is as long as it was measured, but no longer than estimated: on a mesh that is too coarse damage spreads
    over four times the length and more.
    """
    deviation, in_a_zone = abs(check.value), prepared.scene.beam.in_a_zone
    if prepared.method.code == "beam":
        if check.name != "j-integral" or deviation > LEFT_BY_ARMS / in_a_zone**2:
            return ""
        finer = in_a_zone * 1.1 * sqrt(deviation / check.tolerance)
        return f"the process zone spans {in_a_zone:.2g} elements of the beam; beam.in_a_zone = {finer:.2g} resolves it"
    zone = prepared.zone
    length = measured(result)
    if isnan(length):  # no crack has grown: the length over which tractions decay in an intact bond may be shorter
        length = fading_length(prepared.scene) if prepared.effects["shear"] else zone.length
    length = min(length, zone.length)
    elements = zone.resolving(length)
    if not isfinite(elements) or not deviation <= explained(prepared, elements):
        return ""
    if prepared.method.code == "iga" and prepared.scene.discretization.degree == 1:
        return "linear elements lock in bending; discretization.degree = 2 resolves it"
    finer = zone.elements * 1.1 * sqrt(deviation / check.tolerance)
    remedy = zone_resolution.remedy(prepared, finer)
    return f"the process zone spans {elements:.2g} elements of the mesh; {remedy}"


def too_coarse_for_a_curve(pair: Sequence[Prepared], check: Check) -> str:
    """Why the curves of two runs, or of one, give no verdict, and the remedies; empty where their meshes do not explain
    the deviation.

    A zone of few elements takes a part e of G_c more or less, at most what it explains of J. The load of a growing
    crack goes with G_c at most where one is peeled off, and with its power 3/4 in a DCB. On rollers load and opening go
    with its square root each, which changes the curve by ``e / 2`` and by ``e / 2`` times `of_stiffness`. Elements
    through the thickness explain their estimated error.
    """
    said, explains = [], check.tolerance
    for prepared in pair:
        if few := zone_resolution.warnings(prepared):
            of_curve = max(1.0, 0.5 + 0.5 * of_stiffness(prepared.scene))
            explains += explained(prepared, prepared.zone.elements) * of_curve
        thin = zone_resolution.too_few_layers(prepared)
        explains += zone_resolution.error_of_layers(prepared) if thin else 0.0
        said += [f"{prepared.method.name}: {text}" for text in (*few, *thin)]
    return "; ".join(said) if abs(check.value) <= explains else ""


def far_end_unresolved(prepared: Prepared, held: float) -> str:
    """Why the J-integral gives no verdict where the far end carries load from the start, and the remedy.

    ``held`` is the energy at the far end over G_Ic, which explains the deviation. Empty for a method without a mesh,
    whose far end is exact.
    """
    if isnan(prepared.element):
        return ""
    return (
        f"the far end takes part from the start on and holds up to {held:.2g} of G_Ic, on a spot of contact that the "
        f"mesh does not resolve; a larger specimen.{prepared.scene.specimen.bond_key} resolves it"
    )


def far_end_beside_beam(prepared: Prepared, beam: Result, check: Check) -> str:
    """The same of a curve against that of the beam, whose far end is exact; empty where that explains no such distance.

    A mesh locates the spot of contact at the far end within an element of length l, so that the specimen seems longer
    or shorter by l. With the energy q of the far end per area that changes the energy by ``q w l`` at each opening, and
    the load by the derivative: relative to the work W by ``q w l / W``. At most a sixth of it was measured, and less on
    finer meshes.
    """
    scene, steps = prepared.scene, beam.steps
    if not has(steps, "tip_opening", "end_opening", "external_work") or not far_end_loaded(scene, steps):
        return ""
    held, work = float(np.nanmax(far_end_energy(scene, steps))), float(np.max(steps["external_work"]))
    explains = held * scene.interface.toughness * scene.specimen.width * prepared.element
    return far_end_unresolved(prepared, held) if abs(check.value) * work <= explains else ""
