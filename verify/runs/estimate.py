"""About how long a run takes, before it is made: for bars and for dry runs."""

from __future__ import annotations

from verify.methods.plugins import find
from verify.methods.reference_mesh import reference_mesh
from verify.methods.solve import prepare
from verify.scene.effects import crack_at_the_end
from verify.scene.process_zone import bulk_length, slender_length
from verify.scene.schema import Scene, counted_steps

#: While a crack grows the front of the zone goes ahead by an eighth of the full opening a step: so many steps for every
#: length of the zone, and so many besides. Measured on ``dcb-czm1`` and ``peel-120``, by both codes.
STEPS_PER_ZONE, STEPS_BESIDES = 8.2, 20
#: Steps that the path chooses itself, as many as take the same time if they are counted: each ends on a kink of the law
#: and takes half as many iterations again. Measured on ``dcb-czm1`` (29 steps) and ``peel-120`` (42).
STEPS_CHOSEN = 50


def seconds(scene: Scene, method: str) -> float:
    """Estimated time of a run: that besides the steps, and a step's in proportion to the unknowns.

    The times of the methods are those on `dcb-czm1`, finite kinematics, on one core of 2023. A rough guide: another
    machine is as likely to be twice as fast.
    """
    one = find(method)
    return one.besides + steps(scene, method) * one.per_step * unknowns(scene, method) / 1000


def steps(scene: Scene, method: str) -> int:
    """About how many steps a path takes, however many are asked for: the front of the zone asks for its own."""
    if scene.discretization.steps == "auto" and find(method).with_dofs:
        return STEPS_CHOSEN
    specimen = scene.specimen
    bond = specimen.extent - specimen.free_length
    grown = min(max(crack_at_the_end(scene) - specimen.free_length, 0.0), bond)
    zones = grown / min(slender_length(scene), bulk_length(scene))
    return round(max(counted_steps(scene), STEPS_BESIDES + STEPS_PER_ZONE * zones))


def unknowns(scene: Scene, method: str) -> int:
    """Degrees of freedom that a method aims at; 1000 for one that chooses its own."""
    prepared = prepare(scene, method)
    if prepared.method.with_dofs:
        return scene.discretization.dofs // (2 if prepared.effects["symmetry"] else 1)
    if not prepared.method.has_mesh:
        return 1000
    mesh = reference_mesh(scene)
    return 4 * (mesh.degree * mesh.elements + 1) * (mesh.degree * mesh.layers + 1)
