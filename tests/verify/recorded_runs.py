"""Small runs, recorded once: what a check says of a run and of a fault in it needs no solver.

    ./debond exec python tests/verify/recorded_runs.py [NAME ...]     makes them again

A slow test solves them anew and compares (`checks/test_real_runs.py`). A file is the columns of the steps; its first
line has the unknowns, the elements, the status and the ending. ``net.json`` has of every packaged scene by every method
the numbers of `told`, which a change that means to change no result leaves as they are.

    ./debond exec python tests/verify/recorded_runs.py net [SCENE ...]
"""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path

import numpy as np

from verify.curves.curve import load_at
from verify.curves.of_run import peak_load, work
from verify.methods.names import METHODS
from verify.methods.solve import solve
from verify.result import Result
from verify.scene.load import load_scene, packaged_scenes
from verify.scene.schema import Scene
from verify.support.refusal import Refusal

FOLDER = Path(__file__).parent / "recorded"
NET = FOLDER / "net.json"

CLOSING = ("dcb-czm1-linear", "discretization.steps=60", "load.opening=[-0.002, 0.8, -0.004, 1.0]")
PEEL = ("peel-60", "discretization.dofs=2000", "discretization.steps=40", "load.opening=[1.0, -0.5, 1.5]")
STOCKY = (
    "dcb-czm1",
    "specimen={kind='dcb', length=40.0, arm_thickness=3.0, precrack=12.0, width=10.0}",
    "material={young=70e3, poisson=0.3}",
    "interface={strength=20.0, toughness=0.5}",
    "discretization.dofs=900",
    "load.opening=[0.3, 0.05, 0.5]",
)
SMALL = ("dcb-czm1", "discretization.dofs=1200", "discretization.steps=40")

#: Name -> scene with its overrides, and method.
RUNS: Mapping[str, tuple[tuple[str, ...], str]] = {
    "beam": (("dcb-czm1-linear", "discretization.steps=60"), "beam"),
    "small": ((*SMALL, "load.opening=1.2"), "nurbs"),
    "wide": ((*SMALL, "load.opening=1.2", "specimen.width=1.1"), "nurbs"),
    "fine": (("dcb-czm1-linear", "discretization.dofs=1400", "discretization.steps=60"), "nurbs"),
    "pressed": (("dcb-czm1-linear", "discretization.steps=4", "load.opening=-0.004"), "nurbs"),
    "unloaded": (("dcb-czm1-linear", "load.opening=[1.0, 0.4, 1.1]"), "nurbs"),
    "closing": (CLOSING, "nurbs"),
    "closing-peel": (PEEL, "tspline"),
    "through": ((*CLOSING, "effects.contact=false"), "nurbs"),
    "stocky": ((*STOCKY, "effects.kinematics=finite"), "nurbs"),
    "stocky-linear": ((*STOCKY, "effects.kinematics=linear"), "nurbs"),
    "slid": (("enf-as4peek", "load.opening=[3.5, 0.35]", "discretization.dofs=2000"), "nurbs"),
    "short-beam": ((*SMALL, "specimen.length=5.5", "load.opening=0.6"), "beam"),
    "short-through": ((*SMALL, "specimen.length=5.5", "load.opening=0.6", "effects.contact=false"), "nurbs"),
    "ligament": ((*SMALL, "specimen.length=4.7", "load.opening=0.6", "interface.penalty=1e7"), "nurbs"),
    "slender": (("dcb-czm1", "specimen.arm_thickness=0.05", "load.opening=8", "discretization.steps=40"), "nurbs"),
    "upright": (("peel-soft", "discretization.steps=15", "beam.in_a_zone=20"), "beam"),
    "limp": (("moments", "specimen.moments=[1.0, 1.0]", "specimen.arm_thickness=0.4", "load.opening=0.4"), "beam"),
}


def scene_of(name: str) -> Scene:
    (scene, *words), _ = RUNS[name]
    return load_scene(scene, words)


@cache
def recorded(name: str) -> Result:
    """The run of `scene_of` the name."""
    with (FOLDER / f"{name}.csv").open() as lines:
        dofs, elements, status, ending = next(lines).rstrip("\n").split(",", 3)
        columns, table = next(lines).rstrip("\n").split(","), np.loadtxt(lines, delimiter=",", ndmin=2)
    return Result(
        RUNS[name][1], dict(zip(columns, table.T, strict=True)), status, ending, "", 0.0, int(dofs), int(elements)
    )


def record(name: str) -> None:
    run = solve(scene_of(name), RUNS[name][1])
    head = f"{run.dofs},{run.elements},{run.status},{run.ending}\n{','.join(run.steps)}"
    np.savetxt(FOLDER / f"{name}.csv", np.stack(list(run.steps.values()), 1), "%.15g", ",", header=head, comments="")


def told(name: str, method: str) -> list[float] | None:
    """Unknowns, peak load, work, dissipated energy, and the load at eight equal openings of a packaged scene; None
    where the method does not solve it."""
    try:
        run = solve(load_scene(name), method)
    except Refusal:
        return None
    curve = (run.opening, run.load)
    at = np.max(run.opening) * np.arange(1, 9) / 8
    spent = run.steps.get("dissipated_energy", np.zeros(1))[-1]
    return [float(f"{x:.9g}") for x in (run.dofs, peak_load(run), work(run), spent, *load_at(curve, at))]


def cast(names: Sequence[str]) -> None:
    """Write the net of all packaged scenes, or these again."""
    net = json.loads(NET.read_text()) if NET.exists() else {}
    for name in names or packaged_scenes():
        net[name] = {method: found for method in METHODS if (found := told(name, method)) is not None}
        NET.write_text(json.dumps(net, indent=1, sort_keys=True) + "\n")
        print(name, *net[name], flush=True)


if __name__ == "__main__":
    if sys.argv[1:2] == ["net"]:
        sys.exit(cast(sys.argv[2:]))
    for one in sys.argv[1:] or RUNS:
        record(one)
        print(one, recorded(one).opening.size, flush=True)
