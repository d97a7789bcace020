"""Estimated time of a run, for progress bars and dry runs."""

from __future__ import annotations

from verify.methods.plugins import find
from verify.methods.reference_mesh import reference_mesh
from verify.methods.solve import prepare
from verify.scene.effects import crack_at_the_end
from verify.scene.process_zone import bulk_length, slender_length
from verify.scene.schema import Scene, counted_steps

#: During crack growth a step advances the front by an eighth of the full opening: number of steps per length of the
#: process zone, and number of other steps. Measured on ``dcb-czm1`` and ``peel-120`` with both codes.
STEPS_PER_ZONE, STEPS_BESIDES = 8.2, 20
#: Number of counted steps that take as long as the steps of "auto", each of which ends on a kink of the law and needs
#: 1.5 times the iterations. Measured on ``dcb-czm1`` (29 steps) and ``peel-120`` (42).
STEPS_CHOSEN = 50


def seconds(scene: Scene, method: str) -> float:
    """Estimated time of a run: a fixed time, plus a time per step that is proportional to the unknowns.

    The times of the methods were measured on `dcb-czm1` with finite kinematics on one core of 2023; other machines may
    be twice as fast or slow.
    """
    one = find(method)
    return one.besides + steps(scene, method) * one.per_step * unknowns(scene, method) / 1000


def steps(scene: Scene, method: str) -> int:
    """Estimated number of steps: at least those asked for, more where the process zone limits the step length."""
    if scene.discretization.steps == "auto" and find(method).with_dofs:
        return STEPS_CHOSEN
    specimen = scene.specimen
    bond = specimen.extent - specimen.free_length
    grown = min(max(crack_at_the_end(scene) - specimen.free_length, 0.0), bond)
    zones = grown / min(slender_length(scene), bulk_length(scene))
    return round(max(counted_steps(scene), STEPS_BESIDES + STEPS_PER_ZONE * zones))


def unknowns(scene: Scene, method: str) -> int:
    """Target number of unknowns of a method; 1000 for a method without a mesh."""
    prepared = prepare(scene, method)
    if prepared.method.with_dofs:
        return scene.discretization.dofs // (2 if prepared.effects["symmetry"] else 1)
    if not prepared.method.has_mesh:
        return 1000
    mesh = reference_mesh(scene)
    return 4 * (mesh.degree * mesh.elements + 1) * (mesh.degree * mesh.layers + 1)
