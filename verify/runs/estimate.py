"""Estimated time of a run, for progress bars and dry runs."""

from __future__ import annotations

from dataclasses import dataclass

from verify.methods.plugins import find
from verify.methods.solve import prepare
from verify.scene.effects import crack_at_the_end
from verify.scene.process_zone import bulk_length, slender_length
from verify.scene.schema import Scene, bend, counted_steps


@dataclass(frozen=True)
class StepCounts:
    """Numbers of steps of about two iterations each, by the lengths of the process zone that a crack grows.

    per_zone, others : counted steps per length, as a step advances the front by an eighth of the full opening, and all
        other steps; of both codes, measured on ``dcb-czm1`` and ``peel-120``
    per_zone_chosen, others_chosen : those of "auto" with this ``bend``, of which each ends on a kink of the law; the
        error of a step goes with its square. Iterations of both codes on forty scenes of ordinary materials
        (`verify.scene.by_seed.plain_scenes`) were about 0.6 to 1.7 of it for four in five
    sliding : factor where arms slide: twice the iterations, each of which takes longer
    across : factor of a step of a solid for each function or node across its width, which widens the band; a linear
        solid that opens is condensed by NURBS, where that is ``condensed``, and one that slides searches, where it is
        ``searched``. Fitted to 21 solids: of 12 that took 3 s or more, 10 took 0.6 to 1.5 times what is announced, and
        two 0.43 and 2.9 times; those that took less than 3 s, down to 0.16 times
    """

    per_zone: float = 8.2
    others: int = 20
    per_zone_chosen: float = 7.0
    others_chosen: int = 10
    bend: float = 0.005
    sliding: float = 4.0
    across: float = 0.6
    condensed: float = 0.1
    searched: float = 2.0


STEP_COUNTS = StepCounts()


def seconds(scene: Scene, method: str) -> float:
    """Estimated time of a run: a fixed time, plus a time per step that is proportional to the unknowns.

    The times of the methods were measured on `dcb-czm1` with finite kinematics on one core of 2023; other machines may
    be twice as fast or slow.
    """
    one = find(method)
    time = one.besides + steps(scene, method) * one.per_step * unknowns(scene, method) / 1000
    return time * _wide(scene, method) if scene.specimen.plane == "solid" else time


def _wide(scene: Scene, method: str) -> float:
    """By how much a solid takes longer than a plane of as many unknowns."""
    prepared, factor = prepare(scene, method), STEP_COUNTS.across
    if scene.specimen.slides:
        factor = STEP_COUNTS.searched
    elif method == "nurbs" and prepared.effects["kinematics"] == "linear":
        factor = STEP_COUNTS.condensed
    try:
        return max(1.0, factor * prepared.mesh.across) if prepared.mesh else 1.0
    except ValueError:
        return 1.0


def steps(scene: Scene, method: str) -> int:
    """Estimated number of steps: at least those asked for, more where the process zone limits the step length."""
    specimen, by_accuracy = scene.specimen, prepare(scene, method).by_accuracy
    bond = specimen.extent - specimen.free_length
    grown = min(max(crack_at_the_end(scene) - specimen.free_length, 0.0), bond)
    zones = grown / min(slender_length(scene), bulk_length(scene))
    slides = STEP_COUNTS.sliding if specimen.slides else 1.0
    if not by_accuracy:
        return round(max(counted_steps(scene), STEP_COUNTS.others + STEP_COUNTS.per_zone * zones) * slides)
    few = STEP_COUNTS.others_chosen + STEP_COUNTS.per_zone_chosen * zones
    return round(few * slides * max(STEP_COUNTS.bend / bend(scene), 1.0) ** 0.5)


def unknowns(scene: Scene, method: str) -> int:
    """Number of unknowns of a method; where none can be made, or of one without a mesh, 1000, which go with the order
    of a beam."""
    prepared, dofs = prepare(scene, method), scene.discretization.dofs
    if prepared.method.with_dofs and dofs != "auto":
        return dofs // (2 if prepared.effects["symmetry"] else 1)
    try:
        return 500 * (scene.beam.order + 1) if prepared.mesh is None else prepared.mesh.unknowns
    except ValueError:
        return 1000
