"""Where the dead load acts: on a whole end face, at its corner away from the interface, or in its middle."""

from __future__ import annotations

import numpy as np

from iga.specimen.body import Body, mean_row
from iga.specimen.pose import Pose

#: Parameters on a side of a face at which a point load may act: both ends, and the middle.
PLACES = 257


def pulled_row(body: Body, end: str, at: str, pose: Pose, axis: int, n_dof: int) -> np.ndarray:
    """Row (n_dof,) of the displacement at the load of a body, along (0) or across (1) the specimen.

    Parameters
    ----------
    end : the loaded face, "left" or "right".
    at : "face" (mean over the face), "node" (its corner away from the interface) or "hinge" (mid-thickness).
    """
    direction_i = pose.axes_kI[axis]
    if at == "face":
        return mean_row(body.ends[end], direction_i, n_dof)
    face = body.surface(end)
    c_q = np.repeat(np.arange(face.sides), PLACES)
    (r_qb,) = face.coefficients(c_q, np.tile(np.linspace(0.0, 1.0, PLACES), face.sides), 0)
    N_qa, conn_qa = face.functions(c_q, r_qb), face.conn_ca[c_q]
    X_qI = np.einsum("qa,qaI->qI", N_qa, body.mesh.P_AI[conn_qa - body.first])
    height_q = np.abs(pose.own(X_qI)[:, 1])
    place = height_q.max() if at == "node" else 0.5 * (height_q.min() + height_q.max())
    q = int(np.argmin(np.abs(height_q - place)))
    row_Ai = np.zeros((n_dof // 2, 2))
    row_Ai[conn_qa[q]] = N_qa[q, :, None] * direction_i
    return row_Ai.ravel()
