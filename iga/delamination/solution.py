"""From the problem of a delamination specimen to its discrete system and its solution.

A specimen is held by springs against the rigid motions of a floating one, by rollers, or by clamps with an anchor.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from iga.delamination.adaptive import Window, carried, first_window, followed
from iga.delamination.meshes import drawn, follows
from iga.path.point import Point
from iga.run import OnFrame, Solution, run
from iga.specimen.body import Body, edge_row, mean_row, point_row
from iga.specimen.bond import control_points
from iga.specimen.patch import patch_rows
from iga.specimen.problem import Debonding
from iga.specimen.specimen import Specimen, Supports, discretised
from iga.system.state import State
from iga.system.system import Phase, untimed

#: Stiffness of a nearly rigid tie, relative to the modulus times the width: that of the stiffest elements.
TIE = 10.0
#: Stiffness of a roller, relative to the modulus times the width.
ROLLER = 100.0


def supports(problem: Debonding, bodies: tuple[Body, ...]) -> Supports:
    """The supports of a specimen's layout."""
    if problem.layout.supports:
        return _on_rollers(problem, bodies)
    return _clamped(problem, bodies) if problem.layout.clamps else _floating(problem, bodies)


def _on_rollers(problem: Debonding, arms: tuple[Body, ...]) -> Supports:
    """Stiff springs on the patches of the supports, and a soft one along the specimen, which carries no force.

    Springs of `ROLLER` times the modulus times the width are nearly rigid: they deform by about a millionth of the
    deflection. The modulus is that of the stiffer arm.
    """
    bodies, n_dof, pose = problem.layout.bodies, control_points(arms).size, problem.pose
    modulus = max(body.moduli.E1 for body in bodies)
    rows = tuple(patch_rows(arms, support, pose, n_dof) for support in problem.layout.supports)
    stiff = ROLLER * modulus * problem.width
    lever = sum(body.thickness for body in bodies)
    spring_r = [stiff * (lever**2 if support.couple else 1.0) for support in problem.layout.supports]
    along_d = mean_row(arms[-1].ends["right"], pose.axes_kI[0], n_dof)
    soft = modulus * problem.width * max(body.thickness for body in bodies) / bodies[0].length
    springs_rd = np.array([*(row.mean_d for row in rows), along_d])
    return Supports(springs_rd, np.array([*spring_r, soft]), np.ones(n_dof, dtype=bool), rows)


def _floating(problem: Debonding, arms: tuple[Body, ...]) -> Supports:
    """Springs that hold the rigid motions of the whole specimen, and a tie between the far ends of the arms.

    One corner of the lower arm, at the interface and the far end, is held along and across the specimen. The rotation
    is held by a spring on the axial offset between the two loaded faces. As these are rigid motions of the whole, the
    springs carry no force. Without friction one arm could slide along the other. A tie between the far faces prevents
    this and carries the axial resultant of the tractions of a bent interface. Its force acts at the interface but is
    spread over the faces: in a corner its energy would have no bound. One arm alone is held along the specimen only.
    """
    P_AI, pose, upper = control_points(arms), problem.pose, problem.layout.bodies[0]
    (along_i, across_i), free_d = pose.axes_kI[:2], np.ones(P_AI.size, dtype=bool)
    corner = pose.place(np.array([upper.length, 0.0, 0.0][: pose.d]))
    at = [arm.first + int(np.argmin(np.linalg.norm(arm.mesh.P_AI - corner, axis=1))) for arm in arms]
    soft = upper.moduli.E1 * problem.width * upper.thickness / upper.length
    along_rd = [point_row(A, along_i, P_AI.size) for A in at]
    if len(arms) == 1:
        return Supports(np.array(along_rd), np.array([soft]), free_d)
    upper_d, lower_d = (mean_row(arm.ends["left"], along_i, P_AI.size) for arm in arms)
    ends_d = [edge_row(arm.ends["right"], lambda X: np.abs(pose.own(X)[..., 1]), along_i, P_AI.size) for arm in arms]
    rows = [along_rd[1], point_row(at[1], across_i, P_AI.size), upper_d - lower_d]
    if problem.law.slides:  # the bond itself keeps the arms from sliding
        return Supports(np.array(rows), np.full(3, soft), free_d)
    rows.append(ends_d[0] - ends_d[1])
    return Supports(np.array(rows), np.array([soft, soft, soft, TIE * upper.moduli.E1 * problem.width]), free_d)


def _clamped(problem: Debonding, bodies: tuple[Body, ...]) -> Supports:
    """The clamps, and a spring that keeps the upper body from sliding along the lower one, as there is no friction.

    The spring holds the mean displacement of the unloaded end of the upper body and carries the axial resultant of the
    tractions. It is zero in linear kinematics, where tractions stay normal to the specimen; in finite kinematics it
    comes from the tilt of the master's surface.
    """
    upper = problem.layout.bodies[0]
    free_Ai = np.ones_like(control_points(bodies), dtype=bool)
    for body, side in problem.layout.clamps:
        free_Ai[bodies[body].surface(side).conn_ca] = False
    row_d = mean_row(bodies[0].ends["left"], problem.pose.axes_kI[0], free_Ai.size)
    stiffness = upper.moduli.E1 * upper.thickness * problem.width / upper.length
    return Supports(row_d[None], np.array([stiffness]), free_Ai.ravel())


def build(problem: Debonding, phase: Phase = untimed, window: Window | None = None) -> Specimen:
    """Discrete system of a problem with all that is needed to read results from its states.

    ``window`` is the fine part of an adaptive mesh, the first one if left out.
    """
    with phase("mesh"):
        made = drawn(problem, window)
    with phase("basis"):
        return discretised(problem, made, lambda bodies: supports(problem, bodies))


def solve(
    problem: Debonding,
    on_step: Callable[[Mapping[str, float]], None] | None = None,
    phase: Phase = untimed,
    on_frame: OnFrame | None = None,
) -> Solution:
    """Solve a delamination specimen.

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
