"""About how long a run takes, before it is made: for bars, for dry runs, and to choose a mesh."""

from __future__ import annotations

from verify.methods import WITH_DOFS, counted_steps
from verify.schema import Scene

#: Seconds a run takes to start, and seconds a step per thousand unknowns to the power ``GROWTH``; measured on one core
#: of a Xeon of 2023 with `dcb-czm1`, finite kinematics. A rough guide: the next machine is as likely twice as fast.
START = {"dolfinx": 3.0}
PER_STEP = {"tspline": 0.05, "nurbs": 0.05, "lagrange": 0.05, "dolfinx": 0.1, "beam": 0.02, "lefm": 0.001}
GROWTH = 1.1

#: Steps that the path chooses itself, about.
CHOSEN = 60


def seconds(scene: Scene, method: str) -> float:
    """Estimated time of a run."""
    steps = CHOSEN if scene.discretization.steps == "auto" and method in WITH_DOFS else counted_steps(scene)
    return START.get(method, 1.0) + steps * PER_STEP[method] * (unknowns(scene, method) / 1000) ** GROWTH


def unknowns(scene: Scene, method: str) -> int:
    """Degrees of freedom that a method aims at; 1000 for one without a mesh of its own choosing."""
    if method in WITH_DOFS:
        return scene.discretization.dofs // (2 if scene.effects.symmetry else 1)
    if method != "dolfinx":
        return 1000
    p, n = scene.dolfinx.degree, scene.dolfinx.elements
    return 4 * (p * n + 1) * (p + 1)
