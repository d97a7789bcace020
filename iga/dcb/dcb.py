"""The double cantilever beam: two arms, one interface, opened at one end."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from iga.dcb.adaptive import Window, adapted_tmeshes, carried, first_window, followed
from iga.dcb.meshes import arm_meshes, crack_path, tmeshes
from iga.dcb.problem import Problem
from iga.path.point import Point
from iga.run import OnFrame, Solution, run
from iga.specimen.body import Body, edge_row, mean_row, point_row
from iga.specimen.bond import control_points
from iga.specimen.delamination import Delamination, Supports, meshes_of
from iga.specimen.specimen import Specimen, discretised
from iga.system.state import State
from iga.system.system import Phase, untimed

#: Stiffness of a tie that hardly gives, relative to the modulus times the width: that of the stiffest elements.
TIE = 10.0


def build(problem: Problem, phase: Phase = untimed, window: Window | None = None) -> Specimen:
    """Discrete system of a problem with all that is needed to read results from its states.

    ``window`` is the fine part of an adaptive mesh, the first one if left out.
    """
    with phase("mesh"):
        window = window or (first_window(problem) if follows(problem) else None)
        drawn, meshes = meshes_of(
            problem,
            lambda: tmeshes(problem) if window is None else adapted_tmeshes(problem, window),
            lambda: arm_meshes(problem),
        )
    arms = slice(1 if problem.symmetry else 2)
    with phase("basis"):
        layout = Delamination(
            meshes=meshes[arms],
            tmeshes=drawn[arms],
            elasticity=(problem.elasticity,) * len(meshes[arms]),
            bonded=(problem.precrack, problem.length),
            face=(0.0, problem.length),
            loads=(("left", 2.0),) if problem.symmetry else (("left", 1.0), ("left", -1.0)),
            loaded_at=0.0,
            path_end=problem.length if problem.meshes else window.end if window else crack_path(problem),
            supports=lambda bodies: _supports(problem, bodies),
            copies=2.0 if problem.symmetry else 1.0,
        )
        return discretised(problem, layout)


def solve(
    problem: Problem,
    on_step: Callable[[Mapping[str, float]], None] | None = None,
    phase: Phase = untimed,
    on_frame: OnFrame | None = None,
) -> Solution:
    """Solve a double cantilever beam.

    Parameters
    ----------
    problem : the specimen, its law, programme, mesh and pose.
    on_step : called with the row of every converged step, as it comes.
    phase : context manager that times "mesh", "basis", "assembly", "factor", "solve".
    on_frame : called with the opening of every converged step and what makes its frame (see `iga.output.frames`).

    Returns
    -------
    Solution; its ``status`` says whether the whole programme was run.

    Raises
    ------
    ValueError : a problem for which there is no mesh or no material.
    """
    if not follows(problem):
        return run(problem, build(problem, phase), on_step, phase, on_frame=on_frame)
    first = first_window(problem)

    def adapt(specimen: Specimen, point: Point) -> tuple[Specimen, State] | None:
        window = followed(problem, first.roots, specimen, point)
        if window is None:
            return None
        moved = build(problem, phase, window)
        state = carried(specimen, moved, point, phase)
        return None if state is None else (moved, state)

    return run(problem, build(problem, phase, first), on_step, phase, adapt, on_frame)


def follows(problem: Problem) -> bool:
    """Whether the mesh follows the process zone."""
    return problem.adaptive and problem.basis == "tspline" and not problem.meshes


def _supports(problem: Problem, arms: tuple[Body, ...]) -> Supports:
    """The rigid motions of the whole, held by springs, and the arms tied together at their far ends.

    The lower arm's corner of interface and far end is held along and across the specimen, and how far the two loaded
    faces are out of line takes the rotation: the rigid motions of the whole, so that these springs carry no force. An
    interface without friction leaves one arm free to slide along the other. A tie between their far faces carries what
    the tractions of a bent interface amount to lengthwise, at the interface, but spread over the faces: in a corner it
    would hold energy without bound. One arm alone is held along the specimen.
    """
    P_AI, pose = control_points(arms), problem.pose
    (along_i, across_i), free_d = pose.axes_kI, np.ones(P_AI.size, dtype=bool)
    corner = pose.place(np.array([problem.length, 0.0]))
    at = [arm.first + int(np.argmin(np.linalg.norm(arm.mesh.P_AI - corner, axis=1))) for arm in arms]
    soft = problem.E1 * problem.width * problem.arm_thickness / problem.length
    along_rd = [point_row(A, along_i, P_AI.size) for A in at]
    if len(arms) == 1:
        return Supports(np.array(along_rd), np.array([soft]), free_d)
    upper_d, lower_d = (mean_row(arm.face("left"), along_i, P_AI.size) for arm in arms)
    ends_d = [edge_row(arm.face("right"), lambda X: np.abs(pose.own(X)[..., 1]), along_i, P_AI.size) for arm in arms]
    rows = [along_rd[1], point_row(at[1], across_i, P_AI.size), upper_d - lower_d, ends_d[0] - ends_d[1]]
    return Supports(np.array(rows), np.array([soft, soft, soft, TIE * problem.E1 * problem.width]), free_d)
