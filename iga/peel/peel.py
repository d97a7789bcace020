"""The peel test: a strip bonded on a clamped substrate, its free end pulled up."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from iga.peel.meshes import meshes, tmeshes
from iga.peel.problem import Problem
from iga.run import OnFrame, Solution, run
from iga.specimen.body import Body, mean_row
from iga.specimen.bond import control_points
from iga.specimen.delamination import Delamination, Supports, meshes_of
from iga.specimen.specimen import Specimen, discretised
from iga.system.system import Phase, untimed


def build(problem: Problem, phase: Phase = untimed) -> Specimen:
    """Discrete system of a problem with all that is needed to read results from its states."""
    with phase("mesh"):
        drawn, pair = meshes_of(problem, lambda: tmeshes(problem), lambda: meshes(problem))
    with phase("basis"):
        layout = Delamination(
            meshes=pair,
            tmeshes=drawn,
            elasticity=tuple(one.elasticity(problem.plane) for one in (problem.strip, problem.substrate)),
            bonded=(problem.bond_length, 0.0),
            face=(min(problem.strip_length, problem.substrate_length), 0.0),
            loads=(("right", 1.0), ("", 0.0)),
            loaded_at=problem.strip_length,
            path_end=problem.strip_length,
            supports=lambda bodies: _supports(problem, bodies),
        )
        return discretised(problem, layout)


def solve(
    problem: Problem,
    on_step: Callable[[Mapping[str, float]], None] | None = None,
    phase: Phase = untimed,
    on_frame: OnFrame | None = None,
) -> Solution:
    """Solve a peel test; parameters, result and refusals as those of `iga.dcb.dcb.solve`."""
    return run(problem, build(problem, phase), on_step, phase, on_frame=on_frame)


def _supports(problem: Problem, bodies: tuple[Body, ...]) -> Supports:
    """The base of the substrate clamped, and the spring that keeps the strip from sliding along the substrate.

    An interface without friction does not. The spring holds the mean of the strip's left end and carries what the
    tractions amount to lengthwise: nothing in linear kinematics, where they stay across the specimen, and in finite
    kinematics as much as the master's surface tilts where they pull.
    """
    strip, substrate = bodies
    free_Ai = np.ones_like(control_points(bodies), dtype=bool)
    free_Ai[substrate.surface("bottom").conn_ca] = False
    row_d = mean_row(strip.face("left"), problem.pose.axes_kI[0], free_Ai.size)
    stiffness = problem.strip.E1 * problem.strip_thickness * problem.width / problem.strip_length
    return Supports(row_d[None], np.array([stiffness]), free_Ai.ravel())
