"""Where a point of the slave meets the master, and how the surface continues beyond its ends."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from iga.interface.closest_point import PROJECTION, Pairing
from iga.interface.surface import Surface

#: Points beyond an end by less than this part of the side count as on it.
AT_END = 1e-9


@dataclass(frozen=True)
class MasterPoints:
    """Places on the master; points beyond its ends or on a kink meet the straight continuation of a side.

    ``c_q`` sides; ``M_qb`` and ``dM_qb`` (n_q, n_b) functions there and their derivatives; ``t_qi`` and ``t_xi_qi``
    (n_q, 2) first and second derivatives of the position, the second zero on a continuation; ``share_q`` (n_q,) part of
    a point's area that faces the master, ``fading_q`` (n_q,) its logarithmic derivative by the parameter; ``eta_q``
    (n_q,) distance beyond the end of the side, in its parameter; ``straight_q`` (n_q,) points on a continuation.
    """

    c_q: np.ndarray
    M_qb: np.ndarray
    dM_qb: np.ndarray
    t_qi: np.ndarray
    t_xi_qi: np.ndarray
    share_q: np.ndarray
    fading_q: np.ndarray
    eta_q: np.ndarray
    straight_q: np.ndarray


def master_points(master: Surface, pairing: Pairing, x_qi: np.ndarray, y_AI: np.ndarray) -> MasterPoints:
    """Where the points x_qi (n_q, 2) meet the master with the control points y_AI (n_A, 2).

    Beyond the end of a side, at the parameter distance ``eta``, the surface continues along its tangent,
    ``y + eta y'``: the gap is then as smooth as the motion, its variation complete, and the forces are in balance. A
    point beyond an end of the chain carries its full traction up to `ProjectionLimits.held` and none from ``free`` on.
    In between its share falls smoothly, as its area slides off the master little by little.
    """
    c_q, xi_q = pairing.c_q, pairing.xi_q
    r0, r1, r2 = master.coefficients(c_q, xi_q, 2)
    Q_qbi = master.bezier_points(y_AI, c_q)
    t_qi, t_xi_qi = [(r[:, None] @ Q_qbi)[:, 0] for r in (r1, r2)]
    (share_q, fading_q, eta_q), straight_q = np.zeros((3, len(c_q))), np.zeros(len(c_q), dtype=bool)
    share_q += 1.0
    edge = np.flatnonzero((xi_q == 0.0) | (xi_q == 1.0))
    if edge.size:
        t, way = t_qi[edge], np.where(xi_q[edge] == 1.0, 1.0, -1.0)
        d = x_qi[edge] - (r0[edge][:, None] @ Q_qbi[edge])[:, 0]
        eta = np.sum(d * t, -1) / np.sum(t * t, -1)
        eta_q[edge] = eta
        r0[edge] += eta[:, None] * r1[edge]
        straight_q[edge] = way * eta > AT_END
        t_xi_qi[straight_q] = 0.0
        at_end = master.following(c_q[edge], way.astype(int)) == c_q[edge]
        share, rate = _share(np.where(at_end, way * eta, 0.0))
        share_q[edge], fading_q[edge] = share, way * rate
    M_qb, dM_qb = [master.functions(c_q, r) for r in (r0, r1)]
    return MasterPoints(c_q, M_qb, dM_qb, t_qi, t_xi_qi, share_q, fading_q, eta_q, straight_q)


def _share(over: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Share of a point beyond an end by ``over``, in parts of the side, and its logarithmic derivative.

    ``(1 - s)^2 (1 + 2 s)``, with s from 0 at `ProjectionLimits.held` to 1 at ``free``.
    """
    held, free = PROJECTION.held, PROJECTION.free
    s = np.clip((over - held) / (free - held), 0.0, 1.0)
    left = np.where(s < 1.0, 1.0 - s, 1.0)
    return (1.0 - s) ** 2 * (1.0 + 2.0 * s), -6.0 * np.where(s < 1.0, s, 0.0) / (left * (1.0 + 2.0 * s) * (free - held))
