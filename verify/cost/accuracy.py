"""``debond solve --accuracy``: method and mesh from what is known of the cost, and how long the run will take.

Where a study of the same scene is at hand its front decides. Otherwise the elements that must span the process zone
are read off `known.csv`, which says where its numbers come from; a trial of a few steps on the chosen mesh tells the
time of an iteration, on this machine and now, and the length of the crack to be grown how many there will be.
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

from verify.cost.ladder import FAMILIES, STEPS, Try, size_of_an_element
from verify.effects import simulated
from verify.estimate import steps
from verify.fingerprint import source
from verify.methods import NotRun, known_methods, require, solve
from verify.plain import Damaged, read_json
from verify.process_zone import expected
from verify.progress import duration
from verify.refusal import Refusal
from verify.run import machine
from verify.say import say
from verify.scene import SceneError, parse_scene
from verify.schema import Scene

KNOWN = Path(__file__).with_name("known.csv")

#: The family that is chosen where only the table is known.
FAMILY = next(family for family in FAMILIES if family.name == "nurbs-p2")

#: Accuracies that can be asked for; from the table more elements than it says are taken.
FINEST, COARSEST, SAFETY = 0.0005, 0.05, 1.2

#: Newton iterations a step: of finite kinematics measured on ``dcb-czm1`` and ``peel-120``; a linear bulk takes one.
ITERATIONS_PER_STEP = {"finite": 3.2, "linear": 1.0}

#: A trial goes this part of the way in about so many steps.
TRIAL, TRIAL_STEPS = 0.02, 10


#: What is read of a study.
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
    """What to run for an accuracy: overrides of the scene, and the sentence that says so beforehand."""

    method: str
    overrides: tuple[str, ...]
    seconds: float
    why: str


def choose(scene: Scene, accuracy: float, study: Path) -> Choice:
    """Method and mesh for a curve error of at most ``accuracy``.

    Parameters
    ----------
    study : a ``cost.json``, which counts if it is of the same scene and machine and of this source

    Raises
    ------
    Refusal : an accuracy beyond what is known, or a scene of which no mesh is fine enough.
    """
    if not FINEST <= accuracy <= COARSEST:
        raise Refusal(f"--accuracy: must be >= {FINEST:.2%} and <= {COARSEST:.0%}, got {100 * accuracy:g}%")
    return _from_study(scene, accuracy, study) or _from_table(scene, accuracy)


def _from_study(scene: Scene, accuracy: float, path: Path) -> Choice | None:
    known = _same_study(scene, path)
    for run in known:
        if run["curve_error"] > accuracy or run["solver"] == "beam" or run["solver"] not in known_methods():
            continue
        try:
            require(parse_scene(scene.model_dump(), run["overrides"]), run["solver"])
        except (NotRun, Refusal):
            continue
        what = f"{run['method']} of degree {run['degree']} with {run['dofs']} unknowns"
        took = f"took {duration(run['seconds'])} in {path} and was within {run['curve_error']:.2g}"
        return Choice(run["solver"], tuple(run["overrides"]), run["seconds"], f"{what}: {took}")
    return None


def _same_study(scene: Scene, path: Path) -> Sequence[Mapping[str, Any]]:
    """Runs of a study of the same problem, machine and source, the quickest first; none of one that is damaged."""
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
    elements = SAFETY * elements_for(accuracy)
    one = Try(FAMILY, 0, unknowns_for(scene, elements), STEPS)
    overrides = one.job(scene.name, scene).overrides
    chosen = parse_scene(scene.model_dump(), overrides)
    require(chosen, FAMILY.solver)
    number = steps(chosen, FAMILY.solver)
    each = ITERATIONS_PER_STEP[simulated(chosen, FAMILY.solver)["kinematics"]]
    seconds = run_seconds(chosen, FAMILY.solver, each * number)
    mesh = f"NURBS of degree {FAMILY.degree} with {one.size} unknowns, {elements:.1f} elements in the process zone"
    return Choice(FAMILY.solver, overrides, seconds, f"{mesh}: about {duration(seconds)}, {number} steps")


def elements_for(accuracy: float) -> float:
    """Elements that span the process zone where the curve error of every scene in the table is at most this."""
    with KNOWN.open(newline="") as stream:
        rows = list(csv.DictReader(line for line in stream if not line.startswith("#")))
    scenes = dict.fromkeys(row["scene"] for row in rows)
    return max(_crossing([row for row in rows if row["scene"] == scene], accuracy) for scene in scenes)


def _crossing(rows: Sequence[Mapping[str, str]], accuracy: float) -> float:
    """Where the error comes below a value for good; beyond the table on with its slope.

    A mesh that a finer one is worse than is good by chance, and does not count.
    """
    e, error = (np.log([float(row[key]) for row in rows]) for key in ("elements", "curve_error"))
    counts = error == np.maximum.accumulate(error[::-1])[::-1]
    e, error = e[counts], error[counts]
    if np.log(accuracy) < error[-1]:
        return float(np.exp(e[-1] + (np.log(accuracy) - error[-1]) / np.polyfit(e, error, 1)[0]))
    return float(np.exp(np.interp(-np.log(accuracy), -error, e)))


def unknowns_for(scene: Scene, elements: float) -> int:
    """Unknowns with which at least so many elements span the process zone."""
    size = round(size_of_an_element(scene, FAMILY) * elements)
    for _ in range(40):
        try:
            chosen = parse_scene(scene.model_dump(), Try(FAMILY, 0, size, STEPS).job(scene.name, scene).overrides)
        except SceneError:  # more unknowns than a scene may have
            break
        there = expected(chosen, FAMILY.solver).elements
        if there >= elements:
            return size
        size = round(size * (min(elements / there, 1.5) if there > 0.0 else 1.2)) + 8
    raise Refusal(f"--accuracy: no mesh is known with {elements:.1f} elements in the process zone of {scene.name}")


def run_seconds(scene: Scene, method: str, iterations: float) -> float:
    """Time of a run of so many Newton iterations, from a few steps on the same mesh.

    An iteration, with what belongs to it, takes the median over these steps; the rest is for what is done once.
    """
    begun = max(map(abs, scene.load.opening)) * TRIAL
    short = (f"load.opening={begun!r}", f"discretization.steps={TRIAL_STEPS}")
    times, numbers = [perf_counter()], []

    def note(row: Mapping[str, float]) -> None:
        times.append(perf_counter())
        numbers.append(max(row["newton_iterations"], 1.0))

    solve(parse_scene(scene.model_dump(exclude={"published"}), short), method, note)
    each = float(np.median(np.diff(times)[1:] / numbers[1:]))
    return perf_counter() - times[0] + each * (iterations - sum(numbers))
