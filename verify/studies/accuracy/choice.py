"""Choice of method and meshes for an accuracy.

Where ``debond cost`` has studied the same scene, its Pareto front decides. Otherwise the number of elements in the
process zone is interpolated in `known.csv`, whose header has the origin of the numbers. The choice is verified by
solving on finer meshes (`verify.studies.accuracy.verified`).
"""

from __future__ import annotations

import csv
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import ceil
from pathlib import Path
from typing import Any

import numpy as np

from iga.bases.names import BASES
from verify.methods.mesh_choice import size, spline_mesh
from verify.methods.method import Unsuitable
from verify.methods.names import WITH_DOFS
from verify.methods.reference_mesh import reference_mesh, thickness_error
from verify.methods.solve import prepare, require
from verify.methods.zone_resolution import expected
from verify.runs.environment import machine
from verify.runs.estimate import unknowns
from verify.runs.fingerprint import source
from verify.scene.parse import SceneError, parse_scene
from verify.scene.schema import DEFAULT_STEPS, Scene, bend, counted_steps
from verify.studies.cost.ladder import LADDER
from verify.support.checked_files import Damaged, read_json
from verify.support.progress import duration
from verify.support.refusal import NotRun, Refusal
from verify.support.say import say

KNOWN = Path(__file__).with_name("known.csv")

#: The method that is chosen where there is only the table, and the highest degrees of those whose meshes can be refined.
CHOSEN = "nurbs"
HIGHEST = {**{name: max(BASES[name].degrees) for name in WITH_DOFS}, "dolfinx": 4}


@dataclass(frozen=True)
class Guess:
    """Constants of the choice.

    finest, coarsest : range of accuracies
    safety : number of elements over that of the table; larger values cost time and make a second choice rarer
    largest : largest number of unknowns
    through : part of the accuracy up to which the error of one quadratic element through an arm is allowed
    bend : for steps "auto": allowed distance of the load from its tangent, over the accuracy; and the least one
    ratio, more_steps : elements along the specimen, and steps, of a level over those of the level before; the steps end
        elsewhere
    """

    finest: float = 0.0005
    coarsest: float = 0.05
    safety: float = 1.2
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
            if run["curve_error"] > accuracy or run["solver"] not in HIGHEST:
                continue
            require(prepare(parse_scene(scene.model_dump(), overrides), run["solver"]))
        except (NotRun, Refusal):
            continue
        what = f"{run['method']} of degree {run['degree']} with {run['dofs']} unknowns"
        took = f"took {duration(run['seconds'])} in {study} and was within {run['curve_error']:.2g}"
        return Choice(run["solver"], overrides, f"{what}: {took}")
    return _from_table(scene, accuracy)


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


def _from_table(scene: Scene, accuracy: float) -> Choice:
    """NURBS with at least the number of steps of the scene, or for steps "auto" a bend no larger than that of the
    scene."""
    degree, asked = 2 if thickness_error(scene, 2, 1) <= GUESS.through * accuracy else 3, scene.discretization
    steps = f"discretization.steps={max(counted_steps(scene), DEFAULT_STEPS)}"
    if asked.steps == "auto":
        steps = f"discretization.bend={min(bend(scene), max(GUESS.bend * accuracy, GUESS.least_bend))!r}"
    overrides = (steps, *with_elements(scene, CHOSEN, degree, GUESS.safety * elements_for(accuracy)))
    chosen = parse_scene(scene.model_dump(), overrides)
    require(prepare(chosen, CHOSEN))
    mesh = f"NURBS of degree {degree} with {unknowns(chosen, CHOSEN)} unknowns"
    return Choice(CHOSEN, overrides, f"{mesh}, {expected(chosen, CHOSEN).elements:.1f} elements in the process zone")


def elements_for(accuracy: float) -> float:
    """Elements in the process zone for which the curve error of every scene in the table is at most ``accuracy``."""
    with KNOWN.open(newline="") as stream:
        rows = list(csv.DictReader(line for line in stream if not line.startswith("#")))
    scenes = dict.fromkeys(row["scene"] for row in rows)
    return max(_crossing([row for row in rows if row["scene"] == scene], accuracy) for scene in scenes)


def _crossing(rows: Sequence[Mapping[str, str]], accuracy: float) -> float:
    """Number of elements from which on the error stays below ``accuracy``; extrapolated beyond the table.

    A mesh with a smaller error than a finer mesh is good by chance and does not count.
    """
    e, error = (np.log([float(row[key]) for row in rows]) for key in ("elements", "curve_error"))
    counts = error == np.maximum.accumulate(error[::-1])[::-1]
    e, error = e[counts], error[counts]
    if np.log(accuracy) < error[-1]:
        return float(np.exp(e[-1] + (np.log(accuracy) - error[-1]) / np.polyfit(e, error, 1)[0]))
    return float(np.exp(np.interp(-np.log(accuracy), -error, e)))


def with_elements(scene: Scene, method: str, degree: int, elements: float) -> tuple[str, ...]:
    """Overrides for a mesh of an `iga` method with at least ``elements`` elements in the process zone.

    The mesh has this degree through the arms as well, where coarse meshes of higher degree are quadratic.

    Raises
    ------
    Refusal : no mesh is fine enough.
    """
    points = max(degree + LADDER.more_points, spline_mesh(scene).points)
    of_degree = (f"discretization.degree={degree}", f"discretization.interface_points={points}")
    for more in elements * 1.2 ** np.arange(20):
        overrides = (*of_degree, "discretization.dofs=auto", f"discretization.in_a_zone={more:.6g}")
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
    thickness of the arms, or more layers.

    Parameters
    ----------
    scene, overrides : the scene of this level, which contains its overrides, and these overrides
    more : ratio of the numbers of steps

    Raises
    ------
    Refusal : no finer mesh is possible.
    """
    splines = method in WITH_DOFS
    own = scene.discretization.degree if splines else reference_mesh(scene).degree
    degree = min(own + 1, HIGHEST[method])
    if splines:
        mesh = with_elements(scene, method, degree, GUESS.ratio * expected(scene, method).elements)
    else:
        layers = reference_mesh(scene).layers + (degree == own)
        along = size(scene, splines=False).times(GUESS.ratio).override
        mesh = (f"dolfinx.degree={degree}", along, f"dolfinx.layers={layers}")
    steps = f"discretization.steps={ceil(more * counted_steps(scene))}"
    if prepare(scene, method).by_accuracy:
        steps = f"discretization.bend={max(bend(scene) / more**2, GUESS.least_bend)!r}"
    return tuple({one.partition("=")[0]: one for one in (*overrides, steps, *mesh)}.values())
