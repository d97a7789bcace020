"""Number of elements in the process zone, before and after a run, and the mesh size that would resolve it; whether a
mesh resolves an arm, or a strip, through its thickness, which more elements along it cannot replace."""

from __future__ import annotations

from dataclasses import replace
from math import nan

import numpy as np

from verify.methods.mesh_choice import size
from verify.methods.method import ENOUGH, Prepared, Zone
from verify.methods.reference_mesh import thickness_error
from verify.methods.solve import prepare
from verify.result import Result
from verify.scene.schema import Scene

#: Meshes with fewer unknowns are made to test whether they resolve a zone; the size of larger ones is extrapolated.
AT_HAND = 5000
#: Error of the load curve from the mesh through the thickness above which there is a warning: the tolerance between
#: codes.
NAMED = 0.005


def expected(scene: Scene, method: str) -> Zone:
    """Zone and elements of a scene solved by one method."""
    return prepare(scene, method).zone


def warnings(prepared: Prepared) -> tuple[str, ...]:
    """One sentence, with a remedy, before a run whose mesh cannot resolve the process zone."""
    zone = prepared.zone
    if zone.resolved:
        return ()
    parts = [part.strip() for part in prepared.scene.units.split(",")]
    unit = f" {parts[1]}" if len(parts) == 3 else ""
    falls = "process zone" if zone.steepness == 1.0 else "fall of the traction"
    length = zone.elements * zone.element
    spans = (
        f"{falls} {length:.2g}{unit} < element {zone.element:.2g}{unit}"
        if zone.elements < 1
        else f"{falls} {length:.2g}{unit} spans {zone.elements:.1f} elements of {zone.element:.2g}{unit}, "
        f"fewer than {ENOUGH}"
    )
    return (
        f"{spans}: expect too high a load and snap-backs from element to element; {remedy(prepared)}, "
        "or a lower interface.strength",
    )


def too_few_layers(prepared: Prepared) -> tuple[str, ...]:
    """One sentence, with a remedy, before a run whose elements are too few through the thickness."""
    scene, error = prepared.scene, error_of_layers(prepared)
    mesh = prepared.mesh if error > NAMED else None
    if mesh is None:
        return ()
    there = f"{mesh.layers} element{'s' * (mesh.layers > 1)} of degree {mesh.degree} through the {scene.specimen.body}"
    finer = "discretization.layers larger" if scene.discretization.degree > 2 else "discretization.degree = 3"
    remedy = finer if prepared.method.with_dofs else "dolfinx.layers or dolfinx.degree larger"
    return (f"{there}: the load may be off by {error:.1%}, however many elements along it; {remedy} resolves it",)


def error_of_layers(prepared: Prepared) -> float:
    """Estimate of the error of the load curve from the elements through the thickness; 0 where none is known."""
    scene = prepared.scene
    if thickness_error(scene, 2, 1) <= NAMED or scene.specimen.mesh:
        return 0.0
    try:
        mesh = prepared.mesh
    except ValueError:  # `require` refuses this scene
        return 0.0
    return thickness_error(scene, min(mesh.degree, 4), mesh.layers) if mesh is not None and mesh.layers else 0.0


def measured(result: Result) -> float:
    """Median length of the zone over the steps at which a crack runs, NaN where there is none.

    It reaches from the foremost fully open point to the foremost damaged one. Steps at which the latter has reached its
    last place, such as the end of the specimen, do not count, as the zone is not complete then.
    """
    steps = result.steps
    if not {"crack_length", "damage_front"} <= set(steps) or result.opening.size == 0:
        return nan
    crack, front = steps["crack_length"], steps["damage_front"]
    running = (crack > crack[0]) & (front < front.max())
    return float(np.median((front - crack)[running])) if running.any() else nan


def summary(prepared: Prepared, result: Result) -> dict[str, float]:
    """The entry ``process_zone`` of result.json; NaN where a number is not known."""
    zone, length = prepared.zone, measured(result)
    return {
        "estimate": zone.length,
        "elements": zone.elements,
        "measured": length,
        "measured_elements": zone.resolving(length),
    }


def element_length(scene: Scene, method: str) -> float:
    """Longest element along the bond, NaN for a method without a mesh, or where none can be made."""
    return prepare(scene, method).element


def remedy(prepared: Prepared, elements: float = ENOUGH) -> str:
    """The mesh setting with which ``elements`` elements span the zone, in words."""
    scene, method = prepared.scene, prepared.method
    if scene.specimen.mesh and method.with_dofs:
        return f"a mesh with {elements:.2g} elements in it resolves it"
    now = size(scene, method.with_dofs)
    if now.key.endswith("in_a_zone"):
        return f"{now.key} = {now.value * elements / prepared.zone.elements:.2g} resolves it"
    wanted = _rounded(now.value * elements / prepared.zone.elements)
    while method.with_dofs and wanted < AT_HAND and _with_dofs(prepared, wanted).elements < elements:
        wanted = _rounded(1.05 * wanted)
    return f"{now.key} = {wanted} resolves it"


def _with_dofs(prepared: Prepared, dofs: int) -> Zone:
    mesh = prepared.scene.discretization.model_copy(update={"dofs": dofs})
    return replace(prepared, scene=prepared.scene.model_copy(update={"discretization": mesh})).zone


def _rounded(number: float) -> int:
    """Rounded up to two significant digits."""
    digits = 10 ** max(len(str(int(number))) - 2, 0)
    return int(np.ceil(number / digits) * digits)
