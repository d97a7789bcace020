"""Whether a mesh resolves an arm, or a strip, through its thickness; more elements along it cannot replace this."""

from __future__ import annotations

from verify.methods.method import Prepared
from verify.methods.reference_mesh import thickness_error

#: Error of the load curve from the mesh through the thickness above which there is a warning: the tolerance between
#: codes.
NAMED = 0.005


def warnings(prepared: Prepared) -> tuple[str, ...]:
    """One sentence, with a remedy, before a run whose elements are too few through the thickness."""
    scene = prepared.scene
    if thickness_error(scene, 2, 1) <= NAMED or scene.specimen.mesh:
        return ()
    try:
        mesh = prepared.mesh
    except ValueError:  # `require` refuses this scene
        return ()
    if mesh is None or not mesh.layers:
        return ()
    error = thickness_error(scene, min(mesh.degree, 4), mesh.layers)
    if error <= NAMED:
        return ()
    there = f"{mesh.layers} element{'s' * (mesh.layers > 1)} of degree {mesh.degree} through the {scene.specimen.body}"
    finer = "discretization.layers larger" if scene.discretization.degree > 2 else "discretization.degree = 3"
    remedy = finer if prepared.method.with_dofs else "dolfinx.layers or dolfinx.degree larger"
    return (f"{there}: the load may be off by {error:.1%}, however many elements along it; {remedy} resolves it",)
