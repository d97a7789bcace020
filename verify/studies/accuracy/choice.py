"""Choice of method and meshes for an accuracy.

Where ``debond cost`` has studied the same scene, its Pareto front decides. Otherwise the number of elements in the
process zone is that of meshes that are chosen for an accuracy (`verify.methods.mesh_choice.MeshRule`). The choice is
verified by solving on finer meshes (`verify.studies.accuracy.verified`).
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import ceil
from pathlib import Path
from typing import Any

from iga.bases.names import BASES
from verify.methods.mesh_choice import MESH_RULE, spline_mesh
from verify.methods.method import Unsuitable
from verify.methods.names import WITH_DOFS
from verify.methods.reference_mesh import thickness_error
from verify.methods.solve import prepare, require
from verify.methods.zone_resolution import expected
from verify.runs.environment import machine
from verify.runs.estimate import unknowns
from verify.runs.fingerprint import source
from verify.scene.parse import SceneError, parse_scene
from verify.scene.schema import DEFAULT_STEPS, Scene, bend, counted_steps
from verify.studies.cost.grid import GRID
from verify.support.checked_files import Damaged, read_json
from verify.support.progress import duration
from verify.support.refusal import NotRun, Refusal
from verify.support.say import say

#: The method that is chosen where there is no study; those whose meshes are refined are the bases of `iga`.
CHOSEN = "nurbs"


@dataclass(frozen=True)
class Guess:
    """Constants of the choice.

    finest, coarsest : range of accuracies
    largest : largest number of unknowns
    through : part of the accuracy up to which the error of one quadratic element through an arm is allowed
    bend : for steps "auto": allowed distance of the load from its tangent, over the accuracy; and the least one
    ratio, more_steps : elements along the specimen, and steps, of a level over those of the level before; the steps end
        elsewhere
    """

    finest: float = 0.0005
    coarsest: float = 0.05
    largest: int = 1_000_000
    through: float = 0.25
    bend: float = 1.0
    least_bend: float = 1e-5
    ratio: float = 1.5
    more_steps: float = 1.1


GUESS = Guess()

#: Layout of the part of ``cost.json`` that is read.
_STUDY = {
    "scene": dict,
    "machine": dict,
    "source": str,
    "pareto": [
        {
            **dict.fromkeys(("method", "solver"), str),
            **dict.fromkeys(("degree", "dofs"), int),
            **dict.fromkeys(("curve_error", "seconds"), float),
            "overrides": [str],
        }
    ],
}


@dataclass(frozen=True)
class Choice:
    """The first run for an accuracy: method, overrides of the scene, and the reasons in words."""

    method: str
    overrides: tuple[str, ...]
    why: str


def choose(scene: Scene, accuracy: float, study: Path) -> Choice:
    """Choice of method and first mesh for a curve error of at most ``accuracy``, with the effects of the scene.

    Parameters
    ----------
    study : path of a ``cost.json``; used if it is of the same scene, machine and version of the source

    Raises
    ------
    Refusal : an accuracy out of range, or a scene for which no mesh is fine enough.
    """
    if not GUESS.finest <= accuracy <= GUESS.coarsest:
        raise Refusal(f"--accuracy: must be >= {GUESS.finest:.2%} and <= {GUESS.coarsest:.0%}, got {100 * accuracy:g}%")
    for run in _same_study(scene, study):
        overrides = tuple(one for one in run["overrides"] if not one.startswith("effects."))
        try:
            if run["curve_error"] > accuracy or run["solver"] not in WITH_DOFS:
                continue
            require(prepare(parse_scene(scene.model_dump(), overrides), run["solver"]))
        except (NotRun, Refusal):
            continue
        what = f"{run['method']} of degree {run['degree']} with {run['dofs']} unknowns"
        took = f"took {duration(run['seconds'])} in {study} and was within {run['curve_error']:.2g}"
        return Choice(run["solver"], overrides, f"{what}: {took}")
    return _by_rule(scene, accuracy)


def _same_study(scene: Scene, path: Path) -> Sequence[Mapping[str, Any]]:
    """Runs of the study, quickest first; empty if it is damaged or of another problem, machine or source."""
    if not path.exists():
        return ()
    try:
        found = read_json(path, _STUDY)
    except Damaged as error:
        say(f"{error}; it does not count")
        return ()
    meshes = {"discretization", "dolfinx", "published"}
    ours = json.loads(scene.model_dump_json(exclude=meshes))
    theirs = {key: value for key, value in found["scene"].items() if key not in meshes}
    same = (theirs, found["machine"], found["source"]) == (ours, machine(), source(("iga", "fem_reference")))
    return sorted(found["pareto"], key=lambda run: run["seconds"]) if same else ()


def _by_rule(scene: Scene, accuracy: float) -> Choice:
    """NURBS with at least the number of steps of the scene, or for steps "auto" a bend no larger than that of the
    scene."""
    degree, asked = 2 if thickness_error(scene, 2, 1) <= GUESS.through * accuracy else 3, scene.discretization
    steps = f"discretization.steps={max(counted_steps(scene), DEFAULT_STEPS)}"
    if asked.steps == "auto":
        steps = f"discretization.bend={min(bend(scene), max(GUESS.bend * accuracy, GUESS.least_bend))!r}"
    overrides = (steps, *with_elements(scene, CHOSEN, degree, (MESH_RULE.error / accuracy) ** 0.5))
    chosen = parse_scene(scene.model_dump(), overrides)
    require(prepare(chosen, CHOSEN))
    finer(chosen, CHOSEN, overrides)  # refused now where nothing could verify it
    mesh = f"NURBS of degree {degree} with {unknowns(chosen, CHOSEN)} unknowns"
    return Choice(CHOSEN, overrides, f"{mesh}, {expected(chosen, CHOSEN).elements:.1f} elements in the process zone")


def with_elements(scene: Scene, method: str, degree: int, elements: float) -> tuple[str, ...]:
    """Overrides for a mesh of an `iga` method with at least ``elements`` elements in the process zone.

    The mesh has this degree through the arms as well, where coarse meshes of higher degree are quadratic.

    Raises
    ------
    Refusal : no mesh is fine enough.
    """
    points = max(degree + GRID.more_points, spline_mesh(scene).points)
    of_degree = (f"discretization.degree={degree}", f"discretization.interface_points={points}")
    for power in range(20):
        overrides = (*of_degree, "discretization.dofs=auto", f"discretization.in_a_zone={elements * 1.2**power:.6g}")
        try:
            mesh = prepare(parse_scene(scene.model_dump(), overrides), method).mesh
        except (SceneError, Unsuitable):  # more elements in a zone, or on the way of the crack, than there may be
            break
        if mesh is not None and mesh.unknowns > GUESS.largest:
            break
        if mesh is not None and mesh.degree >= degree:
            return overrides
    raise Refusal(f"--accuracy: no mesh is known with {elements:.1f} elements in the process zone of {scene.name}")


def finer(scene: Scene, method: str, overrides: Sequence[str] = (), more: float = GUESS.more_steps) -> tuple[str, ...]:
    """Overrides of the next level: more elements along the specimen, and a higher degree, which also refines the
    thickness of the arms.

    Parameters
    ----------
    scene, overrides : the scene of this level, which contains its overrides, and these overrides
    more : ratio of the numbers of steps

    Raises
    ------
    Refusal : no finer mesh is possible.
    """
    degree = min(scene.discretization.degree + 1, max(BASES[method].degrees))
    mesh = with_elements(scene, method, degree, GUESS.ratio * expected(scene, method).elements)
    steps = f"discretization.steps={ceil(more * counted_steps(scene))}"
    if prepare(scene, method).by_accuracy:
        steps = f"discretization.bend={max(bend(scene) / more**2, GUESS.least_bend)!r}"
    return tuple({one.partition("=")[0]: one for one in (*overrides, steps, *mesh)}.values())
