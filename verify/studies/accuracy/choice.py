"""Choice of method and first mesh, and prediction of the time of the run.

Where ``debond cost`` has studied the same scene, its Pareto front decides. Otherwise the number of elements in the
process zone is interpolated in `known.csv`, whose header has the origin of the numbers. A trial of a few steps on the
chosen mesh measures the time of an iteration; the number of iterations follows from the expected crack growth. The
choice is verified by solving on finer meshes (`verify.studies.accuracy.verified`).
"""

from __future__ import annotations

import csv
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

from verify.methods.mesh_choice import spline_mesh
from verify.methods.method import Unsuitable
from verify.methods.names import WITH_DOFS
from verify.methods.reference_mesh import thickness_error
from verify.methods.solve import prepare, require, solve
from verify.methods.zone_resolution import expected
from verify.runs.environment import machine
from verify.runs.estimate import steps, unknowns
from verify.runs.fingerprint import source
from verify.scene.parse import SceneError, parse_scene
from verify.scene.schema import DEFAULT_STEPS, Scene, bend
from verify.studies.cost.ladder import LADDER
from verify.support.checked_files import Damaged, read_json
from verify.support.progress import duration
from verify.support.refusal import NotRun, Refusal
from verify.support.say import say

KNOWN = Path(__file__).with_name("known.csv")

#: The method that is chosen where there is only the table, and the methods whose meshes can be refined.
CHOSEN, REFINED = "nurbs", (*WITH_DOFS, "dolfinx")


@dataclass(frozen=True)
class Guess:
    """Constants of the first choice.

    finest, coarsest : range of accuracies
    safety : number of elements over that of the table; larger values cost time and make a second choice rarer
    largest : largest number of unknowns
    through : part of the accuracy up to which the error of one quadratic element through an arm is allowed
    bend : for steps "auto": allowed distance of the load from its tangent, over the accuracy
    iterations : Newton iterations per step with finite kinematics, in units of those of the trial: 3.0 to 4.0 on random
        scenes, and iterations with damage take longer. A linear bulk needs one
    trial, trial_steps : part of the programme that a trial runs, and its number of steps
    """

    finest: float = 0.0005
    coarsest: float = 0.05
    safety: float = 1.2
    largest: int = 1_000_000
    through: float = 0.25
    bend: float = 1.0
    iterations: float = 4.2
    trial: float = 0.02
    trial_steps: int = 10


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
    """The first run for an accuracy: method, overrides of the scene, expected time, and the reasons in words."""

    method: str
    overrides: tuple[str, ...]
    seconds: float
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
    return _from_study(scene, accuracy, study) or _from_table(scene, accuracy)


def _from_study(scene: Scene, accuracy: float, path: Path) -> Choice | None:
    known = _same_study(scene, path)
    for run in known:
        if run["curve_error"] > accuracy or run["solver"] not in REFINED:
            continue
        overrides = tuple(one for one in run["overrides"] if not one.startswith("effects."))
        try:
            require(prepare(parse_scene(scene.model_dump(), overrides), run["solver"]))
        except (NotRun, Refusal):
            continue
        what = f"{run['method']} of degree {run['degree']} with {run['dofs']} unknowns"
        took = f"took {duration(run['seconds'])} in {path} and was within {run['curve_error']:.2g}"
        return Choice(run["solver"], overrides, run["seconds"], f"{what}: {took}")
    return None


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
    elements = GUESS.safety * elements_for(accuracy)
    degree = 2 if thickness_error(scene, 2, 1) <= GUESS.through * accuracy else 3
    overrides = (*_steps(scene, accuracy), *with_elements(scene, CHOSEN, degree, elements))
    chosen = parse_scene(scene.model_dump(), overrides)
    require(prepare(chosen, CHOSEN))
    seconds = predicted_seconds(chosen, CHOSEN, iterations(chosen, CHOSEN))
    mesh = f"NURBS of degree {degree} with {unknowns(chosen, CHOSEN)} unknowns"
    zone = f"{expected(chosen, CHOSEN).elements:.1f} elements in the process zone"
    return Choice(CHOSEN, overrides, seconds, f"{mesh}, {zone}: about {duration(seconds)}")


def _steps(scene: Scene, accuracy: float) -> tuple[str, ...]:
    """At least the number of steps of the scene, or for steps "auto" a bend no larger than that of the scene."""
    asked = scene.discretization
    if asked.steps == "auto":
        return (f"discretization.bend={min(bend(scene), max(GUESS.bend * accuracy, 1e-5))!r}",)
    return (f"discretization.steps={max(asked.steps, DEFAULT_STEPS)}",)


def iterations(scene: Scene, method: str) -> float:
    """Estimated number of Newton iterations of a run."""
    finite = prepare(scene, method).effects["kinematics"] == "finite"
    return (GUESS.iterations if finite else 1.0) * steps(scene, method)


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
    more = elements
    for _ in range(20):
        overrides = (*of_degree, "discretization.dofs=auto", f"discretization.in_a_zone={more:.6g}")
        try:
            mesh = prepare(parse_scene(scene.model_dump(), overrides), method).mesh
        except (SceneError, Unsuitable):  # more elements in a zone, or on the way of the crack, than there may be
            break
        if mesh is not None and mesh.unknowns > GUESS.largest:
            break
        if mesh is not None and mesh.degree >= degree:
            return overrides
        more *= 1.2
    raise Refusal(f"--accuracy: no mesh is known with {elements:.1f} elements in the process zone of {scene.name}")


def predicted_seconds(scene: Scene, method: str, iterations: float) -> float:
    """Time of a run with this number of Newton iterations, from a trial of a few steps on the same mesh.

    The time of an iteration is the median over these steps; the rest of the trial is the set-up.
    """
    begun = max(map(abs, scene.load.opening)) * GUESS.trial
    short = (f"load.opening={begun!r}", f"discretization.steps={GUESS.trial_steps}")
    times, numbers = [perf_counter()], []

    def note(row: Mapping[str, float]) -> None:
        times.append(perf_counter())
        numbers.append(max(row["newton_iterations"], 1.0))

    solve(parse_scene(scene.model_dump(exclude={"published"}), short), method, note)
    each = float(np.median(np.diff(times)[1:] / numbers[1:]))
    return perf_counter() - times[0] + each * (iterations - sum(numbers))
