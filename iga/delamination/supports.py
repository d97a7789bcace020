"""What holds a specimen: the rigid motions of one that floats, or clamps and the anchor of a body on a clamped one."""

from __future__ import annotations

import numpy as np

from iga.specimen.body import Body, edge_row, mean_row, point_row
from iga.specimen.bond import control_points
from iga.specimen.patch import patch_rows
from iga.specimen.problem import Debonding
from iga.specimen.specimen import Supports

#: Stiffness of a tie that hardly gives, relative to the modulus times the width: that of the stiffest elements.
TIE = 10.0
#: Stiffness of a roller, relative to the same.
ROLLER = 100.0


def supports(problem: Debonding, bodies: tuple[Body, ...]) -> Supports:
    """The supports of a specimen's layout."""
    if problem.layout.supports:
        return _on_rollers(problem, bodies)
    return _clamped(problem, bodies) if problem.layout.clamps else _floating(problem, bodies)


def _on_rollers(problem: Debonding, arms: tuple[Body, ...]) -> Supports:
    """Stiff springs on the patches of the supports, and a soft one along the specimen, which carries no force.

    Springs of `ROLLER` times the modulus times the width are as good as rigid: they give way by about a millionth of
    the deflection. The modulus is that of the stiffer arm, whichever is up.
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
    """The rigid motions of the whole, held by springs, and the arms tied together at their far ends.

    The lower arm's corner of interface and far end is held along and across the specimen, and how far the two loaded
    faces are out of line takes the rotation: the rigid motions of the whole, so that these springs carry no force. An
    interface without friction leaves one arm free to slide along the other. A tie between their far faces carries what
    the tractions of a bent interface amount to lengthwise, at the interface, but spread over the faces: in a corner it
    would hold energy without bound. One arm alone is held along the specimen.
    """
    P_AI, pose, upper = control_points(arms), problem.pose, problem.layout.bodies[0]
    (along_i, across_i), free_d = pose.axes_kI, np.ones(P_AI.size, dtype=bool)
    corner = pose.place(np.array([upper.length, 0.0]))
    at = [arm.first + int(np.argmin(np.linalg.norm(arm.mesh.P_AI - corner, axis=1))) for arm in arms]
    soft = upper.moduli.E1 * problem.width * upper.thickness / upper.length
    along_rd = [point_row(A, along_i, P_AI.size) for A in at]
    if len(arms) == 1:
        return Supports(np.array(along_rd), np.array([soft]), free_d)
    upper_d, lower_d = (mean_row(arm.ends["left"], along_i, P_AI.size) for arm in arms)
    ends_d = [edge_row(arm.ends["right"], lambda X: np.abs(pose.own(X)[..., 1]), along_i, P_AI.size) for arm in arms]
    rows = [along_rd[1], point_row(at[1], across_i, P_AI.size), upper_d - lower_d]
    if problem.mixed is not None:  # the bond itself keeps the arms from sliding
        return Supports(np.array(rows), np.full(3, soft), free_d)
    rows.append(ends_d[0] - ends_d[1])
    return Supports(np.array(rows), np.array([soft, soft, soft, TIE * upper.moduli.E1 * problem.width]), free_d)


def _clamped(problem: Debonding, bodies: tuple[Body, ...]) -> Supports:
    """The clamps, and the spring that keeps the upper body from sliding along the lower one.

    An interface without friction does not. The spring holds the mean of the unloaded end of the upper body and carries
    what the tractions amount to lengthwise: nothing in linear kinematics, where they stay across the specimen, and in
    finite kinematics as much as the master's surface tilts where they pull.
    """
    upper = problem.layout.bodies[0]
    free_Ai = np.ones_like(control_points(bodies), dtype=bool)
    for body, side in problem.layout.clamps:
        free_Ai[bodies[body].surface(side).conn_ca] = False
    row_d = mean_row(bodies[0].ends["left"], problem.pose.axes_kI[0], free_Ai.size)
    stiffness = upper.moduli.E1 * upper.thickness * problem.width / upper.length
    return Supports(row_d[None], np.array([stiffness]), free_Ai.ravel())
